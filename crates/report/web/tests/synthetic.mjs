// A report of a network that is made up, as large as one wants: for tests of speed. It is packed as the program packs one.

import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";

const asset = (name) => readFileSync(new URL(`../../assets/${name}`, import.meta.url), "utf8");
const column = (kind, values) => ({ [kind]: Buffer.from(values.buffer, values.byteOffset, values.byteLength).toString("base64") });

/** Numbers from 0 to 1 that look random and are the same each time. */
function generator(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** The document of `count` nodes on a square, each heard at some of the stops of a robot that drives in lines. */
export function synthetic(count) {
  const random = generator(7);
  const side = Math.sqrt(count) * 2;
  const truth = new Float32Array(3 * count);
  const places = new Float32Array(3 * count);
  const errors = new Float32Array(count);
  for (let node = 0; node < count; node++) {
    for (let k = 0; k < 2; k++) {
      truth[3 * node + k] = random() * side;
      places[3 * node + k] = truth[3 * node + k] + (random() + random() - 1) * 1.2;
    }
    errors[node] = Math.hypot(places[3 * node] - truth[3 * node], places[3 * node + 1] - truth[3 * node + 1]);
  }
  const lines = Math.max(4, Math.round(side / 12));
  const each = Math.max(8, Math.round(side / 6));
  const stops = lines * each;
  const at = new Float32Array(3 * stops);
  for (let s = 0; s < stops; s++) {
    const line = Math.floor(s / each);
    const along = (s % each) / (each - 1);
    at[3 * s] = side * (line % 2 ? 1 - along : along);
    at[3 * s + 1] = (side * (line + 0.5)) / lines;
  }
  const first = new Uint32Array(count + 1);
  const rows = [];
  for (let node = 0; node < count; node++) {
    const line = Math.min(lines - 1, Math.floor((truth[3 * node + 1] / side) * lines));
    const near = Math.round((truth[3 * node] / side) * (each - 1));
    for (let k = -1; k <= 1; k++) {
      const along = near + k;
      if (along >= 0 && along < each) rows.push(line * each + (line % 2 ? each - 1 - along : along));
    }
    first[node + 1] = rows.length;
  }
  const mean = errors.reduce((sum, error) => sum + error, 0) / count;
  const quantile = (share) => errors.slice().sort()[Math.floor(share * (count - 1))];
  const times = Float32Array.from({ length: stops }, (_, s) => s);
  return {
    kind: "run", title: `${count} nodes`, origin: { file: "synthetic.mcap", scenario: "synthetic", seed: "7", version: "0.0.0", reported_by: "0.0.0" },
    summary: JSON.stringify({
      simulation: { nodes: count, obstacles: 0, events: 0, sim_time_s: stops }, gathering: { stops, path_length_m: side * lines, duration_s: stops },
      maps: [{ algorithm: "ml-tm", mapped: count, unmapped: 0, position_error_m: { mean, median: quantile(0.5), p90: quantile(0.9), p95: quantile(0.95), max: quantile(1) } }],
    }),
    world: {
      frame: { origin_m: [0, 0, 0], start_s: 0 }, names: Array.from({ length: count }, (_, node) => `n${node}`), truth_m: column("f32", truth),
      robots: [{ name: "surveyor", way: { times_s: column("f32", times), places_m: column("f32", at) } }],
      surveys: [{ stops: { times_s: column("f32", times), places_m: column("f32", at), robots: column("u32", new Uint32Array(stops)) },
        receptions: { first: column("u32", first), stops: column("u32", Uint32Array.from(rows)) } }],
      maps: [{ name: "ml-tm", snapshots: [{ time_s: stops - 1, nodes: column("u32", Uint32Array.from({ length: count }, (_, i) => i)), places_m: column("f32", places) }], errors_m: column("f32", errors) }],
    },
  };
}

/** The page of a document. */
export function page(document) {
  const data = gzipSync(Buffer.from(JSON.stringify(document))).toString("base64");
  return `<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>${document.title}</title><style>${asset("report.css")}</style></head><body><header class="top"><div class="titles"><p class="kind">Report of a run</p><h1>${document.title}</h1></div></header><main id="main"></main><script type="application/octet-stream" id="data">${data}</script><script type="text/plain" id="licences">none</script><script>${asset("report.js")}</script></body></html>`;
}
