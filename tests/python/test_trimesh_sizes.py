"""Meshes so small or so large that products of their lengths underflow or overflow in float64."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

from raysheaf.trimesh import RayMeshIntersector  # noqa: E402


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e-120, 1e-90, 1e90, 1e120, 1e160, 1e300])
def test_any_size_that_is_a_number(size):
    ball = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(0)
    origins = rng.normal(size=(200, 3))
    directions = rng.uniform(-0.5, 0.5, (200, 3)) - origins
    expected = RayMeshIntersector(ball).intersects_location(origins, directions)
    mesh = trimesh.Trimesh(ball.vertices * size, ball.faces, process=False)
    ray = RayMeshIntersector(mesh)
    with np.errstate(all="raise"):
        for length in (1, size):
            found = ray.intersects_location(origins * size, directions * length)
            assert np.array_equal(found[1], expected[1]) and np.array_equal(found[2], expected[2])
            assert np.allclose(found[0] / size, expected[0], rtol=0, atol=1e-12)
        assert np.array_equal(
            ray.intersects_first(origins * size, directions),
            RayMeshIntersector(ball).intersects_first(origins, directions),
        )


@pytest.mark.parametrize("told", ["raise", "warn"])
@pytest.mark.parametrize("wrong", [1e-60, 1e-310, np.nan, np.inf])
def test_rounding_raises_no_warning(told, wrong):
    ball = trimesh.creation.icosphere(subdivisions=2)
    vertices = ball.vertices * [1, 1, 1e-60]
    vertices[3] = wrong
    mesh = trimesh.Trimesh(vertices, ball.faces, process=False)
    with np.errstate(all=told), warnings.catch_warnings():
        warnings.simplefilter("error")
        for scaled in (True, False):
            ray = RayMeshIntersector(mesh, scaled)
            for way in ([0, 0, -1], [1e-60, 0, -1], [0, 0, -1e-200]):
                assert ray.intersects_location([[0.3, 0.2, 5]], [way])[0].shape == (1, 3)
