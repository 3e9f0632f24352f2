// The walk on the map in 2D: ways, stops, what is heard now, who is where.

import { placeAt, stopsNow } from "./model.js";
import { after } from "./times.js";
import { ink, robotColor } from "./palette.js";

/** The ways of the robots: what is done is stronger. */
export function drawPaths(map2d, show) {
  const { context: ctx, model } = map2d;
  model.robots.forEach((robot, i) => {
    const { places_m: places, times_s: times } = robot.way;
    const count = places.length / 3;
    const share = model.span ? (show.time - model.span.from) / (model.span.to - model.span.from) : 1;
    const done = times ? after(times, show.time) : Math.ceil(share * count);
    ctx.strokeStyle = robotColor(i);
    ctx.lineJoin = "round";
    // Of a run with several simulations only the way in the present one is drawn.
    const phase = times && model.phaseAt(show.time);
    const begin = phase ? after(times, phase.start_s - 1e-3) : 0;
    const end = phase ? after(times, phase.end_s + 1e-3) : count;
    for (const [from, to, width, alpha] of [[begin, end, 1, 0.35], [begin, done, 1.6, 0.9]]) {
      ctx.lineWidth = width;
      ctx.globalAlpha = alpha;
      ctx.beginPath();
      for (let p = from; p < to; p++) ctx.lineTo(...map2d.at(places, p));
      if (to === done && done < end) {
        const here = placeAt(robot.way, show.time, model.span);
        ctx.lineTo(...map2d.at(here, 0));
      }
      ctx.stroke();
    }
    ctx.globalAlpha = 1;
  });
}

/** The places where robots listened. */
export function drawStops(map2d, show) {
  const { context: ctx, model, camera } = map2d;
  const survey = model.surveys[show.survey];
  if (!survey) return;
  const { times_s: times, places_m: places, robots } = survey.stops;
  const side = Math.max(2, Math.min(5, camera.scale * 0.25));
  for (let s = 0; s < times.length; s++) {
    const [x, y] = map2d.at(places, s);
    if (x < -5 || x > camera.width + 5 || y < -5 || y > camera.height + 5) continue;
    const reached = times[s] <= show.time;
    ctx.globalAlpha = reached ? 0.9 : 0.25;
    ctx.fillStyle = robotColor(robots[s]);
    ctx.fillRect(x - side / 2, y - side / 2, side, side);
  }
  ctx.globalAlpha = 1;
}

/** Lines from the robot to the nodes that it hears now, and the sectors that it hears them in. */
export function drawListening(map2d, show) {
  const { context: ctx, model, camera } = map2d;
  const survey = model.surveys[show.survey];
  if (!survey || !model.span || show.time >= model.span.to) return;
  const heard = model.heard[show.survey];
  for (const stop of stopsNow(survey, show.time)) {
    const [x, y] = map2d.at(survey.stops.places_m, stop);
    const color = robotColor(survey.stops.robots[stop]);
    const sectors = new Set();
    ctx.strokeStyle = color;
    ctx.lineWidth = 1.2;
    ctx.beginPath();
    for (let i = heard.begin[stop]; i < heard.begin[stop + 1]; i++) {
      const node = heard.node[i];
      if (survey.receptions.sectors) sectors.add(survey.receptions.sectors[heard.rows[i]]);
      const place = model.truth && Number.isFinite(model.truth[3 * node]) ? model.truth : show.maps[0]?.places;
      if (!place) continue;
      const [u, v] = map2d.at(place, node);
      if (u !== u) continue;
      ctx.moveTo(x, y);
      ctx.lineTo(u, v);
    }
    ctx.globalAlpha = 0.75;
    ctx.stroke();
    ctx.fillStyle = color;
    ctx.globalAlpha = 0.13;
    const rad = Math.PI / 180;
    for (const sector of survey.sectors ?? []) {
      if (!sectors.has(sector.sector)) continue;
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.arc(x, y, Math.min(camera.width, camera.height) / 6, -sector.azimuth_to_deg * rad, -sector.azimuth_from_deg * rad);
      ctx.closePath();
      ctx.fill();
    }
    ctx.globalAlpha = 1;
  }
}

/** Anchors, sinks and contacts. */
export function drawMarks(map2d, show) {
  const { context: ctx, model } = map2d;
  const { contacts, sinks } = model.world;
  if (contacts && show.layers.path) {
    ctx.strokeStyle = ink("accent");
    ctx.lineWidth = 1.2;
    ctx.beginPath();
    for (let i = 0; i < contacts.times_s.length; i++) {
      if (contacts.times_s[i] > show.time) continue;
      const [x, y] = map2d.at(contacts.places_m, i);
      ctx.moveTo(x - 2.5, y - 2.5);
      ctx.lineTo(x + 2.5, y + 2.5);
      ctx.moveTo(x + 2.5, y - 2.5);
      ctx.lineTo(x - 2.5, y + 2.5);
    }
    ctx.stroke();
  }
  if (sinks) {
    ctx.fillStyle = ink("accent");
    for (let i = 0; i < sinks.ids.length; i++) {
      const [x, y] = map2d.at(sinks.places_m, i);
      ctx.fillRect(x - 5, y - 5, 10, 10);
    }
  }
}

/** Robots, targets and captures. */
export function drawMovers(map2d, show) {
  const { context: ctx, model } = map2d;
  if (show.layers.path) {
    for (const application of model.applications) {
      const { captures, predictions } = application;
      const begin = model.phaseAt(show.time)?.start_s ?? -Infinity;
      ctx.fillStyle = ink("accent");
      ctx.globalAlpha = 0.55;
      for (let i = 0; predictions && i < predictions.times_s.length; i++) {
        if (predictions.times_s[i] > show.time || predictions.times_s[i] < begin) continue;
        const [x, y] = map2d.at(predictions.places_m, i);
        ctx.fillRect(x - 2, y - 2, 4, 4);
      }
      ctx.globalAlpha = 1;
      for (let i = 0; captures && i < captures.times_s.length; i++) {
        if (captures.times_s[i] > show.time || captures.times_s[i] < begin) continue;
        const [x, y] = map2d.at(captures.places_m, i);
        ctx.strokeStyle = ink("accent");
        ctx.lineWidth = 2;
        ctx.beginPath();
        ctx.arc(x, y, 9, 0, 7);
        ctx.stroke();
      }
    }
  }
  ctx.lineWidth = 1.5;
  ctx.strokeStyle = ink("paper");
  for (const target of show.targets) {
    const place = placeAt(target.way, show.time, model.span);
    if (!place) continue;
    const [x, y] = map2d.at(place, 0);
    ctx.fillStyle = ink("accent");
    ctx.beginPath();
    ctx.moveTo(x, y - 8);
    ctx.lineTo(x + 7, y);
    ctx.lineTo(x, y + 8);
    ctx.lineTo(x - 7, y);
    ctx.closePath();
    ctx.fill();
    ctx.stroke();
  }
  if (!show.layers.path) return;
  model.robots.forEach((robot, i) => {
    const place = placeAt(robot.way, show.time, model.span);
    if (!place) return;
    const [x, y] = map2d.at(place, 0);
    ctx.fillStyle = robotColor(i);
    ctx.beginPath();
    ctx.arc(x, y, 7, 0, 7);
    ctx.fill();
    ctx.stroke();
  });
}
