"""A map that grows while a robot drives, and the next place to listen. It needs no ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import sextant

#: The square root of the 95 % quantile of the chi-squared distribution with two degrees of freedom.
REGION_95 = math.sqrt(5.991464547107979)


@dataclass(frozen=True)
class Place:
    """Where a node is likely to be, in the frame of the poses (m), with the entries of its covariance (m²)."""

    node: str
    x_m: float
    y_m: float
    z_m: float
    xx_m2: float
    xy_m2: float
    yy_m2: float

    @property
    def has_covariance(self) -> bool:
        """Whether there is a covariance."""
        return all(math.isfinite(entry) for entry in (self.xx_m2, self.xy_m2, self.yy_m2))

    def axes(self) -> tuple[float, float, float]:
        """Standard deviations along the long and the short axis (m), and the direction of the long axis (rad)."""
        middle = (self.xx_m2 + self.yy_m2) / 2.0
        apart = math.hypot((self.xx_m2 - self.yy_m2) / 2.0, self.xy_m2)
        direction = math.atan2(2.0 * self.xy_m2, self.xx_m2 - self.yy_m2) / 2.0
        return math.sqrt(max(0.0, middle + apart)), math.sqrt(max(0.0, middle - apart)), direction


class LiveMap:
    """Collects poses and packets, maps them, and proposes where to listen next.

    Parameters
    ----------
    algorithm : str
        One of ``sextant.algorithms()``.
    visited_m : float
        A place nearer than this to a pose of the robot counts as visited (m).
    **options
        As for ``sextant.map_log``, such as ``stop_every="1m"``.
    """

    def __init__(self, algorithm: str = "auto", visited_m: float = 1.0, **options: Any) -> None:
        self.algorithm, self.visited_m, self.options = algorithm, visited_m, options
        self._path: dict[str, list[float]] = {"t_s": [], "x_m": [], "y_m": [], "z_m": []}
        self._times: list[float] = []
        self._nodes: list[str] = []
        self._rssi_dbm: list[float] = []

    def add_pose(self, t_s: float, x_m: float, y_m: float, z_m: float = 0.0) -> bool:
        """Add where the robot is. A pose that is not later than the last is left out, and False is returned.

        Raises
        ------
        ValueError
            A number is not finite.
        """
        _check_finite(t_s=t_s, x_m=x_m, y_m=y_m, z_m=z_m)
        if self._path["t_s"] and t_s <= self._path["t_s"][-1]:
            return False
        for column, value in zip(self._path.values(), (t_s, x_m, y_m, z_m), strict=True):
            column.append(float(value))
        return True

    def add_packet(self, t_s: float, node: str, rssi_dbm: float) -> None:
        """Add a packet that was heard.

        Raises
        ------
        ValueError
            A number is not finite.
        """
        _check_finite(t_s=t_s, rssi_dbm=rssi_dbm)
        self._times.append(float(t_s))
        self._nodes.append(node)
        self._rssi_dbm.append(float(rssi_dbm))

    def missing(self) -> str | None:
        """Say what is missing for a map, or None if there is enough."""
        times = self._path["t_s"]
        if len(times) < 2:
            return f"poses: {len(times)}; at least 2 are needed"
        if not self._known():
            span = f"packets from {times[0]} s to {times[-1]} s, the time of the path"
            return f"{span}: 0 of {len(self._times)}; at least 1 is needed"
        return None

    def map(self) -> list[Place]:
        """Work out where the nodes are; no place while something is `missing`."""
        if self.missing() is not None:
            return []
        known = self._known()
        packets = {
            "t_s": [self._times[index] for index in known],
            "node": [self._nodes[index] for index in known],
            "rssi_dbm": [self._rssi_dbm[index] for index in known],
        }
        made = sextant.map_log(self._path, packets, algorithm=self.algorithm, **self.options)
        rows = made.places
        unknown = [math.nan] * len(rows["node"])
        names = ("cov_xx_m2", "cov_xy_m2", "cov_yy_m2")
        entries = [rows[name] if name in rows else unknown for name in names]
        columns = (rows["node"], rows["x_m"], rows["y_m"], rows["z_m"], *entries)
        return [_place(*row) for row in zip(*columns, strict=True)]

    def next_stop(self, places: list[Place]) -> tuple[float, float] | None:
        """Propose the place to listen at next (m), or None if all that it would propose was visited.

        The node with the largest covariance comes first. Its long axis is where least is known, so the ends of the axis of
        its 95 % region are proposed, the nearer to the robot first.
        """
        ranked = sorted((place for place in places if place.has_covariance), key=lambda one: (-one.axes()[0], one.node))
        for place in ranked:
            long_m, _, direction = place.axes()
            reach_m = max(REGION_95 * long_m, self.visited_m)
            along = reach_m * math.cos(direction), reach_m * math.sin(direction)
            ends = [(place.x_m + side * along[0], place.y_m + side * along[1]) for side in (1.0, -1.0)]
            unvisited = [end for end in ends if not self.was_visited(*end)]
            if unvisited:
                return min(unvisited, key=self._distance_from_robot)
        return None

    def was_visited(self, x_m: float, y_m: float) -> bool:
        """Whether the robot was within ``visited_m`` of a place."""
        poses = zip(self._path["x_m"], self._path["y_m"], strict=True)
        return any(math.hypot(x_m - x, y_m - y) < self.visited_m for x, y in poses)

    def _known(self) -> list[int]:
        """Indices of the packets that were heard between the first pose and the last."""
        times = self._path["t_s"]
        return [index for index, t_s in enumerate(self._times) if times[0] <= t_s <= times[-1]]

    def _distance_from_robot(self, end: tuple[float, float]) -> float:
        return math.hypot(end[0] - self._path["x_m"][-1], end[1] - self._path["y_m"][-1])


def _place(node: object, *numbers: float | None) -> Place:
    return Place(str(node), *(math.nan if value is None else float(value) for value in numbers))


def _check_finite(**numbers: float) -> None:
    for name, number in numbers.items():
        if not math.isfinite(number):
            raise ValueError(f"`{name}` is {number}; allowed: a finite number")
