// Numbers and words for people.

const UNITS = [
  ["_bit_per_s", "bit/s"], ["_m_per_s", "m/s"], ["_m2", "m²"], ["_dbm", "dBm"], ["_db", "dB"], ["_deg", "°"],
  ["_rad", "rad"], ["_ghz", "GHz"], ["_j", "J"], ["_m", "m"], ["_s", "s"],
];

/** A key of the summary as words and its unit. */
export function wordsOf(key) {
  for (const [end, unit] of UNITS) {
    if (key.endsWith(end)) return { words: key.slice(0, -end.length).replaceAll("_", " "), unit };
  }
  return { words: key.replaceAll("_", " "), unit: "" };
}

/** A number with three significant digits or more, without needless zeros. */
export function number(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return grouped(value);
  const size = Math.abs(value);
  let text;
  if (size >= 1000) text = grouped(Math.round(value));
  else if (size >= 10) text = value.toFixed(1);
  else if (size >= 1) text = value.toFixed(2);
  else if (size >= 0.001) text = value.toPrecision(3);
  else text = value.toExponential(2);
  return text.replace("-", "−");
}

/** A number with all its digits, so that different numbers have different texts. */
export function exact(value) {
  if (!Number.isFinite(value) || Number.isInteger(value)) return number(value);
  return String(value).replaceAll("-", "−");
}

function grouped(value) {
  const digits = String(Math.abs(value));
  const text = digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, "\u202f") : digits;
  return value < 0 ? `−${text}` : text;
}

/** A number with its unit. */
export function withUnit(value, unit) {
  if (unit === "%") return percent(value);
  return unit ? `${number(value)}\u00a0${unit}` : number(value);
}

/** A share as per cent. */
export function percent(share) {
  return share === null || share === undefined || Number.isNaN(share) ? "–" : `${(100 * share).toFixed(1)}\u00a0%`;
}

/** Seconds as a time of the recording. */
export function clockTime(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.floor(seconds);
  const two = (n) => String(n).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)} h` : `${minutes}:${two(whole % 60)} min`;
}

/** `1 node`, `2 nodes`. */
export function counted(count, what) {
  return `${number(count)} ${what}${count === 1 ? "" : "s"}`;
}

/** Round steps for ticks of an axis: 1, 2 or 5 times a power of ten. */
export function niceStep(span, most) {
  const raw = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 5, 10].find((f) => f * power >= raw) ?? 10;
  return factor * power;
}
