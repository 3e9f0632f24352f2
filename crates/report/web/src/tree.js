// The tree over which packets went, at any time: parents, hops to a sink, and nodes whose battery was empty.

import { after } from "./times.js";

export class Tree {
  #at = null;

  /** `world` has `tree`, `deaths`, or both. */
  constructor(world) {
    this.count = world.names.length;
    this.tree = world.tree ?? null;
    this.deaths = world.deaths ?? null;
    this.hasChanges = Boolean(this.tree?.chosen || this.deaths);
    this.deepest = 1;
    if (this.tree) {
      for (const time of [...(this.tree.chosen?.times_s ?? []), Infinity]) this.#deepen(time);
    }
  }

  /** The most hops of all times, as far as a look at each of some changes tells. */
  #deepen(time) {
    if (this.count > 400 && time !== Infinity) return;
    for (const hops of this.at(time).hops) this.deepest = Math.max(this.deepest, hops);
  }

  /**
   * By node: `parents` as numbers of stations, nodes first and then sinks, -1 without one; `hops` to a sink, 0 without a way; `dead`, 1 if the
   * battery is empty. `version` changes with them.
   */
  at(time) {
    const { count, tree, deaths } = this;
    const chosen = tree?.chosen;
    const seen = chosen ? after(chosen.times_s, time) : 0;
    let gone = 0;
    for (const death of deaths?.times_s ?? []) gone += Number(death <= time);
    const version = `${seen}:${gone}`;
    if (this.#at?.version === version) return this.#at;
    const dead = new Uint8Array(count);
    deaths?.nodes.forEach((node, i) => { if (deaths.times_s[i] <= time) dead[node] = 1; });
    const parents = new Int32Array(count).fill(-1);
    if (chosen) for (let i = 0; i < seen; i++) parents[chosen.nodes[i]] = chosen.parents[i] - 1;
    else tree?.parents.forEach((parent, node) => { parents[node] = parent - 1; });
    const hops = new Uint16Array(count);
    for (let node = 0; node < count; node++) hops[node] = this.#hops(node, parents, dead);
    this.#at = { version, parents, hops, dead };
    return this.#at;
  }

  /** No way leads over a dead node, or along a loop. */
  #hops(node, parents, dead) {
    let station = node;
    for (let hops = 0; hops <= this.count; hops++) {
      if (station >= this.count) return hops;
      if (station < 0 || dead[station]) return 0;
      station = parents[station];
    }
    return 0;
  }
}
