// What is known of one node, in words.

import { element } from "./element.js";
import { number, withUnit } from "./format.js";
import { isolated } from "./text.js";

/** Pairs of a name and a text about `node`. */
export function aboutNode(model, show, node) {
  const pairs = [];
  const place = (places) => model.inWorld(places, node).slice(0, model.isFlat ? 2 : 3).map((value) => (Math.round(value * 100) / 100).toFixed(2).replace("-", "−")).join(", ");
  const has = (column) => column && Number.isFinite(column[3 * node]);
  if (has(model.truth)) pairs.push(["True place", `${place(model.truth)} m`]);
  if (show.tree) {
    const { parents, hops, dead } = show.tree;
    if (model.tree.tree) {
      pairs.push(["Parent", parents[node] >= 0 ? nameOf(model, parents[node]) : "none"]);
      pairs.push(["Hops to a sink", hops[node] > 0 ? number(hops[node]) : "no way"]);
    }
    if (model.tree.deaths) pairs.push(["Battery", dead[node] ? "empty" : "not empty"]);
  }
  for (const { map, places } of show.maps) {
    const called = (word) => (show.maps.length > 1 ? `${isolated(map.name)}: ${word}` : word[0].toUpperCase() + word.slice(1));
    const concern = model.summaryOf(map).concerns?.find?.((one) => one.node === model.names[node])?.concern;
    if (!has(places)) {
      pairs.push([called("place"), "not mapped"]);
      continue;
    }
    pairs.push([called("place"), `${place(places)} m`]);
    if (map.errors_m && Number.isFinite(map.errors_m[node])) pairs.push([called("error"), withUnit(map.errors_m[node], "m")]);
    const deviation = model.deviation(map, node);
    if (Number.isFinite(deviation)) pairs.push([called("standard deviation"), withUnit(deviation, "m")]);
    const { log_likelihood: likelihood, ties } = map.details ?? {};
    if (likelihood && Number.isFinite(likelihood[node])) pairs.push([called("log-likelihood"), number(likelihood[node])]);
    if (ties && ties[node] > 1) pairs.push([called("equally likely places"), number(ties[node])]);
    if (concern) pairs.push([called("concern"), String(concern)]);
  }
  if (show.survey >= 0) {
    const heard = model.heard[show.survey];
    pairs.push(["Packets received", number(heard.packets[node])]);
    pairs.push(["Stops that heard it", number(heard.places[node])]);
    const best = strongest(model, show.survey, node);
    if (Number.isFinite(best)) pairs.push(["Strongest signal", withUnit(best, "dBm")]);
    if (Number.isFinite(heard.firstTime[node]) && model.hasTimes) pairs.push(["First heard", `${withUnit(heard.firstTime[node], "s")} after the start`]);
  }
  return pairs;
}

/** The name of a station: of a node, or the number of a sink. */
function nameOf(model, station) {
  return station < model.count ? isolated(model.names[station]) : `sink ${number(station - model.count + 1)}`;
}

function strongest(model, survey, node) {
  const { first, rssi_dbm: strengths } = model.surveys[survey].receptions;
  let best = NaN;
  for (let row = first[node]; strengths && row < first[node + 1]; row++) if (!(strengths[row] <= best)) best = Number.isFinite(strengths[row]) ? strengths[row] : best;
  return best;
}

/** The facts as a list. */
export function nodeCard(model, show, node) {
  const rows = aboutNode(model, show, node).map(([name, text]) => element("div", {}, element("dt", {}, name), element("dd", {}, text)));
  return [element("h3", {}, model.names[node]), element("dl", {}, rows)];
}
