"""Tracks of tags: the same as those of the command line."""

from __future__ import annotations

import csv
import math
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest
from test_logs import of_folder, texts

import sextant


@pytest.fixture(scope="module")
def folder(command: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The ranges of a tag, as `sextant init track` writes them."""
    folder = tmp_path_factory.mktemp("log") / "hall"
    command("init", "track", "--out", folder)
    return folder


def track_by_command(command: Callable[..., str], log: Path, *words: object) -> list[list[str]]:
    """The track of a log by the command line, as texts."""
    out = log.parent / "track.csv"
    command("map", log, "--track", "--out", out, "--quiet", "--force", *words)
    with out.open() as file:
        return list(csv.reader(file))


def test_a_track_of_tables_and_of_files_is_that_of_the_command_line_to_the_last_bit(
    folder: Path, command: Callable[..., str]
) -> None:
    known = folder / "receivers.csv"
    expected = track_by_command(command, folder, "--known", known)
    ranges, receivers = of_folder(folder, "ranges"), of_folder(folder, "receivers")
    truth = of_folder(folder, "true-path")
    made = sextant.map_log(ranges=ranges, track=True, known=receivers, truth=truth)
    assert texts(sextant.table(made.track)) == expected
    assert made.summary[0]["position_rmse_m"] < 0.3
    assert isinstance(made.track, dict) and min(made.track["cov_xx_m2"]) > 0
    of_file = sextant.track(folder, known, truth=folder / "true-path.csv")
    assert texts(of_file.track) == expected
    assert of_file.summary == made.summary
    kept = pickle.loads(pickle.dumps(made))
    assert kept.track == made.track and kept.summary == made.summary and repr(kept) == repr(made)


def test_strengths_a_height_and_a_side_are_those_of_the_flags(
    command: Callable[..., str], tmp_path: Path
) -> None:
    row = {"node": ["a", "b", "c", "d"], "x_m": [0.0, 4.0, 8.0, 12.0], "y_m": [0.0, 0.0, 0.0, 0.0], "z_m": [2.0] * 4}
    packets: dict[str, list[object]] = {"t_s": [], "receiver": [], "node": [], "rssi_dbm": []}
    for step in range(60):
        x, y = 1.0 + 0.15 * step, 3.0
        for name, at in zip(row["node"], row["x_m"], strict=True):
            distance = ((x - float(at)) ** 2 + y**2 + 1.0) ** 0.5  # type: ignore[arg-type]
            values = (0.5 * step, name, "badge", round(-40.0 - 25.0 * math.log10(distance), 2))
            for column, value in zip(packets.values(), values, strict=True):
                column.append(value)
    log = tmp_path / "row"
    log.mkdir()
    for name, table in (("known", row), ("packets", packets)):
        with (log / f"{name}.csv").open("w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(table)
            rows.writerows(zip(*table.values(), strict=True))
    words = ("--known", log / "known.csv", "--antenna-height", "1", "--side", "0,5", "--reciprocal")
    expected = track_by_command(command, log, *words)
    how = {"antenna_height": 1.0, "side": (0.0, 5.0), "reciprocal": True}
    made = sextant.track(None, row, packets=packets, **how)
    assert texts(sextant.table(made.track)) == expected
    assert set(made.track["tag"]) == {"badge"} and min(made.track["y_m"]) > 0
    assert made.summary[0]["strengths"] == 240


def test_the_log_of_a_robot_among_known_nodes_is_tracked(survey: sextant.Scenario) -> None:
    run = survey.run()
    nodes = run.maps["ml-tm"].truth
    made = sextant.map_log(run.stops, run.receptions, track=True, known=nodes)
    stops = run.stops.to_dict()
    errors = [
        ((x - stops["x_m"][stop]) ** 2 + (y - stops["y_m"][stop]) ** 2) ** 0.5
        for x, y, t in zip(*(made.track[name] for name in ("x_m", "y_m", "t_s")), strict=True)
        for stop in [min(range(len(stops["t_s"])), key=lambda at: abs(stops["t_s"][at] - t))]
    ]
    assert sum(errors) / len(errors) < 3.0


def test_what_is_wrong_is_named(folder: Path) -> None:
    ranges, receivers = of_folder(folder, "ranges"), of_folder(folder, "receivers")
    with pytest.raises(TypeError, match="known"):
        sextant.track(ranges)
    with pytest.raises(TypeError, match="needs ranges"):
        sextant.track(None, receivers)
    with pytest.raises(TypeError, match="algorithm"):
        sextant.map_log(ranges=ranges, track=True, known=receivers, algorithm="ml-tm")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="antenna_height"):
        sextant.track(ranges, receivers, antenna_height=float("nan"))
    with pytest.raises(sextant.RunError, match="straight line"):
        sextant.track(ranges, receivers, side=(1.0, 1.0))
    with pytest.raises(sextant.LogError) as caught:
        sextant.track({**ranges, "range_m": ["far", *ranges["range_m"][1:]]}, receivers)
    assert (caught.value.file, caught.value.row, caught.value.column) == ("ranges", 0, "range_m")
