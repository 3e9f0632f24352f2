// Traffic: packets, losses, delays.

import { chart } from "./chart.js";
import { element, section } from "./element.js";
import { percent } from "./format.js";
import { pairsOf } from "./summary.js";
import { behind, dataTable, facts } from "./table.js";
import { isolated } from "./text.js";

const LOSSES = [
  ["delivered", "delivered"], ["lost_collision", "lost to collisions"], ["lost_channel_access", "lost to a busy channel"], ["lost_queue", "lost to a full queue"],
  ["lost_signal", "weak signal"], ["out_of_range", "out of range"], ["not_listened", "nobody listened"], ["died", "their node died"], ["pending", "pending"],
];

/** The share of packets that are delivered within each time. */
export function delayCurve(bins) {
  const all = bins.reduce((sum, bin) => sum + bin.packets, 0);
  let below = 0;
  const x = [];
  const y = [];
  for (const bin of bins) {
    if (x.length === 0) {
      x.push(1000 * bin.from_s);
      y.push(0);
    }
    below += bin.packets;
    x.push(1000 * bin.to_s);
    y.push(below / all);
  }
  return { x, y };
}

function outcomes(mac) {
  const rows = LOSSES.filter(([key]) => mac[key] > 0);
  const all = Math.max(mac.offered, 1);
  return element("table", { class: "outcomes" }, element("caption", {}, "What became of the packets offered"), element("tbody", {}, rows.map(([key, name]) =>
    element("tr", {}, element("th", { scope: "row" }, name),
      element("td", { class: "number" }, `${mac[key]}`), element("td", { class: "number" }, percent(mac[key] / all)),
      element("td", { class: "fill", "aria-hidden": "true" }, element("span", { class: key === "delivered" ? "good" : "", style: `width:${(100 * mac[key]) / all}%` }))))));
}

function trafficTable(caption, list) {
  const column = (title, of, text) => ({ title, of: (row) => of(list[row]) ?? NaN, text });
  return dataTable(caption, [
    { title: "Name", of: (row) => list[row].name, words: true },
    column("Offered", (one) => one.offered), column("Delivered", (one) => one.delivered), column("Reception ratio", (one) => one.prr, percent),
    column("Throughput (bit/s)", (one) => one.throughput_bit_per_s), column("Mean delay (s)", (one) => one.delay_s?.mean), column("99 % delay (s)", (one) => one.delay_s?.p99),
    column("Retries", (one) => one.retries), column("Collisions", (one) => one.lost_collision), column("Channel busy", (one) => one.lost_channel_access),
    column("Energy (J)", (one) => (one.energy_j ? one.energy_j.tx + one.energy_j.rx + one.energy_j.idle : NaN)),
  ], list.length);
}

function networkPart(mac) {
  const title = mac.network ? element("h3", {}, `Network ${isolated(mac.network)}`) : null;
  const bins = (mac.delay_histogram ?? []).filter((bin) => bin.packets > 0);
  const curve = bins.length > 1 ? delayCurve(bins) : null;
  const { nodes, groups, sinks, delay_histogram: _bins, ...totals } = mac;
  return [title,
    outcomes(mac),
    curve ? chart(`Delay of packets${mac.network ? ` of ${isolated(mac.network)}` : ""}`, curve.x, [{ name: "share of the delivered packets", values: curve.y }], { across: "delay (ms)", up: "share of the packets", top: 1, logarithmic: curve.x[0] > 0 && curve.x[curve.x.length - 1] > 100 * curve.x[0] }) : null,
    groups?.length ? trafficTable("Groups of nodes", groups) : null,
    sinks?.length > 1 ? dataTable("Sinks", [{ title: "Sink", of: (row) => sinks[row].name, words: true }, { title: "Frames received", of: (row) => sinks[row].received }], sinks.length) : null,
    nodes?.length ? behind("Each node", () => trafficTable("Nodes", nodes)) : null,
    behind("All numbers of the traffic", () => facts("Traffic", pairsOf(totals)))];
}

export function macSection(report) {
  const { mac, other_networks: others } = report.summary ?? {};
  if (!mac) return null;
  return section("traffic", "Traffic", [mac, ...(others ?? [])].flatMap(networkPart));
}
