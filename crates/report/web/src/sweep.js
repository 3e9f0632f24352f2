// The table of a sweep: a measure against a setting, with 95 % intervals.

import { chart } from "./chart.js";
import { comparisons, curvesOf, curvesOfMaps, found, textOf } from "./curves.js";
import { choice, element, searchedChoice, section } from "./element.js";
import { counted, exact } from "./format.js";
import { dataTable } from "./table.js";
import { isolated } from "./text.js";

/** Whether a setting has different numbers. */
const isAxis = (column) => column.values.numbers && new Set(column.values.numbers).size > 1 && !column.values.numbers.some(Number.isNaN);

export function sweepSection(report) {
  const { sweep } = report;
  if (!sweep) return null;
  const axes = sweep.settings.filter(isAxis);
  const measures = sweep.measures.filter((column) => column.values.numbers);
  const usual = measures.filter((column) => column.label);
  let across = axes.includes(sweep.settings[sweep.across]) ? sweep.settings[sweep.across] : axes[0];
  // Maps are compared in one chart; what remains of the usual measures is drawn one by one.
  const compared = comparisons(measures);
  const alone = usual.filter((column) => !compared.some(({ columns }) => columns.includes(column)));
  const atFirst = usual.length ? [...compared, ...alone].slice(0, 6) : measures.slice(0, 4);
  let shown = atFirst;
  const place = element("div", { class: "grid" });
  const fields = element("div", { class: "choices" });

  function picture(measure) {
    const { xs, curves } = measure.columns ? curvesOfMaps(sweep, across, measure) : curvesOf(sweep, across, measure);
    const name = isolated(measure.label ?? measure.name);
    const what = measure.is_outcome ? "Share" : "Mean";
    if (!across) {
      return dataTable(name, [{ title: "Settings", of: (row) => curves[row].name, words: true }, { title: what, of: (row) => curves[row].means[0].mean },
        { title: "95 % from", of: (row) => curves[row].means[0].low }, { title: "to", of: (row) => curves[row].means[0].high }, { title: "Runs", of: (row) => curves[row].means[0].n }], curves.length);
    }
    const counts = curves.flatMap((curve) => curve.means.filter(Boolean).map((mean) => mean.n));
    const [least, most] = [Math.min(...counts), Math.max(...counts)];
    const series = curves.slice(0, 14).map((curve) => ({
      name: curve.name,
      values: curve.means.map((mean) => mean?.mean ?? null),
      ...(most > 1 ? { low: curve.means.map((mean) => mean?.low ?? null), high: curve.means.map((mean) => mean?.high ?? null), counts: curve.means.map((mean) => mean?.n ?? 0) } : {}),
    }));
    const title = `${name}, ${what.toLowerCase()} of ${least < most ? `${least} to ` : ""}${counted(most, "run")}${most > 1 ? " with 95 % intervals" : ""}`;
    const made = chart(title, xs, series, { across: across.name, up: name, points: true, ticks: xs, textAcross: exact });
    if (curves.length > 14) made.append(element("p", {}, `${curves.length - 14} more combinations of settings are not drawn.`));
    return made;
  }

  const fill = () => place.replaceChildren(...shown.map(picture));
  if (axes.length > 0) fields.append(choice("Across", axes.map((column) => [column.name, column.name]), across.name, (name) => { across = axes.find((column) => column.name === name); fill(); }));
  const all = [...compared.map((one) => ({ ...one, key: `all.${one.name}`, label: `all maps: ${one.label}` })), ...measures.map((column) => ({ ...column, key: column.name }))];
  const optionsFor = (words) => [["", usual.length ? "the usual ones" : "the first ones"], ...found(all, words).map(({ key, name, label }) => [key, label ? `${label} – ${isolated(name)}` : name])];
  fields.append(...searchedChoice("Measure", optionsFor, (key) => { shown = key ? [all.find((one) => one.key === key)] : atFirst; fill(); }));
  fill();
  const cell = (column) => (column.values.numbers ? { of: (row) => column.values.numbers[row] } : { of: (row) => textOf(column, row), words: true });
  const columns = [...sweep.settings.map((column) => ({ title: column.name, text: column.values.numbers ? exact : undefined, ...cell(column) })),
    ...sweep.measures.map((column) => ({ title: column.name, ...cell(column) }))];
  return section("sweep", "Sweep",
    element("p", {}, `${counted(sweep.rows, "run")}, ${counted(sweep.settings.length, "setting")}, ${counted(sweep.measures.length, "measure")}.`),
    sweep.failed ? element("p", { class: "why" }, `${counted(sweep.failed, "run")} failed. The first: ${sweep.failure}`) : null,
    fields, place,
    element("details", { class: "behind" }, element("summary", {}, "The whole table"),
      dataTable("Runs", columns, sweep.rows)));
}
