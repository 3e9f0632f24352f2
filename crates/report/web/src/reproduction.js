// A reproduction: published values beside ours, and whether they agree.

import { element, section } from "./element.js";
import { counted, number } from "./format.js";
import { isolated } from "./text.js";

/** Words of a verdict, and how it is marked. */
const GOOD = /^(holds|within interval|in interval|yes|agrees)/i;
const BAD = /^(does not hold|no\b|other|fails)/i;

function verdictOf(cells) {
  if (cells.verdict) return cells.verdict;
  return GOOD.test(cells.result ?? "") || BAD.test(cells.result ?? "") || /cannot be told|undecided/i.test(cells.result ?? "") ? cells.result : "";
}

function oursOf(cells) {
  const isVerdict = cells.result && cells.result === verdictOf(cells);
  const unit = cells.unit ? ` ${cells.unit}` : "";
  if (cells.mean) {
    const text = `${number(Number(cells.mean))}${cells.half_width_95 ? ` ± ${number(Number(cells.half_width_95))}` : ""}${unit}`;
    if (isVerdict) return `margin ${text}`;
    return cells.result && !isVerdict ? cells.result : text;
  }
  return cells.result || (cells.runs === "0" ? "no run succeeded" : "");
}

function mark(verdict) {
  const kind = GOOD.test(verdict) ? "good" : BAD.test(verdict) ? "bad" : "open";
  return verdict ? element("span", { class: `verdict ${kind}` }, verdict) : "";
}

function experiment(claims, isOpen) {
  const rows = claims.rows.map((row) => Object.fromEntries(claims.columns.map((name, i) => [name, row[i] ?? ""])));
  const counts = new Map();
  for (const cells of rows) {
    const verdict = verdictOf(cells);
    if (verdict) counts.set(verdict, (counts.get(verdict) ?? 0) + 1);
  }
  const body = () => rows.map((cells) => {
    const published = cells.published ? `${cells.published}${cells.unit && /^[-−\d.,\s]+$/.test(cells.published) ? ` ${cells.unit}` : ""}` : "not stated";
    return element("tr", {}, element("th", { scope: "row" }, cells.what), element("td", {}, published), element("td", { class: "number" }, oursOf(cells)),
      element("td", {}, mark(verdictOf(cells))), element("td", { class: "number" }, cells.runs ?? ""), element("td", {}, cells.source ?? ""));
  });
  const head = ["Claim", "Published", "Ours (mean, 95 % interval)", "Verdict", "Runs", "Where"].map((name, i) => element("th", { scope: "col", class: i === 2 || i === 4 ? "number" : "" }, name));
  const caption = claims.title ? `${isolated(claims.id)}: ${claims.title}` : claims.id;
  const words = [...counts].map(([verdict, count]) => `${isolated(verdict)}: ${count}`).join(" · ");
  const table = () => element("div", { class: "scroller", tabindex: "0", role: "region", "aria-label": caption },
    element("table", { class: "claims" }, element("caption", { class: "hidden" }, caption), element("thead", {}, element("tr", {}, head)), element("tbody", {}, body())));
  const details = element("details", { class: "experiment", open: isOpen, id: `experiment-${claims.id}` },
    element("summary", {}, element("strong", {}, claims.id), ` ${isolated(claims.title ?? "")}`, element("span", { class: "count" }, words)));
  // Of many tables, each is made when it is opened.
  const fill = () => { if (details.open && details.children.length === 1) details.append(table()); };
  details.addEventListener("toggle", fill);
  fill();
  return details;
}

export function reproductionSection(report) {
  const { reproduction } = report;
  if (!reproduction) return null;
  const { experiments } = reproduction;
  const claims = experiments.reduce((sum, one) => sum + one.rows.length, 0);
  return section("reproduction", "Reproduction",
    element("p", {}, `${counted(experiments.length, "table or figure")} of the thesis, ${counted(claims, "line")}. A margin is the mean difference between runs of the same seed; above 0 it supports the claim.`.replace("table or figures", "tables and figures")),
    experiments.map((claims) => experiment(claims, experiments.length <= 3)));
}
