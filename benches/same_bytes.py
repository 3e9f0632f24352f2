#!/usr/bin/env python3
"""Compares the outputs of two builds of Sextant byte for byte.

    benches/same_bytes.py OLD NEW [SCENARIO..]     recordings, captures, summaries, maps and sweep tables

OLD and NEW are programs. Without SCENARIO, every file in `scenarios/` is run; a folder stands for the files in it. For each
scenario these are compared:
  run     recording (.mcap), capture (.pcap) and summary without `timing`
  map     the maps of the recording and the summary without `timing`
  sweep   the table, if the scenario has [sweep]; one run of each cell, and of a large sweep only a part

A scenario that takes OLD longer than --limit is tried again in a shorter form (see FORMS), and named if that is too long
too. Outputs of OLD are kept in the folder --cache, and made again only if OLD or a file in `scenarios/` has changed.
The exit code is 0 if all bytes are equal, 1 if some differ, 2 if nothing could be compared. Python 3.11, no packages.
"""

import argparse
import concurrent.futures
import dataclasses
import hashlib
import json
import math
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENARIOS = ROOT / "scenarios"

# The settings of a scenario that are tried in turn until it is short enough: as written, then the survey without maps.
FORMS = [(), ("maps=[]",)]

# Cells of a sweep that are compared; of a larger one the first part with about as many.
CELLS = 4


class TooLong(Exception):
    """A program used more CPU time than allowed."""


@dataclasses.dataclass(frozen=True)
class Job:
    """One scenario or log, and the settings that shorten it."""

    path: str
    settings: tuple[str, ...] = ()

    @property
    def folder(self) -> str:
        """The name of the folder of its outputs."""
        short = hashlib.sha256("\n".join(self.settings).encode()).hexdigest()[:8] if self.settings else ""
        return self.path.replace("/", "__").removesuffix(".toml") + ("--" + short if short else "")


def run(program: pathlib.Path, arguments: list[str], limit_s: float) -> subprocess.CompletedProcess:
    """Runs the program in the root of the tree; a run above the limit of CPU time raises TooLong."""

    def limit():
        seconds = math.ceil(limit_s)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))

    try:
        done = subprocess.run(
            [str(program), *arguments], cwd=ROOT, preexec_fn=limit, capture_output=True, timeout=20 * limit_s, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise TooLong from error
    if done.returncode < 0:
        raise TooLong
    return done


def message(done: subprocess.CompletedProcess) -> str:
    """What the program printed as its error, on one line."""
    return " ".join(done.stderr.decode(errors="replace").split())


def outputs(program: pathlib.Path, job: Job, folder: pathlib.Path, limit_s: float) -> None:
    """Writes all outputs of one job to the folder, and what failed to `failures.json`."""
    failures = {}
    settings = [part for setting in job.settings for part in ("--set", setting)]
    common = [*settings, "--threads", "1", "--quiet", "--format", "json"]

    def attempt(name: str, arguments: list[str]) -> bool:
        done = run(program, arguments, limit_s)
        if done.returncode != 0:
            failures[name] = {"exit": done.returncode, "error": message(done)}
        return done.returncode == 0

    if (ROOT / job.path).is_dir():
        attempt("map", ["map", job.path, "--out", f"{folder}/map.csv", "--summary", f"{folder}/map.json", *common])
    else:
        recording = f"{folder}/run.mcap"
        arguments = ["run", job.path, "--out", recording, "--summary", f"{folder}/run.json", *common]
        recorded = attempt("capture", [*arguments, "--pcap", f"{folder}/run.pcap"]) or attempt("run", arguments)
        if recorded:
            attempt("map", ["map", recording, "--out", f"{folder}/map.csv", "--summary", f"{folder}/map.json", *common])
        if has_sweep(ROOT / job.path):
            sweep(program, job, folder, limit_s, failures, settings)
    (folder / "failures.json").write_text(json.dumps(failures, indent=1))
    for summary in folder.glob("*.json"):
        summary.write_text(without_timing(summary.read_text()))


def has_sweep(path: pathlib.Path) -> bool:
    """Whether the scenario, or one that it extends, has a sweep."""
    table = tomllib.loads(path.read_text())
    return "sweep" in table or ("extends" in table and has_sweep(path.parent / table["extends"]))


def sweep(program, job, folder, limit_s, failures, settings) -> None:
    """Writes the table of one run of each cell, or of the part of the cells that fits into the limit."""
    plain = ["sweep", job.path, "--runs", "1", "--threads", "1", "--quiet", *settings, "--out", f"{folder}/sweep.csv"]
    parts = max(1, number_of_cells(program, plain, limit_s) // CELLS)
    done = run(program, [*plain, "--shard", f"1/{parts}"], limit_s)
    if done.returncode != 0:
        failures["sweep"] = {"exit": done.returncode, "error": message(done)}


def number_of_cells(program: pathlib.Path, arguments: list[str], limit_s: float) -> int:
    """The cells of a sweep: the numbered lines of its plan."""
    done = run(program, [*arguments, "--dry-run"], limit_s)
    return sum(line.split(maxsplit=1)[0].isdigit() for line in done.stdout.decode().splitlines()[1:] if line.startswith("  "))


def without_timing(text: str) -> str:
    """A summary without `timing`, the only part that is no function of scenario and seed."""
    summary = json.loads(text)
    if isinstance(summary, dict):
        summary.pop("timing", None)
    return json.dumps(summary, indent=1)


ATTACHMENT, DATA_END = 0x09, 0x0F


def records(data: bytes) -> list[tuple[int, bytes]]:
    """The records of an MCAP file up to the end of its data section: code and content."""
    at, found = 8, []
    while at + 9 <= len(data):
        code, length = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        if code == DATA_END:
            break
        found.append((code, data[at + 9 : at + 9 + length]))
        at += 9 + length
    return found


def attachment(content: bytes) -> tuple[str, bytes]:
    """Name and data of an attachment."""
    (length,) = struct.unpack_from("<I", content, 16)
    name = content[20 : 20 + length].decode()
    at = 20 + length
    (media,) = struct.unpack_from("<I", content, at)
    at += 4 + media
    (size,) = struct.unpack_from("<Q", content, at)
    return name, content[at + 8 : at + 8 + size]


def only_new_attachments(old: bytes, new: bytes) -> list[str] | None:
    """The attachments that NEW has beyond those of OLD, if nothing else differs."""
    parts = [records(data) for data in (old, new)]
    rest = [[record for record in part if record[0] != ATTACHMENT] for part in parts]
    before, after = (dict(attachment(content) for code, content in part if code == ATTACHMENT) for part in parts)
    if rest[0] != rest[1] or any(after.get(name) != data for name, data in before.items()):
        return None
    return sorted(set(after) - set(before))


def differences(old: pathlib.Path, new: pathlib.Path, allow_attachments: bool) -> list[str]:
    """How the outputs in two folders differ."""
    names = sorted({path.name for folder in (old, new) for path in folder.iterdir()} - {"done.json", "failures.json"})
    found = []
    for name in names:
        if not (old / name).exists() or not (new / name).exists():
            found.append(f"{name}: only {'NEW' if (new / name).exists() else 'OLD'} writes it")
            continue
        before, after = (old / name).read_bytes(), (new / name).read_bytes()
        if before == after:
            continue
        added = only_new_attachments(before, after) if name.endswith(".mcap") else None
        if added:
            if not allow_attachments:
                found.append(f"{name}: NEW also attaches {', '.join(added)}; nothing else differs")
            continue
        at = next((i for i, (a, b) in enumerate(zip(before, after)) if a != b), min(len(before), len(after)))
        found.append(f"{name}: differs from byte {at} on ({len(before)} and {len(after)} bytes)")
    failures = [json.loads((folder / "failures.json").read_text()) for folder in (old, new)]
    for name in sorted(set(failures[0]) | set(failures[1])):
        exits = [failure.get(name, {"exit": 0})["exit"] for failure in failures]
        if exits[0] != exits[1]:
            reason = failures[1].get(name, failures[0].get(name))["error"]
            found.append(f"{name}: exit code {exits[0]} and {exits[1]}: {reason[:300]}")
    return found


def fingerprint(program: pathlib.Path) -> str:
    """A digest of the program and of all files in `scenarios/`."""
    digest = hashlib.sha256(program.read_bytes())
    for path in sorted(path for path in SCENARIOS.rglob("*") if path.is_file()):
        digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def kept(program: pathlib.Path, job: Job, cache: pathlib.Path, limit_s: float) -> pathlib.Path:
    """The folder with the outputs of OLD, made now if it is not there."""
    folder = cache / job.folder
    state = folder / "done.json"
    if state.exists():
        if json.loads(state.read_text()).get("too_long_s", math.inf) <= limit_s:
            shutil.rmtree(folder)
        elif "too_long_s" in json.loads(state.read_text()):
            raise TooLong
        else:
            return folder
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        outputs(program, job, folder, limit_s)
    except TooLong:
        state.write_text(json.dumps({"too_long_s": limit_s + 0.001}))
        raise
    state.write_text(json.dumps({"path": job.path, "settings": job.settings}))
    return folder


def compare(job: Job, old: pathlib.Path, new: pathlib.Path | None, options) -> tuple[str, list[str] | None]:
    """How the outputs of a job differ: its name, and None if it takes too long."""
    for settings in FORMS:
        shorter = dataclasses.replace(job, settings=settings)
        name = job.path + "".join(f" --set {setting}" for setting in settings)
        try:
            before = kept(old, shorter, options.cache, options.limit)
            if new is None:
                return name, []
            with tempfile.TemporaryDirectory() as folder:
                outputs(new, shorter, pathlib.Path(folder), 2 * options.limit)
                return name, differences(before, pathlib.Path(folder), options.allow_attachments)
        except TooLong:
            continue
    return job.path, None


def jobs(names: list[str]) -> list[Job]:
    """The scenarios and logs that the names stand for."""
    found = []
    for name in names or [str(SCENARIOS)]:
        path = pathlib.Path(name).resolve()
        is_log = (path / "stops.csv").exists() or (path / "path.csv").exists()
        files = sorted(path.rglob("*.toml")) if path.is_dir() and not is_log else [path]
        found += [Job(os.path.relpath(file, ROOT)) for file in files]
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path, metavar="OLD")
    parser.add_argument("new", type=pathlib.Path, metavar="NEW", help="`-` only fills the cache")
    parser.add_argument("scenario", nargs="*", metavar="SCENARIO", help="scenarios, folders of them, or folders of logs")
    parser.add_argument("--limit", type=float, default=240.0, metavar="S", help="CPU seconds of one command [240]")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="scenarios at a time [1]")
    parser.add_argument("--cache", type=pathlib.Path, default=ROOT / "target" / "same-bytes", metavar="FOLDER")
    parser.add_argument("--allow-attachments", action="store_true", help="NEW may attach more files to recordings")
    options = parser.parse_intermixed_args()
    old = options.old.resolve()
    new = None if str(options.new) == "-" else options.new.resolve()
    options.cache = options.cache.resolve() / fingerprint(old)
    counts = {"equal": 0, "different": 0, "too long": 0}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name, found in pool.map(lambda job: compare(job, old, new, options), jobs(options.scenario)):
            state = "too long" if found is None else "different" if found else "equal"
            counts[state] += 1
            print(f"{state:<10} {name}", *[f"\n           {line}" for line in found or []], sep="", flush=True)
    print(", ".join(f"{number} {state}" for state, number in counts.items()))
    return 1 if counts["different"] else 0 if counts["equal"] else 2


if __name__ == "__main__":
    sys.exit(main())
