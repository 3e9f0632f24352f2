// The runs of a sweep as curves of means, or of shares of outcomes.

import { exact } from "./format.js";
import { isolated } from "./text.js";

/** The text of a setting, with all digits: those of different values differ. */
export const textOf = (column, row) => (column.values.numbers ? exact(column.values.numbers[row]) : column.values.texts.words[column.values.texts.rows[row]]);
const last = (name) => name.split(".").pop();

/** Mean and 95 % interval (Student, 1908) of some runs; its ends are null for one run. */
export function meanOf(values, quantiles) {
  const n = values.length;
  const mean = values.reduce((sum, value) => sum + value, 0) / n;
  if (n < 2) return { mean, low: null, high: null, n };
  const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (n - 1);
  const half = quantiles[n - 2] * Math.sqrt(variance / n);
  return { mean, low: mean - half, high: mean + half, n };
}

/** Share and 95 % interval (Clopper and Pearson, 1934) of outcomes that are 1 or 0; its ends are null for one run. */
export function shareOf(outcomes) {
  const n = outcomes.length;
  const happened = outcomes.filter((outcome) => outcome > 0.5).length;
  const mean = happened / n;
  if (n < 2) return { mean, low: null, high: null, n };
  return { mean, low: lowEnd(happened, n), high: 1 - lowEnd(n - happened, n), n };
}

/** The probability p at which `happened` or more of `n` have a probability of 0.025, by bisection. */
function lowEnd(happened, n) {
  if (happened === 0) return 0;
  let [low, high] = [0, 1];
  for (let i = 0; i < 50; i++) {
    const p = (low + high) / 2;
    if (1 - fewer(happened, n, p) < 0.025) low = p;
    else high = p;
  }
  return (low + high) / 2;
}

/** The probability of fewer than `count` of `n`, each of which has the probability `p`. */
function fewer(count, n, p) {
  let [logarithm, sum] = [n * Math.log1p(-p), 0];
  for (let k = 0; k < count; k++) {
    sum += Math.exp(logarithm);
    logarithm += Math.log(((n - k) * p) / ((k + 1) * (1 - p)));
  }
  return sum;
}

/** What is compared first. */
const FIRST = "position_error_m.mean";

/** The usual measures that several maps have, errors of positions first: each with its columns, one for each map. */
export function comparisons(measures) {
  const found = new Map();
  for (const column of measures.filter(({ of_map }) => of_map?.label)) {
    const { measure, label } = column.of_map;
    if (!found.has(measure)) found.set(measure, { name: measure, label, columns: [] });
    found.get(measure).columns.push(column);
  }
  return [...found.values()].filter(({ columns }) => columns.length > 1).sort((a, b) => (b.name === FIRST) - (a.name === FIRST));
}

/** The curves of a measure of several maps: those of each map, by its name. */
export function curvesOfMaps(sweep, across, { columns }) {
  const each = columns.map((column) => ({ map: isolated(column.of_map.map), ...curvesOf(sweep, across, column) }));
  const curves = each.flatMap(({ map, curves }) => curves.map(({ name, means }) => ({ name: name === ALONE ? map : `${map}, ${name}`, means })));
  return { xs: each[0].xs, curves };
}

/** The columns whose name or label has all of the words, in upper or lower case. */
export function found(columns, words) {
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  return columns.filter(({ name, label }) => wanted.every((word) => `${name} ${label ?? ""}`.toLowerCase().includes(word)));
}

/** The name of a curve beside which there is no other. */
const ALONE = "mean";

/** The curves of a measure: one for each combination of the other settings. */
export function curvesOf(sweep, across, measure) {
  const others = sweep.settings.filter((column) => column !== across);
  const xs = across ? [...new Set(across.values.numbers)].sort((a, b) => a - b) : [0];
  const groups = new Map();
  for (let row = 0; row < sweep.rows; row++) {
    const value = measure.values.numbers[row];
    if (!Number.isFinite(value)) continue;
    const name = others.map((column) => `${isolated(last(column.name))} ${isolated(textOf(column, row))}`).join(", ") || ALONE;
    if (!groups.has(name)) groups.set(name, xs.map(() => []));
    groups.get(name)[across ? xs.indexOf(across.values.numbers[row]) : 0].push(value);
  }
  const curves = [...groups].map(([name, cells]) => {
    const averageOf = measure.is_outcome ? shareOf : (values) => meanOf(values, sweep.students_t_975);
    const means = cells.map((values) => (values.length ? averageOf(values) : null));
    return { name, means };
  });
  return { xs, curves };
}
