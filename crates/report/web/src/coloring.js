// How nodes are coloured: by error, by packets, by what is not known of their place, or by map.

import { category, hexRgb, ink, rampRgb } from "./palette.js";

/** The ways that a map can be coloured, as pairs of a key and a text. */
export function waysOf(model, map) {
  const ways = [];
  if (map?.errors_m) ways.push(["error", "Error (m)"]);
  if (model.surveyOf(map) >= 0) ways.push(["packets", "Packets received"]);
  if (map?.details?.covariance_m2) ways.push(["deviation", "Standard deviation (m)"]);
  if (map?.details?.log_likelihood) ways.push(["likelihood", "Log-likelihood"]);
  ways.push(["plain", "One colour"]);
  return ways;
}

/** The value of each node, and the ends of the scale. */
function valuesOf(model, map, way) {
  const value = {
    error: (node) => map.errors_m[node],
    packets: (node) => model.heard[model.surveyOf(map)].packets[node],
    deviation: (node) => model.deviation(map, node),
    likelihood: (node) => map.details.log_likelihood[node],
  }[way];
  const values = Float32Array.from({ length: model.count }, (_, node) => value(node));
  const known = values.filter((one) => Number.isFinite(one)).sort();
  if (known.length === 0) return { values, low: 0, high: 1 };
  const at = (share) => known[Math.min(known.length - 1, Math.floor(share * known.length))];
  // A few nodes that are far off do not make all others look equal.
  const low = way === "likelihood" ? at(0.02) : 0;
  return { values, low, high: Math.max(at(0.98), low + 1e-9) };
}

/** Colours of the nodes: `rgb` has three octets a node, and `scale` is null for one colour. */
export function coloring(model, map, way, index) {
  const rgb = new Uint8Array(3 * model.count);
  const plain = hexRgb(category(index));
  if (way === "plain" || !map) {
    for (let node = 0; node < model.count; node++) rgb.set(plain, 3 * node);
    return { rgb, scale: null };
  }
  const { values, low, high } = valuesOf(model, map, way);
  const unknown = hexRgb(ink("unknown"));
  const steps = Array.from({ length: 256 }, (_, i) => rampRgb(i / 255));
  for (let node = 0; node < model.count; node++) {
    const value = values[node];
    rgb.set(Number.isFinite(value) ? steps[Math.round(255 * Math.min(1, Math.max(0, (value - low) / (high - low))))] : unknown, 3 * node);
  }
  return { rgb, scale: { low, high } };
}
