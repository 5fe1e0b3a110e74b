"""Sides, masks of rays, skipped triangles, and the beginnings of rows."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

TRIANGLE = np.array([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], np.float32)


@pytest.mark.parametrize("method", ["dual", "brute"])
@pytest.mark.parametrize("seed", [1, 2])
def test_what_is_chosen_of_all_hits(seed, method):
    setting = make_setting(seed)
    scene = raysheaf.Scene()
    mesh = scene.add(setting.vertices, setting.triangles, mask=1)
    scene.instance(mesh, np.diag([-1, 1, 1, 1]), mask=6)
    rays = setting.origins, setting.directions
    everything = scene.all_hits(*rays)
    front = everything.hits.front
    masks = np.random.default_rng(seed).integers(0, 8, len(setting.origins), dtype=np.int64)
    nearest = scene.closest_hit(*rays)
    instance_masks = np.array([1, 6])[everything.hits.inst_id]
    ray = everything.ray_id
    own = (everything.hits.prim_id == nearest.prim_id[ray]) & (
        everything.hits.inst_id == nearest.inst_id[ray]
    )
    for options, chosen in [
        ({"sides": "front"}, front),
        ({"sides": "back"}, ~front),
        ({"mask": masks}, (instance_masks & masks[ray]) != 0),
        ({"skip": nearest}, ~own),
        (
            {"sides": "back", "mask": masks, "skip": nearest},
            ~front & ~own & ((instance_masks & masks[ray]) != 0),
        ),
    ]:
        counts = np.bincount(ray[chosen], minlength=len(masks))
        rows = scene.all_hits(*rays, method=method, **options)
        assert rows.hits.array.tobytes() == everything.hits.array[chosen].tobytes()
        assert np.array_equal(rows.counts, counts)
        assert np.array_equal(scene.hit_counts(*rays, method=method, **options), counts)
        assert np.array_equal(scene.any_hit(*rays, method=method, **options), counts > 0)
        first = scene.closest_hit(*rays, method=method, **options)
        met = counts > 0
        assert first.array[met].tobytes() == rows.hits.array[rows.offsets[:-1][met]].tobytes()
        assert not first.hit[~met].any()
        if options == {"sides": "front"}:
            assert first.front[met].all()
        two = scene.all_hits(*rays, method=method, most=2, **options)
        assert np.array_equal(two.counts, np.minimum(counts, 2))
        assert all(np.array_equal(a.array, b.array[:2]) for a, b in zip(two, rows))


def test_forms_of_skip_and_masks():
    scene = raysheaf.Scene()
    near, far = scene.add(TRIANGLE, mask=1), scene.add(TRIANGLE + [0, 0, 1], mask=2)
    origins, up = np.zeros((2, 3, 3)), [0, 0, 1]

    def met(**options):
        return scene.closest_hit(origins, up, **options).geom_id

    assert (met(skip=[near, 0]) == far).all()
    assert met(skip=[[[near, 0]], [[far, 0]]]).tolist() == [[far] * 3, [near] * 3]
    assert (met(skip=scene.closest_hit([0, 0, 0], up)) == far).all()
    assert (met(skip=scene.closest_hit(origins, up)) == far).all()
    assert (met(skip=[raysheaf.INVALID_ID] * 2) == near).all()
    assert (met(skip=[near, 7]) == near).all() and (met(skip=np.uint32([9, 0])) == near).all()
    assert met(mask=[2, 1, 0]).tolist() == [[far, near, raysheaf.INVALID_ID]] * 2
    assert (met(mask=np.array(2)) == far).all() and (met(mask=np.int64(2)) == far).all()
    out = scene.closest_hit(origins, up)
    assert (scene.closest_hit(origins, up, skip=out, out=out).geom_id == far).all()
    assert scene.all_hits(origins, up, most=1).counts.tolist() == [[1] * 3] * 2
    assert scene.all_hits(origins, up, most=0).hits.size == 0


@pytest.mark.parametrize(
    "options, error, words",
    [
        ({"sides": "top"}, ValueError, "^sides: 'top' is given"),
        ({"sides": 1}, TypeError, "^sides: 1 is given"),
        ({"mask": [1, 2]}, ValueError, r"^mask: an array of shape \(2,\) is given; .*\(3,\)"),
        ({"mask": [1.0, 2, 3]}, TypeError, "^mask: .*float64"),
        ({"mask": [1, -2, 3]}, ValueError, "^mask: a number is not from 0"),
        ({"skip": [1, 2, 3]}, ValueError, r"^skip: an array of shape \(3,\) is given; .*\(3, 2\)"),
        ({"skip": "own"}, TypeError, "^skip: "),
    ],
)
def test_what_is_refused(options, error, words):
    scene = raysheaf.Scene()
    scene.add(TRIANGLE)
    with pytest.raises(error, match=words):
        scene.any_hit(np.zeros((3, 3)), [0, 0, 1], **options)


def test_wrong_counts():
    scene = raysheaf.Scene()
    scene.add(TRIANGLE)
    for most, error in ((-1, ValueError), ("a", TypeError)):
        with pytest.raises(error, match="^most: "):
            scene.all_hits([0, 0, 0], [0, 0, 1], most=most)
