// The distribution of the errors of each map.

import { chart } from "./chart.js";
import { section } from "./element.js";

const POINTS = 241;

/** Shares of the sorted numbers that are at most each of `at`. */
function shares(sorted, at) {
  let i = 0;
  return at.map((value) => {
    while (i < sorted.length && sorted[i] <= value) i += 1;
    return i / sorted.length;
  });
}

export function errorsSection(model) {
  const maps = model.maps.filter((map) => map.errors_m);
  const errors = maps.map((map) => map.errors_m.filter((error) => Number.isFinite(error)).sort());
  const known = maps.map((map, i) => ({ map, sorted: errors[i] })).filter(({ sorted }) => sorted.length > 0);
  if (known.length === 0) return null;
  const most = Math.max(...known.map(({ sorted }) => sorted[Math.min(sorted.length - 1, Math.floor(0.99 * sorted.length))])) * 1.05;
  const x = Array.from({ length: POINTS }, (_, i) => (most * i) / (POINTS - 1));
  const series = known.map(({ map, sorted }) => ({ name: map.name, values: shares(sorted, x) }));
  return section("errors", "Errors", chart("Share of the nodes with at most this error", x, series, { across: "error (m)", up: "share of the nodes", top: 1 }));
}
