// What applications did: their results and their time series. Their ways are on the map.

import { chart } from "./chart.js";
import { element, section } from "./element.js";
import { withUnit, wordsOf } from "./format.js";
import { pairsOf } from "./summary.js";
import { behind, dataTable, facts } from "./table.js";
import { isolated } from "./text.js";

/** Time series of one kind, on common instants. */
function together(application, what) {
  const list = application.series.filter((one) => one.name.endsWith(`/${what}`));
  const instants = [...new Set(list.flatMap((one) => [...one.times_s]))].sort((a, b) => a - b);
  const at = new Map(instants.map((time, i) => [time, i]));
  const series = list.slice(0, 12).map((one) => {
    const values = new Array(instants.length).fill(null);
    one.times_s.forEach((time, i) => { values[at.get(time)] = one.values[i]; });
    return { name: one.name.slice(0, -what.length - 1), values };
  });
  return { x: instants.map((time) => time - application.start_s), series };
}

function charts(application) {
  const kinds = [...new Set((application.series ?? []).map((one) => one.name.split("/").pop()))];
  return kinds.map((what) => {
    const { x, series } = together(application, what);
    if (x.length < 2) return null;
    const { words, unit } = wordsOf(what);
    return chart(`${isolated(application.name)}: ${words}`, x, series, { across: "time (s)", up: unit ? `${words} (${unit})` : words, points: x.length < 30 });
  });
}

function outcome(summary) {
  const done = summary.captured ?? summary.arrived;
  if (summary.link) return done ? `All robots arrived after ${withUnit(summary.time_s, "s")}.` : "Not all robots arrived at the end of their way.";
  const what = summary.captured !== undefined ? "All targets were captured" : "A robot arrived";
  if (done) return `${what} after ${withUnit(summary.time_s, "s")}.`;
  return summary.captured !== undefined ? "Not all targets were captured." : "No robot arrived.";
}

export function applicationsSection(report) {
  const summaries = report.summary?.applications ?? [];
  const recorded = report.applications ?? [];
  if (summaries.length + recorded.length === 0) return null;
  const error = (key) => (row) => summaries[row][key]?.mean ?? NaN;
  const columns = [
    { title: "Application", of: (row) => summaries[row].name, words: true },
    { title: "Algorithm", of: (row) => summaries[row].algorithm, words: true },
    { title: "Map", of: (row) => summaries[row].map, words: true },
    { title: "Result", of: (row) => outcome(summaries[row]), words: true },
    { title: "Time (s)", of: (row) => summaries[row].time_s ?? NaN },
    { title: "Path (m)", of: (row) => summaries[row].path_length_m },
    { title: "Prediction error (m)", of: error("prediction_error_m") },
    { title: "Own place error (m)", of: error("own_place_error_m") },
    { title: "Field error", of: error("field_error") },
    { title: "Messages", of: (row) => summaries[row].messages?.sent ?? NaN },
  ].filter((column) => column.words || summaries.some((_, row) => { const value = column.of(row); return value === value; }));
  return section("applications", "Applications",
    summaries.length ? dataTable("Results of the applications", columns, summaries.length) : null,
    recorded.map((application, i) => {
      const details = element("details", { class: "application", open: i === 0 }, element("summary", {}, `${isolated(application.name)} on the map ${isolated(application.map)}`));
      const fill = () => {
        if (!details.open || details.children.length > 1) return;
        const summary = summaries.find((one) => one.name === application.name);
        details.append(...charts(application).filter(Boolean), summary ? behind("All numbers", () => facts(application.name, pairsOf(summary))) : "");
      };
      details.addEventListener("toggle", fill);
      fill();
      return details;
    }));
}
