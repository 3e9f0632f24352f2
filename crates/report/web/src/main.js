// Puts the page together.

import { applicationsSection } from "./applications.js";
import { element, section } from "./element.js";
import { errorsSection } from "./errors.js";
import { follow, isLive } from "./live.js";
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

/** The sections of a report. `earlier` is the map of an earlier state of the same run, which goes on. */
function sectionsOf(report, earlier) {
  let view = null;
  const map = attempt("map", "Map", () => {
    if (!hasPlaces(report.world)) return null;
    view = earlier ?? new MapView(new Model(report));
    if (earlier) earlier.renew(new Model(report));
    return view.section;
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
  return { view, sections };
}

/** Puts the sections of a report on the page. The section of a map that goes on stays where it is, with the focus in it. */
function show(report, main, links) {
  const { view, sections } = sectionsOf(report, globalThis.sextantReport?.view);
  links.replaceChildren(...sections.map((one) => element("a", { href: `#${one.id}` }, one.querySelector("h2").textContent)));
  const stays = view && sections.find((one) => one === view.section && one.parentNode === main);
  if (stays) {
    for (const child of [...main.children]) if (child !== stays) child.remove();
    const at = sections.indexOf(stays);
    stays.before(...sections.slice(0, at));
    stays.after(...sections.slice(at + 1));
  } else {
    main.replaceChildren(...sections);
  }
  view?.resize();
  // For tests and for people who look under the bonnet.
  globalThis.sextantReport = { report, view };
  document.documentElement.dataset.ready = "true";
}

async function start() {
  const main = document.getElementById("main");
  const links = element("nav", { "aria-label": "Sections" });
  try {
    const live = isLive();
    const report = live ? null : await readDocument();
    document.querySelector("header.top").append(element("div", { class: "bar-right" }, links, themeButton()));
    if (live) main.before(follow((one) => show(one, main, links)));
    else show(report, main, links);
  } catch (error) {
    main.replaceChildren(element("p", { class: "why", role: "alert" }, `This report cannot be shown: ${visible(error.message)}. It needs a browser of 2023 or later.`));
    throw error;
  }
}

start();
