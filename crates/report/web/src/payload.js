// Reads the document out of the page. Its texts are those of others: all of them pass here, and are harmless from here on.

import { visible } from "./text.js";

const KINDS = {
  f32: (buffer) => new Float32Array(buffer),
  f32_in_i8: (buffer) => Float32Array.from(new Int8Array(buffer), (one) => (one === -128 ? NaN : one)),
  f64: (buffer) => new Float64Array(buffer),
  u32: (buffer) => new Uint32Array(buffer),
  u32_in_u16: (buffer) => Uint32Array.from(new Uint16Array(buffer)),
  u32_in_u8: (buffer) => Uint32Array.from(new Uint8Array(buffer)),
  u8: (buffer) => new Uint8Array(buffer),
};

function octets(text) {
  const binary = atob(text);
  const made = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) made[i] = binary.charCodeAt(i);
  return made;
}

/** Makes texts harmless, keys too, and turns `{"f32": BASE64}` into a typed array. */
function revive(_key, value) {
  if (typeof value === "string") return visible(value);
  if (value === null || typeof value !== "object" || Array.isArray(value)) return value;
  const entries = Object.entries(value);
  const [kind, text] = entries[0] ?? [];
  if (Object.hasOwn(KINDS, kind) && typeof text === "string") return KINDS[kind](octets(text).buffer);
  return entries.every(([key]) => visible(key) === key) ? value : Object.fromEntries(entries.map(([key, one]) => [visible(key), one]));
}

/** A text of JSON in which whole numbers that a number cannot have exactly, such as large seeds, are texts. */
function withExactNumbers(text) {
  return text.replace(/"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g, (token) =>
    (/^-?\d+$/.test(token) && !Number.isSafeInteger(Number(token)) ? `"${token}"` : token));
}

/** The document of a text of JSON. */
export function documentOf(text) {
  // The summary is a text of JSON within the JSON, so that no program on the way rounds its numbers. It becomes harmless when it is read itself.
  const report = JSON.parse(text, (key, value) => (key === "summary" ? value : revive(key, value)));
  return { ...report, summary: report.summary ? JSON.parse(withExactNumbers(report.summary), revive) : null };
}

/** The document, with typed arrays for its columns. */
export async function readDocument() {
  const packed = octets(document.getElementById("data").textContent.trim());
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return documentOf(await new Response(stream).text());
}
