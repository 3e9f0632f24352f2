// Colours that can be told apart with any colour vision: Okabe and Ito (2008) for categories, viridis (van der Walt and
// Smith, 2015) for numbers.

const CATEGORIES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];
const CATEGORIES_DARK = ["#4aa8de", "#f0803c", "#2fc79a", "#e39bc4", "#8fd0f5", "#f2b733", "#f2f2f2"];
const VIRIDIS = ["#fde725", "#addc30", "#5ec962", "#28ae80", "#21918c", "#2c728e", "#3b528b", "#472d7b", "#440154"];

/** Whether the page is dark now. */
export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

/** The colour of curve or map number `i`. */
export function category(i) {
  return (isDark() ? CATEGORIES_DARK : CATEGORIES)[i % CATEGORIES.length];
}

/** The colour of robot number `i`: the same here, in all sections and in the figures. */
export function robotColor(i) {
  return category(i + 4);
}

const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
const STOPS = VIRIDIS.map(rgb);

/** Red, green and blue (0 to 255) of a share from 0 to 1: larger is farther from the background. */
export function rampRgb(share) {
  const clamped = share > 0 ? Math.min(share, 1) : 0;
  // On white the brightest part is left out, on black the darkest.
  const at = (isDark() ? 7.2 * (1 - clamped) : 0.8 + 7.2 * clamped);
  const low = Math.min(Math.floor(at), 7);
  return STOPS[low].map((from, i) => Math.round(from + (STOPS[low + 1][i] - from) * (at - low)));
}

export const ramp = (share) => `rgb(${rampRgb(share).join(",")})`;
export const hexRgb = rgb;

/** A colour of the style sheet. */
export function ink(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

const listeners = new Set();

/** Calls `listener` when the page becomes dark or light. */
export function onTheme(listener) {
  listeners.add(listener);
}

export function tellTheme() {
  for (const listener of listeners) listener();
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", tellTheme);
