// The map in three dimensions.

import {
  AmbientLight, BufferAttribute, BufferGeometry, CanvasTexture, Color, DirectionalLight, DoubleSide, Group, Line, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, MeshBasicMaterial, PerspectiveCamera, Points, PointsMaterial, Scene, SphereGeometry, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { niceStep, number } from "./format.js";
import { placeAt, stopsNow } from "./model.js";
import { after } from "./times.js";
import { category, ink, rampRgb, robotColor, hexRgb } from "./palette.js";
import { placeOfStation } from "./treelayer.js";

/** With more nodes than this, lines of errors are left out. */
const MOST_LINES = 20000;
/** With more nodes than this, edges are not smoothed and true places are left out, so that a software renderer keeps up. */
const LARGE = 20000;

export class Map3d {
  /** Fails if the browser has no WebGL. */
  constructor(canvas, model, overlay, changed) {
    this.canvas = canvas;
    this.model = model;
    this.overlay = overlay;
    this.isLarge = model.count > LARGE;
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.isLarge, powerPreference: "high-performance" });
    this.scene = new Scene();
    this.#measure();
    this.camera = new PerspectiveCamera(40, 1, this.size / 500, this.size * 50);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", changed);
    this.reset();
    this.lights = [new AmbientLight(0xffffff, 1.6), new DirectionalLight(0xffffff, 1.8)];
    this.lights[1].position.set(1, -2, 3);
    this.scene.add(...this.lights);
    this.dot = new CanvasTexture(disc());
    this.still = null;
  }

  #measure() {
    const { low, high } = this.model.extent;
    this.middle = new Vector3(...low.map((l, k) => (l + high[k]) / 2));
    this.size = Math.max(...low.map((l, k) => high[k] - l), 1e-3);
  }

  /** Draws a later state of the same world from now on. */
  renew(model) {
    this.model = model;
    this.#measure();
    if (this.still) this.still.key = null;
  }

  reset() {
    const distance = this.size * 1.7;
    this.controls.target.copy(this.middle);
    this.camera.position.copy(this.middle).add(new Vector3(-0.35, -0.95, 0.75).normalize().multiplyScalar(distance));
    this.controls.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.width = width;
    this.height = height;
    this.renderer.setPixelRatio(this.isLarge ? 1 : Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A narrow picture is seen from farther away.
    this.camera.fov = width < height ? 40 * Math.min(1.6, height / width) : 40;
    this.camera.updateProjectionMatrix();
  }

  /** Turns by angles (rad). */
  turn(around, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const distance = offset.length();
    const azimuth = Math.atan2(offset.y, offset.x) + around;
    const elevation = Math.min(Math.max(Math.asin(offset.z / distance) + up, -1.5), 1.5);
    offset.set(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation)).multiplyScalar(distance);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).divideScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  /** Moves across the picture, in shares of the distance. */
  pan(right, up) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const move = new Vector3().setFromMatrixColumn(this.camera.matrix, 0).multiplyScalar(right * distance)
      .add(new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(up * distance));
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
  }

  /** The place of a node on the screen, for many nodes at one view. */
  projector() {
    this.camera.updateMatrixWorld();
    const m = this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse).elements;
    const { width, height } = this;
    return (places, node) => {
      const x = places[3 * node];
      const y = places[3 * node + 1];
      const z = places[3 * node + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      return [(((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2) * width, ((1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2) * height];
    };
  }

  draw(show) {
    const key = JSON.stringify([show.maps.map((shown) => [shown.map.name, shown.at, shown.way]), show.layers, ink("paper"), show.survey]);
    if (key !== this.still?.key) this.#rebuild(show, key);
    this.#grow(show);
    this.#move(show);
    this.renderer.render(this.scene, this.camera);
    this.#rulers();
  }

  /** What does not change while the walk is played. */
  #rebuild(show, key) {
    const { model, scene } = this;
    if (this.still) {
      scene.remove(this.still.group);
      this.still.group.traverse((one) => {
        one.geometry?.dispose();
        one.material?.dispose();
      });
    }
    scene.background = new Color(ink("paper"));
    const group = new Group();
    this.still = { key, group, maps: [] };
    group.add(this.#floor());
    if (show.layers.obstacles) {
      for (const solid of model.obstacles) {
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(solid.corners_m, 3));
        geometry.setIndex(new BufferAttribute(solid.triangles, 1));
        const flat = geometry.toNonIndexed();
        geometry.dispose();
        flat.computeVertexNormals();
        const material = new MeshLambertMaterial({ color: ink("obstacle"), transparent: true, opacity: 0.45, side: DoubleSide, depthWrite: false });
        group.add(new Mesh(flat, material));
      }
    }
    if (model.truth && show.layers.truth && !this.isLarge) group.add(this.#points(model.truth, null, ink("faint"), model.count > 3000 ? 2 : 4));
    for (const shown of show.maps) {
      const points = this.#points(shown.places.slice(), shown.colors.rgb, null, this.isLarge ? 1.5 : model.count > 3000 ? 3 : 9);
      group.add(points);
      this.still.maps.push({ points, shown: -1 });
    }
    if (show.layers.errors && model.truth && model.count <= MOST_LINES) {
      show.maps.forEach((shown, k) => {
        const lines = new Float32Array(6 * model.count);
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(lines, 3));
        const segments = new LineSegments(geometry, new LineBasicMaterial({ color: show.maps.length > 1 ? category(k) : ink("thread") }));
        segments.frustumCulled = false;
        group.add(segments);
        this.still.maps[k].lines = lines;
        this.still.maps[k].segments = segments;
      });
    }
    this.still.paths = show.layers.path ? model.robots.map((robot, i) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(robot.way.places_m, 3));
      const line = new Line(geometry, new LineBasicMaterial({ color: robotColor(i) }));
      const body = new Mesh(new SphereGeometry(this.size / 90, 20, 12), new MeshBasicMaterial({ color: robotColor(i) }));
      group.add(line, body);
      return { line, body, robot };
    }) : [];
    this.still.targets = show.targets.map((target) => {
      const body = new Mesh(new SphereGeometry(this.size / 80, 4, 2), new MeshBasicMaterial({ color: ink("accent") }));
      group.add(body);
      return { body, target };
    });
    const { sinks } = model.world;
    if (sinks) group.add(this.#points(sinks.places_m, null, ink("accent"), 14));
    const links = new BufferGeometry();
    this.still.links = new LineSegments(links, new LineBasicMaterial({ color: robotColor(0) }));
    this.still.links.frustumCulled = false;
    group.add(this.still.links);
    const mark = new PointsMaterial({ color: ink("ink"), size: 20, sizeAttenuation: false, map: new CanvasTexture(ring()), transparent: true, depthTest: false });
    this.still.mark = new Points(new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(3), 3)), mark);
    this.still.mark.frustumCulled = false;
    this.still.mark.renderOrder = 2;
    group.add(this.still.mark);
    scene.add(group);
  }

  #points(places, rgb, color, size) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(places, 3));
    if (rgb) geometry.setAttribute("color", new BufferAttribute(rgb, 3, true));
    const material = new PointsMaterial({ size: size * Math.min(devicePixelRatio || 1, 2), sizeAttenuation: false, vertexColors: Boolean(rgb) });
    if (color) material.color = new Color(color);
    if (rgb) material.color = new Color(0xffffff);
    if (size > 3) {
      material.map = this.dot;
      material.alphaTest = 0.5;
    }
    const points = new Points(geometry, material);
    points.frustumCulled = false;
    return points;
  }

  /** The ground with its grid. */
  #floor() {
    const { low, high } = this.model.extent;
    const step = this.step = niceStep(Math.max(high[0] - low[0], high[1] - low[1], 1e-3), 10);
    const [x0, x1] = [Math.floor(low[0] / step) * step, Math.ceil(high[0] / step) * step];
    const [y0, y1] = [Math.floor(low[1] / step) * step, Math.ceil(high[1] / step) * step];
    this.floor = { x0, x1, y0, y1, z: low[2], top: high[2] };
    const at = [];
    for (let x = x0; x <= x1 + step / 2; x += step) at.push(x, y0, low[2], x, y1, low[2]);
    for (let y = y0; y <= y1 + step / 2; y += step) at.push(x0, y, low[2], x1, y, low[2]);
    if (high[2] > low[2]) at.push(x0, y0, low[2], x0, y0, high[2]);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(at), 3));
    return new LineSegments(geometry, new LineBasicMaterial({ color: ink("line") }));
  }

  /** Nodes that are not on the map yet are not drawn. */
  #grow(show) {
    show.maps.forEach((shown, k) => {
      const still = this.still.maps[k];
      if (!still || still.shown === shown.version) return;
      still.shown = shown.version;
      const position = still.points.geometry.getAttribute("position");
      for (let node = 0; node < this.model.count; node++) {
        const seen = shown.visible(node);
        for (let i = 3 * node; i < 3 * node + 3; i++) {
          const to = seen && Number.isFinite(shown.places[i]) ? shown.places[i] : 1e12;
          position.array[i] = to;
          if (still.lines) {
            const whole = seen && Number.isFinite(this.model.truth[i]) && Number.isFinite(shown.places[i]);
            still.lines[2 * (3 * node) + (i % 3)] = whole ? this.model.truth[i] : 0;
            still.lines[2 * (3 * node) + 3 + (i % 3)] = whole ? shown.places[i] : 0;
          }
        }
      }
      position.needsUpdate = true;
      if (still.lines) still.segments.geometry.getAttribute("position").needsUpdate = true;
    });
  }

  #move(show) {
    const { model } = this;
    for (const { line, body, robot } of this.still.paths) {
      const place = placeAt(robot.way, show.time, model.span);
      if (place) body.position.set(...place);
      const count = robot.way.places_m.length / 3;
      line.geometry.setDrawRange(0, robot.way.times_s ? after(robot.way.times_s, show.time) : count);
    }
    for (const { body, target } of this.still.targets) {
      const place = placeAt(target.way, show.time, model.span);
      if (place) body.position.set(...place);
    }
    this.#link(show);
    this.#tree(show);
    const node = show.hovered >= 0 ? show.hovered : show.selected;
    const places = show.maps[0]?.places ?? model.truth;
    this.still.mark.visible = node >= 0 && Boolean(places) && Number.isFinite(places[3 * node]);
    if (this.still.mark.visible) {
      const position = this.still.mark.geometry.getAttribute("position");
      position.array.set(places.subarray(3 * node, 3 * node + 3));
      position.needsUpdate = true;
    }
  }

  /** The tree: lines from nodes to their parents, and discs in the colour of their hops. */
  #tree(show) {
    const { model, still } = this;
    const { tree } = show;
    if (!tree || !model.truth || !show.layers.tree || this.isLarge || still.tree?.version === tree.version) return;
    for (const old of still.tree?.drawn ?? []) {
      still.group.remove(old);
      old.geometry.dispose();
      old.material.dispose();
    }
    const lines = [];
    const places = [];
    const colours = [];
    for (let node = 0; node < model.count; node++) {
      const at = model.truth.subarray(3 * node, 3 * node + 3);
      if (!Number.isFinite(at[0])) continue;
      const parent = tree.parents[node] >= 0 && !tree.dead[node] ? placeOfStation(model, tree.parents[node]) : null;
      if (parent) lines.push(...at, ...parent[0].subarray(3 * parent[1], 3 * parent[1] + 3));
      places.push(...at);
      colours.push(...(tree.dead[node] ? hexRgb(ink("unknown")) : tree.hops[node] > 0 ? rampRgb(tree.hops[node] / model.tree.deepest) : hexRgb(ink("accent"))));
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(lines), 3));
    const links = new LineSegments(geometry, new LineBasicMaterial({ color: ink("thread") }));
    links.frustumCulled = false;
    const discs = this.#points(new Float32Array(places), new Uint8Array(colours), null, 9);
    still.tree = { version: tree.version, drawn: [links, discs] };
    still.group.add(links, discs);
  }

  /** Lines from the robots to the nodes that they hear. */
  #link(show) {
    const { model } = this;
    const survey = model.surveys[show.survey];
    const links = this.still.links;
    links.visible = Boolean(survey && show.layers.listening && model.span && show.time < model.span.to);
    if (!links.visible) return;
    const heard = model.heard[show.survey];
    const places = model.truth ?? show.maps[0]?.places;
    const at = [];
    for (const stop of stopsNow(survey, show.time)) {
      for (let i = heard.begin[stop]; places && i < heard.begin[stop + 1]; i++) {
        const node = heard.node[i];
        if (Number.isFinite(places[3 * node])) at.push(...survey.stops.places_m.subarray(3 * stop, 3 * stop + 3), ...places.subarray(3 * node, 3 * node + 3));
      }
    }
    links.geometry.dispose();
    links.geometry = new BufferGeometry();
    links.geometry.setAttribute("position", new BufferAttribute(new Float32Array(at), 3));
  }

  /** The ends of the axes, with their units. */
  #rulers() {
    const { x0, x1, y0, y1, z, top } = this.floor;
    const [ox, oy, oz] = this.model.origin;
    const ends = [
      [[x0, y0, z], ""], [[x1, y0, z], `x ${number(round(x0 + ox))} to ${number(round(x1 + ox))} m`],
      [[x0, y1, z], `y ${number(round(y0 + oy))} to ${number(round(y1 + oy))} m`],
      ...(top - z > 1e-6 ? [[[x0, y0, top], `z ${number(round(z + oz))} to ${number(round(top + oz))} m`]] : []),
    ];
    const at = this.projector();
    while (this.overlay.children.length < ends.length) this.overlay.append(document.createElement("span"));
    ends.forEach(([place, text], i) => {
      const span = this.overlay.children[i];
      const [x, y] = at(place, 0);
      if (span.textContent !== text) span.textContent = text;
      const width = 8 * text.length;
      span.style.transform = `translate(${Math.min(Math.max(x, 4), this.width - width)}px, ${Math.min(Math.max(y, 2), this.height - 20)}px)`;
    });
  }
}

const round = (value) => Math.round(value * 1000) / 1000;

/** A picture of `size` pixels that `draw` fills in white. */
function texture(draw) {
  const canvas = document.createElement("canvas");
  canvas.width = 64;
  canvas.height = 64;
  const ctx = canvas.getContext("2d");
  ctx.fillStyle = "#fff";
  ctx.strokeStyle = "#fff";
  ctx.beginPath();
  ctx.arc(32, 32, 26, 0, 7);
  draw(ctx);
  return canvas;
}

const disc = () => texture((ctx) => ctx.fill());
const ring = () => texture((ctx) => { ctx.lineWidth = 8; ctx.stroke(); });
