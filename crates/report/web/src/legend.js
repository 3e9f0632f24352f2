// What the marks of the map mean.

import { element } from "./element.js";
import { number } from "./format.js";
import { category, ramp, robotColor } from "./palette.js";
import { isolated } from "./text.js";

const mark = (kind, color, text) =>
  element("li", {}, element("span", { class: `mark ${kind}`, style: color ? `--mark:${color}` : undefined, "aria-hidden": "true" }), text);

export function legend(model, show, wayName) {
  const entries = [];
  if (model.truth && show.layers.truth) entries.push(mark("ring", null, "true place"));
  show.maps.forEach((shown, k) => {
    if (show.maps.length > 1) entries.push(mark(k === 0 ? "disc" : "square", category(k), shown.map.name));
    else if (!shown.colors.scale) entries.push(mark("disc", category(0), `place on ${isolated(shown.map.name)}`));
  });
  if (model.truth && show.maps.length > 0 && show.layers.errors) entries.push(mark("line", null, "error"));
  if (show.layers.regions && show.maps.some(({ map }) => map.details?.covariance_m2)) entries.push(mark("oval", null, "95 % region"));
  if (model.world.anchors && show.layers.truth) entries.push(mark("triangle", null, "anchor"));
  if (model.world.sinks) entries.push(mark("square", "var(--accent)", "sink"));
  if (model.tree && show.layers.tree) {
    if (model.tree.tree) {
      entries.push(mark("line", null, "line to its parent"));
      entries.push(mark("disc", ramp(0.5), `node, by its hops to a sink: 1 to ${number(model.tree.deepest)}`));
      entries.push(mark("cross", "var(--accent)", "node without a way"));
    }
    if (model.tree.deaths) entries.push(mark("disc", "var(--unknown)", "node that died"));
  }
  if (show.layers.path) {
    model.robots.slice(0, 8).forEach((robot, i) => entries.push(mark("disc", robotColor(i), `robot ${isolated(robot.name)}`)));
    if (model.world.contacts) entries.push(mark("cross", "var(--accent)", "contact with an obstacle"));
  }
  if (show.targets.length > 0) entries.push(mark("diamond", "var(--accent)", "target"));
  if (model.applications.some((one) => one.predictions) && show.layers.path) entries.push(mark("small", "var(--accent)", "predicted place of a target"));
  if (model.applications.some((one) => one.captures) && show.layers.path) entries.push(mark("ring", "var(--accent)", "capture"));
  if (model.obstacles.length > 0 && show.layers.obstacles) entries.push(mark("square", "var(--obstacle)", "obstacle"));
  const scale = show.maps.length === 1 && show.maps[0].colors.scale;
  const bar = scale ? element("div", { class: "bar" }, element("span", {}, wayName), element("span", {}, number(scale.low)),
    element("span", { class: "ramp", "aria-hidden": "true", style: `background:linear-gradient(to right,${[0, 0.25, 0.5, 0.75, 1].map(ramp).join(",")})` }),
    element("span", {}, `${number(scale.high)} and more`)) : null;
  return [bar, element("ul", { class: "legend" }, entries)];
}
