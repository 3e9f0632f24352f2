// What part of the plane is seen: a centre and a scale, of x and y or of x and z.

import { niceStep, number } from "./format.js";

export class Camera {
  constructor(extent) {
    this.extent = extent;
    this.width = 1;
    this.height = 1;
    this.axes = [0, 1];
    this.fit();
  }

  /** Shows everything. */
  fit() {
    const { low, high } = this.extent;
    const [a, b] = this.axes;
    this.x = (low[a] + high[a]) / 2;
    this.y = (low[b] + high[b]) / 2;
    const across = Math.max(high[a] - low[a], 1e-3) * 1.06;
    const up = Math.max(high[b] - low[b], 1e-3) * 1.06;
    const margins = 64;
    this.scale = Math.min(Math.max(this.width - margins, 50) / across, Math.max(this.height - margins, 50) / up);
    this.smallest = this.scale / 8;
    this.fitted = true;
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    if (this.fitted) this.fit();
  }

  // The margin of the axes is on the left and at the bottom.
  sx(x) {
    return 20 + this.width / 2 + (x - this.x) * this.scale;
  }

  sy(y) {
    return -12 + this.height / 2 - (y - this.y) * this.scale;
  }

  wx(sx) {
    return this.x + (sx - 20 - this.width / 2) / this.scale;
  }

  wy(sy) {
    return this.y - (sy + 12 - this.height / 2) / this.scale;
  }

  /** Moves the picture by so many pixels. */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
    this.fitted = false;
  }

  /** Enlarges by `factor` about the point of the screen. */
  zoom(factor, sx = this.sx(this.x), sy = this.sy(this.y)) {
    const x = this.wx(sx);
    const y = this.wy(sy);
    this.scale = Math.min(Math.max(this.scale * factor, this.smallest), this.smallest * 1e6);
    this.x += x - this.wx(sx);
    this.y += y - this.wy(sy);
    this.fitted = false;
  }

  /** Moves so that the place is within the picture. */
  reveal(x, y) {
    const sx = this.sx(x);
    const sy = this.sy(y);
    if (sx < 60 || sx > this.width - 20 || sy < 20 || sy > this.height - 50) {
      this.x = x;
      this.y = y;
      this.fitted = false;
    }
  }

  /** Ticks along an axis (0 across, 1 up): pairs of the coordinate and its text. */
  ticks(axis, origin) {
    const across = axis === 0;
    const [from, to] = across ? [this.wx(40), this.wx(this.width)] : [this.wy(this.height - 24), this.wy(0)];
    const step = niceStep(to - from, (across ? this.width : this.height) / 80);
    const ticks = [];
    for (let i = Math.ceil(from / step); i * step <= to; i++) {
      const value = i * step;
      const shown = value + origin;
      ticks.push([value, Math.abs(shown) < 1e-9 * step ? "0" : step >= 1 ? number(Math.round(shown)) : shown.toFixed(Math.ceil(-Math.log10(step))).replace("-", "−")]);
    }
    return ticks;
  }
}
