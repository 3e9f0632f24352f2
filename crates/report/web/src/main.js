// Puts the page together.

import { applicationsSection } from "./applications.js";
import { element, section } from "./element.js";
import { errorsSection } from "./errors.js";
import { macSection } from "./mac.js";
import { MapView } from "./mapview.js";
import { Model } from "./model.js";
import { networkSection } from "./network.js";
import { readDocument } from "./payload.js";
import { reproductionSection } from "./reproduction.js";
import { scenarioSection } from "./scenario.js";
import { summarySection } from "./summary.js";
import { sweepSection } from "./sweep.js";
import { visible } from "./text.js";
import { themeButton } from "./theme.js";

/** Whether there is something to draw on a map. */
function hasPlaces(world) {
  return Boolean(world && (world.truth_m || world.maps || world.surveys || world.sinks || world.targets));
}

/** A section, or why it cannot be shown: a summary of another version or program may hold something else than ours. */
function attempt(id, title, make) {
  try {
    return make();
  } catch (error) {
    console.error(error);
    return section(id, title, element("p", { class: "why", role: "alert" }, `This part cannot be shown: ${visible(error.message)}.`));
  }
}

async function start() {
  const main = document.getElementById("main");
  const top = document.querySelector("header.top");
  try {
    const report = await readDocument();
    let view = null;
    const map = attempt("map", "Map", () => {
      view = hasPlaces(report.world) ? new MapView(new Model(report)) : null;
      return view?.section;
    });
    const isTraffic = !report.summary?.maps?.length && report.summary?.mac;
    const network = attempt("network", "Network", () => networkSection(report));
    const traffic = attempt("traffic", "Traffic", () => macSection(report));
    const sections = [
      attempt("summary", "Summary", () => summarySection(report)), isTraffic ? network : null, isTraffic ? traffic : null,
      map, attempt("errors", "Errors", () => view && errorsSection(view.model)), isTraffic ? null : network, isTraffic ? null : traffic,
      attempt("applications", "Applications", () => applicationsSection(report)), attempt("sweep", "Sweep", () => sweepSection(report)),
      attempt("reproduction", "Reproduction", () => reproductionSection(report)), attempt("origin", "Origin", () => scenarioSection(report)),
    ].filter(Boolean);
    const links = sections.map((one) => element("a", { href: `#${one.id}` }, one.querySelector("h2").textContent));
    top.append(element("div", { class: "bar-right" }, element("nav", { "aria-label": "Sections" }, links), themeButton()));
    main.replaceChildren(...sections);
    view?.resize();
    // For tests and for people who look under the bonnet.
    globalThis.sextantReport = { report, view };
    document.documentElement.dataset.ready = "true";
  } catch (error) {
    main.replaceChildren(element("p", { class: "why", role: "alert" }, `This report cannot be shown: ${visible(error.message)}. It needs a browser of 2023 or later.`));
    throw error;
  }
}

start();
