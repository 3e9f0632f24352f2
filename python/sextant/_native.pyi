"""The part of the package that is written in Rust."""

import os
import random
from collections.abc import Mapping
from typing import Any, final

import numpy as np
import numpy.typing as npt

__version__: str

class SextantError(Exception):
    """An error of Sextant: the base of all others."""

class ScenarioError(SextantError):
    """A scenario is not valid. The attributes are those of the first error, where they are known; `errors` has all."""

    key: str | None
    found: str | None
    allowed: str | None
    file: str | None
    line: int | None
    column: int | None
    errors: list[ScenarioError]

class LogError(SextantError):
    """A log is not valid: `row` counts from 0 in a table, `line` from 1 in a file."""

    file: str | None
    line: int | None
    row: int | None
    column: str | None
    found: str | None
    allowed: str | None

class RunError(SextantError):
    """A run, a map or a sweep failed."""

@final
class Table:
    """Columns by name, with the Arrow PyCapsule interface."""

    @property
    def column_names(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __contains__(self, name: str) -> bool: ...
    def __getitem__(self, name: str) -> npt.NDArray[np.generic]: ...
    def to_list(self, name: str) -> list[Any]: ...
    def to_dict(self) -> dict[str, list[Any]]: ...
    def to_pandas(self) -> Any: ...
    def to_polars(self) -> Any: ...
    def to_arrow(self) -> Any: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...
    def _repr_html_(self) -> str: ...

@final
class Scenario:
    @staticmethod
    def load(path: str, settings: dict[str, Any]) -> Scenario: ...
    @staticmethod
    def of_mapping(mapping: Mapping[str, Any], settings: dict[str, Any]) -> Scenario: ...
    @staticmethod
    def parse(text: str, settings: dict[str, Any]) -> Scenario: ...
    @staticmethod
    def template(name: str, settings: dict[str, Any]) -> Scenario: ...
    def with_settings(self, settings: dict[str, Any]) -> Scenario: ...
    @property
    def name(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def text(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def nodes(self) -> int: ...
    @property
    def node_names(self) -> list[str]: ...
    @property
    def robots(self) -> list[str]: ...
    @property
    def surveyors(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def link(self, a: str, b: str, network: str | None = None) -> dict[str, Any]: ...
    def graph(self, network: str | None = None, least: float = 0.01) -> Table: ...
    def run(
        self,
        record: str | None = None,
        progress: object | None = None,
        controllers: dict[str, Any] | None = None,
        applications: dict[str, Any] | None = None,
        threads: int | None = None,
        force: bool = False,
    ) -> Run: ...

@final
class Run:
    @property
    def scenario(self) -> Scenario: ...
    @property
    def record(self) -> os.PathLike[str] | str | None: ...
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def stops(self) -> Table: ...
    @property
    def receptions(self) -> Table: ...
    @property
    def nodes(self) -> Table: ...
    @property
    def maps(self) -> list[tuple[str, Map]]: ...
    @property
    def interrupted(self) -> bool: ...
    @property
    def heard_text(self) -> str: ...
    def tables(self) -> list[tuple[str, Table]]: ...

@final
class Log:
    @property
    def stops(self) -> Table: ...
    @property
    def receptions(self) -> Table: ...
    @property
    def nodes(self) -> list[str]: ...
    @property
    def networks(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def findings(self) -> list[str]: ...
    def tables(self) -> list[tuple[str, Table]]: ...
    def map(
        self,
        mapping: dict[str, Any],
        set: dict[str, Any],
        truth: object | None,
        progress: object | None,
    ) -> list[Map]: ...

@final
class Map:
    @property
    def name(self) -> str: ...
    @property
    def algorithm(self) -> str: ...
    @property
    def places(self) -> Table: ...
    @property
    def truth(self) -> Table | None: ...
    @property
    def stops(self) -> Table: ...
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def notes(self) -> list[str]: ...
    def figures(self) -> list[tuple[str, str]]: ...

@final
class Tracks:
    @property
    def track(self) -> Table: ...
    @property
    def summary(self) -> list[dict[str, Any]]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Pose:
    """Where a station is (m) and where it looks (rad, counterclockwise from the x axis)."""

    @property
    def x_m(self) -> float: ...
    @property
    def y_m(self) -> float: ...
    @property
    def z_m(self) -> float: ...
    @property
    def heading_rad(self) -> float: ...

@final
class Heard:
    """What was heard of a node at the last stop."""

    @property
    def node(self) -> str: ...
    @property
    def packets(self) -> int: ...
    @property
    def sent(self) -> int: ...
    @property
    def rssi_dbm(self) -> float: ...

@final
class Command:
    """What a robot is to do next."""

@final
class Robot:
    """A robot as its controller sees it; only while :meth:`Controller.next` is called."""

    @property
    def name(self) -> str:
        """Name of the robot."""
    @property
    def time_s(self) -> float:
        """Time of the simulation (s)."""
    @property
    def pose(self) -> Pose:
        """Where the robot is and where it looks, by its odometry."""
    @property
    def node_count(self) -> int:
        """Number of nodes in the world."""
    @property
    def outcome(self) -> str:
        """How the last command ended: ``"started"`` (none was given yet), ``"arrived"``, ``"blocked"`` or ``"listened"``."""
    @property
    def contact(self) -> tuple[float, float, float] | None:
        """The point of contact on the obstacle that blocked the last drive (m), or ``None``."""
    @property
    def heard(self) -> list[Heard]:
        """What was heard of each node at the stop that just ended; empty after a drive."""
    @property
    def seed(self) -> int:
        """Seed of this robot in this run, for generators of your own."""
    @property
    def random(self) -> random.Random:
        """A generator of random numbers that depends on the seed of the run and on the robot alone."""
    def clearance(self, direction_rad: float, range_m: float = 10.0) -> float:
        """Distance to the next obstacle in a direction (m), at most `range_m`: what a range sensor says."""
    def ranges(self, count: int = 8, range_m: float = 10.0) -> list[float]:
        """Clearances in `count` directions (m), evenly spread from the x axis counter-clockwise."""
    def drive_to(self, x_m: float, y_m: float, z_m: float | None = None) -> Command:
        """The command to drive straight to a place (m), at the present height if `z_m` is absent."""
    def drive_arc(self, length_m: float, turn_rad: float) -> Command:
        """The command to drive an arc of so many metres that turns by so many radians, counter-clockwise."""
    def listen(self) -> Command:
        """The command to stand and listen for the time that the scenario says."""
    def sweep(self) -> Command:
        """As ``listen``, in a network whose links sweep sectors."""
    def finish(self, ending: str = "complete") -> Command:
        """The command to end the survey: ``"complete"``, ``"steps_exhausted"`` or ``"stuck"``."""

@final
class Delivery:
    """A frame that was received."""

    @property
    def network(self) -> int: ...
    @property
    def sender(self) -> str: ...
    @property
    def sequence(self) -> int: ...
    @property
    def payload(self) -> bytes: ...
    @property
    def rssi_dbm(self) -> float: ...
    @property
    def sector(self) -> int | None: ...
    @property
    def snr_db(self) -> float | None: ...

@final
class SendReport:
    """The end of a frame: its outcome is ``sent``, ``acknowledged``, ``no-acknowledgement`` or ``channel-access-failure``."""

    @property
    def network(self) -> int: ...
    @property
    def frame(self) -> int: ...
    @property
    def to(self) -> str | None: ...
    @property
    def outcome(self) -> str: ...
    @property
    def attempts(self) -> int:
        """They differ from the transmissions where a receiver is woken first: one that does not answer costs an attempt."""
    @property
    def transmissions(self) -> int: ...
    @property
    def offered_s(self) -> float: ...

@final
class Sensed:
    """What a sensor says: a target ``entered`` or ``left``, or a field was ``sampled``."""

    @property
    def kind(self) -> str: ...
    @property
    def target(self) -> int | None: ...
    @property
    def field(self) -> int | None: ...
    @property
    def value(self) -> float | None: ...

@final
class DriveEnd:
    """How a drive ended: ``arrived``, or ``blocked`` with the point of contact (m)."""

    @property
    def outcome(self) -> str: ...
    @property
    def contact(self) -> tuple[float, float, float] | None: ...

@final
class SweepAnswer:
    """What a node answered to a sector sweep."""

    @property
    def sender(self) -> str: ...
    @property
    def sector(self) -> int | None: ...
    @property
    def snr_db(self) -> float: ...
    @property
    def rssi_dbm(self) -> float: ...
    @property
    def node_sector(self) -> int: ...
    @property
    def sectors(self) -> list[tuple[int, float]]: ...

@final
class Announcement:
    """A frame of a sweep with which another station announces itself."""

    @property
    def network(self) -> int: ...
    @property
    def sender(self) -> str: ...
    @property
    def sector(self) -> int | None: ...
    @property
    def snr_db(self) -> float: ...
    @property
    def rssi_dbm(self) -> float: ...

@final
class TimerKey:
    """A timer that was set, to cancel it."""

@final
class Port:
    """What an application can know and do; only while one of its methods is called."""

    @property
    def station(self) -> str:
        """Name of this station."""
    @property
    def kind(self) -> str:
        """``"node"``, ``"robot"`` or ``"sink"``."""
    @property
    def now_s(self) -> float:
        """Time of the simulation (s)."""
    @property
    def node_count(self) -> int:
        """Number of nodes in the world."""
    @property
    def charge_j(self) -> float | None:
        """Energy that is left in the battery of the station (J); none if it has no battery."""
    @property
    def pose(self) -> Pose:
        """Where the station is and where it looks; of a robot by its odometry."""
    def pose_at(self, time_s: float) -> Pose:
        """The pose at a time (s), as the station moves now: before its drive the start of that, after it the end."""
    @property
    def seed(self) -> int:
        """Seed of this station in this run, for generators of your own."""
    @property
    def random(self) -> random.Random:
        """A generator of random numbers that depends on the seed of the run and on the station alone."""
    def uniform(self, number: int) -> float:
        """A random number in [0, 1) that depends on the run, the station and `number` alone."""
    def choice(self, number: int, count: int) -> int:
        """A random whole number from 0 to `count` - 1 that depends on the run, the station and `number` alone."""
    def send(self, payload: bytes, to: str | None = None, network: int = 0) -> int:
        """Gives a frame to the MAC, for one station or for all that hear it. Returns its number; ``sent`` follows."""
    def after(self, seconds: float, timer: int = 0) -> TimerKey:
        """Sets a timer: ``timer`` is called after so many seconds, with this number. Returns a key for ``cancel``."""
    def cancel(self, key: TimerKey) -> None:
        """Cancels a timer, if it is pending."""
    def listen(self, seconds: float, network: int = 0) -> None:
        """Opens the receiver of a robot for so many seconds, whether it stands or drives; ``listened`` follows."""
    def radio(self, network: int = 0) -> Radio:
        """The radio of the station, in a network with ``mac.program``."""
    def has_sectors(self, network: int = 0) -> bool:
        """Whether the links of a network sweep sectors."""
    def sectors(self, network: int = 0) -> int | None:
        """Number of sectors of the station's antenna, all rings and tilts together; ``None`` without sector sweeps."""
    def sweep(self, kind: str = "gather", network: int = 0) -> None:
        """Begins a sector sweep: nodes answer ``"gather"``, nobody answers ``"announce"``; ``swept`` follows."""
    def drive_to(self, x_m: float, y_m: float, z_m: float | None = None) -> DriveEnd | None:
        """Drives straight to a place (m). Returns the end of a drive that is over at once; else ``drive_ended`` follows."""
    def drive_arc(self, length_m: float, turn_rad: float) -> DriveEnd | None:
        """Drives an arc of so many metres that turns by so many radians, counter-clockwise. Returns as ``drive_to``."""
    def steer(self, seconds: float, turn_rate_rad_per_s: float) -> DriveEnd | None:
        """Drives for so many seconds at the robot's speed and turns meanwhile. Returns as ``drive_to``."""
    def halt(self) -> None:
        """Stops the robot where it is; ``drive_ended`` is not called."""
    @property
    def drive_ahead(self) -> tuple[float, tuple[float, float, float] | None] | None:
        """When the drive under way ends (s), and the point of contact on an obstacle that ends it."""
    def clearance(self, direction_rad: float, range_m: float = 10.0) -> float:
        """Distance to the next obstacle in a direction (m), at most `range_m`: what a range sensor says."""
    def targets_within(self, reach_m: float) -> list[int]:
        """The targets that truly are not farther than `reach_m` from here, by number."""
    def capture(self, reach_m: float) -> list[int]:
        """Captures the targets that are not farther than `reach_m` from the robot. Returns their numbers."""
    def remove_sources(self, reach_m: float) -> int:
        """Removes the sources of fields that are not farther than `reach_m` from here. Returns how many."""
    def log_stop(
        self, heard: dict[str, tuple[int, int, float | None]], since_s: float, network: int = 0
    ) -> None:
        """Writes a stop: what was heard since `since_s` of each node, as received, sent and mean strength (dBm)."""
    def finish(self) -> None:
        """Ends the application of this station."""

class Radio:
    """The radio of a station in a network with ``mac.program``; only while one of its program's methods is called.

    It rests off, idle or with its receiver on. Times are those of the simulation (s): what returns one, returns when that
    comes. What the radio cannot do raises a ``RunError`` that says why, and changes nothing.
    """

    def off(self) -> None:
        """The radio rests off. What it sends ends first; a frame that it receives is lost."""
    def idle(self) -> float:
        """The radio rests idle: it sends sooner than from off. Returns when it is idle (s)."""
    def receive(self) -> float:
        """The receiver is on whenever the radio does nothing else. Returns when it is on (s)."""
    def listen(self, until_s: float, from_s: float | None = None) -> float:
        """Receives from ``from_s``, or as soon as possible, until ``until_s``; a frame that begins by then is heard to its
        end."""

    def assess(self, seconds: float | None = None) -> float:
        """Looks at the channel, for 8 symbols if no time is given; ``assessed`` follows."""

    def transmit(
        self,
        payload: bytes,
        to: str | None = None,
        *,
        at_s: float | None = None,
        acknowledged: bool = False,
        packet: int | None = None,
    ) -> float:
        """Sends a frame without channel access, at an instant or as soon as possible; ``sent`` follows."""

    def cancel(self) -> bool:
        """Takes back the frame that is due, before the radio has turned around for it. Returns whether it did."""
    def tune(self, channel: int) -> float:
        """Changes the channel. Returns when the radio is ready (s)."""
    @property
    def channel(self) -> int:
        """Number of the channel."""
    def set_power(self, dbm: float) -> None:
        """Transmit power of what goes on air from now on (dBm), at most that of the settings."""
    def set_threshold(self, dbm: float) -> None:
        """Mean power at or above which the channel is busy (dBm)."""
    def set_ack_wait(self, seconds: float) -> None:
        """How long the radio waits for an acknowledgement, from the end of a frame (s)."""
    def hear(self, *, all: bool) -> None:
        """Whether frames for other stations are told too."""

    def acknowledge(self, *, automatically: bool) -> None:
        """Whether the radio acknowledges frames by itself; at first it does."""
    @property
    def state(self) -> str:
        """``sleep``, ``idle``, ``receive``, ``transmit`` or ``turnaround``."""

    @property
    def earliest_s(self) -> float:
        """When the first symbol of a frame could go out."""

    @property
    def turnaround_s(self) -> float:
        """Time from receiving to transmitting, and back (s)."""
    def airtime_s(self, octets: int) -> float:
        """Time on air of a frame of so many octets (s)."""
    @property
    def energy_j(self) -> float:
        """Energy that the radio has used so far, from the end of the warm-up (J)."""
    def offer(self, octets: int, to: str | None = None) -> int:
        """A packet of so many octets, which counts as offered; ``transmit(.., packet=)`` and ``done`` name it."""

    def done(self, packet: int, outcome: str = "sent") -> None:
        """Ends a packet: ``sent``, ``acknowledged``, ``no-acknowledgement`` or ``channel-access-failure``."""

    def drop_packet(self, packet: int) -> None:
        """Drops a packet for which the program has no room."""

class RadioEvent:
    """What the radio of a station says. What an event has not is ``None``."""

    @property
    def network(self) -> int: ...
    @property
    def kind(self) -> str:
        """``ready``, ``assessed``, ``began``, ``received``, ``garbled``, ``ignored``, ``window-over``, ``sent``,
        ``acknowledged`` or ``unacknowledged``."""
    @property
    def start_s(self) -> float | None: ...
    @property
    def end_s(self) -> float | None: ...
    @property
    def busy(self) -> bool | None: ...
    @property
    def power_dbm(self) -> float | None: ...
    @property
    def sender(self) -> str | None: ...
    @property
    def to(self) -> str | None: ...
    @property
    def sequence(self) -> int | None: ...
    @property
    def payload(self) -> bytes | None: ...
    @property
    def lqi(self) -> int | None: ...
    @property
    def acknowledged(self) -> bool | None: ...

def table(data: object) -> Table: ...
def read(path: str, network: str | None, options: dict[str, Any]) -> Log: ...
def log_of_tables(
    places: object, heard: object | None, contacts: object | None, ranges: object | None, options: dict[str, Any]
) -> Log: ...
def algorithms() -> list[tuple[str, str]]: ...
def next_stops(log: Log, asked: dict[str, Any], progress: object | None) -> dict[str, Any]: ...
def track(tagged: dict[str, Any], options: dict[str, Any], progress: object | None) -> Tracks: ...
def sweep(
    swept: str | Scenario,
    settings: dict[str, Any],
    axes: dict[str, Any],
    runs: int | None = None,
    out: str | None = None,
    resume: bool = False,
    force: bool = False,
    progress: object | None = None,
    threads: int | None = None,
) -> Table: ...
def localise(
    nodes: int,
    pairs: list[tuple[int, int, float]],
    anchors: list[tuple[int, tuple[float, float, float]]],
    dimensions: int,
    method: str,
) -> tuple[
    list[list[float] | None],
    list[list[list[float]] | None],
    bool,
    list[int],
    float | None,
]: ...
def main(program: str, words: list[str]) -> int: ...
