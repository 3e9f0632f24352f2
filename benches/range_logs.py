#!/usr/bin/env python3
"""Logs with measured ranges: Sextant beside least squares of SciPy.

range_logs.py SEXTANT FOLDER..

Each folder is a log: ranges.csv, nodes.csv (true places), and stops.csv or truth-path.csv; with odometry.csv the path is estimated too.
Prints three tables: static nodes on the true path, odometry with ranges, and the track of a tag among the nodes.
Needs NumPy and SciPy. No node of truth is read by Sextant but for the score.
"""

import csv
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def place(row):
    return [float(row["x_m"]), float(row["y_m"]), float(row.get("z_m") or 0.0)]


class RangeLog:
    def __init__(self, folder):
        self.folder = folder
        self.names = [row["node"] for row in rows(folder / "nodes.csv")]
        self.truth = np.array([place(row) for row in rows(folder / "nodes.csv")])
        known = {name: number for number, name in enumerate(self.names)}
        # As Sextant does, exactly 0 is a failed try.
        ranges = [row for row in rows(folder / "ranges.csv") if row["range_m"] and float(row["range_m"]) != 0.0 and row["node"] in known]
        if (folder / "stops.csv").exists():
            stops = {row["stop"]: place(row) for row in rows(folder / "stops.csv")}
            self.time, where = None, np.array([stops[row["stop"]] for row in ranges])
        else:
            path = rows(folder / "truth-path.csv")
            times = np.array([float(row["t_s"]) for row in path])
            places = np.array([place(row) for row in path])
            ranges = [row for row in ranges if times[0] <= float(row["t_s"]) <= times[-1]]
            self.time = np.array([float(row["t_s"]) for row in ranges])
            where = np.stack([np.interp(self.time, times, places[:, axis]) for axis in range(3)], 1)
        self.where = where
        self.node = np.array([known[row["node"]] for row in ranges])
        self.range = np.array([float(row["range_m"]) for row in ranges])
        self.dimensions = 3 if np.ptp(where[:, 2]) > 1e-3 else 2

    def copy(self, target, path_name, keep):
        for name in keep:
            if (self.folder / name).exists():
                shutil.copy(self.folder / name, target / (path_name if name in ("truth-path.csv", "odometry.csv") else name))


def by_least_squares(log, node, loss, with_bias):
    """The place of a node by SciPy, the best of nine starts."""
    mine = log.node == node
    where, ranges = log.where[mine], log.range[mine]
    axes = log.dimensions
    middle, usual = where.mean(0), np.median(ranges)

    def residuals(sought):
        at = np.append(sought[:axes], middle[axes:])
        bias = sought[axes] if with_bias else 0.0
        return np.linalg.norm(where - at, axis=1) + bias - ranges

    best = None
    for start in range(9):
        angle = start * np.pi / 4
        first = middle + (usual * np.array([np.cos(angle), np.sin(angle), 0.0]) if start < 8 else 1e-3)
        first[2] += 0.3 if start % 2 else -0.3
        found = least_squares(residuals, np.append(first[:axes], [0.0] * with_bias), loss=loss, f_scale=0.3, max_nfev=200)
        if best is None or found.cost < best.cost:
            best = found
    return np.append(best.x[:axes], middle[axes:])


def error(log, places):
    return float(np.linalg.norm(np.array(places) - log.truth, axis=1).mean())


def sextant(program, arguments):
    done = subprocess.run([program, "map", *map(str, arguments), "--format", "json", "--quiet"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def held(log, table):
    """How many of the nodes are in the 95 % region of the plane."""
    count = 0
    for row in rows(table):
        off = np.array([float(row["x_m"]), float(row["y_m"])]) - log.truth[log.names.index(row["node"])][:2]
        xy = float(row["cov_xy_m2"])
        count += off @ np.linalg.solve([[float(row["cov_xx_m2"]), xy], [xy, float(row["cov_yy_m2"])]], off) <= 5.991
    return count


def aligned(places, truth):
    """The places turned and moved to the truth (Umeyama 1991, without scale)."""
    a, b = places.mean(0), truth.mean(0)
    u, _, v = np.linalg.svd((places - a).T @ (truth - b))
    turn = (u @ np.diag([1.0, np.sign(np.linalg.det(u @ v))]) @ v).T
    return lambda some: (some - a) @ turn.T + b


def static(program, log, scratch):
    log.copy(scratch, "path.csv", ["ranges.csv", "stops.csv", "truth-path.csv"])
    out = scratch.with_suffix(".csv")
    found = sextant(program, [scratch, "--truth", log.folder / "nodes.csv", "--out", out])["maps"][0]
    nodes = range(len(log.names))
    peers = [error(log, [by_least_squares(log, node, *kind) for node in nodes]) for kind in (("linear", 0), ("huber", 0), ("huber", 1))]
    return peers, found["position_error_m"]["mean"], held(log, out)


def drive(program, log, scratch):
    log.copy(scratch, "odometry.csv", ["ranges.csv", "odometry.csv"])
    out, path = scratch.with_suffix(".csv"), scratch.with_suffix(".path.csv")
    found = sextant(program, [scratch, "--estimate-path", "--path-out", path, "--out", out])
    truth = rows(log.folder / "truth-path.csv")
    times = np.array([float(row["t_s"]) for row in truth])
    true = np.array([place(row) for row in truth])[:, :2]

    def at(seconds):
        return np.stack([np.interp(seconds, times, true[:, axis]) for axis in range(2)], 1)

    def rms(table):
        seconds = np.array([float(row["t_s"]) for row in table])
        places = np.array([place(row) for row in table])[:, :2]
        return float(np.sqrt(((aligned(places, at(seconds))(places) - at(seconds)) ** 2).sum(1).mean()))

    nodes = {row["node"]: place(row)[:2] for row in rows(out)}
    mapped = np.array([nodes[name] for name in log.names])
    apart = aligned(mapped, log.truth[:, :2])(mapped) - log.truth[:, :2]
    odometry = rows(log.folder / "odometry.csv")
    return rms(odometry), rms(rows(path)), float(np.linalg.norm(apart, axis=1).mean()), found["timing"]["wall_s"]


def epochs(log):
    """Root of the mean square error of the track by least squares of each quarter of a second."""
    height = np.median(log.truth[:, 2])
    squares, last = [], log.truth[:, :2].mean(0)
    epoch = np.floor((log.time - log.time.min()) / 0.25)
    for number in np.unique(epoch):
        mine = epoch == number
        nodes, where = log.truth[log.node[mine]], log.where[mine].mean(0)[:2]
        if len(set(log.node[mine])) < 3:
            continue

        def residuals(at):
            return np.hypot(np.linalg.norm(nodes[:, :2] - at, axis=1), nodes[:, 2] - height) - log.range[mine]

        middle, usual = log.truth[:, :2].mean(0), log.range[mine].mean()
        starts = [last] + [middle + usual * np.array(way) for way in ([1, 0], [-1, 0], [0, 1], [0, -1])]
        best = min((least_squares(residuals, start, max_nfev=60) for start in starts), key=lambda found: found.cost)
        last = best.x
        squares.append(((best.x - where) ** 2).sum())
    return float(np.sqrt(np.mean(squares)))


def tracked(program, log):
    known = ["--track", "--known", log.folder / "nodes.csv", "--truth", log.folder / "truth-path.csv"]
    found = sextant(program, [log.folder, *known])["tracks"][0]
    return epochs(log), found["position_rmse_m"], found["in_region_95"]


def main():
    program, folders = sys.argv[1], [Path(folder) for folder in sys.argv[2:]]
    logs = [RangeLog(folder) for folder in folders]
    with tempfile.TemporaryDirectory() as scratch:
        print("| log | nodes | least squares [m] | Huber | Huber, bias a node | range-ml | ratio | in 95 % regions |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
        ratios = []
        for log in logs:
            folder = Path(scratch) / f"static-{log.folder.name}"
            folder.mkdir()
            (plain, huber, free), own, inside = static(program, log, folder)
            ratios.append(own / plain)
            print(f"| {log.folder.name} | {len(log.names)} | {plain:.2f} | {huber:.2f} | {free:.2f} | {own:.2f} | {own / plain:.2f} | {inside} |", flush=True)
        print(f"\ngeometric mean of the ratios: {np.exp(np.mean(np.log(ratios))):.2f}\n")
        print("| log | odometry [m] | estimated path [m] | nodes, aligned [m] | seconds |\n| --- | --- | --- | --- | --- |")
        for log in logs:
            if (log.folder / "odometry.csv").exists():
                folder = Path(scratch) / f"drive-{log.folder.name}"
                folder.mkdir()
                before, after, nodes, wall_s = drive(program, log, folder)
                print(f"| {log.folder.name} | {before:.2f} | {after:.2f} | {nodes:.2f} | {wall_s:.1f} |", flush=True)
        print("\n| log | a place each quarter of a second [m] | track | ratio | in 95 % regions |\n| --- | --- | --- | --- | --- |")
        ratios = []
        for log in logs:
            if log.time is not None and not (log.folder / "odometry.csv").exists():
                before, after, share = tracked(program, log)
                ratios.append(after / before)
                print(f"| {log.folder.name} | {before:.2f} | {after:.2f} | {after / before:.2f} | {share:.0%} |", flush=True)
        print(f"\nmedian of the ratios: {np.median(ratios):.2f}" if ratios else "")


if __name__ == "__main__":
    main()
