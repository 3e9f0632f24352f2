#!/usr/bin/env python3
"""Measures what a plan costs beside the runs: cells of a simulation of two nodes that takes 0.1 ms.

    benches/campaign.py PROGRAM [--cells 100000] [--chunk 1000]

Printed are, for the plan, one part, the status, the rest of the work and the joined table: wall time, CPU time, and what is on
the disk. Python 3.11, no packages.
"""

import argparse
import os
import pathlib
import resource
import subprocess
import tempfile
import time

SCENARIO = """name = "empty"
seed = 1
duration_s = 0.01

[world.nodes.explicit]
positions_m = [[1.0, 0.0], [0.0, 1.0]]

[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -90.0

[channel.path_loss.log_distance]
exponent = 2.0

[mac.csma_unslotted]

[traffic.once]
mpdu_octets = 20

[[sinks]]
name = "sink"
position_m = [0.0, 0.0]

[sweep]
runs = 1

[sweep.product]
radio.tx_power_dbm = [{powers}]
radio.sensitivity_dbm = [{sensitivities}]
"""


def timed(what, *command):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall_s, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{what:<28} {wall_s:8.2f} s {cpu_s:8.2f} s CPU")


def on_disk(folder):
    files = [path for path in folder.rglob("*") if path.is_file()]
    print(f"{'':<28} {len(files)} files, {sum(map(os.path.getsize, files)) / 1e6:.1f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cells", type=int, default=100_000)
    parser.add_argument("--chunk", type=int, default=1000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenario, plan = folder / "empty.toml", folder / "plan"
        powers = ",".join(f"{-0.001 * i:.3f}" for i in range(options.cells // 100))
        scenario.write_text(SCENARIO.format(powers=powers, sensitivities=",".join(f"{-90 - 0.1 * i:.1f}" for i in range(100))))
        cells = options.cells // 100 * 100
        timed(f"plan of {cells} cells", options.program, "sweep", scenario, "--plan", plan, "--quiet")
        on_disk(plan)
        timed(f"a part of {options.chunk} runs", options.program, "sweep", plan, "--cells", f"0..{options.chunk}", "--quiet")
        timed("a part that is done", options.program, "sweep", plan, "--cells", f"0..{options.chunk}", "--quiet")
        timed("status", options.program, "sweep", plan, "--status")
        for start in range(options.chunk, cells, options.chunk):
            part = f"{start}..{min(start + options.chunk, cells)}"
            subprocess.run([options.program, "sweep", plan, "--cells", part, "--quiet"], check=True, stdout=subprocess.DEVNULL)
        on_disk(plan / "parts")
        timed("status", options.program, "sweep", plan, "--status")
        timed("collect", options.program, "sweep", plan, "--collect", "--out", folder / "t.csv", "--quiet")
        timed("the same sweep, locally", options.program, "sweep", scenario, "--out", folder / "l.csv", "--quiet")
        print("the tables are equal" if (folder / "t.csv").read_bytes() == (folder / "l.csv").read_bytes() else "THEY DIFFER")


main()
