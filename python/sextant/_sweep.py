"""Sweeps."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any

from . import _native
from ._native import Table
from ._progress import Progress, shown
from ._scenario import Scenario


def _values(axis: str, values: Any) -> list[Any]:
    """Give the values of an axis in their order."""
    if isinstance(values, (str, bytes, bytearray, Mapping, Set)) or not isinstance(values, Iterable):
        raise TypeError(f"the values of the axis {axis!r} are a {type(values).__name__}; allowed: a list, or what has an order")
    return list(values)


def sweep(
    scenario: str | os.PathLike[str] | Scenario,
    axes: Mapping[str, Sequence[Any]] | None = None,
    *,
    runs: int | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | Progress = False,
    threads: int | None = None,
    **settings: Any,
) -> Table:
    """Run a scenario with many settings and seeds, on all cores.

    Parameters
    ----------
    scenario : path or Scenario
        The scenario; its table ``[sweep]``, if it has one, lists settings that vary.
    axes : dict of str to sequence, optional
        Settings that vary, with their values: each combination is a cell.
    runs : int, optional
        Runs of each cell, with the seeds ``seed``, ``seed`` + 1, ..; the default is that of the scenario, or 10.
    out : path, optional
        Write the table to this CSV or Parquet file too. What is finished is kept if the sweep is interrupted.
    resume : bool
        Go on with an interrupted sweep to `out`.
    force : bool
        Replace a table.
    progress : bool or callable
        As for :meth:`Scenario.run`.
    threads : int, optional
        The number of threads; the default is one for each core.
    **settings
        Settings of all cells, by their dotted keys, and ``seed``.

    Returns
    -------
    Table
        One row for each cell, run and map: ``cell``, ``replicate``, ``seed``, the settings that vary, ``map``, ``error`` (why a run
        failed), and all results.
    """
    with shown(progress) as told:
        return _native.sweep(
            scenario._native if isinstance(scenario, Scenario) else os.fspath(scenario),
            settings,
            {key: _values(key, values) for key, values in (axes or {}).items()},
            runs,
            None if out is None else os.fspath(out),
            resume,
            force,
            told,
            threads,
        )
