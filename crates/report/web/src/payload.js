// Reads the document out of the page.

const KINDS = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, u8: Uint8Array };

function octets(text) {
  const binary = atob(text);
  const made = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) made[i] = binary.charCodeAt(i);
  return made;
}

/** Turns `{"f32": BASE64}` into a typed array. */
function revive(_key, value) {
  if (value === null || typeof value !== "object") return value;
  for (const kind in value) {
    if (kind in KINDS && typeof value[kind] === "string") return new KINDS[kind](octets(value[kind]).buffer);
    return value;
  }
  return value;
}

/** The document, with typed arrays for its columns. */
export async function readDocument() {
  const packed = octets(document.getElementById("data").textContent.trim());
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const report = JSON.parse(await new Response(stream).text(), revive);
  // A text within the text, so that no program on the way rounds its numbers.
  return { ...report, summary: report.summary ? JSON.parse(report.summary) : null };
}
