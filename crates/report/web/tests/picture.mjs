// Compares pictures by what an eye sees from afar: means over squares. Letters and edges differ from browser to browser and
// from renderer to renderer, so pixels are not compared. A kept picture has one pixel a square.

import { PNG } from "pngjs";

/** Side of a square (px). */
const SIDE = 16;
/** By how much (of 255) the mean of a square may differ. */
const TOLERANCE = 24;

/** A picture with one pixel for each square of another one. */
export function reduced(octets) {
  const { width, height, data } = PNG.sync.read(Buffer.from(octets));
  const small = new PNG({ width: Math.floor(width / SIDE), height: Math.floor(height / SIDE) });
  for (let row = 0; row < small.height; row++) {
    for (let column = 0; column < small.width; column++) {
      const sums = [0, 0, 0];
      for (let y = row * SIDE; y < (row + 1) * SIDE; y++) {
        for (let x = column * SIDE; x < (column + 1) * SIDE; x++) for (let k = 0; k < 3; k++) sums[k] += data[4 * (y * width + x) + k];
      }
      small.data.set([...sums.map((sum) => Math.round(sum / SIDE ** 2)), 255], 4 * (row * small.width + column));
    }
  }
  return PNG.sync.write(small);
}

/** The share of squares whose colours differ, of two reduced pictures; 1 if their sizes do. */
export function difference(one, other) {
  const [a, b] = [PNG.sync.read(one), PNG.sync.read(other)];
  if (a.width !== b.width || a.height !== b.height) return 1;
  let differing = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(a.data[i + k] - b.data[i + k]) > TOLERANCE)) differing += 1;
  }
  return differing / (a.width * a.height);
}
