#!/usr/bin/env python3
"""What `sextant next` brings: stops that it names beside lanes that go on and random places, over the same way.

next_stops.py SEXTANT [--seeds N] [--scene NAME] [--way METRES]

A robot surveys a part of a scene by lanes. Then it drives on over a way of the same length by each rule, and listens every 2.5 m
whatever the rule is. All of it is simulated, mapped and compared with the true places. A node that was never heard counts with
its distance from the middle of the scene. Prints a table: the mean error after each rule, and what `next` gains over lanes, seed by seed,
with intervals of 95 % by Student's law. Needs no package.
"""

import argparse
import heapq
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

STEP = 2.5
RADIUS = 0.2
# Student's law at 95 % with 1 to 30 degrees of freedom.
T95 = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131,
    2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042,
]


class Scene:
    """Nodes, walls, the survey that was, and the lanes that come next, within a box from (0, 0)."""

    def __init__(self, name, size, nodes, first, lanes, walls=(), way=80.0):
        self.name, self.size, self.nodes, self.first, self.lanes, self.walls, self.way = name, size, nodes, first, lanes, walls, way

    def is_free(self, p, margin=RADIUS + 0.15):
        x, y = p
        if not (0 <= x <= self.size[0] and 0 <= y <= self.size[1]):
            return False
        return all(distance_to_line(p, a, b) > margin for a, b in self.walls)

    def is_passable(self, a, b):
        steps = max(1, math.ceil(math.dist(a, b) / 0.1))
        return all(self.is_free([a[0] + (b[0] - a[0]) * i / steps, a[1] + (b[1] - a[1]) * i / steps]) for i in range(steps + 1))

    def way_between(self, a, b):
        """Corners of a way from a to b round walls, the last of which is b."""
        if not self.walls or self.is_passable(a, b):
            return [b]
        h = 0.5
        cell = lambda p: (round(p[0] / h), round(p[1] / h))
        start, goal = self.nearest_cell(a, h), self.nearest_cell(b, h)
        cost, before, heap = {start: 0.0}, {}, [(0.0, start)]
        while heap:
            spent, at = heapq.heappop(heap)
            if at == goal:
                break
            if spent > cost[at]:
                continue
            for dx in (-1, 0, 1):
                for dy in (-1, 0, 1):
                    to = (at[0] + dx, at[1] + dy)
                    total = spent + math.hypot(dx, dy)
                    if (dx or dy) and total < cost.get(to, math.inf) and self.is_passable_cached(at, to, h):
                        cost[to], before[to] = total, at
                        heapq.heappush(heap, (total, to))
        corners, at = [b], goal
        while at in before:
            corners.append([at[0] * h, at[1] * h])
            at = before[at]
        corners.append([start[0] * h, start[1] * h])
        corners.append(a)
        corners.reverse()
        way, here = [], 0
        while here + 1 < len(corners):
            there = next((i for i in range(len(corners) - 1, here + 1, -1) if self.is_passable(corners[here], corners[i])), here + 1)
            way.append(corners[there])
            here = there
        return way

    def nearest_cell(self, p, h):
        near = [(round(p[0] / h) + i, round(p[1] / h) + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        near = [c for c in near if self.is_free([c[0] * h, c[1] * h]) and self.is_passable(p, [c[0] * h, c[1] * h])]
        return min(near, key=lambda c: math.dist(p, [c[0] * h, c[1] * h]))

    def is_passable_cached(self, a, b, h, known={}):
        key = (id(self), a, b)
        if key not in known:
            known[key] = self.is_passable([a[0] * h, a[1] * h], [b[0] * h, b[1] * h])
        return known[key]


def distance_to_line(p, a, b):
    along = [b[0] - a[0], b[1] - a[1]]
    square = along[0] ** 2 + along[1] ** 2
    share = max(0.0, min(1.0, ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square))
    return math.hypot(p[0] - a[0] - share * along[0], p[1] - a[1] - share * along[1])


def lanes(x0, y0, x1, y1, ys):
    """Corners of lanes along x at these y, there and back."""
    corners = []
    for number, y in enumerate(ys):
        corners += [[x0, y], [x1, y]] if number % 2 == 0 else [[x1, y], [x0, y]]
    return corners


def uniform(rng, count, size):
    return [[rng.uniform(0, size[0]), rng.uniform(0, size[1])] for _ in range(count)]


def field(rng):
    size = [40.0, 40.0]
    return Scene("field", size, uniform(rng, 40, size), lanes(1, 1, 39, 39, [5, 15, 25, 35]), lanes(1, 1, 39, 39, [30, 20, 10, 1]))


def half(rng):
    size = [40.0, 40.0]
    first = [[y, x] for x, y in lanes(1, 1, 39, 39, [2, 8, 14])]
    go_on = [[y, x] for x, y in lanes(1, 1, 39, 39, [20, 26, 32, 38])]
    if first[-1][1] > 20:
        go_on = [[x, 40 - y] for x, y in go_on]
    return Scene("half", size, uniform(rng, 40, size), first, go_on, way=120.0)


def clusters(rng):
    size = [60.0, 60.0]
    nodes = []
    for _ in range(4):
        x, y = rng.uniform(8, 52), rng.uniform(8, 52)
        nodes += [[min(59, max(1, rng.gauss(x, 3))), min(59, max(1, rng.gauss(y, 3)))] for _ in range(10)]
    return Scene("clusters", size, nodes, lanes(2, 2, 58, 58, [6, 18, 30, 42, 54]), lanes(2, 2, 58, 58, [48, 36, 24, 12]))


def rooms(rng):
    size = [30.0, 18.0]
    walls = [([0, 7], [30, 7], [3, 10, 17, 24]), ([0, 11], [30, 11], [6, 13, 20, 27])]
    lines = []
    for (x0, y), (x1, _), doors in walls:
        at = x0
        for door in doors:
            lines.append(([at, y], [door - 0.6, y]))
            at = door + 0.6
        lines.append(([at, y], [x1, y]))
    for x in (7.5, 15, 22.5):
        lines += [([x, 0], [x, 7]), ([x, 11], [x, 18])]
    lines += [([-0.5, -0.5], [30.5, -0.5]), ([30.5, -0.5], [30.5, 18.5]), ([30.5, 18.5], [-0.5, 18.5]), ([-0.5, 18.5], [-0.5, -0.5])]
    nodes = []
    while len(nodes) < 40:
        p = [rng.uniform(0.3, 29.7), rng.uniform(0.3, 17.7)]
        if all(distance_to_line(p, a, b) > 0.3 for a, b in lines):
            nodes.append(p)
    first = [[1, 9], [29, 9]]
    go_on = []
    for room, door in zip((26, 19, 11, 4), (24, 17, 10, 3)):
        go_on += [[door, 9], [door, 5.5], [room - 2, 5.5], [room - 2, 2], [room + 2, 2], [room + 2, 5.5]]
    for room, door in zip((4, 11, 19, 26), (6, 13, 20, 27)):
        go_on += [[door, 9], [door, 12.5], [room + 2, 12.5], [room + 2, 16], [room - 2, 16], [room - 2, 12.5]]
    return Scene("rooms", size, nodes, first, go_on, lines, way=80.0)


SCENES = {"field": field, "half": half, "clusters": clusters, "rooms": rooms}


def stops_along(scene, start, corners, way):
    """Stops every STEP along the way over the corners, up to a length; the corners do not stop the count."""
    stops, here, left, since = [], start, way, 0.0
    for corner in corners:
        for to in scene.way_between(here, corner):
            leg = math.dist(here, to)
            at = STEP - since
            while at <= leg and at <= left:
                stops.append([here[0] + (to[0] - here[0]) * at / leg, here[1] + (to[1] - here[1]) * at / leg])
                at += STEP
            driven = min(leg, left)
            since = (since + driven) % STEP
            left -= driven
            here = to
            if left <= 1e-9:
                return stops
    return stops


class Trial:
    def __init__(self, program, folder, scene, seed, algorithm):
        self.program, self.folder, self.scene, self.seed, self.algorithm = program, Path(folder), scene, seed, algorithm
        self.base = [scene.first[0]] + stops_along(scene, scene.first[0], scene.first, 1e9)

    def sextant(self, *words):
        return subprocess.run([self.program, *map(str, words)], check=True, capture_output=True, text=True, cwd=self.folder).stdout

    def scenario(self, stops):
        walls = "".join(
            f"[[world.walls]]\npoints_m = [{a}, {b}]\nthickness_m = 0.1\nheight_m = 3.0\nmaterial = \"plasterboard\"\n" for a, b in self.scene.walls
        )
        (self.folder / "walls.toml").write_text("# Walls\n" + walls)
        return (
            f"name = \"next\"\nseed = {self.seed}\n[world.nodes.explicit]\npositions_m = {self.scene.nodes}\n{walls}"
            "[radio]\ntx_power_dbm = -50.0\nsensitivity_dbm = -80.0\n"
            "[channel]\nmax_range_m = 30.0\nshadowing.sigma_db = 4.0\n"
            "[channel.path_loss.log_distance]\nexponent = 3.0\nreference_loss_db = 0.0\n"
            "[mac.csma_unslotted]\n[traffic.beacon]\nmpdu_octets = 20\ninterval_s = 1.0\njitter = 0.1\n"
            "[reception.sinr_threshold]\nthreshold_db = 3.0\n"
            f"[[robots]]\nname = \"r\"\nstart_m = {stops[0]}\nspeed_m_per_s = 0.5\nlisten_s = 3.2\nradius_m = {RADIUS}\n"
            f"[robots.controller.waypoints]\nplaces_m = {stops}\n"
            "[[maps]]\n[maps.algorithm.packet_centroid]\n"
        )

    def run(self, name, stops):
        (self.folder / f"{name}.toml").write_text(self.scenario(stops))
        self.sextant("run", f"{name}.toml", "--out", f"{name}.mcap", "--quiet", "--force")
        self.sextant("map", f"{name}.mcap", "--algorithm", self.algorithm, "--out", f"{name}.csv", "--quiet", "--force", "--summary", f"{name}.json")
        rows = (self.folder / f"{name}.csv").read_text().splitlines()[1:]
        places = {row.split(",")[0]: [float(x) for x in row.split(",")[1:3]] for row in rows}
        middle = [0.5 * self.scene.size[0], 0.5 * self.scene.size[1]]
        errors = [math.dist(node, places.get(f"n{i}", middle)) for i, node in enumerate(self.scene.nodes)]
        return sum(errors) / len(errors), len(self.scene.nodes) - len(places)

    def next(self, recording, way, start):
        x, y = self.scene.size
        words = ["next", recording, "--algorithm", self.algorithm, "--area", f"0.4,0.4,{x - 0.4},{y - 0.4}", "--way", way, "--stops", 60, "--format", "json", "--quiet"]
        if self.scene.walls:
            words += ["--floorplan", "walls.toml", "--radius", 0.4]
        found = json.loads(self.sextant(*words))
        corners = [corner for stop in found["stops"] for corner in stop["way"]]
        return corners, found

    def rules(self, way, parts):
        start = self.base[-1]
        yield "before", self.base
        yield "lanes", self.base + stops_along(self.scene, start, self.scene.lanes, way)
        rng = random.Random(f"{self.scene.name} {self.seed}")
        places = []
        while len(places) < 40:
            p = [rng.uniform(0, self.scene.size[0]), rng.uniform(0, self.scene.size[1])]
            if self.scene.is_free(p):
                places.append(p)
        yield "random", self.base + stops_along(self.scene, start, places, way)
        stops = list(self.base)
        self.run("part", stops)
        for part in range(parts):
            corners, found = self.next("part.mcap", way / parts, stops[-1])
            more = stops_along(self.scene, stops[-1], corners, way / parts)
            stops += more
            self.expected = found["error_m"], found["error_after_m"]
            if not more:
                break
            if part + 1 < parts:
                self.run("part", stops)
        yield "next", stops


def interval(values):
    """The mean, and half of its interval: not a number for one value."""
    mean, freedom = sum(values) / len(values), len(values) - 1
    if freedom == 0:
        return mean, math.nan
    deviation = math.sqrt(sum((v - mean) ** 2 for v in values) / freedom)
    t95 = T95[freedom - 1] if freedom <= len(T95) else 1.96 + 2.5 / freedom
    return mean, t95 * deviation / math.sqrt(len(values))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--scene", action="append", choices=sorted(SCENES))
    parser.add_argument("--way", type=float)
    parser.add_argument("--parts", type=int, default=2, help="how often `next` is asked on the way")
    parser.add_argument("--algorithm", default="auto", help="maps are made, and `next` is asked, by this one")
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    print(f"{'scene':10} {'way m':>6} {'before m':>9} {'lanes m':>9} {'random m':>9} {'next m':>9} {'gain over lanes':>22} {'over random':>20} {'unmapped':>14}", flush=True)
    for name in arguments.scene or list(SCENES):
        errors, unmapped = {}, {}
        for seed in range(1, arguments.seeds + 1):
            scene = SCENES[name](random.Random(f"{name} {seed}"))
            way = arguments.way or scene.way
            with tempfile.TemporaryDirectory() as folder:
                trial = Trial(program, folder, scene, seed, arguments.algorithm)
                for rule, stops in trial.rules(way, arguments.parts):
                    error, lost = trial.run("rule", stops)
                    errors.setdefault(rule, []).append(error)
                    unmapped.setdefault(rule, []).append(lost)
            print(name, "seed", seed, *(f"{rule} {of[-1]:.3f}" for rule, of in errors.items()), file=sys.stderr, flush=True)
        mean = {rule: sum(of) / len(of) for rule, of in errors.items()}
        gain = lambda other: "%.1f ± %.1f %%" % tuple(100 * v for v in interval([1 - b / a for a, b in zip(errors[other], errors["next"])]))
        lost = "/".join(f"{sum(of) / len(of):.1f}" for of in unmapped.values())
        print(f"{name:10} {way:6.0f} {mean['before']:9.3f} {mean['lanes']:9.3f} {mean['random']:9.3f} {mean['next']:9.3f} {gain('lanes'):>22} {gain('random'):>20} {lost:>14}", flush=True)


if __name__ == "__main__":
    main()
