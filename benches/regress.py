#!/usr/bin/env python3
"""CPU time of two builds of the program, pair by pair.

    benches/regress.py OLD NEW [JOB..] [--pairs 12]

OLD and NEW are programs, and run each job in turn, each of them first in every other pair. What the machine does meanwhile so slows both.
Printed are the medians of the CPU seconds, the median of the ratios NEW / OLD, and its interval of at least 95 %, from the order of
the ratios (no distribution is assumed; it needs six pairs). The exit code is 1 if a job surely takes more than --allow longer, otherwise 0.
Without JOB, all jobs are run. Python 3.11, no packages.
"""

import argparse
import math
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
JOBS = {
    "circular": ["run", "scenarios/ml-tm/circular.toml"],
    "survey": ["run", "scenarios/ml-tm/circular.toml", "--set", "maps=[]"],
    "saturated-star": ["run", "scenarios/mac/saturated-star.toml"],
    "saturated-cell": ["run", "scenarios/tsch/saturated-cell.toml", "--set", "duration_s=1000.0"],
    "small-log": ["map", "docs/examples/walk"],
    "ranges": ["map", "docs/examples/uwb"],
}


def cpu_s(program: pathlib.Path, arguments: list[str]) -> float:
    """The CPU time of a command on one thread, without what it prints [s]."""
    with tempfile.TemporaryDirectory() as folder:
        output = ["--out", f"{folder}/run.mcap"] if arguments[0] == "run" else []
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [str(program), *arguments, *output, "--threads", "1", "--quiet", "--format", "json"]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def interval(values: list[float]) -> tuple[float, float]:
    """The narrowest interval between two values, as far from both ends, that holds the median with 95 %; infinite if there is none."""
    values, count = sorted(values), len(values)
    outside, beyond = 0.0, 0
    while (outside := outside + math.comb(count, beyond) / 2 ** (count - 1)) <= 0.05:
        beyond += 1
    return (values[beyond - 1], values[-beyond]) if beyond else (-math.inf, math.inf)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path, metavar="OLD")
    parser.add_argument("new", type=pathlib.Path, metavar="NEW")
    parser.add_argument("jobs", nargs="*", metavar="JOB", help=f"of {', '.join(JOBS)} [all]")
    parser.add_argument("--pairs", type=int, default=12, metavar="N", help="pairs of a job, after one that is not counted [12]")
    parser.add_argument("--allow", type=float, default=0.02, metavar="SHARE", help="what a job may take longer [0.02]")
    options = parser.parse_intermixed_args()
    if unknown := set(options.jobs) - set(JOBS):
        parser.error(f"no job {', '.join(sorted(unknown))}; jobs are {', '.join(JOBS)}")
    if options.pairs < 1:
        parser.error(f"--pairs is {options.pairs}, and must be 1 or more")
    programs = options.old.resolve(), options.new.resolve()
    print(f"{'job':<16}{'OLD':>8}{'NEW':>10}{'ratio':>8}  95 % interval")
    is_slower = False
    for name in options.jobs or JOBS:
        pairs = []
        for pair in range(options.pairs + 1):
            first = cpu_s(programs[pair % 2], JOBS[name])
            second = cpu_s(programs[1 - pair % 2], JOBS[name])
            pairs.append((first, second) if pair % 2 == 0 else (second, first))
        before, after = zip(*pairs[1:])
        ratios = [new_s / old_s for old_s, new_s in pairs[1:]]
        low, high = interval(ratios)
        is_slower |= low > 1 + options.allow
        medians = f"{statistics.median(before):6.3f} s{statistics.median(after):8.3f} s{statistics.median(ratios):8.3f}"
        print(f"{name:<16}{medians}  {low:.3f} to {high:.3f}", flush=True)
    return int(is_slower)


if __name__ == "__main__":
    sys.exit(main())
