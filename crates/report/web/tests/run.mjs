// Tests of reports in the browsers that are installed. `node tests/run.mjs FOLDER PROGRAM`: FOLDER has reports as tests/make.sh
// makes them, with that program, which is asked for a live view too. With `--keep`, the pictures of Chromium become those that later ones are compared with.

import { strict as assert } from "node:assert";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { installed, open, settled, start } from "./browser.mjs";
import { namesInNode, namesInPage } from "./names.mjs";
import { difference, reduced } from "./picture.mjs";
import { sweepInNode } from "./sweep.mjs";
import { page as pageOf, synthetic } from "./synthetic.mjs";

const [folder, program] = process.argv.slice(2).filter((word) => !word.startsWith("--"));
const isKeeping = process.argv.includes("--keep");
const kept = new URL("./kept/", import.meta.url).pathname;
const axe = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
const reports = readdirSync(folder).filter((name) => name.endsWith(".html") && name !== "names.html").sort();
const made = mkdtempSync(join(tmpdir(), "sextant-report-"));
/** Of a picture, at most this share of the squares may differ. */
const MOST_DIFFERENT = 0.03;

let failures = 0;
async function test(name, body) {
  const began = Date.now();
  try {
    await body();
    console.log(`ok    ${name} (${Date.now() - began} ms)`);
  } catch (error) {
    failures += 1;
    console.log(`FAIL  ${name}: ${error.stack}`);
  }
}

/** What `read` finds in the page, when `done` holds. */
async function eventually(page, read, done, what) {
  let value;
  for (let i = 0; i < 40; i++) {
    value = await page.evaluate(read);
    if (done(value)) return value;
    await new Promise((later) => setTimeout(later, 50));
  }
  assert.fail(`${what}: ${JSON.stringify(value)}`);
}

function isQuiet({ said, asked }) {
  assert.deepEqual(said, [], "errors on the console");
  assert.deepEqual(asked, [], "requests that leave the file");
}

async function hasNoBarriers(page) {
  await page.evaluate(axe);
  const violations = await page.evaluate(async () => (await globalThis.axe.run(document)).violations
    .map((one) => `${one.id}: ${one.nodes.slice(0, 3).map((node) => `${node.html.slice(0, 120)} ${node.failureSummary?.slice(0, 200)}`).join(" | ")}`));
  assert.deepEqual(violations, []);
}

/** Each report, in light and dark, wide and narrow. */
async function looks(name, browser) {
  for (const report of reports) {
    for (const dark of [false, true]) {
      await test(`${name}: ${report} ${dark ? "dark" : "light"}`, async () => {
        const opened = await open(browser, join(folder, report), { dark });
        if (name === "chromium" && (!dark || report === "survey.html")) await hasNoBarriers(opened.page);
        const picture = reduced(await opened.page.screenshot());
        const file = join(kept, `${report.replace(".html", "")}-${dark ? "dark" : "light"}.png`);
        if (isKeeping && name === "chromium") writeFileSync(file, picture);
        if (name === "chromium") {
          assert.ok(existsSync(file), `there is no kept picture ${file}; --keep makes it`);
          const share = difference(picture, readFileSync(file));
          assert.ok(share <= MOST_DIFFERENT, `${(100 * share).toFixed(1)} % of the squares differ from ${file}`);
        }
        isQuiet(opened);
        await opened.page.close();
      });
    }
    await test(`${name}: ${report} in a narrow window`, async () => {
      const opened = await open(browser, join(folder, report), { width: 360, height: 740 });
      const wide = await opened.page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= 360, `the page is ${wide} px wide`);
      isQuiet(opened);
      await opened.page.close();
    });
  }
}

/** Mouse and keyboard on the map of a survey. */
async function uses(name, browser) {
  const survey = join(folder, "survey.html");
  await test(`${name}: pointing at a node shows its error`, async () => {
    const opened = await open(browser, survey);
    const { page } = opened;
    const at = await page.evaluate(() => {
      document.querySelector("#map").scrollIntoView({ behavior: "instant" });
      const { view } = sextantReport;
      const { places } = view.show().maps[0];
      const box = view.canvas2d.getBoundingClientRect();
      const [x, y] = view.two.at(places, 3);
      return [box.left + x, box.top + y];
    });
    await page.mouse.move(...at);
    const tip = await eventually(page, () => { const tip = document.querySelector(".tip"); return tip.hidden ? "" : tip.textContent; }, (text) => text !== "", "a tip");
    assert.match(tip, /n3.*Error: .*m.*Packets received/);
    await page.mouse.click(...at);
    await eventually(page, () => document.querySelector("#node h3").textContent, (text) => text === "n3", "the card of the node");
    isQuiet(opened);
    await page.close();
  });
  await test(`${name}: everything is reached by the keyboard`, async () => {
    const opened = await open(browser, survey);
    const { page } = opened;
    const reached = new Set();
    const unseen = [];
    for (let i = 0; i < 60; i++) {
      await page.keyboard.press("Tab");
      const found = await page.evaluate(() => {
        const one = document.activeElement;
        if (one === document.body) return null;
        const style = getComputedStyle(one);
        return { what: `${one.tagName} ${one.textContent.slice(0, 24) || one.getAttribute("aria-label") || one.id}`, seen: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0 };
      });
      if (!found) break;
      reached.add(found.what);
      if (!found.seen) unseen.push(found.what);
    }
    const count = await page.evaluate(() => [...document.querySelectorAll("a, button, select, input, summary, [tabindex='0']")].filter((one) => one.offsetParent !== null && !one.disabled).length);
    assert.ok(reached.size >= Math.min(count, 60) * 0.9 - 3, `${reached.size} of ${count} reached: ${[...reached].join("; ")}`);
    assert.deepEqual(unseen, [], "elements whose focus is not visible");
    isQuiet(opened);
    await page.close();
  });
  await test(`${name}: keys move, zoom and go from node to node`, async () => {
    const opened = await open(browser, survey);
    const { page } = opened;
    await page.focus("#map canvas");
    const before = await page.evaluate(() => ({ x: sextantReport.view.two.camera.x, scale: sextantReport.view.two.camera.scale }));
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("+");
    await page.keyboard.press("n");
    const after = await page.evaluate(() => ({ x: sextantReport.view.two.camera.x, scale: sextantReport.view.two.camera.scale, said: document.querySelector("[role=status].hidden").textContent }));
    assert.ok(after.x > before.x && after.scale > before.scale);
    assert.match(after.said, /^n0: True place/);
    await page.keyboard.press("0");
    const fitted = await page.evaluate(() => sextantReport.view.two.camera.scale);
    assert.ok(Math.abs(fitted - before.scale) < 1e-6);
    isQuiet(opened);
    await page.close();
  });
  await test(`${name}: the map grows while the walk is played`, async () => {
    const opened = await open(browser, survey);
    const { page } = opened;
    const visible = () => { const { view } = sextantReport; const shown = view.show().maps[0]; let count = 0; for (let n = 0; n < view.model.count; n++) count += Number(shown.visible(n)); return count; };
    const whole = await page.evaluate(visible);
    await page.evaluate(() => sextantReport.view.clock.set(0));
    assert.ok(await page.evaluate(visible) < whole);
    await page.evaluate(() => { sextantReport.view.clock.speed = 100; });
    await page.evaluate(() => document.querySelector(".play").click());
    assert.equal(await page.evaluate(visible, { timeout: 20_000 }) <= whole, true);
    await eventually(page, visible, (count) => count === whole, "all nodes at the end of the walk");
    isQuiet(opened);
    await page.close();
  });
  await test(`${name}: 3D turns, and 2D stays where there is no WebGL`, async () => {
    const opened = await open(browser, survey);
    const { page } = opened;
    await page.evaluate(() => [...document.querySelectorAll(".views button")].find((button) => button.textContent === "3D").click());
    await settled(page);
    const is3d = await page.evaluate(() => sextantReport.view.in3d);
    if (is3d) {
      const position = () => sextantReport.view.three.camera.position.toArray();
      const before = await page.evaluate(position);
      await page.evaluate(() => sextantReport.view.canvas3d.focus());
      await page.keyboard.press("ArrowLeft");
      assert.notDeepEqual(await page.evaluate(position), before);
    } else {
      assert.match(await page.evaluate(() => document.querySelector(".why").textContent), /3D needs WebGL/);
      opened.said.length = 0;
    }
    isQuiet(opened);
    await page.close();
  });
}

/** Two maps of one log beside each other. */
async function compares(name, browser) {
  if (!reports.includes("compare.html")) return;
  await test(`${name}: two maps are compared`, async () => {
    const opened = await open(browser, join(folder, "compare.html"));
    const { page } = opened;
    const other = await page.evaluate(() => {
      const select = [...document.querySelectorAll(".choices select")].find((one) => one.previousSibling.textContent === "Compare with");
      select.value = select.options[1].value;
      select.dispatchEvent(new Event("change"));
      return select.value;
    });
    await settled(page);
    const legend = await page.evaluate(() => document.querySelector(".key").textContent);
    assert.ok(legend.includes(other), legend);
    await page.evaluate(() => sextantReport.view.select(2));
    const card = await page.evaluate(() => document.querySelector("#node").textContent);
    assert.equal(card.match(/: error/g)?.length, 2, card);
    isQuiet(opened);
    await page.close();
  });
}

/** The regions of all nodes are drawn if they are asked for. */
async function regions(name, browser) {
  await test(`${name}: a switch draws the regions of all nodes`, async () => {
    const opened = await open(browser, join(folder, "log.html"));
    const { page } = opened;
    const picture = () => page.evaluate(() => { sextantReport.view.draw(); return sextantReport.view.canvas2d.toDataURL(); });
    const toggle = () => page.evaluate(() => {
      [...document.querySelectorAll(".ticks label")].find((one) => one.textContent.includes("95 % regions")).click();
      return document.querySelector(".key").textContent.includes("95 % region");
    });
    const before = await picture();
    assert.ok(await toggle());
    assert.notEqual(await picture(), before);
    assert.ok(!await toggle());
    assert.equal(await picture(), before);
    isQuiet(opened);
    await page.close();
  });
}

/** The page of a sweep finds a measure by a part of its name. */
async function sweeps(name, browser) {
  await test(`${name}: a measure of a sweep is found by its name, and ticks are at the values that were run`, async () => {
    const opened = await open(browser, join(folder, "sweep.html"));
    const { page } = opened;
    const charts = () => page.evaluate(() => document.querySelectorAll("#sweep .grid figure").length);
    const atFirst = await charts();
    await page.evaluate(() => document.querySelector("#sweep input[type=search]").focus());
    await page.keyboard.type("delivered");
    const found = await page.evaluate(() => ({
      options: [...document.querySelectorAll("#sweep select")].at(-1).options.length,
      all: sextantReport.report.sweep.measures.length,
      said: document.querySelector("#sweep output").textContent,
    }));
    assert.ok(found.options >= 2 && found.options < found.all / 2, JSON.stringify(found));
    assert.equal(found.said, `${found.options - 1} found`);
    assert.equal(await charts(), 1);
    await page.evaluate(() => { const search = document.querySelector("#sweep input[type=search]"); search.value = ""; search.dispatchEvent(new Event("input")); });
    assert.equal(await charts(), atFirst);
    isQuiet(opened);
    await page.close();
  });
}

/** The tree of a network follows the slider. */
async function networks(name, browser) {
  if (!reports.includes("network.html")) return;
  await test(`${name}: the tree follows the slider, and dead nodes are grey`, async () => {
    const opened = await open(browser, join(folder, "network.html"));
    const { page } = opened;
    const at = (time) => page.evaluate((time) => {
      const { view } = sextantReport;
      if (time !== null) view.clock.set(time);
      const { parents, hops, dead } = view.show().tree;
      const count = (list, is) => Array.from(list).filter(is).length;
      return { linked: count(parents, (one) => one >= 0), ways: count(hops, (one) => one > 0), dead: count(dead, (one) => one === 1), deepest: Math.max(...hops) };
    }, time);
    const summary = await page.evaluate(() => sextantReport.report.summary);
    const end = await at(null);
    assert.equal(end.dead, summary.battery.depleted);
    assert.ok(end.dead > 0 && end.ways <= summary.battery.nodes.length - end.dead, JSON.stringify(end));
    assert.deepEqual(await at(0), { linked: 0, ways: 0, dead: 0, deepest: 0 });
    const living = await at(summary.battery.first_death_s - 1);
    assert.deepEqual([living.dead, living.ways], [0, summary.battery.nodes.length]);
    assert.equal((await at(summary.battery.first_death_s + 1)).dead, 1);
    // The picture changes with it.
    const picture = () => page.evaluate(() => { sextantReport.view.draw(); return sextantReport.view.canvas2d.toDataURL(); });
    const pictures = [];
    for (const time of [0, summary.battery.first_death_s - 1, 1e9]) {
      await at(time);
      pictures.push(await picture());
    }
    assert.equal(new Set(pictures).size, 3);
    await page.evaluate(() => sextantReport.view.select(0));
    const card = await page.evaluate(() => document.querySelector("#node").textContent);
    assert.match(card, /Parent.*Hops to a sink.*Battery/);
    isQuiet(opened);
    await page.close();
  });
  await test(`${name}: a network has its table by depth and its lifetimes`, async () => {
    const opened = await open(browser, join(folder, "network.html"));
    const text = await opened.page.evaluate(() => document.querySelector("#network").textContent);
    for (const words of ["Nodes by hops to a sink", "Shortest lifetime (d)", "first battery empty after", "changes of parents"]) assert.ok(text.includes(words), words);
    isQuiet(opened);
    await opened.page.close();
  });
}

/** Sizes and times. */
async function limits(browser) {
  for (const [count, mostOctets] of [[1000, 5e6], [100_000, 20e6]]) {
    await test(`chromium: ${count} nodes`, async () => {
      const html = pageOf(synthetic(count));
      assert.ok(html.length < mostOctets, `${html.length} octets`);
      const file = join(made, `${count}.html`);
      writeFileSync(file, html);
      const opened = await open(browser, file);
      const measured = await opened.page.evaluate(async () => {
        const { view } = sextantReport;
        const first = performance.getEntriesByName("first-contentful-paint")[0]?.startTime;
        const each = [];
        for (let i = 0; i < 20; i++) {
          const began = performance.now();
          view.two.camera.pan(3, 1);
          view.draw();
          each.push(performance.now() - began);
          await new Promise(requestAnimationFrame);
        }
        return { first, draw: each.sort((a, b) => a - b)[10], elements: document.querySelectorAll("*").length };
      });
      console.log(`      ${count} nodes: ${(html.length / 1e6).toFixed(2)} MB, first paint after ${measured.first?.toFixed(0)} ms, a picture in ${measured.draw.toFixed(1)} ms`);
      assert.ok(measured.elements < 2000, `${measured.elements} elements`);
      isQuiet(opened);
      await opened.page.close();
    });
  }
}

async function withoutWebgl() {
  const browser = await start("chromium", ["--disable-3d-apis"]);
  await test("chromium without WebGL: the 2D map is there, and why 3D is not", async () => {
    const { page } = await open(browser, join(folder, "survey.html"));
    await page.evaluate(() => [...document.querySelectorAll(".views button")].find((button) => button.textContent === "3D").click());
    assert.match(await page.evaluate(() => document.querySelector(".why").textContent), /3D needs WebGL/);
    assert.equal(await page.evaluate(() => sextantReport.view.in3d), false);
    assert.ok(Number(await page.evaluate(() => sextantReport.view.canvas2d.dataset.drawn)) > 0);
  });
  await browser.close();
}

/** A run that is shown while it is simulated. */
async function live(name, browser) {
  await test(`${name}: a run goes on in the page, is paused there, and what is looked at stays`, async () => {
    const scenario = new URL("../../../../scenarios/smoke.toml", import.meta.url).pathname;
    const run = spawn(program, ["run", scenario, "--out", join(made, `${name}.mcap`), "--live", "--port", "0", "--speed", "40"]);
    const address = await new Promise((done) => {
      let said = "";
      run.stderr.on("data", (part) => { said += part; const found = /http:\S+\//.exec(said); if (found) done(found[0]); });
    });
    const ended = new Promise((done) => run.on("exit", done));
    const page = await browser.newPage();
    const said = [];
    page.on("console", (message) => { if (message.type() === "error") said.push(message.text()); });
    page.on("pageerror", (error) => said.push(error.message));
    const asked = [];
    page.on("request", (request) => { if (!request.url().startsWith(address) && !/^(data|blob):/.test(request.url())) asked.push(request.url()); });
    await page.goto(address);
    const stops = () => globalThis.sextantReport?.view?.model.surveys[0]?.stops.times_s.length ?? 0;
    await page.waitForFunction(stops, { timeout: 20_000 });
    await page.evaluate(() => { sextantReport.view.zoom(2); sextantReport.view.select(3); [...document.querySelectorAll(".live button")][0].click(); });
    await page.waitForFunction(() => /paused/.test(document.querySelector(".live output").textContent), { timeout: 5_000 });
    const before = await page.evaluate(() => ({ scale: sextantReport.view.two.camera.scale, stops: sextantReport.view.model.surveys[0].stops.times_s.length }));
    assert.ok(before.stops < 100);
    await page.evaluate(() => [...document.querySelectorAll(".live button")][0].click());
    await page.waitForFunction(() => document.querySelector("#summary") && /over/.test(document.querySelector(".live output").textContent), { timeout: 30_000 });
    const after = await page.evaluate(() => ({ scale: sextantReport.view.two.camera.scale, selected: sextantReport.view.selected, stops: sextantReport.view.model.surveys[0].stops.times_s.length, maps: document.querySelectorAll("#map").length }));
    assert.deepEqual(after, { scale: before.scale, selected: 3, stops: 100, maps: 1 });
    assert.equal(await ended, 0);
    assert.deepEqual(said, [], "errors on the console");
    assert.deepEqual(asked, [], "requests to elsewhere");
    await page.close();
  });
}

await namesInNode(test);
await sweepInNode(test);
for (const name of Object.keys(installed)) {
  const browser = await start(name);
  console.log(await browser.version());
  await looks(name, browser);
  await uses(name, browser);
  await compares(name, browser);
  await live(name, browser);
  await regions(name, browser);
  await sweeps(name, browser);
  await networks(name, browser);
  await namesInPage(test, name, browser, join(folder, "names.html"));
  if (name === "chromium") await limits(browser);
  await browser.close();
}
if (installed.chromium) await withoutWebgl();
if (Object.keys(installed).length === 0) console.log("no browser is installed");
process.exit(failures > 0 ? 1 : 0);
