// A network of several hops, of batteries, of slots or of sleeping nodes: what the summary says of it.

import { element, section } from "./element.js";
import { number, percent, withUnit } from "./format.js";
import { pairsOf } from "./summary.js";
import { behind, dataTable, facts } from "./table.js";

/** The columns that have a number in some row. */
const filled = (columns, count) => columns.filter((column) => Array.from({ length: count }, (_, row) => column.of(row)).some((value) => value !== undefined && value !== null && value === value));

/** The nodes by their hops to a sink: the table of the command line. */
function depthTable(list) {
  const column = (title, of, text) => ({ title, of: (row) => of(list[row]), text });
  return dataTable("Nodes by hops to a sink", filled([
    column("Hops", (one) => one.depth ?? NaN), column("Nodes", (one) => one.nodes), column("With a way", (one) => one.with_way ?? one.nodes), column("Offered", (one) => one.offered), column("Delivered", (one) => one.delivered),
    column("Delivery", (one) => one.delivery, percent), column("Mean delay (s)", (one) => one.delay_s), column("Energy of a node (J)", (one) => one.energy_j),
    column("For sending (J)", (one) => one.energy_tx_j), column("Empty batteries", (one) => one.depleted),
    column("Shortest lifetime (d)", (one) => one.lifetime_d?.min), column("Median lifetime (d)", (one) => one.lifetime_d?.median),
  ], list.length), list.length);
}

function nodeTable(list) {
  const column = (title, of) => ({ title, of: (row) => of(list[row]) });
  return dataTable("Nodes of the tree", [
    { title: "Node", of: (row) => list[row].name, words: true }, { title: "Parent", of: (row) => list[row].parent ?? "", words: true },
    column("Hops", (one) => one.depth ?? NaN), column("Offered", (one) => one.offered), column("Delivered", (one) => one.delivered),
    column("Mean delay (s)", (one) => one.delay_s ?? NaN), column("Transmissions", (one) => one.transmissions), column("Changes of parent", (one) => one.parent_changes),
    column("Energy (J)", (one) => one.energy_j),
  ], list.length);
}

function batteryTable(list) {
  const column = (title, of) => ({ title, of: (row) => of(list[row]) ?? NaN });
  return dataTable("Batteries", filled([
    { title: "Node", of: (row) => list[row].name, words: true }, column("Capacity (J)", (one) => one.capacity_j), column("Left (J)", (one) => one.left_j),
    column("Mean power (W)", (one) => one.mean_power_w), column("Lifetime (d)", (one) => one.lifetime_d), column("Empty after (s)", (one) => one.depleted_s),
  ], list.length), list.length);
}

/** The slots of nodes by what they did in them, as bars. */
function slotBars(slots) {
  const kinds = [
    ["idle_listen", "listened, and nobody sent"], ["transmit_acknowledged", "sent, and acknowledged"], ["transmit_unacknowledged", "sent, not acknowledged"],
    ["transmit", "sent to all"], ["receive_acknowledge", "received and acknowledged"], ["receive", "received"],
  ].filter(([key]) => slots[key] > 0);
  const all = Math.max(kinds.reduce((sum, [key]) => sum + slots[key], 0), 1);
  return element("table", { class: "outcomes" }, element("caption", {}, "Slots in which radios of nodes were on"), element("tbody", {}, kinds.map(([key, name]) =>
    element("tr", {}, element("th", { scope: "row" }, name), element("td", { class: "number" }, number(slots[key])), element("td", { class: "number" }, percent(slots[key] / all)),
      element("td", { class: "fill", "aria-hidden": "true" }, element("span", { class: key === "idle_listen" ? "" : "good", style: `width:${(100 * slots[key]) / all}%` }))))));
}

/** The numbers that matter first, as tiles. */
function tiles({ routing, battery, slots, sleep }) {
  const found = [];
  const add = (name, value, text) => { if (value !== undefined && value !== null) found.push([name, text(value)]); };
  const duty = (share) => `${(100 * share).toFixed(share < 0.1 ? 2 : 1)}\u00a0%`;
  const days = (value) => withUnit(value, "d");
  const seconds = (value) => withUnit(value, "s");
  if (routing) {
    add("delivered end to end", routing.delivery, percent);
    add("median delay", routing.delay_s?.p50, seconds);
    add("hops of a packet", routing.hops?.mean, number);
    add("depth of the tree", routing.depth, number);
    add("changes of parents", routing.parent_changes, number);
  }
  if (battery) {
    add("shortest lifetime", battery.lifetime_d?.min, days);
    add("median lifetime", battery.lifetime_d?.median, days);
    add("empty batteries", battery.depleted, (count) => `${number(count)} of ${number(battery.nodes.length)}`);
    add("first battery empty after", battery.first_death_s, seconds);
    add("half of them empty after", battery.half_death_s, seconds);
  }
  for (const used of [slots, sleep]) {
    add("duty cycle of a node", used?.duty_cycle, duty);
    add("duty cycle of sinks", used?.sink_duty_cycle, duty);
  }
  if (sleep?.worst_node) add("duty cycle of the worst node", sleep.worst_duty_cycle, duty);
  return element("ul", { class: "tiles" }, found.map(([name, text]) => element("li", {}, element("strong", {}, text), element("span", {}, name))));
}

export function networkSection(report) {
  const { routing, battery, mac } = report.summary ?? {};
  const { slots, sleep } = mac ?? {};
  if (!routing && !battery && !slots && !sleep) return null;
  const flat = (object, ...without) => Object.fromEntries(Object.entries(object).filter(([key]) => !without.includes(key)));
  const all = [
    ["Packets over several hops", routing && flat(routing, "by_depth", "nodes")], ["Batteries", battery && flat(battery, "nodes")], ["Slots", slots], ["Sleep", sleep],
  ].filter(([, object]) => object);
  return section("network", "Network",
    tiles({ routing, battery, slots, sleep }),
    routing?.by_depth?.length ? depthTable(routing.by_depth) : null,
    slots ? slotBars(slots) : null,
    routing?.nodes?.length ? behind("Each node of the tree", () => nodeTable(routing.nodes)) : null,
    battery?.nodes?.length ? behind("Each battery", () => batteryTable(battery.nodes)) : null,
    behind("All numbers of the network", () => element("div", { class: "columns" }, all.map(([name, object]) => facts(name, pairsOf(object))))));
}
