"""What Python costs: a call of a program, a survey with a controller in Python, a log of a million rows.

``python benches/python/costs.py`` prints medians of several runs. The package must be installed (``pip install ./python``), with
NumPy and pandas.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

import sextant

SCENARIOS = Path(__file__).resolve().parents[2] / "scenarios"
RUNS = 7


def median_s(work: Callable[[], object], runs: int = RUNS) -> float:
    """The median time of some work (s)."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


class Waits(sextant.Application):
    """Sets a timer again and again."""

    def __init__(self, calls: int) -> None:
        self.left = calls

    def started(self, port: sextant.Port) -> None:
        port.after(1e-6)

    def timer(self, timer: int, port: sextant.Port) -> None:
        self.left -= 1
        if self.left:
            port.after(1e-6)


class Creeps(sextant.Controller):
    """Drives a millimetre again and again."""

    def __init__(self, calls: int) -> None:
        self.left = calls

    def next(self, robot: sextant.Robot) -> sextant.Command:
        self.left -= 1
        return robot.drive_arc(0.001, 0.1) if self.left > 0 else robot.finish()


class Follows(sextant.Controller):
    """Drives from stop to stop of a list, and listens at each."""

    def __init__(self, stops: list[tuple[float, float]]) -> None:
        self.stops = iter(stops)

    def next(self, robot: sextant.Robot) -> sextant.Command:
        if robot.outcome in ("arrived", "blocked"):
            return robot.listen()
        stop = next(self.stops, None)
        return robot.finish() if stop is None else robot.drive_to(*stop)


def calls() -> None:
    """A call of a controller and of an application, with one command each; what the simulation does for it is part of it."""
    scenario = sextant.Scenario.template("survey", **{"maps": []})
    count = 100_000
    few = median_s(lambda: scenario.run(controller=Creeps(2)))
    many = median_s(lambda: scenario.run(controller=Creeps(count)))
    print(f"a call of a controller: {(many - few) / count * 1e6:.2f} us")
    scenario = sextant.Scenario(SCENARIOS / "mac" / "poisson-star.toml", **{"duration_s": 1.0})
    few = median_s(lambda: scenario.run(applications={"sink": Waits(2)}))
    many = median_s(lambda: scenario.run(applications={"sink": Waits(count)}))
    print(f"a call of an application: {(many - few) / count * 1e6:.2f} us")


def surveys() -> None:
    """A survey by the scenario's controller, and by one in Python that drives the same stops."""
    for name in ("ml-tm/circular.toml", "smoke.toml"):
        scenario = sextant.Scenario(SCENARIOS / name)
        run = scenario.run()
        stops = list(zip(run.stops["x_m"], run.stops["y_m"], strict=True))
        # Without maps, so that the survey alone is timed.
        alone = scenario.replace(maps=[])
        in_rust = median_s(alone.run)
        in_python = median_s(lambda: alone.run(controller=Follows(stops)))
        print(f"{name}: {in_rust:.3f} s in Rust, {in_python:.3f} s in Python: {in_python / in_rust:.2f} times")


def rows() -> None:
    """A log of a million receptions in data frames."""
    generator = np.random.default_rng(1)
    nodes, side, count = 1000, 32, 1_000_000
    stops = pd.DataFrame({"stop": range(side * side), "x_m": np.arange(side * side) % side, "y_m": np.arange(side * side) // side})
    pairs = generator.choice(nodes * side * side, count, replace=False)
    pairs.sort()
    receptions = pd.DataFrame(
        {
            "node": pd.Categorical.from_codes(pairs // (side * side), [f"node-{i}" for i in range(nodes)]),
            "stop": pairs % (side * side),
            "received": generator.integers(1, 5, count),
            "sent": 5,
            "rssi_dbm": generator.uniform(-90.0, -50.0, count),
        }
    )
    print(f"a log of {count} receptions: {median_s(lambda: sextant.Log(stops, receptions)):.3f} s")
    texts = receptions.assign(node=receptions["node"].astype(str))
    print(f"the same with texts for names: {median_s(lambda: sextant.Log(stops, texts)):.3f} s")
    columns = {name: receptions[name].to_numpy() for name in ("stop", "received", "sent", "rssi_dbm")}
    columns["node"] = receptions["node"].cat.codes.to_numpy().astype("int64")
    places = {name: stops[name].to_numpy() for name in stops.columns}
    print(f"the same in arrays of NumPy: {median_s(lambda: sextant.Log(places, columns)):.3f} s")


if __name__ == "__main__":
    calls()
    surveys()
    rows()
