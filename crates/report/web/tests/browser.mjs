// Starts the browsers and opens pages in them. All that a page says or asks for is kept.

import { existsSync } from "node:fs";
import puppeteer from "puppeteer-core";

const CHROMIUM = process.env.SEXTANT_CHROMIUM ?? "/usr/bin/chromium";
const FIREFOX = process.env.SEXTANT_FIREFOX ?? "/usr/bin/firefox-esr";
const FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--force-color-profile=srgb"];

/** The browsers that are installed, by name. */
export const installed = Object.fromEntries(Object.entries({ chromium: CHROMIUM, firefox: FIREFOX }).filter(([, path]) => existsSync(path)));

export function start(name, flags = []) {
  return puppeteer.launch({
    browser: name === "firefox" ? "firefox" : "chrome", executablePath: installed[name], headless: true,
    args: name === "firefox" ? [] : [...FLAGS, ...flags],
  });
}

/** Opens the file at `path` and waits until it is drawn. `said` has its errors, `asked` the addresses that it asked for. */
export async function open(browser, path, { width = 1280, height = 900, dark = false } = {}) {
  const page = await browser.newPage();
  const said = [];
  const asked = [];
  page.on("console", (message) => { if (message.type() === "error") said.push(message.text()); });
  page.on("pageerror", (error) => said.push(error.message));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); });
  await page.setViewport({ width, height });
  await page.goto(`file://${path}`);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", { timeout: 60_000 });
  if (dark) await page.click("button.quiet");
  await settled(page);
  return { page, said, asked };
}

/** Two frames later, everything is drawn. */
export function settled(page) {
  return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60)))));
}
