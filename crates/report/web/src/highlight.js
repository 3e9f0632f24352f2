// The node that is looked at: a ring, its error, its 95 % region, the stops that heard it. And the regions of all nodes.

import { category, ink } from "./palette.js";

/** Marks a node. */
export function drawHighlight(map2d, show, node, isSelected) {
  const { context: ctx, model } = map2d;
  const places = show.maps[0]?.places;
  const has = (column) => column && Number.isFinite(column[3 * node]);
  const place = has(places) ? places : has(model.truth) ? model.truth : null;
  if (!place) return;
  const [x, y] = map2d.at(place, node);
  const covariance = show.maps[0]?.map.details?.covariance_m2;
  if (covariance && has(places)) {
    ctx.fillStyle = ink("ink");
    ctx.globalAlpha = 0.12;
    ctx.beginPath();
    addEllipse(map2d, x, y, covariance.subarray(6 * node, 6 * node + 6));
    ctx.fill();
    ctx.globalAlpha = 1;
  }
  ctx.strokeStyle = ink("ink");
  ctx.lineWidth = isSelected ? 2.5 : 1.5;
  ctx.beginPath();
  ctx.arc(x, y, 10, 0, 7);
  ctx.stroke();
  if (has(places) && has(model.truth)) {
    const [u, v] = map2d.at(model.truth, node);
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.lineTo(u, v);
    ctx.stroke();
  }
  if (show.survey >= 0 && isSelected) {
    const { first, stops, received } = model.surveys[show.survey].receptions;
    ctx.strokeStyle = ink("faint");
    ctx.lineWidth = 1;
    for (let row = first[node]; row < first[node + 1]; row++) {
      if (received && received[row] === 0) continue;
      const [u, v] = map2d.at(model.surveys[show.survey].stops.places_m, stops[row]);
      ctx.beginPath();
      ctx.arc(u, v, 4, 0, 7);
      ctx.stroke();
    }
  }
}

/** The 95 % regions of all nodes in sight, in the colour of their map. */
export function drawRegions(map2d, show) {
  const { context: ctx, model } = map2d;
  show.maps.forEach(({ map, places, visible }, k) => {
    const covariance = map.details?.covariance_m2;
    if (!covariance) return;
    ctx.beginPath();
    for (let node = 0; node < model.count; node++) {
      if (!visible(node)) continue;
      const [x, y] = map2d.at(places, node);
      addEllipse(map2d, x, y, covariance.subarray(6 * node, 6 * node + 6));
    }
    ctx.strokeStyle = show.maps.length > 1 ? category(k) : ink("faint");
    ctx.lineWidth = 1;
    ctx.stroke();
  });
}

/** Adds the region that has the node with 95 % probability, of a normal distribution, to the path, if it is in sight. */
function addEllipse(map2d, x, y, covariance) {
  const { context: ctx, camera } = map2d;
  const index = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
  const [p, q] = camera.axes;
  const [a, b, d] = [covariance[index[p][p]], covariance[index[p][q]], covariance[index[q][q]]];
  const middle = (a + d) / 2;
  const apart = Math.hypot((a - d) / 2, b);
  // Chi-squared with two degrees of freedom: -2 ln 0.05.
  const size = (variance) => Math.sqrt(Math.max(variance, 0) * 5.991) * camera.scale;
  if (!Number.isFinite(middle)) return;
  const [long, short, turn] = [size(middle + apart), size(middle - apart), -Math.atan2(2 * b, a - d) / 2];
  if (x < -long || x > camera.width + long || y < -long || y > camera.height + long) return;
  ctx.moveTo(x + long * Math.cos(turn), y + long * Math.sin(turn));
  ctx.ellipse(x, y, long, short, turn, 0, 2 * Math.PI);
}
