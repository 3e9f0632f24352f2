// Names of others: nothing in them changes how the page around them is read, and none of them runs.

import { strict as assert } from "node:assert";
import { documentOf } from "../src/payload.js";
import { isolated, short, visible } from "../src/text.js";
import { open } from "./browser.mjs";

const range = (from, to) => Array.from({ length: to - from + 1 }, (_, i) => String.fromCharCode(from + i));
/** What terminals, HTML and the order of letters would obey: control characters, Unicode Standard Annex 9, ends of lines, halves of pairs. */
const HARMFUL = [...range(0, 0x1f), ...range(0x7f, 0x9f), ...range(0x202a, 0x202e), ...range(0x2066, 0x2069), "\u2028", "\u2029", "\ud800", "\udbff", "\udc00", "\udfff"]
  .filter((letter) => !"\n\t".includes(letter));
const HARMLESS = ["\n", "\t", ...range(0x20, 0x7e), ...range(0xa0, 0xff), "\u061c", "\u200e", "\u200f", "\u200d", "שלום", "مرحبا", "節点", "👩‍🔬", "\ud7ff", "\ue000", "\u{10ffff}"];

/** Without a browser. */
export async function namesInNode(test) {
  await test("harmful characters are seen, and all others stay", () => {
    for (const letter of HARMFUL) assert.equal(visible(`a${letter}b`), `a\\u{${letter.codePointAt(0).toString(16)}}b`);
    for (const letter of HARMLESS) assert.equal(visible(`a${letter}b`), `a${letter}b`);
  });
  await test("each name of a document is harmless, also in the summary within it", () => {
    for (const letter of [...HARMFUL, ...HARMLESS]) {
      const name = `a${letter}b\\u{202e}`;
      const summary = JSON.stringify({ maps: [{ name, [name]: 1, summary: name }] });
      const report = documentOf(JSON.stringify({ title: name, summary, world: { names: [name] } }));
      const expected = visible(name);
      assert.deepEqual([report.title, report.world.names, report.summary], [expected, [expected], { maps: [{ name: expected, [expected]: 1, summary: expected }] }]);
    }
  });
  await test("columns stay columns", () => {
    const column = Buffer.from(Float32Array.of(1.5, -2).buffer).toString("base64");
    assert.deepEqual(documentOf(JSON.stringify({ world: { truth_m: { f32: column }, f32: ["a"], u32: null } })).world, { truth_m: Float32Array.of(1.5, -2), f32: ["a"], u32: null });
  });
  await test("a name from right to left keeps its direction inside", () => {
    assert.equal(isolated("שלום"), "\u2068שלום\u2069");
    assert.equal(isolated("a\u200fb"), "\u2068a\u200fb\u2069");
    assert.equal(isolated("node 7"), "node 7");
    assert.equal(short("👩".repeat(30)), `${"👩".repeat(23)}…`);
  });
}

/** In a report of a log with such names. */
export async function namesInPage(test, name, browser, path) {
  await test(`${name}: names of others are seen and do nothing`, async () => {
    const opened = await open(browser, path);
    const { page } = opened;
    await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
    await page.evaluate(() => { for (let node = 0; node < 7; node++) sextantReport.view.select(node); });
    const { names, text, cards } = await page.evaluate(() => ({
      names: sextantReport.report.world.names, text: document.querySelector("#main").textContent + document.title,
      cards: sextantReport.view.model.names.map((_, node) => { sextantReport.view.select(node); return document.querySelector("#node h3").textContent; }),
    }));
    assert.deepEqual(names, ["\\u{202e}edon", "שלום\u200f", "\\u{85}\\u{80}", "</script><b>", "a\\u{2067}b", "\\u202e", "node"]);
    assert.deepEqual(cards, names);
    assert.deepEqual(HARMFUL.filter((letter) => text.replaceAll(/\u2068|\u2069/g, "").includes(letter)), []);
    assert.deepEqual([opened.said, opened.asked], [[], []]);
    await page.close();
  });
  await test(`${name}: the page runs no code but its own`, async () => {
    const { page } = await open(browser, path);
    const ran = await page.evaluate(async () => {
      // The browser tells of each violation when it has time for it.
      const refused = [];
      const all = new Promise((resolve) => {
        document.addEventListener("securitypolicyviolation", (event) => {
          refused.push(event.effectiveDirective);
          if (refused.length === 3) resolve();
        });
        setTimeout(resolve, 5000);
      });
      const script = document.createElement("script");
      script.textContent = "globalThis.foreign = 1";
      const button = document.createElement("button");
      button.setAttribute("onclick", "globalThis.foreign = 2");
      document.body.append(script, button);
      button.click();
      const style = document.createElement("style");
      style.textContent = "h1 { display: none }";
      document.head.append(style);
      await all;
      return [globalThis.foreign ?? null, getComputedStyle(document.querySelector("h1")).display, refused.sort()];
    });
    assert.deepEqual(ran, [null, "block", ["script-src-attr", "script-src-elem", "style-src-elem"]]);
    await page.close();
  });
}
