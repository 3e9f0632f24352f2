// The section of the map: pictures in 2D and 3D, what is shown on them, and the node that is looked at.

import { Clock } from "./clock.js";
import { coloring, waysOf } from "./coloring.js";
import { choice, element, section, tick } from "./element.js";
import { counted, number, withUnit } from "./format.js";
import { KEY_HELP, pressed } from "./keys.js";
import { legend } from "./legend.js";
import { Map2d } from "./map2d.js";
import { Map3d } from "./map3d.js";
import { aboutNode, nodeCard } from "./nodecard.js";
import { nodeTable } from "./nodetable.js";
import { onTheme } from "./palette.js";
import { player } from "./player.js";
import { listenToPointer } from "./pointer.js";
import { behind } from "./table.js";
import { isolated, short } from "./text.js";

/** The layers, and their names. */
const LAYERS = { tree: "Tree", truth: "True places", errors: "Errors", regions: "95 % regions (2D)", path: "Robots", stops: "Stops", listening: "Receptions", obstacles: "Obstacles", surface: "Field", labels: "Names" };
/** The pointer may be so far from a node (px). */
const REACH = 14;

export class MapView {
  #pending = false;
  #versions = 0;

  constructor(model) {
    this.model = model;
    this.clock = new Clock(model.span);
    this.mapA = model.maps[0] ?? null;
    this.mapB = null;
    this.way = waysOf(model, this.mapA)[0][0];
    this.layers = { tree: true, truth: true, errors: true, regions: false, path: true, stops: model.count < 20000, listening: true, obstacles: true, surface: true, labels: false };
    this.selected = -1;
    this.hovered = -1;
    this.in3d = false;
    this.#build();
    this.two = new Map2d(this.canvas2d, model);
    this.clock.listen(() => this.redraw());
    onTheme(() => this.#recolor());
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.#recolor();
  }

  #build() {
    const { model } = this;
    this.canvas2d = this.#canvas("Map of the network seen from above");
    this.canvas3d = this.#canvas("Map of the network in three dimensions");
    this.canvas3d.hidden = true;
    this.overlay = element("div", { class: "rulers", "aria-hidden": "true" });
    this.tip = element("div", { class: "tip", hidden: true, "aria-hidden": "true" });
    this.stage = element("div", { class: "stage" }, this.canvas2d, this.canvas3d, this.overlay, this.tip);
    this.card = element("div", { class: "card", id: "node" });
    this.live = element("p", { class: "hidden", role: "status" });
    this.legend = element("div", { class: "key" });
    this.why = element("p", { class: "why", role: "status" });
    this.help = element("p", { class: "keys", id: "map-keys" }, KEY_HELP);
    this.buttons = {
      two: element("button", { type: "button", "aria-pressed": "true", onclick: () => this.show3d(false) }, "2D"),
      three: element("button", { type: "button", "aria-pressed": "false", onclick: () => this.show3d(true) }, "3D"),
    };
    this.side = model.isFlat ? null : element("button", { type: "button", "aria-pressed": "false", onclick: () => this.#turn() }, "From the side");
    this.choices = element("div", { class: "choices" });
    this.ticks = element("fieldset", { class: "ticks" }, element("legend", {}, "Show"), this.#layerTicks());
    this.find = this.#finder();
    const views = element("div", { class: "views", role: "group", "aria-label": "View" }, this.buttons.two, this.buttons.three, this.side,
      element("button", { type: "button", onclick: () => this.zoom(1.3), "aria-label": "Zoom in" }, "+"),
      element("button", { type: "button", onclick: () => this.zoom(1 / 1.3), "aria-label": "Zoom out" }, "−"),
      element("button", { type: "button", onclick: () => this.fit() }, "Show all"));
    this.data = element("div");
    this.time = element("div");
    this.#player();
    this.section = section("map", "Map",
      element("div", { class: "tools" }, this.choices, views),
      this.why,
      element("div", { class: "map" }, element("div", { class: "picture" }, this.stage, this.time, this.legend),
        element("aside", { "aria-label": "Node and layers" }, this.find, this.card, this.ticks)),
      this.live, this.help, this.data);
    this.#choices();
  }

  #player() {
    this.player?.end();
    this.player = this.model.span ? player(this.clock, this.model) : null;
    this.time.replaceChildren(...(this.player ? [this.player.bar] : []));
  }

  /** Goes on with a later state of the same run. What is looked at stays: the maps, the layers, the part of the plane, the node. A clock at its end stays there. */
  renew(model) {
    const { clock } = this;
    const isAtEnd = !clock.span || clock.time >= clock.span.to;
    const named = (map) => model.maps.find((one) => one.name === map?.name) ?? null;
    this.mapA = named(this.mapA) ?? model.maps[0] ?? null;
    this.mapB = named(this.mapB);
    this.model = model;
    clock.renew(model.span, isAtEnd);
    this.two.renew(model);
    this.three?.renew(model);
    this.#player();
    this.ticks.replaceChildren(element("legend", {}, "Show"), ...this.#layerTicks());
    this.#changed();
  }

  #canvas(label) {
    const canvas = element("canvas", { tabindex: "0", role: "application", "aria-label": label, "aria-describedby": "map-keys",
      onkeydown: (event) => { if (pressed(event, this)) event.preventDefault(); } });
    listenToPointer(canvas, {
      drag: (dx, dy) => { if (!this.in3d) { this.two.camera.pan(dx, dy); this.redraw(); } },
      zoom: (factor, x, y) => { if (!this.in3d) { this.two.camera.zoom(factor, x, y); this.redraw(); } },
      hover: (x, y) => this.#hover(this.nodeAt(x, y), x, y),
      leave: () => this.#hover(-1, 0, 0),
      click: (x, y) => { canvas.focus(); this.select(this.nodeAt(x, y)); },
    });
    return canvas;
  }

  #choices() {
    const { model } = this;
    const isDoubtful = (name) => model.summaries.some((map) => (map.name ?? map.algorithm) === name && (map.judgement ?? []).some((one) => one.level === "warning"));
    const maps = model.maps.map((map) => [map.name, isDoubtful(map.name) ? `${map.name} (has warnings)` : map.name]);
    const fields = [];
    if (maps.length > 0) {
      fields.push(choice("Map", maps, this.mapA.name, (name) => { this.mapA = model.maps.find((map) => map.name === name); this.#changed(); }));
      if (maps.length > 1) {
        fields.push(choice("Compare with", [["", "no other map"], ...maps.filter(([name]) => name !== this.mapA.name)], this.mapB?.name ?? "",
          (name) => { this.mapB = model.maps.find((map) => map.name === name) ?? null; this.#changed(); }));
      }
      if (!this.mapB) fields.push(choice("Colour", waysOf(model, this.mapA), this.way, (way) => { this.way = way; this.#recolor(); }));
    }
    // A choice that is made anew keeps the focus.
    const focus = [...this.choices.querySelectorAll("select")].indexOf(document.activeElement);
    this.choices.replaceChildren(...fields);
    if (focus >= 0) this.choices.querySelectorAll("select")[focus]?.focus();
  }

  #changed() {
    if (this.mapB === this.mapA) this.mapB = null;
    if (!waysOf(this.model, this.mapA).some(([way]) => way === this.way)) this.way = waysOf(this.model, this.mapA)[0][0];
    this.#choices();
    this.#recolor();
  }

  #layerTicks() {
    const { model } = this;
    const has = { tree: model.tree, truth: model.truth, errors: model.truth && model.maps.length, regions: model.maps.some((map) => map.details?.covariance_m2), path: model.robots.length || model.world.contacts, stops: model.surveys.length,
      listening: model.surveys.length && model.span, obstacles: model.obstacles.length, labels: model.count,
      surface: model.fields.length || model.likelihoods.length || model.applications.some((application) => application.fields) };
    return Object.entries(LAYERS).filter(([key]) => has[key]).map(([key, name]) =>
      tick(key === "surface" && model.likelihoods.length ? "Likelihood, field" : name, this.layers[key], (on) => { this.layers[key] = on; this.#legend(); this.redraw(); }));
  }

  #finder() {
    const { model } = this;
    const input = element("input", { type: "search", id: "find", autocomplete: "off", placeholder: "Name of a node",
      onchange: () => this.#find(input.value) });
    return element("form", { class: "field find", role: "search", onsubmit: (event) => { event.preventDefault(); this.#find(input.value); } },
      element("label", { for: "find" }, `Find one of ${counted(model.count, "node")}`), input);
  }

  #find(text) {
    if (!text) return;
    const exact = this.model.names.indexOf(text);
    const node = exact >= 0 ? exact : this.model.names.findIndex((name) => name.toLowerCase().includes(text.toLowerCase()));
    if (node < 0) this.live.textContent = `No node is called ${text}.`;
    this.select(node);
    this.#reveal(node);
  }

  #recolor() {
    const { model } = this;
    const maps = [this.mapA, this.mapB].filter(Boolean);
    this.colors = maps.map((map, k) => coloring(model, map, maps.length > 1 ? "plain" : this.way, k));
    this.#versions += 1;
    this.#legend();
    this.data.replaceChildren(behind("Nodes as a table", () => nodeTable(model, this.show(), (node) => { this.select(node); this.#reveal(node); })));
    this.redraw();
    this.#card();
  }

  #legend() {
    const name = waysOf(this.model, this.mapA).find(([way]) => way === this.way)?.[1] ?? "";
    this.legend.replaceChildren(...legend(this.model, this.show(), name).filter(Boolean));
  }

  /** What is shown now. */
  show() {
    const { model, clock } = this;
    const time = model.span ? clock.time : Infinity;
    const survey = model.surveyOf(this.mapA);
    const isOver = !model.span || time >= model.span.to;
    const maps = [this.mapA, this.mapB].filter(Boolean).map((map, k) => {
      const { places, at } = model.placesAt(map, time);
      const own = model.surveyOf(map);
      const first = own >= 0 && !isOver ? model.heard[own].firstTime : null;
      // A map that was recorded once, at its end, is shown as far as its nodes were heard.
      const visible = first ? (node) => first[node] <= time && places[3 * node] === places[3 * node] : (node) => places[3 * node] === places[3 * node];
      return { map, places, at, colors: this.colors[k], visible, way: this.way, version: `${this.#versions}:${at}:${first ? time : "end"}` };
    });
    const application = model.applications.find((one, i) => time >= one.start_s && time <= (model.phases.find((phase) => phase.name === one.name)?.end_s ?? model.applications[i + 1]?.start_s ?? Infinity));
    const targets = application?.targets ?? model.targets;
    return { time, survey, maps, targets, layers: this.layers, selected: this.selected, hovered: this.hovered, surface: this.#surface(time, application), tree: model.tree?.at(time) ?? null };
  }

  /** The likelihood of the selected node, or the field at that time. */
  #surface(time, application) {
    const { model } = this;
    const node = this.selected >= 0 ? model.names[this.selected] : null;
    const likelihood = model.likelihoods.find((plane) => plane.node === node && plane.of === this.mapA?.name);
    if (likelihood) return likelihood;
    const fields = application?.fields ?? model.fields;
    return fields.findLast((plane) => plane.time_s <= time) ?? fields[0] ?? null;
  }

  redraw() {
    if (this.#pending) return;
    this.#pending = true;
    requestAnimationFrame(() => {
      this.#pending = false;
      this.draw();
    });
  }

  draw() {
    const show = this.show();
    if (this.in3d) this.three.draw(show);
    else this.two.draw(show);
    this.canvas2d.dataset.drawn = String(Number(this.canvas2d.dataset.drawn ?? 0) + 1);
  }

  resize() {
    (this.in3d ? this.three : this.two).resize();
    this.draw();
  }

  show3d(on) {
    if (on && !this.three) {
      try {
        this.three = new Map3d(this.canvas3d, this.model, this.overlay, () => this.redraw());
      } catch (error) {
        this.why.textContent = `3D needs WebGL, which this browser does not offer here (${error.message}). The 2D map shows the same nodes.`;
        this.buttons.three.disabled = true;
        return;
      }
    }
    this.in3d = on;
    this.canvas3d.hidden = !on;
    this.overlay.hidden = !on;
    this.canvas2d.hidden = on;
    this.buttons.two.setAttribute("aria-pressed", String(!on));
    this.buttons.three.setAttribute("aria-pressed", String(on));
    if (this.side) this.side.hidden = on;
    this.#hover(-1, 0, 0);
    this.resize();
  }

  #turn() {
    const aside = this.two.camera.axes[1] === 1;
    this.two.turn(aside ? [0, 2] : [0, 1]);
    this.side.setAttribute("aria-pressed", String(aside));
    this.canvas2d.setAttribute("aria-label", `Map of the network seen from ${aside ? "the side" : "above"}`);
    this.redraw();
  }

  arrow(right, up, shift) {
    if (!this.in3d) this.two.camera.pan(-60 * right, 60 * up);
    else if (shift) this.three.pan(0.1 * right, 0.1 * up);
    else this.three.turn(0.15 * right, 0.12 * up);
    this.redraw();
  }

  zoom(factor) {
    if (this.in3d) this.three.zoom(factor);
    else this.two.camera.zoom(factor);
    this.redraw();
  }

  fit() {
    if (this.in3d) this.three.reset();
    else this.two.camera.fit();
    this.redraw();
  }

  toggle() {
    if (this.clock.playing) this.clock.pause();
    else this.clock.play();
  }

  /** The next node that can be seen. */
  step(by) {
    const { model } = this;
    const show = this.show();
    let node = this.selected < 0 && by < 0 ? 0 : this.selected;
    for (let i = 0; i < model.count; i++) {
      node = (node + by + model.count) % model.count;
      if (this.#placeOf(show, node)) break;
    }
    this.select(node);
    this.#reveal(node);
  }

  #placeOf(show, node) {
    for (const shown of show.maps) if (shown.visible(node)) return shown.places;
    return this.model.truth && Number.isFinite(this.model.truth[3 * node]) && (show.maps.length === 0 || this.layers.truth) ? this.model.truth : null;
  }

  #reveal(node) {
    const places = node >= 0 && this.#placeOf(this.show(), node);
    if (!places || this.in3d) return;
    const [a, b] = this.two.camera.axes;
    this.two.camera.reveal(places[3 * node + a], places[3 * node + b]);
    this.redraw();
  }

  /** The node under a point of the picture; -1 if there is none. */
  nodeAt(x, y) {
    const show = this.show();
    const at = (this.in3d ? this.three : this.two).projector();
    let best = -1;
    let least = REACH * REACH;
    const look = (places, visible) => {
      for (let node = 0; node < this.model.count; node++) {
        if (!visible(node)) continue;
        const [u, v] = at(places, node);
        const far = (u - x) ** 2 + (v - y) ** 2;
        if (far < least) {
          least = far;
          best = node;
        }
      }
    };
    for (const shown of show.maps) look(shown.places, shown.visible);
    if (this.model.truth && this.layers.truth) look(this.model.truth, () => true);
    return best;
  }

  #hover(node, x, y) {
    this.tip.hidden = node < 0;
    if (node >= 0) {
      const { model } = this;
      const lines = aboutNode(model, this.show(), node).filter(([name]) => !/place$/i.test(name)).slice(0, 7);
      this.tip.replaceChildren(element("strong", {}, short(model.names[node])), ...lines.map(([name, text]) => element("span", {}, `${name}: ${text}`)));
      const right = x > this.stage.clientWidth * 0.6;
      this.tip.style.left = right ? "auto" : `${x + 14}px`;
      this.tip.style.right = right ? `${this.stage.clientWidth - x + 14}px` : "auto";
      this.tip.style.top = `${Math.min(Math.max(y - 20, 4), Math.max(4, this.stage.clientHeight - 150))}px`;
    }
    if (node !== this.hovered) {
      this.hovered = node;
      this.redraw();
    }
  }

  select(node) {
    this.selected = node;
    this.#card();
    if (node >= 0) {
      const texts = aboutNode(this.model, this.show(), node).map(([name, text]) => `${name} ${text}`);
      this.live.textContent = `${isolated(this.model.names[node])}: ${texts.join("; ")}`;
    }
    this.redraw();
  }

  #card() {
    const { model, selected } = this;
    if (selected >= 0) {
      this.card.replaceChildren(...nodeCard(model, this.show(), selected));
      return;
    }
    const facts = [counted(model.count, "node")];
    if (this.mapA) {
      const errors = model.summaryOf(this.mapA).position_error_m;
      facts.push(`${number(model.finished(this.mapA).filter((x, i) => i % 3 === 0 && x === x).length)} on ${isolated(this.mapA.name)}`);
      if (errors) facts.push(`mean error ${withUnit(errors.mean, "m")}`);
    }
    this.card.replaceChildren(element("h3", {}, "No node selected"), element("p", {}, `${facts.join(", ")}. Point at a node, or click it.`));
  }
}
