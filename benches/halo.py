#!/usr/bin/env python3
"""Compares surveys of which only the part near the listeners is simulated with surveys of all nodes.

    benches/halo.py PROGRAM SCENARIO [--seeds 20] [--halos 20,30] [--set K=V ..]

Each seed is run with `simulation.region = "all"` and with `"listeners"`. Printed are, for each figure, the mean over the
seeds with its 95 % interval in both, and the mean of the paired differences with theirs. A figure holds if the interval of
the difference has zero in it, or lies within the interval of "all". Packets by distance are those received in a pair of a
node and a stop, over all pairs at that distance. Python 3.11, no packages.
"""

import argparse
import csv
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

# Edges of the classes of distance (m).
EDGES_M = [0, 2, 4, 6, 8, 10]
STUDENT_95 = {5: 2.57, 10: 2.23, 15: 2.13, 19: 2.09, 29: 2.05}


def run(program, scenario, seed, settings, folder):
    recording = folder / "run.mcap"
    summary = folder / "summary.json"
    command = [program, "run", scenario, "--seed", str(seed), "--out", recording, "--summary", summary, "--quiet"]
    subprocess.run([*command, "--threads", "1", *flags(settings)], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, "export", recording, "--out", folder / "tables"], check=True, stdout=subprocess.DEVNULL)
    return figures(json.loads(summary.read_text()), folder / "tables")


def flags(settings):
    return [flag for setting in settings for flag in ("--set", setting)]


def rows(file):
    with open(file, newline="") as text:
        yield from csv.DictReader(text)


def figures(summary, tables):
    gathering, simulation = summary["gathering"], summary["simulation"]
    packets_by_pair = {(row["node"], row["stop"]): int(row["received"]) for row in rows(tables / "receptions.csv")}
    nodes = [(row["node"], float(row["x_m"]), float(row["y_m"])) for row in rows(tables / "nodes.csv")]
    pairs, packets = [0] * (len(EDGES_M) - 1), [0] * (len(EDGES_M) - 1)
    for stop in rows(tables / "stops.csv"):
        x_m, y_m = float(stop["x_m"]), float(stop["y_m"])
        for node, nx_m, ny_m in nodes:
            distance_m = math.hypot(nx_m - x_m, ny_m - y_m)
            if distance_m < EDGES_M[-1]:
                bin = next(i for i, edge_m in enumerate(EDGES_M[1:]) if distance_m < edge_m)
                pairs[bin] += 1
                packets[bin] += packets_by_pair.get((node, stop["stop"]), 0)
    found = {f"packets a pair, {a} to {b} m": p / n for a, b, p, n in zip(EDGES_M, EDGES_M[1:], packets, pairs) if n}
    found["receptions"] = gathering["receptions"]
    found["packets received"] = gathering["packets_received"]
    found["lost to collisions"] = gathering["lost_collision"]
    found["lost to a weak signal"] = gathering["lost_signal"]
    found["access failures of 1000 packets"] = 1000 * gathering["lost_channel_access"] / gathering["packets_offered"]
    found["energy of the nodes (J)"] = sum(gathering["energy_j"].values())
    for map in summary.get("maps", []):
        found[f"mean error of {map['algorithm']} (m)"] = map["position_error_m"]["mean"]
    found["events"] = simulation["events"]
    found["CPU time of the survey (s)"] = summary["timing"]["gather_s"]
    return found


def interval(values):
    t = STUDENT_95.get(len(values) - 1, 2.0 if len(values) > 20 else 2.3)
    return statistics.mean(values), t * statistics.stdev(values) / math.sqrt(len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenario")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--halos", default="", help="radii of the halo (m), besides the default one")
    parser.add_argument("--set", action="append", default=[])
    arguments = parser.parse_args()
    forms = {"listeners": ["simulation.region=listeners"]}
    for halo_m in filter(None, arguments.halos.split(",")):
        forms[f"halo {halo_m} m"] = ["simulation.region=listeners", f"simulation.halo_m={halo_m}"]
    found = {name: [] for name in ["all", *forms]}
    for seed in range(1, arguments.seeds + 1):
        for name, settings in {"all": ["simulation.region=all"], **forms}.items():
            with tempfile.TemporaryDirectory() as folder:
                settings = [*settings, *arguments.set]
                found[name].append(run(arguments.program, arguments.scenario, seed, settings, pathlib.Path(folder)))
    for name in forms:
        print(f"{name} against all, {arguments.seeds} seeds: mean and 95 % interval")
        for figure in found["all"][0]:
            of_all = [run[figure] for run in found["all"]]
            near = [run[figure] for run in found[name]]
            (a, da), (b, db) = interval(of_all), interval(near)
            d, dd = interval([y - x for x, y in zip(of_all, near)])
            holds = "holds" if abs(d) <= dd or abs(d) <= da else "DIFFERS"
            print(f"  {figure:34} {a:12.5g} ± {da:8.2g}  {b:12.5g} ± {db:8.2g}  difference {d:10.3g} ± {dd:8.2g}  {holds}")


if __name__ == "__main__":
    main()
