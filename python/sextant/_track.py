"""Tracks of tags among receivers at known places."""

from __future__ import annotations

import os
from typing import Any

from . import _native
from ._frames import Like, as_like, without_rows
from ._native import Table
from ._progress import Progress, shown


class _KeptTracks:
    """What pickle keeps of tracks."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.track: Table = state["track"]
        self.summary: list[dict[str, Any]] = state["summary"]
        self.notes: list[str] = state["notes"]
        self._told: str = state["told"]

    def __repr__(self) -> str:
        return self._told


def _kept_tracks(state: dict[str, Any], like: Like) -> Tracks:
    return Tracks(_KeptTracks(state), like)


class Tracks:
    """Where tags were over time.

    It is made by :func:`track`, or by :func:`map_log` with ``track=True``.
    """

    __slots__ = ("_like", "_native")

    def __init__(self, native: _native.Tracks | _KeptTracks, like: Like = None) -> None:
        self._native = native
        self._like = like

    @property
    def track(self) -> Any:
        """The poses of all tags, a row each, in the order of time of each tag.

        Columns: ``t_s``, ``tag``, ``x_m``, ``y_m``, ``z_m``; the entries ``cov_xx_m2``, ``cov_xy_m2``, ``cov_yy_m2``, ``cov_zz_m2`` of
        the covariance (m²), the last one empty where the height is given; ``velocity_x_m_per_s``, ``velocity_y_m_per_s``. It is a data
        frame of the library of the log, or a :class:`Table`.
        """
        return as_like(self._native.track, self._like)

    @property
    def summary(self) -> list[dict[str, Any]]:
        """What was learned of each tag, and its errors if the truth is known, as ``sextant map --track --summary`` writes it."""
        return self._native.summary

    @property
    def notes(self) -> list[str]:
        """What you should know of the log."""
        return self._native.notes

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[Any, ...]:
        native = self._native
        state = {"track": native.track, "summary": native.summary, "notes": native.notes, "told": repr(native)}
        return (_kept_tracks, (state, without_rows(self._like)))


def track(
    log: Any = None,
    known: Any = None,
    *,
    packets: Any = None,
    odometry: Any = None,
    tags: Any = None,
    truth: Any = None,
    antenna_height: float | None = None,
    side: tuple[float, float] | None = None,
    path_error: str | None = None,
    progress: bool | Progress = False,
    threads: int | None = None,
    **options: Any,
) -> Tracks:
    """Work out the tracks of moving tags among receivers at known places.

    Parameters
    ----------
    log : path or table
        What ``sextant map --track`` reads: a folder, a file, a recording. Or a table of ranges: ``t_s``, ``node``, ``range_m`` (or
        ``range_cm``, ``range_mm``, ``range_ft``, ``range_ns``), and ``tag`` of several. It may be None beside `packets`.
    known : table or path
        Where the receivers are: ``node``, ``x_m``, ``y_m``, and ``z_m`` where you have it.
    packets : table, optional
        Strengths: ``t_s``, ``node``, ``rssi_dbm``, and ``tag`` of several; or ``receiver`` and ``node``, which is the tag then.
    odometry : table, optional
        The path of the robot that carries the tags, in any frame: ``t_s``, ``x_m``, ``y_m``, and ``heading_rad`` for `tags`.
    tags : table, optional
        Where the tags are on it, x ahead and y to the left: ``tag``, ``x_m``, ``y_m``, ``z_m``.
    truth : table or path, optional
        The true path, to compare with: ``t_s``, ``x_m``, ``y_m``.
    antenna_height : float, optional
        The height of the tags (m), above the zero of those of the receivers.
    side : tuple of float, optional
        Of receivers on a straight line: a place (m) on the side of the tag.
    path_error : str, optional
        How wrong odometry is: ``"scale=1%,heading=0.01"``.
    progress : bool or callable
        As for :meth:`Scenario.run`.
    threads : int, optional
        The number of threads; the default is one for each core.
    **options
        As the flags of ``sextant map``, with ``_`` for ``-``: ``reciprocal=True``, ``range_fields={"node": "anchor"}``.

    Returns
    -------
    Tracks

    Raises
    ------
    LogError
        With the table or the file, the row or the line, the column, what was found and what is allowed.

    Examples
    --------
    >>> import sextant
    >>> corners = {"node": ["a", "b", "c"], "x_m": [0.0, 8.0, 4.0], "y_m": [0.0, 0.0, 7.0]}
    >>> times = [0.1 * step for step in range(120)]
    >>> names = [corners["node"][step % 3] for step in range(120)]
    >>> places = [(corners["x_m"][step % 3], corners["y_m"][step % 3]) for step in range(120)]
    >>> ranges = [((3.0 + 0.1 * t - x) ** 2 + (2.0 - y) ** 2) ** 0.5 for t, (x, y) in zip(times, places)]
    >>> found = sextant.track({"t_s": times, "node": names, "range_m": ranges}, corners)
    >>> found
    sextant.Tracks(tag: 40 poses)
    >>> abs(found.track["x_m"][0] - 3.0) < 0.1
    True
    """
    if known is None:
        raise TypeError("a track needs the places of the receivers: known")
    is_path = isinstance(log, (str, os.PathLike))
    tagged = {
        "path": os.path.abspath(os.fspath(log)) if is_path else None,
        "places": odometry,
        "heard": packets,
        "ranges": None if is_path else log,
        "tags": tags,
        "known": known,
        "truth": truth,
        "antenna_height": antenna_height,
        "side": side,
        "path_error": path_error,
        "threads": threads,
    }
    if is_path and not (packets is None and odometry is None and tags is None):
        raise TypeError("packets, odometry and tags are tables beside a table of ranges; a path has its own")
    with shown(progress) as told:
        native = _native.track(tagged, options, told)
    like = None if is_path else next((table for table in (log, packets) if table is not None), None)
    return Tracks(native, like)
