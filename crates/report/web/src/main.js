// Puts the page together.

import { applicationsSection } from "./applications.js";
import { element } from "./element.js";
import { errorsSection } from "./errors.js";
import { macSection } from "./mac.js";
import { MapView } from "./mapview.js";
import { Model } from "./model.js";
import { readDocument } from "./payload.js";
import { reproductionSection } from "./reproduction.js";
import { scenarioSection } from "./scenario.js";
import { summarySection } from "./summary.js";
import { sweepSection } from "./sweep.js";
import { themeButton } from "./theme.js";

/** Whether there is something to draw on a map. */
function hasPlaces(world) {
  return Boolean(world && (world.truth_m || world.maps || world.surveys || world.sinks || world.targets));
}

async function start() {
  const main = document.getElementById("main");
  const top = document.querySelector("header.top");
  try {
    const report = await readDocument();
    const view = hasPlaces(report.world) ? new MapView(new Model(report)) : null;
    const isTraffic = !report.summary?.maps?.length && report.summary?.mac;
    const traffic = macSection(report);
    const sections = [
      summarySection(report), isTraffic ? traffic : null, view?.section, view ? errorsSection(view.model) : null, isTraffic ? null : traffic,
      applicationsSection(report), sweepSection(report), reproductionSection(report), scenarioSection(report),
    ].filter(Boolean);
    const links = sections.map((one) => element("a", { href: `#${one.id}` }, one.querySelector("h2").textContent));
    top.append(element("div", { class: "bar-right" }, element("nav", { "aria-label": "Sections" }, links), themeButton()));
    main.replaceChildren(...sections);
    view?.resize();
    // For tests and for people who look under the bonnet.
    globalThis.sextantReport = { report, view };
    document.documentElement.dataset.ready = "true";
  } catch (error) {
    main.replaceChildren(element("p", { class: "why", role: "alert" }, `This report cannot be shown: ${error.message}. It needs a browser of 2023 or later.`));
    throw error;
  }
}

start();
