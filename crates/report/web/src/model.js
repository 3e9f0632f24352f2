// What the pictures of a world need: places by node, receptions by stop, the span of time, the extent of space.

import { after } from "./times.js";
import { Tree } from "./tree.js";

/** The numbers of a document's world, ready to be drawn. */
export class Model {
  constructor(report) {
    const world = report.world;
    this.world = world;
    this.names = world.names;
    this.count = world.names.length;
    this.origin = world.frame.origin_m;
    this.start = world.frame.start_s;
    this.truth = world.truth_m ?? null;
    this.maps = world.maps ?? [];
    this.robots = world.robots ?? [];
    this.targets = world.targets ?? [];
    this.surveys = (world.surveys ?? []).filter((survey) => survey.stops.times_s.length > 0);
    this.obstacles = world.obstacles ?? [];
    this.phases = world.phases ?? [];
    this.applications = report.applications ?? [];
    this.summaries = report.summary?.maps ?? [];
    this.fields = world.fields ?? [];
    this.likelihoods = world.likelihoods ?? [];
    this.tree = world.tree || world.deaths ? new Tree(world) : null;
    this.hasTimes = this.#giveTimes();
    this.span = this.#span();
    this.extent = this.#extent();
    this.isFlat = this.extent.high[2] - this.extent.low[2] < 1e-6 + 1e-3 * Math.max(...[0, 1].map((i) => this.extent.high[i] - this.extent.low[i]));
    this.spacing = this.#spacing();
    this.heard = this.surveys.map((survey) => heardOf(survey, this.count));
    this.places = new Map();
  }

  /** Stops without times follow each other, one a second. */
  #giveTimes() {
    const all = this.surveys.flatMap((survey) => [...spanOf(survey.stops.times_s)]);
    if (all.length === 0 || Math.max(...all) > Math.min(...all)) return true;
    for (const survey of this.surveys) {
      survey.stops.times_s = Float32Array.from(survey.stops.times_s, (_, i) => i);
    }
    const end = Math.max(...this.surveys.map((survey) => survey.stops.times_s.length));
    for (const map of this.maps) for (const snapshot of map.snapshots) snapshot.time_s = end;
    return false;
  }

  #span() {
    const times = [];
    const add = (column) => { if (column && column.length) times.push(...spanOf(column)); };
    for (const survey of this.surveys) add(survey.stops.times_s);
    for (const body of [...this.robots, ...this.targets]) add(body.way.times_s);
    for (const application of this.applications) for (const target of application.targets ?? []) add(target.way.times_s);
    for (const phase of this.phases) times.push(phase.start_s, phase.end_s);
    if (this.tree?.hasChanges) times.push(...(this.world.tree?.span_s ?? [0, ...spanOf(this.world.deaths.times_s)]));
    if (times.length === 0) return null;
    const span = { from: Math.min(...times), to: Math.max(...times) };
    return span.to > span.from ? span : null;
  }

  #extent() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const add = (places) => {
      for (let i = 0; places && i + 2 < places.length; i += 3) {
        if (Number.isNaN(places[i])) continue;
        for (let k = 0; k < 3; k++) {
          low[k] = Math.min(low[k], places[i + k]);
          high[k] = Math.max(high[k], places[i + k]);
        }
      }
    };
    const world = this.world;
    add(this.truth);
    add(world.sinks?.places_m);
    for (const solid of this.obstacles) add(solid.corners_m);
    for (const body of [...this.robots, ...this.targets]) add(body.way.places_m);
    for (const survey of this.surveys) add(survey.stops.places_m);
    for (const application of this.applications) {
      for (const body of [...(application.robots ?? []), ...(application.targets ?? [])]) add(body.way.places_m);
    }
    // Estimates that are far off do not make the world small.
    if (low[0] > high[0]) for (const map of this.maps) for (const snapshot of map.snapshots) add(snapshot.places_m);
    if (low[0] > high[0]) return { low: [0, 0, 0], high: [1, 1, 0] };
    return { low, high };
  }

  /** How far nodes are apart, roughly (m). */
  #spacing() {
    const { low, high } = this.extent;
    const lengths = low.map((l, k) => high[k] - l).sort((a, b) => b - a);
    return Math.sqrt((lengths[0] * Math.max(lengths[1], lengths[0] / 100)) / Math.max(this.count, 1));
  }

  /** The simulation that goes on at `time`, if there are several. */
  phaseAt(time) {
    return this.phases.length > 1 ? this.phases.findLast((phase) => phase.start_s <= time) ?? this.phases[0] : null;
  }

  /** The map that was written last at `time`, as places by node; NaN where a node is not mapped. */
  placesAt(map, time) {
    const snapshots = map.snapshots;
    if (snapshots.length === 0) return { places: new Float32Array(3 * this.count).fill(NaN), at: -1 };
    let at = snapshots.length - 1;
    while (at > 0 && snapshots[at].time_s > time) at -= 1;
    const key = `${this.maps.indexOf(map)}:${at}`;
    let places = this.places.get(key);
    if (!places) {
      places = new Float32Array(3 * this.count).fill(NaN);
      const { nodes, places_m } = snapshots[at];
      for (let i = 0; i < nodes.length; i++) places.set(places_m.subarray(3 * i, 3 * i + 3), 3 * nodes[i]);
      if (this.places.size > 40) this.places.clear();
      this.places.set(key, places);
    }
    return { places, at };
  }

  /** The finished places of a map. */
  finished(map) {
    return this.placesAt(map, Infinity).places;
  }

  /** The summary of a map. */
  summaryOf(map) {
    return this.summaries.find((summary) => (summary.name ?? summary.algorithm) === map.name) ?? {};
  }

  /** The survey that a map uses, as its number; -1 without one. */
  surveyOf(map) {
    const networks = (map && this.summaryOf(map).networks) ?? [];
    const found = this.surveys.findIndex((survey) => survey.network && networks.includes(survey.network));
    return found >= 0 ? found : this.surveys.length > 0 ? 0 : -1;
  }

  /** Coordinates in the world. */
  inWorld(places, node) {
    return [0, 1, 2].map((k) => places[3 * node + k] + this.origin[k]);
  }

  /** How far a node may be off by its covariance (m): the root of the sum of the variances; NaN if not known. */
  deviation(map, node) {
    const entries = map.details?.covariance_m2;
    if (!entries) return NaN;
    return Math.sqrt(entries[6 * node] + entries[6 * node + 3] + entries[6 * node + 5]);
  }
}

function spanOf(column) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of column) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/** Receptions by stop, when each node was first heard, and how often. */
function heardOf(survey, count) {
  const { first, stops, received } = survey.receptions;
  const stopCount = survey.stops.times_s.length;
  const firstTime = new Float32Array(count).fill(Infinity);
  const packets = new Uint32Array(count);
  const places = new Uint32Array(count);
  const begin = new Uint32Array(stopCount + 1);
  const node = new Uint32Array(stops.length);
  for (let n = 0; n + 1 < first.length && n < count; n++) {
    for (let row = first[n]; row < first[n + 1]; row++) {
      const packet = received ? received[row] : 1;
      if (packet === 0) continue;
      firstTime[n] = Math.min(firstTime[n], survey.stops.times_s[stops[row]]);
      packets[n] += packet;
      places[n] += 1;
      begin[stops[row] + 1] += 1;
    }
  }
  for (let s = 0; s < stopCount; s++) begin[s + 1] += begin[s];
  const next = begin.slice();
  const rows = new Uint32Array(begin[stopCount]);
  for (let n = 0; n + 1 < first.length && n < count; n++) {
    for (let row = first[n]; row < first[n + 1]; row++) {
      if (received && received[row] === 0) continue;
      const slot = next[stops[row]]++;
      node[slot] = n;
      rows[slot] = row;
    }
  }
  return { firstTime, packets, places, begin, node, rows };
}

/** Where a body is at `time`: it moves straight between two places. */
export function placeAt(way, time, span) {
  const { places_m: places } = way;
  const count = places.length / 3;
  if (count === 0) return null;
  const times = way.times_s;
  if (!times) {
    if (!span) return places.subarray(0, 3);
    const at = Math.max(0, Math.min(1, (time - span.from) / (span.to - span.from))) * (count - 1);
    return between(places, Math.floor(at), at - Math.floor(at), count);
  }
  if (time <= times[0]) return places.subarray(0, 3);
  if (time >= times[count - 1]) return places.subarray(3 * count - 3);
  const next = after(times, time);
  const share = (time - times[next - 1]) / (times[next] - times[next - 1] || 1);
  return between(places, next - 1, share, count);
}

function between(places, i, share, count) {
  const j = Math.min(i + 1, count - 1);
  return [0, 1, 2].map((k) => places[3 * i + k] + share * (places[3 * j + k] - places[3 * i + k]));
}

/** The last stop of each robot at `time`. */
export function stopsNow(survey, time) {
  const last = new Map();
  const { times_s: times, robots } = survey.stops;
  for (let s = 0; s < times.length; s++) if (times[s] <= time && !(times[last.get(robots[s])] > times[s])) last.set(robots[s], s);
  return [...last.values()];
}
