// Curves with axes, by uPlot, with their data behind them.

import uPlot from "uplot";
import { element } from "./element.js";
import { number } from "./format.js";
import { category, ink, onTheme } from "./palette.js";
import { behind, dataTable } from "./table.js";
import { isolated } from "./text.js";

/** Width of a tick with its text (px). */
const ROOM = 46;
const PATTERNS = [[], [9, 4], [2, 3], [9, 3, 2, 3]];

/**
 * A chart. `x` are the numbers on the axis across, `series` are `{ name, values, low?, high?, counts?, color? }`, where `low` and
 * `high` are the ends of an interval, and `counts` says of how many runs each value is the mean. Options: `across`, `up` (names of
 * the axes with units), `ticks` (the numbers across that have a tick, if there is room for them), `textAcross` (the text of a number across), `steps`, `logarithmic`, `points`, `top`.
 */
export function chart(title, x, series, options) {
  const box = element("div", { class: "plot", role: "img", "aria-label": spoken(title, x, series, options) });
  const textAcross = options.textAcross ?? number;
  let plot = null;
  const data = [x];
  const bands = [];
  for (const one of series) {
    data.push(one.values);
    if (one.low) {
      bands.push({ series: [data.length + 1, data.length], color: one });
      data.push(one.low, one.high);
    }
  }
  const color = (one) => (one.color ? one.color() : category(series.indexOf(one)));
  function make() {
    plot?.destroy();
    const width = Math.max(box.clientWidth, 200);
    const axis = { stroke: ink("faint"), grid: { stroke: ink("grid"), width: 1 }, ticks: { show: false }, font: "12px system-ui", labelFont: "12px system-ui", labelSize: 22,
      values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : tickText(tick))) };
    const lines = series.flatMap((one, i) => [{
      label: one.name, stroke: color(one), width: 2, dash: PATTERNS[Math.floor(i / 7) % PATTERNS.length], spanGaps: true,
      points: { show: Boolean(options.points), size: 6, fill: color(one) }, paths: options.steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
      value: (_, value) => number(value),
    }, ...(one.low ? [0, 1].map(() => ({ label: "", stroke: "transparent", points: { show: false } })) : [])]);
    plot = new uPlot({
      width, height: 280,
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { size: 7 } },
      scales: { x: { time: false, distr: options.logarithmic ? 3 : 1 }, y: options.top ? { range: [0, options.top] } : { range: (_, low, high) => padded(low, high) } },
      axes: [{ ...axis, label: options.across, size: 34, ...(options.ticks ? { splits: (u) => roomy(options.ticks, (tick) => u.valToPos(tick, "x")), values: (_, ticks) => ticks.map(textAcross) } : {}) }, { ...axis, label: options.up, size: 58 }],
      series: [{ label: options.across, value: (_, value) => number(value) }, ...lines],
      bands: bands.map(({ series: pair, color: one }) => ({ series: pair, fill: faded(color(one)) })),
      hooks: { setCursor: [(u) => tell(u)] },
    }, data, box);
    plot.root.querySelectorAll("canvas").forEach((canvas) => canvas.setAttribute("aria-hidden", "true"));
  }
  const read = element("p", { class: "read", "aria-hidden": "true" }, "\u00a0");
  function tell(u) {
    const at = u.cursor.idx;
    if (at === null || at === undefined) {
      read.textContent = "\u00a0";
      return;
    }
    const values = series.filter((one) => one.values[at] !== null && one.values[at] === one.values[at]).slice(0, 6).map((one) => `${isolated(one.name)} ${number(one.values[at])}`);
    read.textContent = `${textAcross(x[at])}: ${values.join(", ")}`;
  }
  new ResizeObserver(([entry]) => {
    const width = Math.floor(entry.contentRect.width);
    if (!plot) make();
    else if (width > 0 && Math.abs(plot.width - width) > 1) plot.setSize({ width, height: 280 });
  }).observe(box);
  onTheme(() => { make(); colorLegend(); });
  const keys = series.map((one) => element("li", {}, element("span", { class: "mark line", "aria-hidden": "true" }), one.name));
  function colorLegend() {
    keys.forEach((key, i) => key.firstChild.style.setProperty("--mark", color(series[i])));
  }
  colorLegend();
  const columns = [{ title: options.across, of: (row) => x[row], text: textAcross }, ...series.flatMap((one) => [
    { title: one.name, of: (row) => one.values[row] },
    ...(one.low ? [{ title: `${isolated(one.name)}, low`, of: (row) => one.low[row] }, { title: `${isolated(one.name)}, high`, of: (row) => one.high[row] }] : []),
    ...(one.counts ? [{ title: `${isolated(one.name)}, runs`, of: (row) => one.counts[row] }] : []),
  ])];
  return element("figure", { class: "chart" }, element("figcaption", {}, title), box, read,
    series.length > 1 ? element("ul", { class: "legend" }, keys) : null,
    behind("Data of this chart", () => dataTable(title, columns, x.length)));
}

/** Those of `ticks` whose texts do not overlap: the last one, and as many before it as there is room for. */
export function roomy(ticks, at) {
  const kept = [];
  for (const tick of [...ticks].reverse()) {
    if (kept.length === 0 || Math.abs(at(kept[0]) - at(tick)) >= ROOM) kept.unshift(tick);
  }
  return kept;
}

function padded(low, high) {
  if (low === null || high === null) return [0, 1];
  const bottom = low >= 0 && low <= 0.6 * high ? 0 : low - 0.08 * (high - low || Math.abs(high) || 1);
  const top = high + 0.08 * (high - bottom || 1);
  return [bottom, top];
}

/** A tick without needless zeros. */
function tickText(tick) {
  const size = Math.abs(tick);
  return size !== 0 && (size < 1e-3 || size >= 1e5) ? tick.toExponential(0).replace("e", "·10^").replace("+", "") : String(Number(tick.toPrecision(6))).replace("-", "−");
}

function faded(color) {
  return `${color}33`;
}

/** The chart in words: what each curve does. */
function spoken(title, x, series, options) {
  const parts = series.slice(0, 8).map((one) => {
    const known = Array.from(one.values).filter((value) => value !== null && Number.isFinite(value));
    if (known.length === 0) return `${isolated(one.name)}: no values`;
    const [low, high] = known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
    return `${isolated(one.name)} from ${number(low)} to ${number(high)}`;
  });
  return `${title}. ${options.up} against ${options.across}, from ${number(x[0])} to ${number(x[x.length - 1])}. ${parts.join("; ")}.`;
}
