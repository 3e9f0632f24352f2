"""Logs in data frames and files: the same maps as those of the command line."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sextant


def of_folder(folder: Path, name: str) -> dict[str, list[Any]]:
    """The columns of a CSV file: numbers where they are numbers."""
    with (folder / f"{name}.csv").open() as file:
        rows = list(csv.DictReader(file))

    def value(text: str) -> Any:
        for kind in (int, float):
            try:
                return kind(text)
            except ValueError:
                continue
        return text or None

    return {column: [value(row[column]) for row in rows] for column in rows[0]}


@pytest.fixture(scope="module")
def folder(command: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a robot, as `sextant init log` writes it."""
    folder = tmp_path_factory.mktemp("log") / "walk"
    command("init", "log", "--out", folder)
    return folder


def places_by_command(command: Callable[..., str], log: Path, *words: object) -> list[list[str]]:
    """The map of a log by the command line, as texts."""
    out = log.parent / "map.csv"
    command("map", log, "--out", out, "--quiet", "--force", *words)
    with out.open() as file:
        return list(csv.reader(file))


def texts(table: sextant.Table) -> list[list[str]]:
    """A map as the command line writes it."""

    def text(value: Any) -> str:
        if value is None:
            return ""
        if isinstance(value, bool):
            return str(int(value))
        if isinstance(value, float):
            plain = np.format_float_positional(value, trim="-")
            return str(plain)
        return str(value)

    columns = [table.to_list(name) for name in table.column_names]
    return [table.column_names, *([text(value) for value in row] for row in zip(*columns, strict=True))]


@pytest.mark.parametrize("algorithm", ["auto", "ml-tm", "self-calibrated", "rssi-centroid"])
def test_a_log_in_memory_gives_the_map_of_the_command_line_to_the_last_bit(
    folder: Path, command: Callable[..., str], algorithm: str
) -> None:
    expected = places_by_command(command, folder, "--algorithm", algorithm)
    stops, receptions = of_folder(folder, "stops"), of_folder(folder, "receptions")
    made = sextant.map_log(stops, receptions, algorithm=algorithm)
    table = sextant.table(made.places)
    assert texts(table) == expected
    assert texts(sextant.read(folder).map(algorithm).places) == expected


def test_a_log_of_ranges_needs_no_receptions_and_is_mapped_as_by_the_command_line(
    command: Callable[..., str], tmp_path: Path
) -> None:
    folder = tmp_path / "uwb"
    shutil.copytree(Path(__file__).parents[2] / "docs" / "examples" / "uwb", folder)
    path, ranges, nodes = (of_folder(folder, name) for name in ("odometry", "ranges", "nodes"))
    made = sextant.map_log(path, ranges=ranges, truth=nodes)
    assert texts(sextant.table(made.places)) == places_by_command(command, folder)
    assert made.summary["position_error_m"]["mean"] > 0.0
    with pytest.raises(TypeError, match="neither"):
        sextant.Log(path)
    with pytest.raises(sextant.LogError, match="range_m"):
        sextant.Log(path, ranges={"node": ["A"], "t_s": [1.0]})


def test_the_truth_gives_errors(folder: Path) -> None:
    stops, receptions = of_folder(folder, "stops"), of_folder(folder, "receptions")
    made = sextant.map_log(stops, receptions, algorithm="ml-tm", truth=of_folder(folder, "nodes"))
    assert made.summary["position_error_m"]["mean"] > 0.0
    assert "position_error_m" not in sextant.map_log(stops, receptions, algorithm="ml-tm").summary


def as_pandas(columns: dict[str, Any]) -> Any:
    return pytest.importorskip("pandas").DataFrame(columns)


def as_polars(columns: dict[str, Any]) -> Any:
    return pytest.importorskip("polars").DataFrame(columns)


def as_pyarrow(columns: dict[str, Any]) -> Any:
    return pytest.importorskip("pyarrow").table(columns)


def as_duckdb(columns: dict[str, Any]) -> Any:
    duckdb = pytest.importorskip("duckdb")
    rows = pytest.importorskip("pyarrow").table(columns)
    assert rows.num_rows
    return duckdb.sql("select * from rows")


def as_numpy(columns: dict[str, Any]) -> Any:
    return {name: np.array(values) for name, values in columns.items()}


def as_structured(columns: dict[str, Any]) -> Any:
    arrays = as_numpy(columns)
    rows = np.empty(len(next(iter(arrays.values()))), dtype=[(name, array.dtype) for name, array in arrays.items()])
    for name, array in arrays.items():
        rows[name] = array
    return rows


def as_table(columns: dict[str, Any]) -> Any:
    return sextant.table(columns)


FORMS = [as_pandas, as_polars, as_pyarrow, as_duckdb, as_numpy, as_structured, as_table]


@pytest.mark.parametrize("form", FORMS)
def test_each_kind_of_table_gives_the_same_map(folder: Path, form: Callable[[dict[str, Any]], Any]) -> None:
    stops, receptions = of_folder(folder, "stops"), of_folder(folder, "receptions")
    expected = sextant.map_log(stops, receptions, algorithm="ml-tm").places
    made = sextant.map_log(form(stops), form(receptions), algorithm="ml-tm")
    places = made.places
    kind = type(form(stops))
    if form in (as_pandas, as_polars, as_pyarrow, as_numpy, as_table):
        assert type(places) is kind
    for name in ("x_m", "y_m"):
        assert list(np.asarray(places[name], dtype=float)) == expected[name], name


def test_a_pandas_frame_needs_no_pyarrow(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    stops, receptions = as_pandas(of_folder(folder, "stops")), as_pandas(of_folder(folder, "receptions"))
    expected = sextant.map_log(stops, receptions, algorithm="ml-tm").places
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert sextant.map_log(stops, receptions, algorithm="ml-tm").places.equals(expected)


def test_a_run_can_be_mapped_from_its_tables(surveyed: sextant.Run) -> None:
    made = sextant.map_log(surveyed.stops, surveyed.receptions, algorithm="packet-centroid")
    # A run knows nothing more than its log of centroids.
    assert made.places.to_dict() == surveyed.maps["packet-centroid"].places.to_dict()


def test_categories_and_gaps_are_read(folder: Path) -> None:
    pandas = pytest.importorskip("pandas")
    stops, receptions = as_pandas(of_folder(folder, "stops")), as_pandas(of_folder(folder, "receptions"))
    expected = sextant.map_log(stops, receptions, algorithm="ml-tm").places
    receptions["node"] = pandas.Categorical(receptions["node"])
    receptions["received"] = receptions["received"].astype("float64")
    assert sextant.map_log(stops, receptions, algorithm="ml-tm").places.equals(expected)


def test_a_path_and_packets_are_a_log() -> None:
    path = {"t_s": [0.0, 10.0, 20.0], "x_m": [0.0, 10.0, 10.0], "y_m": [0.0, 0.0, 10.0]}
    times = [0.5 * i for i in range(40)]
    packets = {"t_s": times, "node": ["lamp"] * 40, "rssi_dbm": [-60.0 - abs(t - 8.0) for t in times]}
    log = sextant.Log(path, packets, stop_every="1m")
    assert log.nodes == ["lamp"]
    assert len(log.stops) > 5
    assert log.map().places["node"] == ["lamp"]


def test_a_recording_is_read(survey: sextant.Scenario, tmp_path: Path) -> None:
    run = survey.run(record=tmp_path / "run.mcap")
    log = sextant.read(tmp_path / "run.mcap")
    assert log.receptions.to_dict() == run.receptions.to_dict()
    for name, made in log.maps().items():
        assert made.places.to_dict() == run.maps[name].places.to_dict()


def test_errors_name_table_row_and_column() -> None:
    stops = {"stop": [1, 2], "x_m": [0.0, float("inf")], "y_m": [0.0, 1.0]}
    with pytest.raises(sextant.LogError) as caught:
        sextant.Log(stops, {"node": ["a"], "stop": [1]})
    error = caught.value
    assert (error.file, error.row, error.column) == ("stops", 1, "x_m")
    assert error.found == "inf" and error.allowed

    with pytest.raises(sextant.LogError) as caught:
        sextant.Log({"stop": [1], "x_m": [0.0], "y_m": [0.0]}, {"node": ["a"], "stop": [9], "received": [1]})
    assert (caught.value.file, caught.value.row, caught.value.column) == ("receptions", 0, "stop")


def test_an_error_of_a_whole_log_has_no_row(tmp_path: Path) -> None:
    (tmp_path / "broken.mcap").write_bytes(b"not a recording")
    with pytest.raises(sextant.LogError) as caught:
        sextant.read(tmp_path / "broken.mcap")
    error = caught.value
    assert (error.row, error.line, error.column) == (None, None, None)
    assert "broken.mcap" in str(error)


def test_errors_name_file_and_line(tmp_path: Path) -> None:
    (tmp_path / "stops.csv").write_text("stop,x_m,y_m\nA,0,zero\n")
    (tmp_path / "receptions.csv").write_text("node,stop,received\na,A,1\n")
    with pytest.raises(sextant.LogError) as caught:
        sextant.read(tmp_path)
    error = caught.value
    assert error.file == str(tmp_path / "stops.csv")
    assert (error.line, error.row, error.column, error.found) == (2, None, "y_m", "zero")


@pytest.mark.parametrize("wrong", [7, "stops.csv", [1, 2], object()])
def test_what_is_no_table_is_refused(wrong: object) -> None:
    with pytest.raises((TypeError, sextant.LogError)):
        sextant.Log(wrong, {"node": ["a"], "stop": [1]})


def test_an_unknown_option_names_those_that_are_known() -> None:
    with pytest.raises(TypeError, match="stop_every"):
        sextant.Log({"stop": [1], "x_m": [0.0], "y_m": [0.0]}, {"node": ["a"], "stop": [1]}, every="1m")


def test_the_next_stops_are_those_of_the_command_line(folder: Path, command: Callable[..., str], tmp_path: Path) -> None:
    printed = json.loads(command("next", folder, "--stops", "2", "--format", "json"))
    found = sextant.read(folder).next_stops(2)
    assert [stop["stop"] for stop in found["stops"]] == ["next1", "next2"]
    assert found == printed
    for wrong, message in ({"area": (1.0, 1.0, 0.0, 0.0)}, "area"), ({"floorplan": tmp_path / "none.toml"}, "none.toml"), ({"floorplan": tmp_path / "none.dxf", "floorplan_unit": "mile"}, "floorplan_unit"), ({"robot": "nobody"}, "nobody"):
        with pytest.raises((sextant.SextantError, ValueError), match=message):
            sextant.read(folder).next_stops(**wrong)
