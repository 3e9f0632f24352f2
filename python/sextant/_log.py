"""Logs of robots and recordings, and maps of them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Literal, overload

from . import _native
from ._frames import Like
from ._map import Map
from ._native import Table
from ._progress import Progress, shown
from ._track import Tracks
from ._track import track as _track


class Log:
    """What robots heard, and where.

    It is made by :func:`read`, or of your own tables.

    Parameters
    ----------
    stops : table
        Where the robot listened: ``stop``, ``x_m``, ``y_m`` (or ``lat``, ``lon``), and ``t_s``, ``z_m``, ``robot``, ``sent``,
        ``heading_rad`` where you have them. Or its path: ``t_s``, ``x_m``, ``y_m``.
    receptions : table
        What it heard: ``node``, ``stop``, and ``received``, ``sent``, ``rssi_dbm``, ``snr_db``, ``sector`` where you have them. Or
        packets, with a path: ``t_s``, ``node``, ``rssi_dbm``.
    contacts : table, optional
        Where it met obstacles: ``t_s``, ``x_m``, ``y_m``.
    ranges : table, optional
        Distances to nodes that it measured: ``node``, ``range_m`` (or ``range_cm``, ``range_mm``, ``range_ft``, ``range_ns``), and ``stop``, or ``t_s`` with a path.
        With ranges, `receptions` may be None.
    **options
        As the flags of ``sextant map``, with ``_`` for ``-``: ``stop_every="1m"``, ``lora=True``.

    Raises
    ------
    LogError
        With the table, the row (from 0), the column, what was found and what is allowed.

    Notes
    -----
    A table is anything with the Arrow PyCapsule interface (a data frame of pandas, polars or DuckDB, a table of pyarrow), a
    dict of columns, or a structured array of NumPy. Columns mean what they mean in the files of ``sextant map``: see the page on
    logs of robots in the guide.
    """

    __slots__ = ("_like", "_made_of", "_native")

    def __init__(
        self, stops: Any, receptions: Any = None, *, contacts: Any = None, ranges: Any = None, **options: Any
    ) -> None:
        self._native = _native.log_of_tables(stops, receptions, contacts, ranges, options)
        self._like: Like = stops
        # Pickle makes it again, of the same tables or the same file.
        self._made_of: tuple[Any, ...] = (_of_tables, (stops, receptions, contacts, ranges, options))

    @classmethod
    def _of(cls, native: _native.Log, made_of: tuple[Any, ...]) -> Log:
        made = cls.__new__(cls)
        made._native, made._like, made._made_of = native, None, made_of
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made_of

    @property
    def stops(self) -> Table:
        """Where the robots listened: ``stop``, ``t_s``, ``x_m``, ``y_m``, ``z_m``, and ``robot`` of several."""
        return self._native.stops

    @property
    def receptions(self) -> Table:
        """What was heard of each node at each stop: ``node``, ``stop``, ``received``, ``sent``, and what was measured."""
        return self._native.receptions

    @property
    def nodes(self) -> list[str]:
        """Names of the nodes."""
        return self._native.nodes

    @property
    def networks(self) -> list[str]:
        """Names of the networks that were surveyed; empty if there is one without a name."""
        return self._native.networks

    @property
    def notes(self) -> list[str]:
        """How the log was read: what you should know."""
        return self._native.notes

    @property
    def findings(self) -> list[str]:
        """What is odd in the log of a robot."""
        return self._native.findings

    @property
    def tables(self) -> dict[str, Table]:
        """All tables of a recording by name, as ``sextant export`` writes them."""
        return dict(self._native.tables())

    def map(
        self,
        algorithm: str = "auto",
        *,
        profile: str | None = None,
        network: str | None = None,
        area: str | tuple[float, float, float, float] | None = None,
        near_stops: float | None = None,
        truth: Any = None,
        settings: Mapping[str, Any] | None = None,
        progress: bool | Progress = False,
        threads: int | None = None,
    ) -> Map:
        """Work out where the nodes are.

        Parameters
        ----------
        algorithm : str
            One of :func:`algorithms`; ``auto`` chooses by what the log has.
        profile : str, optional
            The probability of a reception by distance: ``fitted``, or ``trapezoid:p0=0.95,plateau_m=2,range_m=10``.
        network : str, optional
            The network to map, if several were surveyed.
        area : tuple of float, or str, optional
            All nodes are within this box ``(x0, y0, x1, y1)`` (m), or within the polygon of this file.
        near_stops : float, optional
            Nodes are near the stops: the probability of a place falls by e for each so many metres.
        truth : table, optional
            The true places, to compare with: ``node``, ``x_m``, ``y_m``.
        settings : dict, optional
            Settings by their keys, as ``--set`` takes them: ``{"maps.0.algorithm.ml_tm.grid_step_m": 0.5}``.
        progress : bool or callable
            As for :meth:`Scenario.run`.
        threads : int, optional
            The number of threads; the default is one for each core.

        Returns
        -------
        Map
        """
        return self._maps(algorithm, profile, network, area, near_stops, truth, settings, progress, threads)[0]

    def maps(
        self,
        *,
        truth: Any = None,
        settings: Mapping[str, Any] | None = None,
        progress: bool | Progress = False,
        threads: int | None = None,
    ) -> dict[str, Map]:
        """Make all maps of the scenario that was recorded, by name; of the log of a robot, the map by ``auto``."""
        made = self._maps(None, None, None, None, None, truth, settings, progress, threads)
        return {one.name: one for one in made}

    def next_stops(
        self,
        stops: int = 10,
        *,
        algorithm: str | None = None,
        profile: str | None = None,
        network: str | None = None,
        area: str | tuple[float, float, float, float] | None = None,
        floorplan: str | os.PathLike[str] | None = None,
        floorplan_unit: str | None = None,
        way_m: float | None = None,
        speed_m_per_s: float | None = None,
        listen_s: float | None = None,
        radius_m: float = 0.2,
        robot: str | None = None,
        progress: bool | Progress = False,
        threads: int | None = None,
    ) -> dict[str, Any]:
        """Say where the robot should listen next: the stops that let the errors of the nodes fall most for their time.

        Parameters
        ----------
        stops : int
            The most stops.
        algorithm, profile, network : str, optional
            How the log is mapped first, as for :meth:`map`.
        area : tuple of float, or str, optional
            The stops are within this box ``(x0, y0, x1, y1)`` (m), or within the polygon of this file; the default is as far round
            the stops of the log as nodes are heard.
        floorplan : path, optional
            Walls that the robot goes round: a map of ROS, GeoJSON, DXF, or what ``sextant floorplan`` wrote.
        floorplan_unit : str, optional
            Unit of lengths of a plan in DXF, or in GeoJSON that is not in degrees: ``"mm"``, ``"m"``, ``"ft"`` or another one; the
            default is what the file says.
        way_m : float, optional
            The longest way of all stops together (m).
        speed_m_per_s, listen_s : float, optional
            Speed between stops (m/s) and time of listening at one (s); the default is what the log tells.
        radius_m : float
            Radius of the hull of the robot, which stays so far from walls (m).
        robot : str, optional
            The robot that drives, if there are several; the default is the one that listened last.
        progress : bool or callable
            As for :meth:`Scenario.run`.
        threads : int, optional
            The number of threads; the default is one for each core.

        Returns
        -------
        dict
            As ``sextant next --format json`` prints it. ``stops`` is a list of one dict a stop: ``stop``, ``x_m``, ``y_m``, ``z_m``,
            ``way_m``, ``time_s``, ``error_fall_m``, ``error_m``, ``nodes`` and more. ``end`` says why there are no more stops.

        Raises
        ------
        RunError
            If the log does not tell where to listen.
        """
        asked = {
            "stops": stops,
            "algorithm": algorithm,
            "profile": profile,
            "network": network,
            "area": _box(area),
            "floorplan": None if floorplan is None else os.path.abspath(os.fspath(floorplan)),
            "floorplan_unit": floorplan_unit,
            "way_m": way_m,
            "speed_m_per_s": speed_m_per_s,
            "listen_s": listen_s,
            "radius_m": radius_m,
            "robot": robot,
            "threads": threads,
        }
        with shown(progress) as told:
            return _native.next_stops(self._native, asked, told)

    def _maps(
        self,
        algorithm: str | None,
        profile: str | None,
        network: str | None,
        area: str | tuple[float, float, float, float] | None,
        near_stops: float | None,
        truth: Any,
        settings: Mapping[str, Any] | None,
        progress: bool | Progress,
        threads: int | None,
    ) -> list[Map]:
        how = {
            "algorithm": algorithm,
            "profile": profile,
            "network": network,
            "area": _box(area),
            "near_stops": near_stops,
            "threads": threads,
        }
        with shown(progress) as told:
            made = self._native.map(how, dict(settings or {}), truth, told)
        return [Map(native, self._like) for native in made]

    def __repr__(self) -> str:
        return repr(self._native)


def read(path: str | os.PathLike[str], *, network: str | None = None, **options: Any) -> Log:
    """Read what the command line reads: a recording, a folder of tables, a ROS 2 bag, a capture.

    Parameters
    ----------
    path : path
        The file or the folder.
    network : str, optional
        The network to map first, if several were surveyed.
    **options
        As the flags of ``sextant map``, with ``_`` for ``-``: ``pose_topic="/odom"``, ``stop_every="1m"``.

    Returns
    -------
    Log

    Raises
    ------
    LogError
        With the file, the line, the column, what was found and what is allowed.
    """
    path = os.path.abspath(os.fspath(path))
    return Log._of(_native.read(path, network, options), (_read_again, (path, network, options)))


def _box(area: str | tuple[float, float, float, float] | None) -> str | None:
    """The area as the command line writes it."""
    return ",".join(map(str, area)) if isinstance(area, tuple) else area


def _read_again(path: str, network: str | None, options: dict[str, Any]) -> Log:
    return read(path, network=network, **options)


def _of_tables(stops: Any, receptions: Any, contacts: Any, ranges: Any, options: dict[str, Any]) -> Log:
    return Log(stops, receptions, contacts=contacts, ranges=ranges, **options)


@overload
def map_log(
    stops: Any,
    receptions: Any = None,
    *,
    algorithm: str = "auto",
    contacts: Any = None,
    ranges: Any = None,
    track: Literal[False] = False,
    profile: str | None = None,
    area: str | tuple[float, float, float, float] | None = None,
    near_stops: float | None = None,
    truth: Any = None,
    settings: Mapping[str, Any] | None = None,
    progress: bool | Progress = False,
    threads: int | None = None,
    **options: Any,
) -> Map: ...


@overload
def map_log(
    stops: Any = None,
    receptions: Any = None,
    *,
    track: Literal[True],
    known: Any,
    ranges: Any = None,
    tags: Any = None,
    antenna_height: float | None = None,
    side: tuple[float, float] | None = None,
    path_error: str | None = None,
    truth: Any = None,
    progress: bool | Progress = False,
    threads: int | None = None,
    **options: Any,
) -> Tracks: ...


def map_log(
    stops: Any = None,
    receptions: Any = None,
    *,
    algorithm: str = "auto",
    contacts: Any = None,
    ranges: Any = None,
    track: bool = False,
    profile: str | None = None,
    area: str | tuple[float, float, float, float] | None = None,
    near_stops: float | None = None,
    truth: Any = None,
    settings: Mapping[str, Any] | None = None,
    progress: bool | Progress = False,
    threads: int | None = None,
    **options: Any,
) -> Map | Tracks:
    """Work out where the nodes are, from your own tables.

    It is ``Log(stops, receptions, contacts=contacts, ranges=ranges, **options).map(algorithm, ..)``: see :class:`Log` and :meth:`Log.map` for the
    parameters. The same log gives the same map as ``sextant map``, to the last bit.

    With ``track=True`` it is ``track(ranges, known, packets=receptions, odometry=stops, ..)``: see :func:`track`. Of stops with a
    column ``stop``, the robot is the tag, and where it was is not looked at.

    Returns
    -------
    Map or Tracks
        ``places`` of a map, or ``track`` of tracks, are a data frame of the library of the first table.

    Examples
    --------
    >>> import sextant
    >>> walk = [(x, y) for y in (0, 2, 4, 6) for x in (0, 2, 4, 6)]
    >>> stops = {"stop": list(range(16)), "x_m": [x for x, _ in walk], "y_m": [y for _, y in walk]}
    >>> heard = {"node": ["lamp"] * 16, "stop": list(range(16))}
    >>> heard["rssi_dbm"] = [-40.0 - 3.0 * ((x - 4) ** 2 + (y - 2) ** 2) ** 0.5 for x, y in walk]
    >>> places = sextant.map_log(stops, heard, algorithm="rssi-centroid").places
    >>> places["node"]
    ['lamp']
    """
    if track:
        of_maps = {"profile": profile, "area": area, "near_stops": near_stops, "settings": settings, "contacts": contacts}
        for name, value in of_maps.items():
            if value is not None:
                raise TypeError(f"`{name}` is for maps, and this is a track: leave it out")
        if algorithm != "auto":
            raise TypeError("`algorithm` is for maps, and this is a track: leave it out")
        return _track(ranges, packets=receptions, odometry=stops, truth=truth, progress=progress, threads=threads, **options)
    log = Log(stops, receptions, contacts=contacts, ranges=ranges, **options)
    return log.map(
        algorithm,
        profile=profile,
        area=area,
        near_stops=near_stops,
        truth=truth,
        settings=settings,
        progress=progress,
        threads=threads,
    )
