"""Controllers and applications that are written in Python."""

from __future__ import annotations

import traceback
from pathlib import Path

import pytest
from conftest import SCENARIOS

import sextant

FLOOD = {
    "name": "flood",
    "seed": 1,
    "duration_s": 10.0,
    "world": {
        "nodes": {
            "lattice": {
                "spacing_m": 3.0,
                "jitter_m": 0.5,
                "count": 60,
                "region": {"rectangle": {"min_m": [0, 0], "max_m": [30, 18]}},
            }
        }
    },
    "radio": {"tx_power_dbm": -50, "sensitivity_dbm": -90},
    "channel": {
        "environment": "light-tree",
        "max_range_m": 6.0,
        "path_loss": {"log_distance": {"reference_loss_db": 0.0}},
    },
    "mac": {"csma_unslotted": {"rx_on_when_idle": True}},
    "traffic": {"silent": {}},
    "sinks": [{"name": "sink", "position_m": [0, 0, 0]}],
}


class Wander(sextant.Controller):
    """Drives to random places and listens there."""

    def __init__(self, stops: int) -> None:
        self.stops = stops
        self.heard: list[tuple[str, int]] = []
        self.outcomes: set[str] = set()

    def next(self, robot: sextant.Robot) -> sextant.Command:
        self.outcomes.add(robot.outcome)
        self.heard += [(heard.node, heard.packets) for heard in robot.heard]
        if robot.outcome in ("arrived", "blocked"):
            return robot.listen()
        if self.stops == 0:
            return robot.finish()
        self.stops -= 1
        return robot.drive_to(robot.random.uniform(0.0, 14.0), robot.random.uniform(0.0, 10.0))


class Flooder(sextant.Application):
    """Relays the first copy of a message after a random wait."""

    def __init__(self, is_origin: bool) -> None:
        self.is_origin = is_origin
        self.heard_s: float | None = None
        self.senders: list[str] = []
        self.reports: list[str] = []

    def started(self, port: sextant.Port) -> None:
        if self.is_origin:
            self.heard_s = port.now_s
            port.send(b"fire in room 7")

    def delivered(self, delivery: sextant.Delivery, port: sextant.Port) -> None:
        assert delivery.payload == b"fire in room 7"
        self.senders.append(delivery.sender)
        if self.heard_s is None:
            self.heard_s = port.now_s
            port.after(port.uniform(0))

    def timer(self, timer: int, port: sextant.Port) -> None:
        port.send(b"fire in room 7")

    def sent(self, report: sextant.SendReport, port: sextant.Port) -> None:
        self.reports.append(report.outcome)


def flood(seed: int = 1, threads: int | None = None) -> tuple[sextant.Run, dict[str, Flooder]]:
    """The flood, and its programs by node."""
    scenario = sextant.Scenario(FLOOD, seed=seed)
    programs = {name: Flooder(name == "n0") for name in scenario._native.node_names}
    return scenario.run(applications=programs, threads=threads), programs


def test_a_controller_drives_a_survey(survey: sextant.Scenario) -> None:
    wander = Wander(20)
    run = survey.run(controller=wander)
    assert len(run.stops) == 20
    assert wander.outcomes == {"started", "arrived", "listened", "blocked"}
    heard = sum(packets for _, packets in wander.heard)
    assert heard == sum(run.receptions.to_list("received")) > 0
    assert run.summary["gathering"]["stops"] == 20


def test_a_run_with_a_controller_can_be_repeated(survey: sextant.Scenario, tmp_path: Path) -> None:
    def bytes_of(name: str, seed: int, threads: int) -> bytes:
        path = tmp_path / name
        survey.run(seed=seed, controller=Wander(10), threads=threads, record=path)
        return path.read_bytes()

    assert bytes_of("a.mcap", 3, 1) == bytes_of("b.mcap", 3, 3)
    assert bytes_of("a.mcap", 3, 1) != bytes_of("c.mcap", 4, 1)


def test_a_flood_reaches_all_nodes_as_in_rust() -> None:
    run, programs = flood()
    heard = [program.heard_s for program in programs.values() if program.heard_s is not None]
    # The example `own_application` of the library prints the same.
    assert (len(heard), f"{max(heard):.2f}") == (60, "2.26")
    assert {outcome for program in programs.values() for outcome in program.reports} == {"sent"}
    assert run.summary["gathering"] if "gathering" in run.summary else True


def test_a_flood_is_the_same_at_any_number_of_threads() -> None:
    def told(threads: int) -> list[object]:
        _, programs = flood(threads=threads)
        return [(name, program.heard_s, program.senders) for name, program in programs.items()]

    assert told(1) == told(2)


def test_nodes_without_a_program_keep_their_traffic(survey: sextant.Scenario) -> None:
    class Silent(sextant.Application):
        pass

    run = survey.run(applications={"n0": Silent()})
    nodes = set(run.receptions.to_list("node"))
    assert "n0" not in nodes and len(nodes) > 20


@pytest.mark.parametrize("at", [0, 3])
def test_an_exception_of_a_controller_ends_the_run_and_keeps_the_recording(
    survey: sextant.Scenario, tmp_path: Path, at: int
) -> None:
    class Failing(Wander):
        def next(self, robot: sextant.Robot) -> sextant.Command:
            if self.stops == 10 - at:
                raise ValueError("no way")
            return super().next(robot)

    with pytest.raises(ValueError, match="no way") as caught:
        survey.run(controller=Failing(10), record=tmp_path / "run.mcap")
    frames = [frame.name for frame in traceback.extract_tb(caught.tb)]
    assert "next" in frames
    assert (tmp_path / "run.mcap").exists()
    assert not list(tmp_path.glob("*.part"))
    if at > 1:
        assert 0 < len(sextant.read(tmp_path / "run.mcap").stops) < 10


def test_an_exception_of_an_application_ends_the_run() -> None:
    class Failing(Flooder):
        def timer(self, timer: int, port: sextant.Port) -> None:
            raise KeyError("lost")

    scenario = sextant.Scenario(FLOOD)
    programs = {name: Failing(name == "n0") for name in scenario._native.node_names}
    with pytest.raises(KeyError, match="lost"):
        scenario.run(applications=programs)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (lambda robot: None, "NoneType"),
        (lambda robot: robot.drive_to(float("nan"), 0.0), "allowed: metres"),
        (lambda robot: robot.drive_arc(-1.0, 0.0), "allowed: a length"),
        (lambda robot: robot.finish("tired"), "complete"),
        (lambda robot: robot.sweep(), "listen"),
        (lambda robot: robot.clearance(0.0, -1.0), "allowed"),
    ],
)
def test_a_wrong_answer_says_what_is_allowed(survey: sextant.Scenario, answer: object, words: str) -> None:
    class Wrong(sextant.Controller):
        def next(self, robot: sextant.Robot) -> sextant.Command:
            return answer(robot)  # type: ignore[operator, no-any-return]

    with pytest.raises(Exception, match=words):
        survey.run(controller=Wrong())


def test_robots_and_ports_are_closed_outside_of_calls(survey: sextant.Scenario) -> None:
    class Keeps(Wander):
        robot: sextant.Robot

        def next(self, robot: sextant.Robot) -> sextant.Command:
            self.robot = robot
            return super().next(robot)

    keeps = Keeps(2)
    survey.run(controller=keeps)
    with pytest.raises(RuntimeError, match="only while"):
        _ = keeps.robot.pose


def test_unknown_stations_are_refused(survey: sextant.Scenario) -> None:
    with pytest.raises(KeyError, match="n0"):
        survey.run(applications={"nobody": sextant.Application()})
    with pytest.raises(sextant.RunError, match="surveyor"):
        survey.run(controllers={"nobody": Wander(1)})


def test_frames_to_one_station_are_acknowledged() -> None:
    class Asks(sextant.Application):
        outcomes: list[str] = []

        def started(self, port: sextant.Port) -> None:
            port.send(b"hello", to="sink")

        def sent(self, report: sextant.SendReport, port: sextant.Port) -> None:
            self.outcomes.append(report.outcome)
            assert report.to == "sink"

    class Listens(sextant.Application):
        got: list[bytes] = []

        def delivered(self, delivery: sextant.Delivery, port: sextant.Port) -> None:
            self.got.append(delivery.payload)

    sextant.Scenario(FLOOD).run(applications={"n0": Asks(), "sink": Listens()})
    assert Asks.outcomes == ["acknowledged"]
    assert Listens.got == [b"hello"]


def test_a_robot_with_an_application_of_its_own_writes_the_stops_that_are_mapped(survey: sextant.Scenario) -> None:
    class Walks(sextant.Application):
        has_task = True

        def __init__(self) -> None:
            self.places = [(x, y) for y in (1.0, 4.0, 7.0) for x in (1.0, 4.0, 7.0, 10.0, 13.0)]
            self.heard: dict[str, list[float]] = {}

        def go(self, port: sextant.Port) -> None:
            if not self.places:
                port.finish()
            elif port.drive_to(*self.places.pop(0)) is not None:
                self.stop(port)

        def stop(self, port: sextant.Port) -> None:
            self.heard.clear()
            self.since_s = port.now_s
            port.listen(2.5)

        def started(self, port: sextant.Port) -> None:
            with pytest.raises(ValueError, match="a finite angle"):
                port.steer(1e9, 1e300)
            self.go(port)

        def drive_ended(self, end: sextant.DriveEnd, port: sextant.Port) -> None:
            self.stop(port)

        def delivered(self, delivery: sextant.Delivery, port: sextant.Port) -> None:
            self.heard.setdefault(delivery.sender, []).append(delivery.rssi_dbm)

        def listened(self, network: int, port: sextant.Port) -> None:
            with pytest.raises(KeyError, match="nobody"):
                port.log_stop({"nobody": (1, 1, None)}, self.since_s)
            with pytest.raises(ValueError, match="allowed"):
                port.log_stop({"n0": (2, 1, None)}, self.since_s)
            heard = {node: (len(all), len(all), sum(all) / len(all)) for node, all in self.heard.items()}
            port.log_stop(heard, self.since_s)
            self.go(port)

    run = survey.run(applications={"surveyor": Walks()})
    assert len(run.stops) == 15
    assert len(run.maps["packet-centroid"].places) > 20


def test_sectors_are_swept_by_a_controller() -> None:
    class Sweeps(Wander):
        def next(self, robot: sextant.Robot) -> sextant.Command:
            if robot.outcome in ("arrived", "blocked"):
                return robot.sweep()
            return super().next(robot)

    run = sextant.Scenario.template("mmwave").run(controller=Sweeps(5))
    assert "sector" in run.receptions.column_names
    assert SCENARIOS.exists()
