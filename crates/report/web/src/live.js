// What goes on: a run that is simulated, or a log that grows. The page asks the program for what is new, and tells a run to pause, to step or to hurry.

import { choice, element } from "./element.js";
import { clockTime, number } from "./format.js";
import { documentOf } from "./payload.js";
import { visible } from "./text.js";

/** Between two questions (ms). */
const PAUSE = 300;
/** The program is gone after so many questions without an answer. */
const GONE = 10;
const SPEEDS = [["1", "1 ×"], ["10", "10 ×"], ["100", "100 ×"], ["1000", "1000 ×"], ["max", "as fast as possible"]];

/** Whether the page is that of something that goes on. */
export function isLive() {
  return document.documentElement.dataset.live !== undefined;
}

/** Shows each new document by `show`, until nothing follows. Gives the bar with its controls. */
export function follow(show) {
  const said = element("output", { class: "time", role: "status" }, "Waiting for the program");
  const pause = element("button", { type: "button", hidden: true, onclick: () => tell(state.pace.is_paused ? "resume" : "pause") }, "Pause");
  const step = element("button", { type: "button", hidden: true, title: "To the next instant at which something is recorded", onclick: () => tell("step") }, "Step");
  const speed = element("div", { class: "speed" });
  const bar = element("div", { class: "player live", role: "group", "aria-label": "What goes on" }, element("strong", {}, "Live"), pause, step, said, speed);
  let state = { pace: null };
  let shown = 0;
  let missed = 0;

  async function tell(what) {
    await fetch(what, { method: "POST" });
    await ask();
  }

  async function ask() {
    state = await (await answered("state")).json();
    if (state.pace) controls(state.pace);
    if (state.document > shown) {
      shown = state.document;
      show(documentOf(await (await answered("document")).text()));
    }
    // Who reads that the run is over sees its end.
    said.textContent = [state.pace && progress(state.pace), state.news && visible(state.news)].filter(Boolean).join("; ") || "Waiting for what can be mapped";
    if (state.is_over) for (const one of bar.querySelectorAll("button, select")) one.disabled = true;
    return state.is_over && shown === state.document;
  }

  function controls({ is_paused, speed: times }) {
    pause.hidden = step.hidden = false;
    pause.textContent = is_paused ? "Go on" : "Pause";
    if (speed.childElementCount > 0) return;
    const now = times === null ? "max" : String(times);
    const all = SPEEDS.some(([key]) => key === now) ? SPEEDS : [[now, `${number(times)} ×`], ...SPEEDS];
    speed.append(choice("Speed", all, now, (value) => tell(`speed/${value}`)));
  }

  function progress({ is_paused, time_s }) {
    return `${clockTime(time_s)}, ${state.is_over ? "the run is over" : is_paused ? "paused" : "simulated"}`;
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
