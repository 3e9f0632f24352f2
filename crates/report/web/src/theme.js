// The button that makes the page dark or light.

import { element } from "./element.js";
import { isDark, tellTheme } from "./palette.js";

export function themeButton() {
  const button = element("button", { type: "button", class: "quiet", onclick: turn });
  function name() {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", isDark() ? "Use light colours" : "Use dark colours");
  }
  function turn() {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    name();
    tellTheme();
  }
  name();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", name);
  return button;
}
