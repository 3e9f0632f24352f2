"""Places from a table of distances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


@dataclass(frozen=True)
class Localised:
    """Places of nodes that were computed from distances.

    Attributes
    ----------
    places : array of shape (nodes, dimensions)
        Where the nodes are (m); NaN where the distances do not fix a node.
    covariances : array of shape (nodes, dimensions, dimensions)
        How sure that is (m²), by least squares with anchors; NaN elsewhere, and for anchors.
    in_world : bool
        Whether the places are in the frame of the anchors. Without anchors they are known up to turns, shifts and a mirror image.
    part_of : array of shape (nodes,)
        The connected part of the network that each node is in.
    residual_m : float
        Root of the mean squared difference of the given distances and those of the places (m); NaN without any.
    """

    places: npt.NDArray[np.float64]
    covariances: npt.NDArray[np.float64]
    in_world: bool
    part_of: npt.NDArray[np.int64]
    residual_m: float


def localise(
    distances: Any,
    anchors: Mapping[int, Sequence[float]] | None = None,
    *,
    method: str = "least_squares",
    dimensions: int | None = None,
) -> Localised:
    """Compute where nodes are from a matrix of the distances between them.

    Parameters
    ----------
    distances : array of shape (nodes, nodes)
        Measured distances (m). NaN, infinity, or 0 off the diagonal are pairs that were not measured. Where both halves have a distance,
        its mean counts.
    anchors : dict of int to sequence, optional
        Places of nodes that are known (m), two or three coordinates each: at least three in the plane, four in space. Without any, the
        shape is found, but not where it is.
    method : str
        ``least_squares`` (all places together, with covariances), ``smacof`` (stress majorisation, then aligned to the anchors), or
        ``mds`` (classical scaling of shortest ways; with numbers of hops instead of distances it is MDS-MAP).
    dimensions : int, optional
        2 or 3. The default follows from the anchors, 2 without any.

    Returns
    -------
    Localised

    Examples
    --------
    >>> import numpy as np, sextant
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0]])
    >>> distances = np.linalg.norm(square[:, None] - square[None, :], axis=2)
    >>> found = sextant.localise(distances, anchors={0: (0, 0), 1: (4, 0), 2: (4, 4)})
    >>> np.round(found.places[4], 6).tolist()
    [1.0, 2.0]
    """
    import numpy as np  # The package is imported without it.

    matrix = np.asarray(distances, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError(f"distances have the shape {matrix.shape}; allowed: a square matrix, a row and a column a node")
    nodes = matrix.shape[0]
    known = {int(node): [float(along) for along in place] for node, place in (anchors or {}).items()}
    lengths = {len(place) for place in known.values()}
    if not lengths <= {2} and not lengths <= {3}:
        raise ValueError(f"places of anchors have {sorted(lengths)} coordinates; allowed: two each, or three each")
    if dimensions is None:
        dimensions = lengths.pop() if lengths else 2
    measured = np.isfinite(matrix) & (matrix != 0.0)
    rows, columns = np.triu_indices(nodes, 1)
    either = measured[rows, columns] | measured[columns, rows]
    rows, columns = rows[either], columns[either]
    both = np.stack([matrix[rows, columns], matrix[columns, rows]])
    told = np.stack([measured[rows, columns], measured[columns, rows]])
    means = np.where(told, both, 0.0).sum(axis=0) / told.sum(axis=0)
    pairs = list(zip(rows.tolist(), columns.tolist(), means.tolist(), strict=True))
    in_space = [(node, (place[0], place[1], place[2] if len(place) == 3 else 0.0)) for node, place in known.items()]
    places, covariances, in_world, part_of, residual_m = _native.localise(nodes, pairs, in_space, dimensions, method)
    unknown = [float("nan")] * 3
    found = np.array([unknown if place is None else place for place in places], dtype=np.float64).reshape(nodes, 3)
    unsure = [[float("nan")] * 3] * 3
    spread = np.array([unsure if one is None else one for one in covariances], dtype=np.float64).reshape(nodes, 3, 3)
    return Localised(
        places=found[:, :dimensions],
        covariances=spread[:, :dimensions, :dimensions],
        in_world=in_world,
        part_of=np.array(part_of, dtype=np.int64),
        residual_m=float("nan") if residual_m is None else residual_m,
    )
