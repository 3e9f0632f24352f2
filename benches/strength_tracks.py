#!/usr/bin/env python3
"""Tracks of tags by strengths alone: Sextant beside the strongest receiver and the weighted centroid.

strength_tracks.py SEXTANT [FOLDER..]

Each folder is a log with strengths in ranges.csv (t_s,node,range_m,rssi_dbm), nodes.csv and truth-path.csv; its ranges are not used.
Without folders, tags in a generated hall are tracked, ten seeds each. Prints the root of the mean square error of each. Needs NumPy.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

WINDOW_S = 1.0


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def baselines(places, times, nodes, strengths, truth, sought):
    """Errors of the strongest receiver and of the centroid weighted by amplitude, within a second before and after."""
    errors = []
    for time in sought:
        near = np.abs(times - time) <= WINDOW_S
        heard = np.unique(nodes[near])
        if not len(heard):
            continue
        mean = np.array([strengths[near & (nodes == node)].mean() for node in heard])
        weights = 10.0 ** (mean / 20.0)
        centroid = weights @ places[heard] / weights.sum()
        here = np.array([np.interp(time, truth[:, 0], truth[:, axis]) for axis in (1, 2)])
        errors.append([np.hypot(*(place - here)) for place in (places[heard[mean.argmax()]], centroid)])
    return np.sqrt(np.mean(np.square(errors), axis=0))


def track(sextant, folder):
    arguments = ["map", folder, "--track", "--known", folder / "known.csv", "--truth", folder / "truth.csv"]
    done = subprocess.run([sextant, *arguments, "--format", "json", "--quiet"], capture_output=True, check=True)
    return json.loads(done.stdout)["tracks"][0]


def write(path, header, table):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(table)


def errors(sextant, names, places, packets, truth):
    """The errors of both baselines and of Sextant, and the share in its regions."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        write(folder / "packets.csv", ["t_s", "node", "rssi_dbm"], [(f"{t:.3f}", names[n], f"{s:.2f}") for t, n, s in packets])
        write(folder / "known.csv", ["node", "x_m", "y_m", "z_m"], [(name, *place) for name, place in zip(names, places)])
        write(folder / "truth.csv", ["t_s", "x_m", "y_m"], truth)
        found = track(sextant, folder)
    times, nodes, strengths = (np.array([packet[at] for packet in packets]) for at in range(3))
    sought = np.arange(max(truth[0, 0], times[0]), min(truth[-1, 0], times[-1]), 0.25)
    strongest, centroid = baselines(places[:, :2], times, nodes.astype(int), strengths, truth, sought)
    return [strongest, centroid, found["position_rmse_m"], found["in_region_95"]]


def real(sextant, folder):
    known = rows(folder / "nodes.csv")
    names = [row["node"] for row in known]
    places = np.array([[float(row["x_m"]), float(row["y_m"]), float(row.get("z_m") or 0)] for row in known])
    path = rows(folder / "truth-path.csv")
    truth = np.array([[float(row[key]) for key in ("t_s", "x_m", "y_m")] for row in path])
    heard = [row for row in rows(folder / "ranges.csv") if row["rssi_dbm"] and row["node"] in names and float(row["t_s"]) >= 0]
    packets = [(float(row["t_s"]), names.index(row["node"]), float(row["rssi_dbm"])) for row in heard]
    return errors(sextant, names, places, packets, truth)


def hall(seed, count, shadowing_db, correlation_m):
    """A tag that walks for three minutes in a hall of 24 by 16 m with receivers on its walls: shadowing stays the same over some metres."""
    draw = np.random.default_rng(seed)
    way = np.linspace(0, 1, count, endpoint=False) * 80
    places = np.array([[w, 0] if w < 24 else [24, w - 24] if w < 40 else [64 - w, 16] if w < 64 else [0, 80 - w] for w in way])
    places = np.column_stack([places, np.full(count, 2.5)])
    corners = draw.uniform([2, 2], [22, 14], (40, 2))
    legs = np.hypot(*np.diff(corners, axis=0).T)
    at = np.concatenate([[0], np.cumsum(legs)])
    times = np.arange(0, 180, 0.5)
    spot = np.column_stack([np.interp(times, at, corners[:, axis]) for axis in (0, 1)])
    moved = np.concatenate([[0], np.hypot(*np.diff(spot, axis=0).T)])
    offsets, shadow = draw.normal(0, 1.5, count), draw.normal(0, shadowing_db, count)
    packets = []
    for time, here, step in zip(times, spot, moved):
        kept = np.exp(-step / correlation_m)
        shadow = kept * shadow + np.sqrt(1 - kept**2) * draw.normal(0, shadowing_db, count)
        distance = np.sqrt(np.sum((places[:, :2] - here) ** 2, 1) + 1.5**2)
        strengths = -42 - 24 * np.log10(distance) + offsets + shadow + draw.normal(0, 2, count)
        packets += [(time, node, strength) for node, strength in enumerate(strengths) if strength > -92]
    names = [f"R{number}" for number in range(count)]
    return names, places, packets, np.column_stack([times, spot])


def line(name, table):
    table = np.atleast_2d(table)
    mean, half = table.mean(0), 1.96 * table.std(0, ddof=1) / np.sqrt(len(table)) if len(table) > 1 else None
    cells = [f"{mean[at]:.2f}" + (f" ± {half[at]:.2f}" if half is not None else "") for at in range(3)]
    print(f"| {name} | {' | '.join(cells)} | {mean[3]:.0%} |", flush=True)


def main():
    sextant, folders = sys.argv[1], [Path(folder) for folder in sys.argv[2:]]
    print("| log | strongest receiver [m] | weighted centroid [m] | track [m] | in 95 % regions |\n| --- | --- | --- | --- | --- |")
    for folder in folders:
        line(folder.name, [real(sextant, folder)])
    if not folders:
        for count, shadowing_db, correlation_m in [(8, 4, 2), (8, 2, 2), (8, 6, 2), (8, 4, 0.5), (4, 4, 2), (16, 4, 2)]:
            found = [errors(sextant, *hall(seed, count, shadowing_db, correlation_m)) for seed in range(1, 11)]
            line(f"hall, {count} receivers, shadowing {shadowing_db} dB over {correlation_m} m", found)


main()
