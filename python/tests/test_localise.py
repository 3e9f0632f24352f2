"""Places from a matrix of distances, beside SciPy's least squares where it is there."""

from __future__ import annotations

import numpy as np
import pytest

import sextant


def network(nodes: int, noise_m: float, reach_m: float, seed: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Make places in 30 m, and the distances of those within reach."""
    random = np.random.default_rng(seed)
    places = random.uniform(0.0, 30.0, (nodes, 2))
    distances = np.linalg.norm(places[:, None] - places[None, :], axis=2)
    noise = np.triu(random.normal(0.0, noise_m, distances.shape), 1)
    measured = distances + noise + noise.T
    measured[distances > reach_m] = np.nan
    return places, measured


@pytest.mark.parametrize("method", ["least_squares", "smacof", "mds"])
def test_exact_distances_give_exact_places(method: str) -> None:
    places, distances = network(12, 0.0, np.inf)
    anchors = {node: places[node] for node in range(4)}
    found = sextant.localise(distances, anchors, method=method)
    assert np.allclose(found.places, places, atol=1e-6)
    assert found.in_world and found.residual_m < 1e-6


def test_no_other_places_near_fit_noisy_distances_better() -> None:
    places, distances = network(40, 0.2, 12.0)
    anchors = {node: places[node] for node in range(5)}
    found = sextant.localise(distances, anchors)
    rows, columns = np.nonzero(np.triu(np.isfinite(distances), 1))

    def squares(at: np.ndarray) -> float:
        return float(((np.linalg.norm(at[rows] - at[columns], axis=1) - distances[rows, columns]) ** 2).sum())

    assert found.residual_m == pytest.approx(np.sqrt(squares(found.places) / len(rows)))
    random = np.random.default_rng(1)
    for _ in range(50):
        shift = random.normal(0.0, 0.01, found.places.shape)
        shift[:5] = 0.0
        assert squares(found.places + shift) > squares(found.places)
    errors = np.linalg.norm(found.places - places, axis=1)
    assert errors.max() < 0.6
    assert np.isnan(found.covariances[:5]).all() and (found.covariances[5:, 0, 0] > 0.0).all()


def test_hops_are_scaled_by_the_anchors() -> None:
    places = np.random.default_rng(1).uniform(0.0, 20.0, (150, 2))
    hops = (np.linalg.norm(places[:, None] - places[None, :], axis=2) < 4.0).astype(float)
    anchors = {node: places[node] for node in range(6)}
    found = sextant.localise(hops, anchors, method="mds")
    errors = np.linalg.norm(found.places - places, axis=1)
    assert found.in_world and errors.mean() < 1.5, "hops are up to 4 m long"


def test_without_anchors_the_shape_is_found() -> None:
    places, distances = network(10, 0.0, np.inf)
    found = sextant.localise(distances)
    again = np.linalg.norm(found.places[:, None] - found.places[None, :], axis=2)
    assert not found.in_world and np.allclose(again, distances, atol=1e-6)
    assert found.part_of.tolist() == [0] * 10


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (([[0.0, 1.0]],), "square matrix"),
        ((np.ones((4, 4)), {0: (0.0, 0.0)}), "1 anchors; allowed: none, or at least 3"),
        ((np.ones((4, 4)), {9: (0, 0), 1: (1, 0), 2: (0, 1)}), "allowed: 0 to 3 for 4 nodes"),
        ((np.ones((4, 4)), {0: (0, 0), 1: (1, 0, 0), 2: (0, 1)}), "two each, or three each"),
        ((-np.ones((4, 4)),), "allowed: a number above 0"),
    ],
)
def test_mistakes_are_named(arguments: tuple[object, ...], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        sextant.localise(*arguments)  # type: ignore[arg-type]


def test_an_unknown_method_is_named() -> None:
    with pytest.raises(ValueError, match="least_squares"):
        sextant.localise(np.ones((4, 4)), method="magic")
