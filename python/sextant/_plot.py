"""Drawing with matplotlib."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._map import Map

#: The square root of the 95 % quantile of the chi-squared distribution with two degrees of freedom.
_REGION_95 = math.sqrt(5.991464547107979)


def plot(made: Map, ax: Any, *, truth: bool, regions: bool, labels: bool) -> Any:
    """Draw a map."""
    if ax is None:
        import matplotlib.pyplot as plt

        _, ax = plt.subplots()
    native = made._native
    places, stops = native.places, native.stops
    ax.plot(stops["x_m"], stops["y_m"], ".", color="0.75", markersize=3, label="stops", zorder=1)
    known = native.truth if truth else None
    if known is not None:
        ax.plot(known["x_m"], known["y_m"], "x", color="black", markersize=5, label="true places", zorder=2)
        at = {node: (x, y) for node, x, y in zip(known["node"], known["x_m"], known["y_m"], strict=True)}
        for node, x, y in zip(places["node"], places["x_m"], places["y_m"], strict=True):
            if node in at:
                ax.plot([x, at[node][0]], [y, at[node][1]], "-", color="tab:red", linewidth=0.7, zorder=2)
    if regions and "cov_xx_m2" in places:
        _regions(places, ax)
    ax.plot(places["x_m"], places["y_m"], "o", color="tab:blue", markersize=4, label=made.name, zorder=3)
    if labels:
        for node, x, y in zip(places["node"], places["x_m"], places["y_m"], strict=True):
            ax.annotate(node, (x, y), xytext=(3, 3), textcoords="offset points", fontsize=7)
    ax.set_aspect("equal")
    ax.set_xlabel("x (m)")
    ax.set_ylabel("y (m)")
    ax.legend(loc="best", fontsize=8)
    return ax


def _regions(places: Any, ax: Any) -> None:
    from matplotlib.patches import Ellipse

    columns = ("x_m", "y_m", "cov_xx_m2", "cov_xy_m2", "cov_yy_m2")
    for x, y, xx, xy, yy in zip(*(places[name] for name in columns), strict=True):
        if any(math.isnan(value) for value in (xx, xy, yy)):
            continue
        # The axes of the ellipse, by the eigenvalues of a symmetric matrix of two rows.
        middle, apart = (xx + yy) / 2.0, math.hypot((xx - yy) / 2.0, xy)
        half = [_REGION_95 * math.sqrt(max(0.0, value)) for value in (middle + apart, middle - apart)]
        angle = math.degrees(math.atan2(2.0 * xy, xx - yy) / 2.0)
        ax.add_patch(
            Ellipse((x, y), 2.0 * half[0], 2.0 * half[1], angle=angle, alpha=0.15, color="tab:blue", zorder=1)
        )
