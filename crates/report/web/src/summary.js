// The numbers that matter first, and the maps beside each other.

import { element, section } from "./element.js";
import { number, percent, withUnit, wordsOf } from "./format.js";
import { behind, dataTable, facts } from "./table.js";
import { isolated } from "./text.js";

/** The most important numbers of a run or a log: pairs of a name and a text. */
function tiles(summary, world) {
  const found = [];
  const add = (name, text) => found.push([name, text]);
  const nodes = summary.simulation?.nodes ?? world?.names.length;
  if (nodes) add("nodes", number(nodes));
  const maps = (summary.maps ?? []).filter((map) => map.position_error_m);
  if (maps.length > 0) {
    const best = maps.reduce((a, b) => (b.position_error_m.mean < a.position_error_m.mean ? b : a));
    const name = isolated(best.name ?? best.algorithm);
    add(maps.length > 1 ? `least mean error (${name})` : `mean error of ${name}`, withUnit(best.position_error_m.mean, "m"));
  } else if (summary.maps?.length) {
    add(`mapped by ${isolated(summary.maps[0].name ?? summary.maps[0].algorithm)}`, number(summary.maps[0].mapped));
  }
  const { gathering, mac } = summary;
  if (gathering?.stops) add("stops", number(gathering.stops));
  if (gathering?.path_length_m) add("path", withUnit(gathering.path_length_m, "m"));
  if (gathering?.duration_s) add("survey", withUnit(gathering.duration_s, "s"));
  if (mac?.prr !== undefined) add("packet reception ratio", percent(mac.prr));
  if (mac) add("throughput", withUnit(mac.throughput_bit_per_s / 1000, "kbit/s"));
  if (mac?.delay_s) add("median delay", withUnit(1000 * mac.delay_s.p50, "ms"));
  for (const application of (summary.applications ?? []).slice(0, 4)) {
    const done = application.captured ?? application.arrived;
    const what = application.captured !== undefined ? "captured" : "arrived";
    add(`${isolated(application.name)} ${done ? what : `has not ${what}`}`, done ? withUnit(application.time_s, "s") : "–");
  }
  return found.slice(0, 8);
}

/** Facts of an object of the summary; objects inside it follow with their names. */
export function pairsOf(object, prefix = "") {
  return Object.entries(object).flatMap(([key, value]) => {
    if (Array.isArray(value)) return [];
    const { words, unit } = wordsOf(key);
    const name = prefix ? `${prefix}, ${words}` : words;
    if (value !== null && typeof value === "object") {
      return pairsOf(Object.fromEntries(Object.entries(value).map(([inner, one]) => [unit && !/_/.test(inner) ? `${inner}_${unit.replace("/", "_per_").toLowerCase()}` : inner, one])), name);
    }
    const text = typeof value === "number" ? (/rate|ratio|prr|connectivity.error$/.test(key) && !unit ? percent(value) : withUnit(value, unit)) : typeof value === "boolean" ? (value ? "yes" : "no") : String(value);
    return [[name, text]];
  });
}

function mapsTable(maps) {
  const error = (key) => (row) => maps[row].position_error_m?.[key] ?? NaN;
  const columns = [
    { title: "Map", of: (row) => maps[row].name ?? maps[row].algorithm, words: true },
    { title: "Mapped", of: (row) => maps[row].mapped },
    { title: "Unmapped", of: (row) => maps[row].unmapped },
    { title: "Mean error (m)", of: error("mean") },
    { title: "Median (m)", of: error("median") },
    { title: "90 % (m)", of: error("p90") },
    { title: "95 % (m)", of: error("p95") },
    { title: "Max (m)", of: error("max") },
    { title: "In 95 % region", of: (row) => maps[row].coverage_95 ?? NaN, text: percent },
    { title: "Bound (m)", of: (row) => maps[row].posterior_bound_m ?? NaN },
    { title: "Aligned mean (m)", of: (row) => maps[row].aligned_error_m?.mean ?? NaN },
    { title: "Connectivity error", of: (row) => maps[row].connectivity_error ?? NaN, text: percent },
    { title: "False neighbours", of: (row) => maps[row].false_neighbour_rate ?? NaN, text: percent },
    { title: "Knows", of: (row) => (maps[row].knowledge ?? []).join(", "), words: true },
  ];
  const used = columns.filter((column) => maps.some((_, row) => { const value = column.of(row); return value === value && value !== ""; }));
  return dataTable("Maps", used, maps.length);
}

/** Sentences on a map that begin with its name: the name in bold. */
function sentence(map, text) {
  const name = map.name ?? map.algorithm;
  const rest = text.startsWith(`${name}: `) ? text.slice(name.length + 2) : text;
  const plain = rest.replace(/^warning: /, "");
  return element("li", {}, element("strong", {}, isolated(name)), `: ${plain}`);
}

/** What there is to know of the maps before trusting them: what is not reliable at the top, and how each map came about behind. */
function judgements(maps) {
  const of = (level) => maps.flatMap((map) => (map.judgement ?? []).filter((one) => one.level === level).map((one) => sentence(map, one.text)));
  const [warnings, notes] = [of("warning"), of("note")];
  return [
    warnings.length ? element("div", { class: "notes warnings" }, element("h3", {}, warnings.length > 1 ? "What is not reliable" : "Not reliable"), element("ul", {}, warnings)) : null,
    notes.length ? () => behind("How the maps came about", () => element("ul", { class: "judgement" }, of("note"))) : null,
  ];
}

export function summarySection(report) {
  const { summary, world } = report;
  if (!summary) return null;
  const shown = tiles(summary, world);
  const robots = summary.gathering?.robots ?? [];
  const details = [
    ["Survey", summary.gathering], ["Simulation", summary.simulation], ["Discovery", summary.discovery], ["Sensing", summary.sensing],
  ].filter(([, object]) => object);
  const [warnings, notes] = judgements(summary.maps ?? []);
  return section("summary", "Summary",
    element("ul", { class: "tiles" }, shown.map(([name, text]) => element("li", {}, element("strong", {}, text), element("span", {}, name)))),
    warnings,
    report.notes?.length ? element("div", { class: "notes" }, element("h3", {}, report.notes.length > 1 ? "Notes" : "Note"), element("ul", {}, report.notes.map((note) => element("li", {}, note)))) : null,
    summary.maps?.length ? mapsTable(summary.maps) : null,
    notes?.(),
    robots.length > 1 ? dataTable("Robots", [
      { title: "Robot", of: (row) => robots[row].name, words: true },
      { title: "Stops", of: (row) => robots[row].stops },
      { title: "Path (m)", of: (row) => robots[row].path_length_m },
      { title: "Duration (s)", of: (row) => robots[row].duration_s },
    ], robots.length) : null,
    details.length ? behind("All numbers of the survey and the simulation", () => element("div", { class: "columns" }, details.map(([name, object]) => facts(name, pairsOf(object))))) : null);
}
