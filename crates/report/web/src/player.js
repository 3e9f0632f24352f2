// The buttons and the slider of the time, and what ends their following it.

import { choice, element, identity } from "./element.js";
import { clockTime, number } from "./format.js";
import { isolated } from "./text.js";

export function player(clock, model) {
  const { from, to } = clock.span;
  const id = identity("time");
  const button = element("button", { type: "button", class: "play", onclick: () => (clock.playing ? clock.pause() : clock.play()) });
  const slider = element("input", {
    type: "range", id, min: "0", max: "1000", step: "1",
    oninput: () => { clock.pause(); clock.set(from + (to - from) * (slider.value / 1000)); },
  });
  const shown = element("output", { for: id, class: "time" });
  const unit = model.hasTimes;
  const speeds = [...new Set([1, 2, 5, 10, 20, 50, 100, clock.speed])].sort((a, b) => a - b);
  const speed = choice("Speed", speeds.map((s) => [String(s), unit ? `${number(s)} ×` : `${number(s)} stops/s`]), String(clock.speed),
    (value) => { clock.speed = Number(value); });
  const phases = element("div", { class: "phases", "aria-hidden": "true" }, model.phases.map((phase) =>
    element("span", { style: `left:${(100 * (phase.start_s - from)) / (to - from)}%;width:${(100 * (phase.end_s - phase.start_s)) / (to - from)}%`, title: phase.name }, phase.name)));
  function update() {
    button.textContent = clock.playing ? "Pause" : "Play";
    if (document.activeElement !== slider || clock.playing) slider.value = String(Math.round((1000 * (clock.time - from)) / (to - from)));
    const phase = model.phases.find((one) => clock.time >= one.start_s && clock.time <= one.end_s);
    const text = unit ? clockTime(clock.time) : `stop ${number(Math.floor(clock.time))}`;
    const all = phase && model.phases.length > 1 ? `${text}, ${isolated(phase.name)}` : text;
    shown.textContent = all;
    slider.setAttribute("aria-valuetext", all);
  }
  const end = clock.listen(update);
  update();
  const bar = element("div", { class: "player", role: "group", "aria-label": "The walk in time" }, button,
    element("div", { class: "track" }, element("label", { for: id, class: "hidden" }, "Time"), slider, model.phases.length > 1 ? phases : null),
    shown, speed);
  return { bar, end };
}
