// The nodes as a table: the data behind the map.

import { dataTable } from "./table.js";
import { isolated } from "./text.js";

export function nodeTable(model, show, onrow) {
  const columns = [{ title: "Node", of: (node) => model.names[node], words: true }];
  const axes = model.isFlat ? ["x", "y"] : ["x", "y", "z"];
  const add = (title, of) => columns.push({ title, of });
  if (model.truth) axes.forEach((axis, k) => add(`True ${axis} (m)`, (node) => model.truth[3 * node + k] + model.origin[k]));
  for (const { map } of show.maps) {
    const places = model.finished(map);
    const name = isolated(map.name);
    axes.forEach((axis, k) => add(`${name} ${axis} (m)`, (node) => places[3 * node + k] + model.origin[k]));
    if (map.errors_m) add(`${name} error (m)`, (node) => map.errors_m[node]);
    if (map.details?.covariance_m2) add(`${name} deviation (m)`, (node) => model.deviation(map, node));
    if (map.details?.log_likelihood) add(`${name} log-likelihood`, (node) => map.details.log_likelihood[node]);
  }
  if (show.survey >= 0) {
    add("Packets received", (node) => model.heard[show.survey].packets[node]);
    add("Stops", (node) => model.heard[show.survey].places[node]);
  }
  return dataTable("Nodes", columns, model.count, { onrow });
}
