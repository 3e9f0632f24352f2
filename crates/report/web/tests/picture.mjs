// Compares pictures by what an eye sees from afar: means over squares. Letters and edges differ from browser to browser and
// from renderer to renderer, so pixels are not compared.

import { PNG } from "pngjs";

/** Side of a square (px). */
const SIDE = 16;

/** The mean colour of each square. */
function means(octets) {
  const { width, height, data } = PNG.sync.read(Buffer.from(octets));
  const [columns, rows] = [Math.floor(width / SIDE), Math.floor(height / SIDE)];
  const squares = new Float64Array(3 * columns * rows);
  for (let y = 0; y < rows * SIDE; y++) {
    for (let x = 0; x < columns * SIDE; x++) {
      const square = 3 * (Math.floor(y / SIDE) * columns + Math.floor(x / SIDE));
      for (let k = 0; k < 3; k++) squares[square + k] += data[4 * (y * width + x) + k] / SIDE ** 2;
    }
  }
  return { columns, rows, squares };
}

/** The share of squares whose colour differs by more than `tolerance` (of 255); 1 for pictures of different sizes. */
export function difference(one, other, tolerance = 24) {
  const [a, b] = [means(one), means(other)];
  if (a.columns !== b.columns || Math.abs(a.rows - b.rows) > 1) return 1;
  let differing = 0;
  const count = a.columns * Math.min(a.rows, b.rows);
  for (let i = 0; i < count; i++) {
    const far = [0, 1, 2].some((k) => Math.abs(a.squares[3 * i + k] - b.squares[3 * i + k]) > tolerance);
    if (far) differing += 1;
  }
  return differing / count;
}
