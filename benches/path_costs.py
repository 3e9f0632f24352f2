#!/usr/bin/env python3
"""What an estimated path costs: wall time and memory of `sextant map --estimate-path` over poses and nodes.

path_costs.py SEXTANT [POSES,NODES ..]

A robot drives lanes half a metre a pose through a square in which the density of nodes stays the same; its odometry turns by 0.002 rad/m,
and each pose has ranges to up to six nodes within 15 m. Needs NumPy.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

DRIFT = 0.002
REACH_M = 15.0
RANGES = 6


def write(folder, poses, nodes):
    draw = np.random.default_rng(1)
    lanes = max(2, round(np.sqrt(poses * 0.5 / 4.0)))
    side = max(4.0 * lanes, 20.0)
    way = 0.5 * np.arange(poses) % (2 * (side + 4.0) * lanes / 2)
    lane, along = np.divmod(way, side + 4.0)
    up = np.clip(along - side, 0, 4.0)
    x = np.where(lane % 2 < 1, np.minimum(along, side), side - np.minimum(along, side))
    truth = np.column_stack([x, 4.0 * lane + up])
    steps = np.diff(truth, axis=0)
    turn = np.cumsum(np.concatenate([[0], DRIFT * np.hypot(*steps.T)[:-1]]))
    sin, cos = np.sin(turn), np.cos(turn)
    turned = np.column_stack([cos * steps[:, 0] - sin * steps[:, 1], sin * steps[:, 0] + cos * steps[:, 1]])
    believed = np.vstack([truth[:1], truth[0] + np.cumsum(turned, axis=0)])
    places = draw.uniform(0, [side, truth[:, 1].max() + 1e-9], (nodes, 2))
    with open(folder / "odometry.csv", "w") as path, open(folder / "ranges.csv", "w") as ranges:
        path.write("t_s,x_m,y_m\n")
        ranges.write("t_s,node,range_m\n")
        for step in range(poses):
            path.write(f"{0.5 * step},{believed[step, 0]:.4f},{believed[step, 1]:.4f}\n")
            distance = np.hypot(*(places - truth[step]).T)
            near = np.argsort(distance)[:RANGES]
            for node in near[distance[near] < REACH_M]:
                ranges.write(f"{0.5 * step},n{node},{distance[node] + 0.1 * draw.normal() + 0.3:.3f}\n")


def main():
    sextant = sys.argv[1]
    cases = sys.argv[2:] or ["1000,10", "1000,50", "4000,50", "4000,100", "10000,100", "10000,500", "100000,500"]
    print("| poses | nodes | wall [s] | memory [MB] | moved |\n| --- | --- | --- | --- | --- |")
    for case in cases:
        poses, nodes = map(int, case.split(","))
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), poses, nodes)
            start = time.monotonic()
            command = [sextant, "map", folder, "--estimate-path", "--algorithm", "range-ml", "--format", "json", "--quiet"]
            done = subprocess.run(command, capture_output=True, check=True)
            wall_s = time.monotonic() - start
        summary = json.loads(done.stdout)
        memory = summary.get("timing", {}).get("peak_rss_bytes") or 0
        print(f"| {poses} | {nodes} | {wall_s:.1f} | {memory / 1e6:.0f} | {summary['path']['moved']} |", flush=True)


if __name__ == "__main__":
    main()
