// The runs of a sweep as curves of means.

import { exact } from "./format.js";
import { isolated } from "./text.js";

/** The text of a setting, with all digits: those of different values differ. */
export const textOf = (column, row) => (column.values.numbers ? exact(column.values.numbers[row]) : column.values.texts.words[column.values.texts.rows[row]]);
const last = (name) => name.split(".").pop();

/** Mean and half of the 95 % interval (Student, 1908) of some runs; `half` is null for one run. */
export function meanOf(values, quantiles) {
  const n = values.length;
  const mean = values.reduce((sum, value) => sum + value, 0) / n;
  if (n < 2) return { mean, half: null, n };
  const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (n - 1);
  return { mean, half: quantiles[n - 2] * Math.sqrt(variance / n), n };
}

/** The curves of a measure: one for each combination of the other settings. */
export function curvesOf(sweep, across, measure) {
  const others = sweep.settings.filter((column) => column !== across);
  const xs = across ? [...new Set(across.values.numbers)].sort((a, b) => a - b) : [0];
  const groups = new Map();
  for (let row = 0; row < sweep.rows; row++) {
    const value = measure.values.numbers[row];
    if (!Number.isFinite(value)) continue;
    const name = others.map((column) => `${isolated(last(column.name))} ${isolated(textOf(column, row))}`).join(", ") || "mean";
    if (!groups.has(name)) groups.set(name, xs.map(() => []));
    groups.get(name)[across ? xs.indexOf(across.values.numbers[row]) : 0].push(value);
  }
  const curves = [...groups].map(([name, cells]) => {
    const means = cells.map((values) => (values.length ? meanOf(values, sweep.students_t_975) : null));
    return { name, means };
  });
  return { xs, curves };
}
