// Mouse and touch on the map: drag to move, wheel or two fingers to zoom, point at a node, click it.

/** `on` has `drag(dx, dy)`, `zoom(factor, x, y)`, `hover(x, y)`, `leave()` and `click(x, y)`. */
export function listenToPointer(canvas, on) {
  const down = new Map();
  let moved = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, place(event));
    if (down.size === 1) moved = 0;
    canvas.setPointerCapture?.(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const [x, y] = place(event);
    const before = down.get(event.pointerId);
    if (!before) {
      on.hover(x, y);
      return;
    }
    const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      on.zoom(apart([x, y]) / Math.max(apart(before), 1), (x + other[0]) / 2, (y + other[1]) / 2);
    } else on.drag(x - before[0], y - before[1]);
    moved += Math.abs(x - before[0]) + Math.abs(y - before[1]);
    down.set(event.pointerId, [x, y]);
  });
  const up = (event) => {
    const was = down.delete(event.pointerId);
    if (was && moved < 6 && event.type === "pointerup") on.click(...place(event));
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => on.leave());
  canvas.addEventListener("wheel", (event) => {
    // The page scrolls on, unless the map has the focus or Ctrl is held.
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    on.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0016)), ...place(event));
  }, { passive: false });
}
