// The nodes on the map: a few as discs, many as pixels.

import { hexRgb, ink } from "./palette.js";

/** With more nodes than this, each is a few pixels. */
const MOST_DISCS = 3000;

/** Draws true places as rings and estimates as discs. */
export function drawNodes(map2d, show) {
  const { context: ctx, camera, model } = map2d;
  const radius = Math.max(2, Math.min(5.5, 0.2 * model.spacing * camera.scale));
  if (model.count > MOST_DISCS) {
    drawPixels(map2d, show);
    return;
  }
  if (model.truth && show.layers.truth) {
    ctx.strokeStyle = ink("ink");
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (let node = 0; node < model.count; node++) {
      const [x, y] = map2d.at(model.truth, node);
      if (!(x > -9 && x < camera.width + 9 && y > -9 && y < camera.height + 9)) continue;
      ctx.moveTo(x + radius, y);
      ctx.arc(x, y, radius, 0, 2 * Math.PI);
    }
    ctx.globalAlpha = 0.75;
    ctx.stroke();
    ctx.globalAlpha = 1;
  }
  show.maps.forEach((shown, k) => {
    for (let node = 0; node < model.count; node++) {
      if (!shown.visible(node)) continue;
      const [x, y] = map2d.at(shown.places, node);
      if (!(x > -9 && x < camera.width + 9 && y > -9 && y < camera.height + 9)) continue;
      const rgb = shown.colors.rgb;
      ctx.fillStyle = `rgb(${rgb[3 * node]},${rgb[3 * node + 1]},${rgb[3 * node + 2]})`;
      ctx.beginPath();
      if (k === 0) ctx.arc(x, y, radius, 0, 7);
      else ctx.rect(x - 0.88 * radius, y - 0.88 * radius, 1.76 * radius, 1.76 * radius);
      ctx.fill();
    }
  });
  const { anchors } = model.world;
  if (anchors && show.layers.truth) {
    ctx.strokeStyle = ink("ink");
    ctx.lineWidth = 1.5;
    for (let i = 0; i < anchors.ids.length; i++) {
      const [x, y] = map2d.at(anchors.places_m, i);
      const size = radius + 2.5;
      ctx.beginPath();
      ctx.moveTo(x, y - size);
      ctx.lineTo(x + 0.87 * size, y + 0.5 * size);
      ctx.lineTo(x - 0.87 * size, y + 0.5 * size);
      ctx.closePath();
      ctx.stroke();
    }
  }
}

/** Writes small squares into the picture directly: faster than paths by far. */
function drawPixels(map2d, show) {
  const { context: ctx, camera, model, ratio } = map2d;
  const width = map2d.canvas.width;
  const height = map2d.canvas.height;
  const image = ctx.getImageData(0, 0, width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const side = Math.max(2, Math.min(9, Math.round(0.3 * model.spacing * camera.scale * ratio)));
  const [a, b] = camera.axes;
  const ox = camera.sx(0) * ratio;
  const oy = camera.sy(0) * ratio;
  const scale = camera.scale * ratio;
  const put = (places, node, color, size, hollow) => {
    const x = Math.round(ox + scale * places[3 * node + a] - size / 2);
    const y = Math.round(oy - scale * places[3 * node + b] - size / 2);
    if (!(x >= 0 && y >= 0 && x + size < width && y + size < height)) return;
    for (let v = 0; v < size; v++) {
      const line = (y + v) * width + x;
      if (hollow && v > 0 && v < size - 1) {
        pixels[line] = color;
        pixels[line + size - 1] = color;
      } else pixels.fill(color, line, line + size);
    }
  };
  const packed = (r, g, b) => (255 << 24) | (b << 16) | (g << 8) | r;
  // True places are drawn where there is room for them beside the estimates.
  if (model.truth && show.layers.truth && (side > 3 || show.maps.length === 0)) {
    const color = packed(...hexRgb(ink("thread")));
    for (let node = 0; node < model.count; node++) put(model.truth, node, color, side, side > 3);
  }
  for (const shown of show.maps) {
    const { rgb } = shown.colors;
    for (let node = 0; node < model.count; node++) {
      if (shown.visible(node)) put(shown.places, node, packed(rgb[3 * node], rgb[3 * node + 1], rgb[3 * node + 2]), side, false);
    }
  }
  ctx.putImageData(image, 0, 0);
}
