// The table of a sweep: a measure against a setting, with 95 % intervals.

import { chart } from "./chart.js";
import { choice, element, section } from "./element.js";
import { counted, number } from "./format.js";
import { dataTable } from "./table.js";
import { isolated } from "./text.js";

const textOf = (column, row) => (column.values.numbers ? number(column.values.numbers[row]) : column.values.texts.words[column.values.texts.rows[row]]);
const last = (name) => name.split(".").pop();

/** Whether a setting has different numbers. */
const isAxis = (column) => column.values.numbers && new Set(column.values.numbers).size > 1 && !column.values.numbers.some(Number.isNaN);

/** Mean and half of the 95 % interval (Student, 1908) of some runs; no interval for one run. */
export function meanOf(values, quantiles) {
  const n = values.length;
  const mean = values.reduce((sum, value) => sum + value, 0) / n;
  if (n < 2) return { mean, half: 0, n };
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

export function sweepSection(report) {
  const { sweep } = report;
  if (!sweep) return null;
  const axes = sweep.settings.filter(isAxis);
  const measures = sweep.measures.filter((column) => column.values.numbers);
  const usual = measures.filter((column) => column.label);
  let across = axes.includes(sweep.settings[sweep.across]) ? sweep.settings[sweep.across] : axes[0];
  let shown = usual.length ? usual.slice(0, 6) : measures.slice(0, 4);
  const place = element("div", { class: "grid" });
  const fields = element("div", { class: "choices" });

  function picture(measure) {
    const { xs, curves } = curvesOf(sweep, across, measure);
    const name = isolated(measure.label ?? measure.name);
    if (!across) {
      return dataTable(name, [{ title: "Settings", of: (row) => curves[row].name, words: true }, { title: "Mean", of: (row) => curves[row].means[0].mean },
        { title: "± (95 %)", of: (row) => curves[row].means[0].half }, { title: "Runs", of: (row) => curves[row].means[0].n }], curves.length);
    }
    const runs = Math.max(...curves.flatMap((curve) => curve.means.map((mean) => mean?.n ?? 0)));
    const series = curves.slice(0, 14).map((curve) => ({
      name: curve.name,
      values: curve.means.map((mean) => mean?.mean ?? null),
      ...(runs > 1 ? { low: curve.means.map((mean) => (mean ? mean.mean - mean.half : null)), high: curve.means.map((mean) => (mean ? mean.mean + mean.half : null)) } : {}),
    }));
    const title = `${name}, mean of ${counted(runs, "run")}${runs > 1 ? " with 95 % intervals" : ""}`;
    const made = chart(title, xs, series, { across: across.name, up: name, points: true });
    if (curves.length > 14) made.append(element("p", {}, `${curves.length - 14} more combinations of settings are not drawn.`));
    return made;
  }

  const fill = () => place.replaceChildren(...shown.map(picture));
  if (axes.length > 0) fields.append(choice("Across", axes.map((column) => [column.name, column.name]), across.name, (name) => { across = axes.find((column) => column.name === name); fill(); }));
  fields.append(choice("Measure", [["", usual.length ? "the usual ones" : "the first ones"], ...measures.map((column) => [column.name, column.label ? `${column.label} – ${isolated(column.name)}` : column.name])], "",
    (name) => { shown = name ? [measures.find((column) => column.name === name)] : usual.length ? usual.slice(0, 6) : measures.slice(0, 4); fill(); }));
  fill();
  const all = [...sweep.settings, ...sweep.measures];
  return section("sweep", "Sweep",
    element("p", {}, `${counted(sweep.rows, "run")}, ${counted(sweep.settings.length, "setting")}, ${counted(sweep.measures.length, "measure")}.`),
    sweep.failed ? element("p", { class: "why" }, `${counted(sweep.failed, "run")} failed. The first: ${sweep.failure}`) : null,
    fields, place,
    element("details", { class: "behind" }, element("summary", {}, "The whole table"),
      dataTable("Runs", all.map((column) => ({ title: column.name, of: (row) => (column.values.numbers ? column.values.numbers[row] : textOf(column, row)), words: !column.values.numbers })), sweep.rows)));
}
