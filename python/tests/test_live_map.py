"""The live map, fed by a simulated run."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest

import sextant

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples"))

from live_map import LiveMap, Place


@pytest.fixture(scope="module")
def run() -> sextant.Run:
    return sextant.Scenario.template("survey", seed=1).run()


@pytest.fixture(scope="module")
def live(run: sextant.Run) -> LiveMap:
    """A live map that was told all that the robot of the run heard, at the time of the stop where it heard it."""
    live, times = LiveMap(), {}
    stops = run.stops.to_dict()
    for stop, t_s, x_m, y_m in zip(stops["stop"], stops["t_s"], stops["x_m"], stops["y_m"], strict=True):
        live.add_pose(t_s, x_m, y_m)
        times[stop] = t_s
    heard = run.receptions.to_dict()
    for node, stop, received, rssi_dbm in zip(
        heard["node"], heard["stop"], heard["received"], heard["rssi_dbm"], strict=True
    ):
        for _ in range(received):
            live.add_packet(times[stop], node, -70.0 if rssi_dbm is None else rssi_dbm)
    return live


def test_the_nodes_are_near_their_true_places(run: sextant.Run, live: LiveMap) -> None:
    truth = run.nodes.to_dict()
    at = {node: (x, y) for node, x, y in zip(truth["node"], truth["x_m"], truth["y_m"], strict=True)}
    errors = [math.hypot(one.x_m - at[one.node][0], one.y_m - at[one.node][1]) for one in live.map()]
    assert len(errors) == len(at)
    assert sum(errors) / len(errors) < 1.0


def test_there_is_no_map_before_a_packet_between_two_poses() -> None:
    live = LiveMap()
    assert live.map() == []
    assert live.missing() == "poses: 0; at least 2 are needed"
    live.add_pose(0.0, 0.0, 0.0)
    live.add_pose(1.0, 1.0, 0.0)
    live.add_packet(2.0, "late", -60.0)
    assert live.map() == []
    assert "0 of 1" in (live.missing() or "")
    live.add_packet(0.5, "heard", -60.0)
    assert live.missing() is None
    assert [place.node for place in live.map()] == ["heard"]


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_and_not_kept(number: float) -> None:
    live = LiveMap()
    live.add_pose(0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="`t_s` is .*finite"):
        live.add_pose(number, 0.0, 0.0)
    with pytest.raises(ValueError, match="`rssi_dbm` is .*finite"):
        live.add_packet(0.5, "bad", number)
    assert live.add_pose(1.0, 1.0, 0.0)
    live.add_packet(0.5, "good", -60.0)
    assert [place.node for place in live.map()] == ["good"]


def test_the_same_input_gives_the_same_map(live: LiveMap) -> None:
    assert live.map() == live.map()


def test_a_pose_that_is_not_later_is_left_out() -> None:
    live = LiveMap()
    assert live.add_pose(1.0, 0.0, 0.0)
    assert not live.add_pose(1.0, 5.0, 0.0)
    assert not live.was_visited(5.0, 0.0)


def test_the_next_stop_is_on_the_long_axis_of_the_least_certain_node() -> None:
    live = LiveMap(visited_m=1.0)
    live.add_pose(0.0, 0.0, 0.0)
    sure = Place("sure", 3.0, 3.0, 0.0, 0.01, 0.0, 0.01)
    unsure = Place("unsure", 10.0, 5.0, 0.0, 1.0, 0.0, 4.0)
    stop = live.next_stop([sure, unsure])
    assert stop == pytest.approx((10.0, 5.0 - 2.0 * math.sqrt(5.991464547107979)))
    live.add_pose(1.0, *stop)
    assert live.next_stop([sure, unsure]) == pytest.approx((10.0, 5.0 + 2.0 * math.sqrt(5.991464547107979)))


def test_nothing_is_proposed_without_covariances() -> None:
    live = LiveMap()
    live.add_pose(0.0, 0.0, 0.0)
    assert live.next_stop([Place("n", 1.0, 1.0, 0.0, math.nan, math.nan, math.nan)]) is None
