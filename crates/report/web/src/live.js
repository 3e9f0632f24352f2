// A run that is still simulated: its page asks the program for what is new, and tells it to pause, to step or to hurry.

import { choice, element } from "./element.js";
import { clockTime, number } from "./format.js";
import { documentOf } from "./payload.js";

/** Between two questions (ms). */
const PAUSE = 300;
/** The program is gone after so many questions without an answer. */
const GONE = 10;
const SPEEDS = [["1", "1 ×"], ["10", "10 ×"], ["100", "100 ×"], ["1000", "1000 ×"], ["max", "as fast as possible"]];

/** Whether the page is that of a run that is still simulated. */
export function isLive() {
  return document.documentElement.dataset.live !== undefined;
}

/** Shows each new document by `show`, until the run is over. Gives the bar with its controls. */
export function follow(show) {
  const said = element("output", { class: "time", role: "status" }, "Waiting for the program");
  const pause = element("button", { type: "button", onclick: () => tell(state.is_paused ? "resume" : "pause") }, "Pause");
  const step = element("button", { type: "button", title: "To the next instant at which something is recorded", onclick: () => tell("step") }, "Step");
  const speed = element("div", { class: "speed" });
  const bar = element("div", { class: "player live", role: "group", "aria-label": "The run" }, element("strong", {}, "Live"), pause, step, said, speed);
  let state = { is_paused: false };
  let shown = 0;
  let missed = 0;

  async function tell(what) {
    await fetch(what, { method: "POST" });
    await ask();
  }

  async function ask() {
    state = await (await answered("state")).json();
    pause.textContent = state.is_paused ? "Go on" : "Pause";
    if (speed.childElementCount === 0) {
      const now = state.speed === null ? "max" : String(state.speed);
      const all = SPEEDS.some(([key]) => key === now) ? SPEEDS : [[now, `${number(state.speed)} ×`], ...SPEEDS];
      speed.append(choice("Speed", all, now, (value) => tell(`speed/${value}`)));
    }
    const what = state.is_over ? "the run is over" : state.is_paused ? "paused" : "simulated";
    said.textContent = `${clockTime(state.time_s)}, ${what}${state.problem ? `; ${state.problem}` : ""}`;
    if (state.document > shown) {
      shown = state.document;
      show(documentOf(await (await answered("document")).text()));
    }
    if (state.is_over) for (const one of bar.querySelectorAll("button, select")) one.disabled = true;
    return state.is_over && shown === state.document;
  }

  async function loop() {
    while (missed < GONE) {
      try {
        if (await ask()) return;
        missed = 0;
      } catch {
        missed += 1;
      }
      await new Promise((later) => setTimeout(later, PAUSE));
    }
    said.textContent = "The program has ended. What it told until then is shown.";
    for (const one of bar.querySelectorAll("button, select")) one.disabled = true;
  }
  loop();
  return bar;
}

async function answered(what) {
  const answer = await fetch(what, { cache: "no-store" });
  if (!answer.ok) throw new Error(`${what}: ${answer.status}`);
  return answer;
}
