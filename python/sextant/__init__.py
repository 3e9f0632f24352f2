"""Sextant simulates wireless sensor networks, and maps the nodes from what robots and anchors heard.

>>> import sextant
>>> run = sextant.Scenario.template("survey").run(seed=3)
>>> run
sextant.Run('survey': 36 of 36 nodes heard, 2 maps)
>>> run.maps["ml-tm"].summary["mapped"]
36

- :class:`Scenario` is a simulation: a file, a dict or a text, checked, with other settings by keyword.
- :class:`Run` is what came of it: its summary, what was heard, and its maps.
- :func:`sweep` runs a scenario with many settings and seeds.
- :func:`map_log` maps what your own robots heard, from data frames; :func:`read` reads their files.
- :func:`track` works out the way of a tag among receivers at known places.
- :func:`localise` places nodes by a matrix of the distances between them.
- :class:`Controller` drives a robot by what it hears; :class:`Application` is a program of a node, a robot or a sink,
  and :class:`RadioProgram` one that commands its radio.

Positions are in metres in the frame of the stops: x east, y north, z up. Angles are in radians, counterclockwise from the x
axis, times in seconds, powers in dBm.
"""

from ._application import Application
from ._controller import Controller
from ._localise import Localised, localise
from ._log import Log, map_log, read
from ._map import Figure, Map, algorithms
from ._native import (
    Announcement,
    Command,
    Delivery,
    DriveEnd,
    Heard,
    LogError,
    Port,
    Pose,
    Radio,
    RadioEvent,
    Robot,
    RunError,
    ScenarioError,
    SendReport,
    Sensed,
    SextantError,
    SweepAnswer,
    Table,
    TimerKey,
    __version__,
    table,
)
from ._radio import RadioProgram, Wait, wait
from ._scenario import Run, Scenario
from ._sweep import sweep
from ._track import Tracks, track

__all__ = [
    "Announcement",
    "Application",
    "Command",
    "Controller",
    "Delivery",
    "DriveEnd",
    "Figure",
    "Heard",
    "Localised",
    "Log",
    "LogError",
    "Map",
    "Port",
    "Pose",
    "Radio",
    "RadioEvent",
    "RadioProgram",
    "Robot",
    "Run",
    "RunError",
    "Scenario",
    "ScenarioError",
    "SendReport",
    "Sensed",
    "SextantError",
    "SweepAnswer",
    "Table",
    "TimerKey",
    "Tracks",
    "Wait",
    "__version__",
    "algorithms",
    "localise",
    "map_log",
    "read",
    "sweep",
    "table",
    "track",
    "wait",
]
