"""Maps of nodes."""

from __future__ import annotations

import os
from typing import Any

from . import _native
from ._frames import Like, as_like, without_rows
from ._native import Table


class Figure:
    """A picture, which shows itself in a notebook.

    Attributes
    ----------
    name : str
        Its name.
    svg : str
        The picture as SVG.
    """

    __slots__ = ("name", "svg")

    def __init__(self, name: str, svg: str) -> None:
        self.name = name
        self.svg = svg

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to an SVG file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)

    def _repr_svg_(self) -> str:
        return self.svg

    def _repr_html_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"sextant.Figure({self.name!r})"


class _KeptMap:
    """What pickle keeps of a map: the results, without what the library has of them."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.name: str = state["name"]
        self.algorithm: str = state["algorithm"]
        self.places: Table = state["places"]
        self.truth: Table | None = state["truth"]
        self.stops: Table = state["stops"]
        self.summary: dict[str, Any] = state["summary"]
        self.notes: list[str] = state["notes"]
        self._told: str = state["told"]

    def figures(self) -> list[tuple[str, str]]:
        return []

    def __repr__(self) -> str:
        return self._told


def _kept_map(state: dict[str, Any], like: Like) -> Map:
    return Map(_KeptMap(state), like)


class Map:
    """Where the nodes are, as worked out from what was heard.

    Pickle keeps everything but the figures: :meth:`plot` draws afterwards too.

    It is made by :meth:`Run.maps`, :func:`map_log` or :meth:`Log.map`.
    """

    __slots__ = ("_like", "_native", "_figures")

    def __init__(self, native: _native.Map | _KeptMap, like: Like = None) -> None:
        self._native = native
        self._like = like
        self._figures: dict[str, Figure] | None = None

    @property
    def name(self) -> str:
        """Name of the map."""
        return self._native.name

    @property
    def algorithm(self) -> str:
        """Name of the algorithm that made it."""
        return self._native.algorithm

    @property
    def places(self) -> Any:
        """The places of the nodes, a row each.

        Columns: ``node``, ``x_m``, ``y_m``, ``z_m``; ``ties`` (number of places that are as good), ``infeasible`` (no place
        explains all receptions), ``concern`` (why a place is not reliable: ``at-edge``, ``unsettled``, ``no-evidence``,
        ``two-places``, ``too-few``, or empty);
        the entries ``cov_xx_m2`` .. ``cov_zz_m2`` of the covariance (m²) if the algorithm gives one; ``lat``, ``lon`` if the log has
        them. Nodes that were never heard have no row. It is a data frame of the library of the log, or a :class:`Table`.
        """
        return as_like(self._native.places, self._like)

    @property
    def truth(self) -> Table | None:
        """The true places of the nodes, where they are known: ``node``, ``x_m``, ``y_m``, ``z_m``."""
        return self._native.truth

    @property
    def summary(self) -> dict[str, Any]:
        """Properties of the map, and its errors if the truth is known, as ``sextant map --summary`` writes them."""
        return self._native.summary

    @property
    def notes(self) -> list[str]:
        """What you should know of the map."""
        return self._native.notes

    @property
    def figures(self) -> dict[str, Figure]:
        """All figures by name: the survey, the map, its errors, the reception curve against the data, residuals."""
        if self._figures is None:
            self._figures = {name: Figure(name, svg) for name, svg in self._native.figures()}
        return dict(self._figures)

    def plot(self, ax: Any = None, *, truth: bool = True, regions: bool = True, labels: bool = False) -> Any:
        """Draw the map with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; the default is a new figure.
        truth : bool
            Draw the true places, where they are known, and lines to them.
        regions : bool
            Draw the region of each node that holds it with a probability of 95 %, if there are covariances.
        labels : bool
            Write the names of the nodes.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from ._plot import plot

        return plot(self, ax, truth=truth, regions=regions, labels=labels)

    def _repr_svg_(self) -> str | None:
        return next((figure.svg for name, figure in self.figures.items() if name.startswith("map")), None)

    def _repr_html_(self) -> str:
        svg = self._repr_svg_() or ""
        told = repr(self).replace("&", "&amp;").replace("<", "&lt;")
        return f"<div><p>{told}</p>{svg}</div>"

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[Any, ...]:
        native = self._native
        state = {
            "name": native.name,
            "algorithm": native.algorithm,
            "places": native.places,
            "truth": native.truth,
            "stops": native.stops,
            "summary": native.summary,
            "notes": native.notes,
            "told": repr(native),
        }
        return (_kept_map, (state, without_rows(self._like)))


def algorithms() -> dict[str, str]:
    """Give the algorithms for maps by name, each with what it is.

    Examples
    --------
    >>> import sextant
    >>> "ml-tm" in sextant.algorithms()
    True
    """
    return dict(_native.algorithms())
