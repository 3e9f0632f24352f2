"""Scenarios and runs: the same as those of the command line."""

from __future__ import annotations

import csv
import json
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import SCENARIOS

import sextant


def test_a_run_has_the_summary_of_the_command_line_to_the_last_bit(
    command: Callable[..., str], tmp_path: Path
) -> None:
    summary = tmp_path / "summary.json"
    recording = tmp_path / "by-command.mcap"
    command("run", SCENARIOS / "smoke.toml", "--seed", 7, "--out", recording, "--summary", summary, "--quiet")
    record = tmp_path / "by-python.mcap"
    run = sextant.Scenario(SCENARIOS / "smoke.toml").run(seed=7, record=record)
    expected, found = json.loads(summary.read_text()), dict(run.summary)
    expected.pop("timing"), found.pop("timing")
    assert found == expected
    assert record.read_bytes() == recording.read_bytes()


def test_results_do_not_depend_on_the_number_of_threads(survey: sextant.Scenario) -> None:
    def results(threads: int) -> object:
        run = survey.run(threads=threads)
        return [(name, made.places.to_dict()) for name, made in run.maps.items()]

    assert results(1) == results(3)


def test_settings_override_those_of_the_file() -> None:
    scenario = sextant.Scenario(SCENARIOS / "smoke.toml", seed=5, **{"robots.0.listen_s": 2.5})
    assert scenario.seed == 5
    assert "listen_s = 2.5" in scenario.text
    assert scenario.replace(seed=6).seed == 6


def test_a_scenario_may_be_a_dict() -> None:
    layout = {
        "name": "of a dict",
        "seed": 2,
        "duration_s": 20.0,
        "world": {"nodes": {"lattice": {"spacing_m": 3.0, "count": 9, "region": {"rectangle": {"min_m": [0, 0], "max_m": [9, 9]}}}}},
        "radio": {"tx_power_dbm": -50, "sensitivity_dbm": -90},
        "channel": {"environment": "light-tree", "max_range_m": 6.0, "path_loss": {"log_distance": {"reference_loss_db": 0.0}}},
        "mac": {"csma_unslotted": {}},
        "traffic": {"periodic": {"interval_s": 1.0}},
        "sinks": [{"name": "sink", "position_m": [0, 0, 0]}],
    }
    run = sextant.Scenario(layout).run()
    assert run.summary["scenario"]["name"] == "of a dict"
    assert len(run.nodes) == 9


def test_tables_hold_what_was_heard(surveyed: sextant.Run) -> None:
    heard = surveyed.receptions
    assert sum(heard.to_list("received")) <= surveyed.summary["gathering"]["packets_received"]
    assert len(surveyed.stops) == surveyed.summary["gathering"]["stops"]
    assert set(heard.to_list("node")) <= set(surveyed.nodes.to_list("node"))
    assert set(heard.to_list("stop")) <= set(surveyed.stops.to_list("stop"))


def test_maps_have_places_with_covariances(surveyed: sextant.Run) -> None:
    made = surveyed.maps["ml-tm"]
    assert made.places["cov_xx_m2"].min() > 0.0
    summary = next(one for one in surveyed.summary["maps"] if one["algorithm"] == "ml-tm")
    assert made.summary == summary
    truth = made.truth
    assert truth is not None
    at = dict(zip(truth.to_list("node"), zip(truth["x_m"], truth["y_m"], strict=True), strict=True))
    places = zip(made.places["node"], made.places["x_m"], made.places["y_m"], strict=True)
    errors = [((x - at[node][0]) ** 2 + (y - at[node][1]) ** 2) ** 0.5 for node, x, y in places]
    assert sum(errors) / len(errors) == pytest.approx(summary["position_error_m"]["mean"], rel=1e-12)


def test_the_tables_of_a_recording_are_those_of_the_export(
    survey: sextant.Scenario, command: Callable[..., str], tmp_path: Path
) -> None:
    record = tmp_path / "run.mcap"
    run = survey.replace(**{"recording.packets": True}).run(record=record)
    command("export", record, "--out", tmp_path / "tables")
    written = {str(path.relative_to(tmp_path / "tables"))[:-4]: path for path in (tmp_path / "tables").rglob("*.csv")}
    tables = run.tables
    assert set(tables) <= set(written)
    for name in ("mac_packets", "stops", "receptions"):
        with written[name].open() as file:
            rows = list(csv.reader(file))
        table = tables[name]
        assert rows[0] == table.column_names, name
        assert len(rows) - 1 == len(table), name
    assert len(run.packets) > 0


def test_packets_need_a_recording(surveyed: sextant.Run) -> None:
    with pytest.raises(ValueError, match="record="):
        _ = surveyed.packets


def test_a_sweep_gives_the_table_of_the_command_line(command: Callable[..., str], tmp_path: Path) -> None:
    out = tmp_path / "by-command.csv"
    words = ["--set", 'sweep.product."robots.0.listen_s"=[2.4, 4.8]', "--runs", 2]
    command("sweep", SCENARIOS / "smoke.toml", *words, "--out", out, "--quiet")
    axes = {"robots.0.listen_s": [2.4, 4.8]}
    table = sextant.sweep(SCENARIOS / "smoke.toml", axes, runs=2, out=tmp_path / "by-python.csv")
    assert (tmp_path / "by-python.csv").read_bytes() == out.read_bytes()
    again = sextant.sweep(SCENARIOS / "smoke.toml", axes, runs=2, threads=1)
    assert again.to_dict() == table.to_dict()
    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert table.column_names == list(rows[0])
    assert [float(row["robots.0.listen_s"]) for row in rows] == table.to_list("robots.0.listen_s")


def test_runs_and_maps_show_themselves(surveyed: sextant.Run) -> None:
    made = surveyed.maps["ml-tm"]
    assert repr(surveyed) == "sextant.Run('survey': 36 of 36 nodes heard, 2 maps)"
    svg = made._repr_svg_()
    assert svg is not None and svg.lstrip().startswith("<svg") and svg.rstrip().endswith("</svg>")
    assert "<svg" in made._repr_html_() and "<svg" in surveyed._repr_html_()
    assert "<table>" in surveyed.stops._repr_html_()
    assert {"network", "map-ml-tm", "error-cdf"} <= set(made.figures)
    assert made.figures["map-ml-tm"]._repr_svg_() == svg


def test_a_map_is_drawn_with_matplotlib(surveyed: sextant.Run, tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    ax = surveyed.maps["ml-tm"].plot(labels=True)
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert names == ["stops", "true places", "ml-tm"]
    assert len(ax.patches) == 36
    ax.figure.savefig(tmp_path / "map.png")


def test_scenarios_and_tables_can_be_pickled(survey: sextant.Scenario, surveyed: sextant.Run) -> None:
    again = pickle.loads(pickle.dumps(survey))
    assert (again.text, again.seed) == (survey.text, survey.seed)
    table = pickle.loads(pickle.dumps(surveyed.stops))
    assert table.to_dict() == surveyed.stops.to_dict()


def test_runs_maps_and_logs_can_be_pickled(surveyed: sextant.Run, tmp_path: Path) -> None:
    again = pickle.loads(pickle.dumps(surveyed))
    assert again.summary == surveyed.summary and repr(again) == repr(surveyed)
    assert again.stops.to_dict() == surveyed.stops.to_dict()
    assert again.scenario.text == surveyed.scenario.text
    made = again.maps["ml-tm"]
    assert made.places.to_dict() == surveyed.maps["ml-tm"].places.to_dict()
    assert made.summary == surveyed.maps["ml-tm"].summary
    twice = pickle.loads(pickle.dumps(again))
    assert twice.summary == surveyed.summary

    stops = {"stop": [0, 1, 2], "x_m": [0.0, 4.0, 0.0], "y_m": [0.0, 0.0, 4.0]}
    heard = {"stop": [0, 1, 2], "node": ["a", "a", "a"], "received": [5, 3, 4], "sent": [5, 5, 5]}
    log = sextant.Log(stops, heard)
    assert pickle.loads(pickle.dumps(log)).receptions.to_dict() == log.receptions.to_dict()
    (tmp_path / "stops.csv").write_text("stop,x_m,y_m\n0,0,0\n1,4,0\n2,0,4\n")
    (tmp_path / "receptions.csv").write_text("stop,node,received,sent\n0,a,5,5\n1,a,3,5\n2,a,4,5\n")
    read = sextant.read(tmp_path)
    assert read.receptions.to_dict() == log.receptions.to_dict()
    assert pickle.loads(pickle.dumps(read)).receptions.to_dict() == read.receptions.to_dict()


def test_a_recorded_run_is_pickled_with_the_path_of_its_recording(survey: sextant.Scenario, tmp_path: Path) -> None:
    run = survey.replace(**{"recording.packets": True}).run(record=tmp_path / "run.mcap")
    again = pickle.loads(pickle.dumps(run))
    assert again.record == run.record
    assert again.packets.to_dict() == run.packets.to_dict()


def test_a_sweep_takes_a_scenario_with_its_settings() -> None:
    axes = {"channel.max_range_m": [8.0, 10.0]}
    settings = {"robots.0.listen_s": 2.4}
    by_scenario = sextant.sweep(sextant.Scenario(SCENARIOS / "smoke.toml", seed=5, **settings), axes, runs=2)
    by_file = sextant.sweep(SCENARIOS / "smoke.toml", axes, runs=2, seed=5, **settings)
    assert by_scenario.to_dict() == by_file.to_dict()


def test_a_link_is_explained_and_a_network_has_a_graph(command: Callable[..., str]) -> None:
    scenario = sextant.Scenario.template("mac")
    graph = scenario.graph()
    assert graph.column_names == ["from", "to", "distance_m", "received_dbm", "probability"]
    edges = list(zip(graph.to_list("from"), graph.to_list("to"), strict=True))
    assert len(edges) == len(set(edges)) > 0 and all(a != b for a, b in edges)
    link = scenario.link(*edges[0])
    assert link["distance_m"] == pytest.approx(graph["distance_m"][0])
    with pytest.raises(ValueError, match="nobody"):
        scenario.link("nobody", edges[0][0])
    with pytest.raises(ValueError, match="0 to 1"):
        scenario.graph(least=2.0)


def test_tables_become_data_frames(surveyed: sextant.Run) -> None:
    frame = pytest.importorskip("pandas")
    stops = surveyed.stops.to_pandas()
    assert isinstance(stops, frame.DataFrame)
    assert list(stops.columns) == surveyed.stops.column_names
    assert stops["x_m"].tolist() == surveyed.stops.to_list("x_m")
