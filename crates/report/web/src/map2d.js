// The map from above or from the side, on a canvas.

import { Camera } from "./camera.js";
import { drawHighlight, drawRegions } from "./highlight.js";
import { drawNodes } from "./marks.js";
import { category, ink } from "./palette.js";
import { planeImage } from "./planeimage.js";
import { short } from "./text.js";
import { drawTree } from "./treelayer.js";
import { drawListening, drawMarks, drawMovers, drawPaths, drawStops } from "./walk.js";

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

  /** Draws a later state of the same world from now on. */
  renew(model) {
    this.model = model;
    this.images.clear();
    this.camera.extent = model.extent;
    if (this.camera.fitted) this.camera.fit();
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
    if (show.layers.path) drawPaths(this, show);
    if (show.layers.stops) drawStops(this, show);
    if (show.layers.regions) drawRegions(this, show);
    if (show.layers.errors) this.#errors(show);
    drawNodes(this, show);
    if (show.layers.tree) drawTree(this, show);
    if (fromAbove && show.layers.listening) drawListening(this, show);
    drawMarks(this, show);
    drawMovers(this, show);
    if (show.layers.labels) this.#labels(show);
    for (const node of new Set([show.selected, show.hovered])) if (node >= 0) drawHighlight(this, show, node, node === show.selected);
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
      const sheet = this.#isSheet(solid);
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
      if (sheet) ctx.globalAlpha = 0.25;
      ctx.fill("nonzero");
      ctx.globalAlpha = 1;
      if (!sheet) ctx.stroke();
    }
  }

  /** Whether an obstacle is thin in the direction of the view and large across it, as a floor seen from above: filled, it would hide what is behind it. */
  #isSheet(solid) {
    const { axes } = this.camera;
    const size = (axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = axis; i < solid.corners_m.length; i += 3) {
        low = Math.min(low, solid.corners_m[i]);
        high = Math.max(high, solid.corners_m[i]);
      }
      return high - low;
    };
    const depth = size(3 - axes[0] - axes[1]);
    const across = axes[1] === 1 ? Math.min(size(0), size(1)) : size(0);
    return depth <= Math.min(0.5, 0.3 * across);
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


}
