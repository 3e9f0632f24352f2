// The tree over the map: a line from each node to its parent, and a disc in the colour of its hops.

import { ink, ramp } from "./palette.js";

/** With more nodes than this, lines are left out while many are in sight. */
const MOST_LINES = 6000;

/** The place of a station: a true place of a node, or that of a sink. */
export function placeOfStation(model, station) {
  if (station < model.count) return model.truth ? [model.truth, station] : null;
  const sinks = model.world.sinks;
  const at = sinks ? sinks.ids.indexOf(station - model.count) : -1;
  return at >= 0 ? [sinks.places_m, at] : null;
}

export function drawTree(map2d, show) {
  const { context: ctx, camera, model } = map2d;
  const { tree } = show;
  if (!tree || !model.truth || (model.count > MOST_LINES && camera.scale < 4)) return;
  const radius = Math.max(2.5, Math.min(6, 0.2 * model.spacing * camera.scale));
  ctx.strokeStyle = ink("thread");
  ctx.lineWidth = 1.2;
  ctx.beginPath();
  for (let node = 0; node < model.count; node++) {
    const parent = tree.parents[node] >= 0 && !tree.dead[node] ? placeOfStation(model, tree.parents[node]) : null;
    if (!parent) continue;
    const [x, y] = map2d.at(model.truth, node);
    const [u, v] = map2d.at(...parent);
    if (!(x === x && u === u)) continue;
    ctx.moveTo(x, y);
    ctx.lineTo(u, v);
  }
  ctx.stroke();
  for (let node = 0; node < model.count; node++) {
    const [x, y] = map2d.at(model.truth, node);
    if (!(x > -9 && x < camera.width + 9 && y > -9 && y < camera.height + 9)) continue;
    if (tree.dead[node]) ctx.fillStyle = ink("unknown");
    else if (tree.hops[node] > 0) ctx.fillStyle = ramp(tree.hops[node] / model.tree.deepest);
    else {
      if (model.tree.tree) cross(ctx, x, y, radius);
      continue;
    }
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 7);
    ctx.fill();
  }
}

/** A node without a way. */
function cross(ctx, x, y, radius) {
  ctx.strokeStyle = ink("accent");
  ctx.lineWidth = 1.6;
  ctx.beginPath();
  ctx.moveTo(x - radius, y - radius);
  ctx.lineTo(x + radius, y + radius);
  ctx.moveTo(x - radius, y + radius);
  ctx.lineTo(x + radius, y - radius);
  ctx.stroke();
}
