"""Maximum-likelihood places of nodes on a grid, as a user of NumPy would compute them.

Usage: grid_ml.py FOLDER VERSION

FOLDER holds `stops.f64` and `vertices.f64` (x, y, z of each, little-endian) and `heard.u8` (a row for each node, one
octet a stop: 1 if it was heard there), and `profile.f64`: p0, plateau, range, floor, ceiling of a trapezoid. Written by
`sextant-benches grid-solver`. VERSION is `product` (the product over all stops, node by node) or `gemm` (one matrix product of
logarithms in single precision, in tiles of vertices). Prints the seconds and then the index of the best vertex of
every node.
"""

import pathlib
import sys
import time

import numpy as np

folder, version = pathlib.Path(sys.argv[1]), sys.argv[2]
stops = np.fromfile(folder / "stops.f64").reshape(-1, 3)
vertices = np.fromfile(folder / "vertices.f64").reshape(-1, 3)
heard = np.fromfile(folder / "heard.u8", dtype=np.uint8).reshape(-1, len(stops)).astype(bool)
p0, plateau, reach, floor, ceiling = np.fromfile(folder / "profile.f64")


def reception(places):
    """S of every place and stop."""
    squares = ((places[:, None, :] - stops[None, :, :]) ** 2).sum(axis=2)
    s = p0 * (reach - np.sqrt(squares)) / (reach - plateau)
    return np.clip(s, floor, min(p0, ceiling))


start = time.perf_counter()
if version == "product":
    s = reception(vertices)
    best = [int(np.argmax(np.where(row, s, 1.0 - s).prod(axis=1))) for row in heard]
else:
    tile = max(1, 4_000_000 // len(stops))
    best = np.zeros(len(heard), dtype=np.int64)
    highest = np.full(len(heard), -np.inf, dtype=np.float32)
    weights = heard.astype(np.float32).T
    for first in range(0, len(vertices), tile):
        s = reception(vertices[first : first + tile])
        missed = np.log1p(-s)
        odds = (np.log(s) - missed).astype(np.float32)
        score = odds @ weights + missed.sum(axis=1).astype(np.float32)[:, None]
        local = score.argmax(axis=0)
        value = score[local, np.arange(len(heard))]
        better = value > highest
        highest[better] = value[better]
        best[better] = first + local[better]
print(time.perf_counter() - start)
print(*best)
