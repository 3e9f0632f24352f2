// The scenario, the versions, and the licences of what is inside this file.

import { element, section } from "./element.js";
import { facts } from "./table.js";

export function scenarioSection(report) {
  const { origin, scenario, summary } = report;
  const about = [
    ["File", origin.file], ["Scenario", origin.scenario], ["Seed", origin.seed], ["Version", origin.version ? `sextant ${origin.version}` : undefined],
    ["Report made by", `sextant ${origin.reported_by}`], ["SHA-256 of the scenario", summary?.scenario?.sha256],
  ].filter(([, text]) => text);
  const licences = element("details", {}, element("summary", {}, "Licences of the libraries in this file"));
  licences.addEventListener("toggle", () => {
    if (licences.children.length === 1) licences.append(element("pre", { tabindex: "0" }, document.getElementById("licences").textContent));
  });
  return section("origin", "Origin",
    facts("Where the data are from", about, "text"),
    scenario ? element("details", {}, element("summary", {}, "Text of the scenario"), element("pre", { tabindex: "0" }, scenario)) : null,
    licences);
}
