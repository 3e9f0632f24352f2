// A likelihood or a field as a picture.

import { rampRgb } from "./palette.js";

/** A canvas with one pixel a vertex of the plane. */
export function planeImage(plane) {
  const rows = plane.values.length / plane.columns;
  const canvas = document.createElement("canvas");
  canvas.width = plane.columns;
  canvas.height = rows;
  const ctx = canvas.getContext("2d");
  const image = ctx.createImageData(plane.columns, rows);
  const known = plane.values.filter((value) => Number.isFinite(value));
  let high = -Infinity;
  let low = Infinity;
  for (const value of known) {
    high = Math.max(high, value);
    low = Math.min(low, value);
  }
  // Of a likelihood only the places that count are seen: those within 12 of the highest logarithm.
  if (plane.node !== undefined) low = Math.max(low, high - 12);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < plane.columns; column++) {
      const value = plane.values[row * plane.columns + column];
      const at = 4 * ((rows - 1 - row) * plane.columns + column);
      const share = high > low ? (value - low) / (high - low) : 1;
      const isSeen = Number.isFinite(value) && (plane.node === undefined || share > 0);
      image.data.set(isSeen ? [...rampRgb(share), plane.node === undefined ? 255 : 255 * Math.min(1, 0.15 + share)] : [0, 0, 0, 0], at);
    }
  }
  ctx.putImageData(image, 0, 0);
  return canvas;
}
