"""Many worlds in one scene: rays and points see the instances of their own."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import raysheaf

TRIANGLE = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.float32)
WORLDS, EACH = 5, 3


def make_worlds():
    """World w has triangles at the heights w + 1, w + 11 and w + 21; the ground is in all."""
    scene = raysheaf.Scene(threads=1)
    scene.add(TRIANGLE * [9, 9, 1])
    mesh = scene.add(TRIANGLE, place=False)
    matrices = np.tile(np.eye(4), (WORLDS, EACH, 1, 1))
    matrices[:, :, 2, 3] = np.arange(WORLDS)[:, None] + 1 + 10 * np.arange(EACH)
    ids = scene.instances(mesh, matrices, worlds=range(WORLDS))
    return scene, mesh, ids


def test_instances_are_made_from_arrays():
    scene, mesh, ids = make_worlds()
    assert ids.tolist() == (1 + np.arange(WORLDS * EACH)).reshape(WORLDS, EACH).tolist()
    assert scene.instances(mesh) == ids.ravel().tolist()
    assert [scene.world(i) for i in ids[:, 1]] == list(range(WORLDS))
    assert scene.world(0) == raysheaf.ALL_WORLDS
    assert scene.transform(ids[3, 2])[2, 3] == 24
    posed = scene.instances(mesh, np.ones((2, 3)), [[0, 0, 0, 1]] * 2, worlds=[7, 8], mask=2)
    assert [scene.world(i) for i in posed] == [7, 8] and scene.mask(posed[1]) == 2
    assert scene.world(scene.instances(mesh, np.eye(4)[None])[0]) == raysheaf.ALL_WORLDS
    assert scene.world(scene.instance(mesh, world=9)) == 9
    scene.set_world(posed[0], 3)
    assert scene.world(posed[0]) == 3
    lone = scene.add(TRIANGLE, world=np.int64(4))
    assert scene.world(scene.instances(lone)[0]) == 4
    assert scene.instances(mesh, []).shape == (0,)


@pytest.mark.parametrize("method", ["dual", "brute"])
def test_rays_see_their_world(method):
    scene, _, ids = make_worlds()
    origins = np.zeros((WORLDS, 4, 3)) + [0, 0, 99]
    down = [0, 0, -1]
    heights = 99 - (np.arange(WORLDS) + 21.0)
    expected = np.broadcast_to(heights[:, None], (WORLDS, 4))

    def same(worlds, wanted):
        asked = {"worlds": worlds, "method": method}
        hits = scene.closest_hit(origins, down, **asked)
        assert hits.t.tolist() == wanted.tolist()
        counts = scene.hit_counts(origins, down, **asked)
        assert (counts == scene.all_hits(origins, down, **asked).counts.reshape(counts.shape)).all()
        assert scene.any_hit(origins, down, t_max=98.5, **asked).tolist() == (wanted < 98.5).tolist()
        return counts

    assert (same(range(WORLDS), expected) == EACH + 1).all()
    same(np.arange(WORLDS), expected)
    same(np.arange(WORLDS)[:, None], expected)
    same(np.repeat(np.arange(WORLDS, dtype=np.uint8), 4).reshape(WORLDS, 4), expected)
    same(np.arange(WORLDS)[::-1], expected[::-1])
    assert (same(2, np.full((WORLDS, 4), heights[2])) == EACH + 1).all()
    same(raysheaf.ALL_WORLDS, np.full((WORLDS, 4), heights.min()))
    assert (same(99, np.full((WORLDS, 4), 99.0)) == 1).all()
    assert (same(None, np.full((WORLDS, 4), heights.min())) == WORLDS * EACH + 1).all()
    hits = scene.closest_hit(origins, down, worlds=range(WORLDS), method=method)
    assert (hits.inst_id == ids[:, 2:]).all()
    # They move.
    matrices = np.tile(np.eye(4), (WORLDS, EACH, 1, 1))
    matrices[..., 2, 3] = -5
    scene.set_transforms(ids, matrices)
    same(range(WORLDS), np.full((WORLDS, 4), 99.0))


@pytest.mark.parametrize("method", ["dual", "brute"])
def test_points_see_their_world(method):
    scene, _, _ = make_worlds()
    points = np.zeros((WORLDS, 2, 3)) + [0, 0, 30]
    distances = 30 - (np.arange(WORLDS) + 21.0)
    asked = {"worlds": range(WORLDS), "method": method}
    assert (scene.closest_point(points, **asked).distance == distances[:, None]).all()
    nearest = scene.nearest(points, 2, **asked).distance
    assert (nearest == distances[:, None, None] + [0, 10]).all()
    # Four of the world's triangles are below, on one of six rays; without them the ground is.
    assert (scene.signed_distance(points, **asked) == -distances[:, None]).all()
    assert scene.contains(points, **asked).all()
    assert not scene.contains(points, worlds=99, method=method).any()
    assert (scene.closest_point(points, worlds=3, method=method).distance == distances[3]).all()


@pytest.mark.parametrize("way", [copy.copy, lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_have_worlds(way):
    scene, _, ids = make_worlds()
    other = way(scene)
    assert [other.world(i) for i in (0, *ids[:, 0])] == [raysheaf.ALL_WORLDS, *range(WORLDS)]
    rays = np.zeros((WORLDS, 1, 3)) + [0, 0, 99], [0, 0, -1]
    mine, theirs = (s.closest_hit(*rays, worlds=range(WORLDS)).array for s in (scene, other))
    assert mine.tobytes() == theirs.tobytes()


@pytest.mark.parametrize(
    "worlds, error, words",
    [
        (range(4), ValueError, r"^worlds: an array of shape \(4,\) .* the first of \(5, 2\)"),
        (np.zeros((5, 2, 1), int), ValueError, r"^worlds: an array of shape \(5, 2, 1\)"),
        (0.5, TypeError, "^worlds: .*float64"),
        ([0, 1, 2, 3, -1], ValueError, "^worlds: a number is not from 0"),
        (2**32, ValueError, "^worlds: a number is not from 0"),
        ("all", TypeError, "^worlds: "),
    ],
)
def test_what_is_refused(worlds, error, words):
    scene, mesh, _ = make_worlds()
    with pytest.raises(error, match=words):
        scene.any_hit(np.zeros((5, 2, 3)), [0, 0, 1], worlds=worlds)
    with pytest.raises(error, match=words):
        scene.contains(np.zeros((5, 2, 3)), worlds=worlds)
    with pytest.raises(error, match=words):
        scene.instances(mesh, np.zeros((5, 2, 3, 4)), worlds=worlds)


def test_wrong_transforms():
    scene, mesh, ids = make_worlds()
    for shape in ((4,), (2, 4, 3), (3, 4)):
        with pytest.raises(ValueError, match="^transforms: "):
            scene.instances(mesh, np.zeros(shape))
    with pytest.raises(raysheaf.InvalidError, match="not finite"):
        scene.instances(mesh, np.full((2, 3, 4), np.nan))
    with pytest.raises(raysheaf.NotFoundError):
        scene.instances(99, np.zeros((2, 3, 4)))
    with pytest.raises(ValueError, match="^transforms: .*equal shapes"):
        scene.set_transforms(ids, np.zeros((EACH, WORLDS, 3, 4)))
    assert scene.instances(mesh) == ids.ravel().tolist()


def test_no_rays():
    scene, _, _ = make_worlds()
    assert scene.closest_hit(np.zeros((WORLDS, 0, 3)), [0, 0, 1], worlds=range(WORLDS)).size == 0
    assert scene.closest_hit(np.zeros((0, 7, 3)), [0, 0, 1], worlds=range(0)).size == 0
