// The keyboard of the map.

/** What the keys do, for people. */
export const KEY_HELP = "Arrow keys move (in 3D they turn; with Shift they move), + and − zoom, 0 shows everything, N and P go from node to node, Escape leaves the node, Space plays.";

/** Does what a key says. Returns whether it was one of the map's. */
export function pressed(event, view) {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (event.key in arrows) view.arrow(...arrows[event.key], event.shiftKey);
  else if (event.key === "+" || event.key === "=") view.zoom(1.25);
  else if (event.key === "-") view.zoom(0.8);
  else if (event.key === "0" || event.key === "Home") view.fit();
  else if (event.key === "n" || event.key === "N") view.step(1);
  else if (event.key === "p" || event.key === "P") view.step(-1);
  else if (event.key === "Escape") view.select(-1);
  else if (event.key === " ") view.toggle();
  else return false;
  return true;
}
