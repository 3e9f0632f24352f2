// The map from above or from the side, on a canvas.

import { Camera } from "./camera.js";
import { drawNodes } from "./marks.js";
import { category, ink, rampRgb, robotColor } from "./palette.js";
import { after, placeAt } from "./model.js";

/** With more nodes in sight than this, lines of errors are left out: they would cover everything. */
const MOST_LINES = 4000;
/** With more names in sight than this, none is written. */
const MOST_LABELS = 60;

export class Map2d {
  constructor(canvas, model) {
    this.canvas = canvas;
    this.model = model;
    this.camera = new Camera(model.extent);
    this.context = canvas.getContext("2d", { alpha: false, willReadFrequently: model.count > 3000 });
    this.images = new Map();
  }

  resize() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    this.ratio = ratio;
    this.camera.resize(width, height);
  }

  /** Sees x and y, or x and z. */
  turn(axes) {
    this.camera.axes = axes;
    this.camera.fit();
  }

  /** Draws what `show` says. */
  draw(show) {
    const { context: ctx, camera, model } = this;
    ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    ctx.fillStyle = ink("paper");
    ctx.fillRect(0, 0, camera.width, camera.height);
    this.#grid();
    const fromAbove = camera.axes[1] === 1;
    if (fromAbove && show.layers.surface && show.surface) this.#plane(show.surface);
    if (show.layers.obstacles) this.#obstacles();
    if (show.layers.path) this.#paths(show);
    if (show.layers.stops) this.#stops(show);
    if (show.layers.errors) this.#errors(show);
    drawNodes(this, show);
    if (fromAbove && show.layers.listening) this.#listening(show);
    this.#marks(show);
    this.#movers(show);
    if (show.layers.labels) this.#labels(show);
    for (const node of new Set([show.selected, show.hovered])) if (node >= 0) this.#highlight(show, node, node === show.selected);
    this.#axes();
  }

  /** The place of a node on the screen, for many nodes at one view. */
  projector() {
    const { camera } = this;
    const [a, b] = camera.axes;
    return (places, i) => [camera.sx(places[3 * i + a]), camera.sy(places[3 * i + b])];
  }

  at(places, i) {
    const [a, b] = this.camera.axes;
    return [this.camera.sx(places[3 * i + a]), this.camera.sy(places[3 * i + b])];
  }

  #grid() {
    const { context: ctx, camera, model } = this;
    ctx.strokeStyle = ink("grid");
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (const [x] of camera.ticks(0, model.origin[camera.axes[0]])) {
      const at = Math.round(camera.sx(x)) + 0.5;
      ctx.moveTo(at, 0);
      ctx.lineTo(at, camera.height);
    }
    for (const [y] of camera.ticks(1, model.origin[camera.axes[1]])) {
      const at = Math.round(camera.sy(y)) + 0.5;
      ctx.moveTo(0, at);
      ctx.lineTo(camera.width, at);
    }
    ctx.stroke();
  }

  #axes() {
    const { context: ctx, camera, model } = this;
    ctx.fillStyle = ink("paper");
    ctx.globalAlpha = 0.86;
    ctx.fillRect(0, camera.height - 24, camera.width, 24);
    ctx.fillRect(0, 0, 40, camera.height - 24);
    ctx.globalAlpha = 1;
    ctx.fillStyle = ink("faint");
    ctx.font = "12px system-ui, sans-serif";
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    const names = ["x (m)", "y (m)", "z (m)"];
    for (const [x, text] of camera.ticks(0, model.origin[camera.axes[0]])) {
      const at = camera.sx(x);
      if (at > 44 && at < camera.width - 50) ctx.fillText(text, at, camera.height - 12);
    }
    ctx.textAlign = "right";
    ctx.fillText(names[camera.axes[0]], camera.width - 8, camera.height - 12);
    for (const [y, text] of camera.ticks(1, model.origin[camera.axes[1]])) {
      const at = camera.sy(y);
      if (at > 28 && at < camera.height - 32) ctx.fillText(text, 36, at);
    }
    ctx.fillText(names[camera.axes[1]], 36, 12);
  }

  #plane(plane) {
    const { context: ctx, camera } = this;
    let image = this.images.get(plane);
    const theme = ink("paper");
    if (!image || image.theme !== theme) {
      image = { canvas: planeImage(plane), theme };
      this.images.set(plane, image);
    }
    const rows = plane.values.length / plane.columns;
    const half = plane.step_m / 2;
    const x = camera.sx(plane.first_m[0] - half);
    const y = camera.sy(plane.first_m[1] - half + rows * plane.step_m);
    ctx.imageSmoothingEnabled = false;
    ctx.globalAlpha = 0.75;
    ctx.drawImage(image.canvas, x, y, plane.columns * plane.step_m * camera.scale, rows * plane.step_m * camera.scale);
    ctx.globalAlpha = 1;
  }

  #obstacles() {
    const { context: ctx, model } = this;
    ctx.fillStyle = ink("obstacle");
    ctx.strokeStyle = ink("obstacle");
    ctx.lineWidth = 1;
    for (const solid of model.obstacles) {
      // One shape of all triangles: where they overlap, it is not darker.
      ctx.beginPath();
      for (let t = 0; t + 2 < solid.triangles.length; t += 3) {
        const corners = [0, 1, 2].map((k) => this.at(solid.corners_m, solid.triangles[t + k]));
        const turns = (corners[1][0] - corners[0][0]) * (corners[2][1] - corners[0][1]) - (corners[2][0] - corners[0][0]) * (corners[1][1] - corners[0][1]);
        if (turns < 0) corners.reverse();
        ctx.moveTo(...corners[0]);
        ctx.lineTo(...corners[1]);
        ctx.lineTo(...corners[2]);
        ctx.closePath();
      }
      ctx.fill("nonzero");
      ctx.stroke();
    }
  }

  #paths(show) {
    const { context: ctx, model } = this;
    model.robots.forEach((robot, i) => {
      const { places_m: places, times_s: times } = robot.way;
      const count = places.length / 3;
      const share = model.span ? (show.time - model.span.from) / (model.span.to - model.span.from) : 1;
      const done = times ? after(times, show.time) : Math.ceil(share * count);
      ctx.strokeStyle = robotColor(i);
      ctx.lineJoin = "round";
      // Of a run with several simulations only the way in the present one is drawn.
      const phase = times && model.phaseAt(show.time);
      const begin = phase ? after(times, phase.start_s - 1e-3) : 0;
      const end = phase ? after(times, phase.end_s + 1e-3) : count;
      for (const [from, to, width, alpha] of [[begin, end, 1, 0.35], [begin, done, 1.6, 0.9]]) {
        ctx.lineWidth = width;
        ctx.globalAlpha = alpha;
        ctx.beginPath();
        for (let p = from; p < to; p++) ctx.lineTo(...this.at(places, p));
        if (to === done && done < end) {
          const here = placeAt(robot.way, show.time, model.span);
          ctx.lineTo(...this.at(here, 0));
        }
        ctx.stroke();
      }
      ctx.globalAlpha = 1;
    });
  }

  #stops(show) {
    const { context: ctx, model, camera } = this;
    const survey = model.surveys[show.survey];
    if (!survey) return;
    const { times_s: times, places_m: places, robots } = survey.stops;
    const side = Math.max(2, Math.min(5, camera.scale * 0.25));
    for (let s = 0; s < times.length; s++) {
      const [x, y] = this.at(places, s);
      if (x < -5 || x > camera.width + 5 || y < -5 || y > camera.height + 5) continue;
      const reached = times[s] <= show.time;
      ctx.globalAlpha = reached ? 0.9 : 0.25;
      ctx.fillStyle = robotColor(robots[s]);
      ctx.fillRect(x - side / 2, y - side / 2, side, side);
    }
    ctx.globalAlpha = 1;
  }

  /** Lines from the true places to the estimates. */
  #errors(show) {
    const { context: ctx, model, camera } = this;
    if (!model.truth || (model.count > MOST_LINES && camera.scale < 4)) return;
    show.maps.forEach((shown, k) => {
      ctx.strokeStyle = show.maps.length > 1 ? category(k) : ink("thread");
      ctx.lineWidth = 1;
      ctx.globalAlpha = 0.7;
      ctx.beginPath();
      let lines = 0;
      for (let node = 0; node < model.count && lines < MOST_LINES; node++) {
        if (!shown.visible(node)) continue;
        const [x, y] = this.at(shown.places, node);
        const [u, v] = this.at(model.truth, node);
        if (!(x === x && u === u) || Math.max(x, u) < 0 || Math.min(x, u) > camera.width || Math.max(y, v) < 0 || Math.min(y, v) > camera.height) continue;
        ctx.moveTo(u, v);
        ctx.lineTo(x, y);
        lines += 1;
      }
      if (lines < MOST_LINES) ctx.stroke();
      ctx.globalAlpha = 1;
    });
  }

  /** Lines from the robot to the nodes that it hears now, and the sectors that it hears them in. */
  #listening(show) {
    const { context: ctx, model, camera } = this;
    const survey = model.surveys[show.survey];
    if (!survey || !model.span || show.time >= model.span.to) return;
    const heard = model.heard[show.survey];
    for (const stop of stopsNow(survey, show.time)) {
      const [x, y] = this.at(survey.stops.places_m, stop);
      const color = robotColor(survey.stops.robots[stop]);
      const sectors = new Set();
      ctx.strokeStyle = color;
      ctx.lineWidth = 1.2;
      ctx.beginPath();
      for (let i = heard.begin[stop]; i < heard.begin[stop + 1]; i++) {
        const node = heard.node[i];
        if (survey.receptions.sectors) sectors.add(survey.receptions.sectors[heard.rows[i]]);
        const place = model.truth && Number.isFinite(model.truth[3 * node]) ? model.truth : show.maps[0]?.places;
        if (!place) continue;
        const [u, v] = this.at(place, node);
        if (u !== u) continue;
        ctx.moveTo(x, y);
        ctx.lineTo(u, v);
      }
      ctx.globalAlpha = 0.75;
      ctx.stroke();
      ctx.fillStyle = color;
      ctx.globalAlpha = 0.13;
      const rad = Math.PI / 180;
      for (const sector of survey.sectors ?? []) {
        if (!sectors.has(sector.sector)) continue;
        ctx.beginPath();
        ctx.moveTo(x, y);
        ctx.arc(x, y, Math.min(camera.width, camera.height) / 6, -sector.azimuth_to_deg * rad, -sector.azimuth_from_deg * rad);
        ctx.closePath();
        ctx.fill();
      }
      ctx.globalAlpha = 1;
    }
  }

  /** Anchors, sinks and contacts. */
  #marks(show) {
    const { context: ctx, model } = this;
    const { contacts, sinks } = model.world;
    if (contacts && show.layers.path) {
      ctx.strokeStyle = ink("accent");
      ctx.lineWidth = 1.2;
      ctx.beginPath();
      for (let i = 0; i < contacts.times_s.length; i++) {
        if (contacts.times_s[i] > show.time) continue;
        const [x, y] = this.at(contacts.places_m, i);
        ctx.moveTo(x - 2.5, y - 2.5);
        ctx.lineTo(x + 2.5, y + 2.5);
        ctx.moveTo(x + 2.5, y - 2.5);
        ctx.lineTo(x - 2.5, y + 2.5);
      }
      ctx.stroke();
    }
    if (sinks) {
      ctx.fillStyle = ink("accent");
      for (let i = 0; i < sinks.ids.length; i++) {
        const [x, y] = this.at(sinks.places_m, i);
        ctx.fillRect(x - 5, y - 5, 10, 10);
      }
    }
  }

  /** Robots, targets and captures. */
  #movers(show) {
    const { context: ctx, model } = this;
    if (show.layers.path) {
      for (const application of model.applications) {
        const { captures } = application;
        for (let i = 0; captures && i < captures.times_s.length; i++) {
          if (captures.times_s[i] > show.time || captures.times_s[i] < (model.phaseAt(show.time)?.start_s ?? -Infinity)) continue;
          const [x, y] = this.at(captures.places_m, i);
          ctx.strokeStyle = ink("accent");
          ctx.lineWidth = 2;
          ctx.beginPath();
          ctx.arc(x, y, 9, 0, 7);
          ctx.stroke();
        }
      }
    }
    ctx.lineWidth = 1.5;
    ctx.strokeStyle = ink("paper");
    for (const target of show.targets) {
      const place = placeAt(target.way, show.time, model.span);
      if (!place) continue;
      const [x, y] = this.at(place, 0);
      ctx.fillStyle = ink("accent");
      ctx.beginPath();
      ctx.moveTo(x, y - 8);
      ctx.lineTo(x + 7, y);
      ctx.lineTo(x, y + 8);
      ctx.lineTo(x - 7, y);
      ctx.closePath();
      ctx.fill();
      ctx.stroke();
    }
    if (!show.layers.path) return;
    model.robots.forEach((robot, i) => {
      const place = placeAt(robot.way, show.time, model.span);
      if (!place) return;
      const [x, y] = this.at(place, 0);
      ctx.fillStyle = robotColor(i);
      ctx.beginPath();
      ctx.arc(x, y, 7, 0, 7);
      ctx.fill();
      ctx.stroke();
    });
  }

  #labels(show) {
    const { context: ctx, model, camera } = this;
    const places = show.maps[0]?.places ?? model.truth;
    if (!places) return;
    const seen = [];
    for (let node = 0; node < model.count; node++) {
      if (show.maps[0] && !show.maps[0].visible(node)) continue;
      const [x, y] = this.at(places, node);
      if (x > 40 && x < camera.width && y > 0 && y < camera.height - 24) seen.push([x, y, node]);
      if (seen.length > MOST_LABELS) return;
    }
    ctx.font = "11px system-ui, sans-serif";
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    ctx.lineWidth = 3;
    ctx.strokeStyle = ink("paper");
    ctx.fillStyle = ink("ink");
    const taken = [];
    for (const [x, y, node] of seen) {
      const name = short(model.names[node]);
      const box = [x + 7, y - 7, x + 9 + 6.2 * name.length, y + 7];
      if (taken.some((t) => box[0] < t[2] && box[2] > t[0] && box[1] < t[3] && box[3] > t[1])) continue;
      taken.push(box);
      ctx.strokeText(name, x + 8, y);
      ctx.fillText(name, x + 8, y);
    }
  }

  #highlight(show, node, isSelected) {
    const { context: ctx, model, camera } = this;
    const places = show.maps[0]?.places;
    const has = (column) => column && Number.isFinite(column[3 * node]);
    const place = has(places) ? places : has(model.truth) ? model.truth : null;
    if (!place) return;
    const [x, y] = this.at(place, node);
    const covariance = show.maps[0]?.map.details?.covariance_m2;
    if (covariance && has(places)) this.#ellipse(x, y, covariance.subarray(6 * node, 6 * node + 6));
    ctx.strokeStyle = ink("ink");
    ctx.lineWidth = isSelected ? 2.5 : 1.5;
    ctx.beginPath();
    ctx.arc(x, y, 10, 0, 7);
    ctx.stroke();
    if (has(places) && has(model.truth)) {
      const [u, v] = this.at(model.truth, node);
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
        const [u, v] = this.at(model.surveys[show.survey].stops.places_m, stops[row]);
        ctx.beginPath();
        ctx.arc(u, v, 4, 0, 7);
        ctx.stroke();
      }
    }
  }

  /** The region that has the node with 95 % probability, of a normal distribution. */
  #ellipse(x, y, covariance) {
    const { context: ctx, camera } = this;
    const index = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
    const [p, q] = camera.axes;
    const [a, b, d] = [covariance[index[p][p]], covariance[index[p][q]], covariance[index[q][q]]];
    const middle = (a + d) / 2;
    const apart = Math.hypot((a - d) / 2, b);
    // Chi-squared with two degrees of freedom: -2 ln 0.05.
    const size = (variance) => Math.sqrt(Math.max(variance, 0) * 5.991) * camera.scale;
    if (!Number.isFinite(middle)) return;
    ctx.fillStyle = ink("ink");
    ctx.globalAlpha = 0.12;
    ctx.beginPath();
    ctx.ellipse(x, y, size(middle + apart), size(middle - apart), -Math.atan2(2 * b, a - d) / 2, 0, 7);
    ctx.fill();
    ctx.globalAlpha = 1;
  }
}

/** A name that is not longer than a label may be. */
export function short(name) {
  return name.length > 24 ? `${name.slice(0, 23)}…` : name;
}

/** The last stop of each robot at `time`. */
export function stopsNow(survey, time) {
  const last = new Map();
  const { times_s: times, robots } = survey.stops;
  for (let s = 0; s < times.length; s++) if (times[s] <= time && !(times[last.get(robots[s])] > times[s])) last.set(robots[s], s);
  return [...last.values()];
}

function planeImage(plane) {
  const rows = plane.values.length / plane.columns;
  const canvas = document.createElement("canvas");
  canvas.width = plane.columns;
  canvas.height = rows;
  const ctx = canvas.getContext("2d");
  const image = ctx.createImageData(plane.columns, rows);
  const known = plane.values.filter((value) => Number.isFinite(value));
  let high = -Infinity;
  let low = Infinity;
  for (const value of known) {
    high = Math.max(high, value);
    low = Math.min(low, value);
  }
  // Of a likelihood only the places that count are seen: those within 12 of the highest logarithm.
  if (plane.node !== undefined) low = Math.max(low, high - 12);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < plane.columns; column++) {
      const value = plane.values[row * plane.columns + column];
      const at = 4 * ((rows - 1 - row) * plane.columns + column);
      const share = high > low ? (value - low) / (high - low) : 1;
      const isSeen = Number.isFinite(value) && (plane.node === undefined || share > 0);
      image.data.set(isSeen ? [...rampRgb(share), plane.node === undefined ? 255 : 255 * Math.min(1, 0.15 + share)] : [0, 0, 0, 0], at);
    }
  }
  ctx.putImageData(image, 0, 0);
  return canvas;
}


