"""Batches of any shape: broadcasting and empty batches."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from conftest import make_setting

import raysheaf
from raysheaf._rays import batch_of

SETTING = make_setting(7)


@pytest.fixture(scope="module")
def scene():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene


def test_broadcasting(scene):
    origins = SETTING.origins[:12].reshape(3, 4, 3)
    directions = SETTING.directions[:4]
    hits = scene.closest_hit(origins, directions, t_max=np.full((3, 1), 2.0))
    assert hits.shape == hits.t.shape == (3, 4)
    for i in range(3):
        for j in range(4):
            one = scene.closest_hit(origins[i, j], directions[j], t_max=2)
            assert one.shape == () and one.array == hits[i, j].array
    rows = scene.all_hits(origins, directions)
    assert rows.shape == rows.counts.shape == (3, 4) and len(rows) == 3
    assert np.array_equal(rows[1, 2].array, scene.all_hits(origins[1, 2], directions[2]).hits.array)
    assert np.array_equal(rows[-1, -1].array, rows[2, 3].array)
    assert scene.any_hit(origins, directions).shape == (3, 4)
    assert scene.hit_counts(origins, directions).dtype == np.uint32
    with pytest.raises(IndexError):
        rows[3, 0]
    with pytest.raises(IndexError):
        rows[0]


@pytest.mark.parametrize("shape", [(0, 3), (2, 0, 3)])
def test_no_rays(scene, shape):
    assert scene.closest_hit(np.zeros(shape), [0, 0, 1]).shape == shape[:-1]
    assert scene.any_hit(np.zeros(shape), [0, 0, 1]).shape == shape[:-1]
    assert scene.hit_counts(np.zeros(shape), [0, 0, 1]).shape == shape[:-1]
    rows = scene.all_hits(np.zeros(shape), [0, 0, 1])
    assert rows.offsets.tolist() == [0] and rows.hits.size == 0
    assert scene.closest_hit([], []).size == 0
    assert scene.closest_hit(np.zeros((0, 8))).size == 0


def test_no_triangles():
    scene = raysheaf.Scene()
    rays = ([0, 0, 0], [[0, 0, 1]])
    assert not scene.any_hit(*rays).any() and scene.bounds is None
    mesh = scene.add(np.zeros((0, 3)), np.zeros((0, 3), int))
    scene.add([], [])
    assert not scene.any_hit(*rays).any()
    assert scene.all_hits(*rays).counts.tolist() == [0]
    scene.replace(mesh, [[-1, -1, 1], [1, -1, 1], [0, 1, 1]], [[0, 1, 2]])
    assert scene.any_hit(*rays).all()


def test_repetition_along_some_axes_is_spread_in_float32(scene):
    rng = np.random.default_rng(5)
    eyes, ways = rng.normal(size=(300, 1, 3)), rng.normal(size=(1, 400, 3))
    t_max = rng.uniform(0, 3, (300, 1))
    tracemalloc.start()
    batch_of(eyes, ways, None, t_max)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < (12 + 12 + 4 + 4) * 300 * 400
    whole = scene.closest_hit(eyes, ways, t_max=t_max)
    wide = [np.broadcast_to(a, (300, 400, 3)).copy() for a in (eyes, ways)]
    t_wide = np.broadcast_to(t_max, (300, 400)).copy()
    assert whole.array.tobytes() == scene.closest_hit(*wide, t_max=t_wide).array.tobytes()
