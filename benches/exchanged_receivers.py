#!/usr/bin/env python3
"""Whether `sextant map --track` names two receivers that are exchanged.

exchanged_receivers.py SEXTANT FOLDER..

Each folder is a log with ranges.csv, nodes.csv and, for errors, truth-path.csv. Each pair of nodes gets each other's name in turn; in the
first row of a log all are right. Prints what is told: the pair, another one, or nothing, and the error of the track.
"""

import csv
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path


def track(sextant, folder, head, nodes):
    """The track of the only tag with receivers at these places."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv", newline="") as known:
        csv.writer(known).writerows([head, *nodes])
        known.flush()
        command = [sextant, "map", folder, "--track", "--known", known.name, "--format", "json", "--quiet"]
        truth = folder / "truth-path.csv"
        command += ["--truth", truth] if truth.exists() else []
        done = subprocess.run(command, capture_output=True, check=True)
    return json.loads(done.stdout)["tracks"][0]


def main():
    sextant, *folders = sys.argv[1:]
    counts = {"named": 0, "named, and another one": 0, "another one": 0, "nothing": 0}
    print("| log | exchanged | told | error [m] |\n| --- | --- | --- | --- |")
    for folder in map(Path, folders):
        with open(folder / "nodes.csv", newline="") as file:
            head, *nodes = csv.reader(file)
        for pair in [None, *itertools.combinations(range(len(nodes)), 2)]:
            changed = [list(node) for node in nodes]
            if pair:
                changed[pair[0]][0], changed[pair[1]][0] = changed[pair[1]][0], changed[pair[0]][0]
            found = track(sextant, folder, head, changed)
            told = [sorted(names) for names in found.get("exchanged", [])]
            names = sorted(nodes[at][0] for at in pair or ())
            if names in told:
                result = "named" if len(told) == 1 else "named, and another one"
            else:
                result = "another one" if told else "nothing"
            if pair:
                counts[result] += 1
            error = found.get("position_rmse_m")
            print(f"| {folder.name} | {', '.join(names)} | {result} | {'' if error is None else f'{error:.2f}'} |", flush=True)
    print(", ".join(f"{result}: {count}" for result, count in counts.items()))


if __name__ == "__main__":
    main()
