"""Positions, normals, texture coordinates and sides of hits."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

TRIANGLE = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1]], np.float32)
UP = [0.25, 0.5, 0], [0, 0, 1]


def crowd(seed: int):
    """A soup, twice, once mirrored, and rays through it."""
    setting = make_setting(seed)
    scene = raysheaf.Scene()
    mesh = scene.add(setting.vertices, setting.triangles)
    scene.instance(mesh, np.diag([-2, 1, 1, 1]))
    return scene, setting


@pytest.mark.parametrize("seed", [1, 2])
def test_positions_lie_on_rays_and_normals_across_triangles(seed):
    scene, setting = crowd(seed)
    hits = scene.closest_hit(setting.origins, setting.directions)
    met = hits.hit
    there = setting.origins + hits.t[:, None] * setting.directions
    np.testing.assert_allclose(hits.position[met], there[met], atol=2e-5)
    assert np.isnan(hits.position[~met]).all() and np.isnan(hits.normal[~met]).all()
    matrices = np.stack([scene.transform(i) for i in hits.inst_id[met]])
    corners = setting.vertices[setting.triangles[hits.prim_id[met]]].astype(np.float64)
    a, b, c = np.moveaxis(
        np.einsum("nij,nkj->nki", matrices[:, :, :3], corners) + matrices[:, None, :, 3], 1, 0
    )
    across = np.cross(b - a, c - a) * np.where(hits.inst_id[met] == 1, -1, 1)[:, None]
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    np.testing.assert_allclose(hits.geometric_normal[met], across, atol=1e-6)
    assert np.array_equal(hits.normal[met], hits.geometric_normal[met])
    front = np.sum(across * setting.directions[met], axis=1) < 0
    assert np.array_equal(hits.front[met], front) and not hits.front[~met].any()
    assert np.array_equal(hits.side, np.where(met, np.where(hits.front, 1, -1), 0))
    assert 0.2 < front.mean() < 0.8


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("packed", [False, True])
def test_sides_are_those_of_the_query(dtype, packed):
    scene = raysheaf.Scene()
    scene.add(TRIANGLE)
    rays = np.zeros((4, 8), dtype)
    rays[:, :2], rays[:, 6], rays[:, 7] = 0.25, 1, np.inf
    given = (rays,) if packed else (rays[:, :3], rays[:, 4:7])
    hits, rows = scene.closest_hit(*given), scene.all_hits(*given)
    some = hits[1:3]
    rays[:, 4:7] *= -1
    for found in hits, rows.hits, some:
        assert (found.side == -1).all() and not found.front.any()


def test_what_the_mesh_has():
    scene = raysheaf.Scene()
    tilted = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1]], np.float32)
    uv = np.array([[0, 0], [1, 0], [0, 2]], np.float32)
    mesh = scene.add(TRIANGLE, normals=tilted, uv=uv, material=raysheaf.Material())
    hits = scene.closest_hit(*UP)
    assert hits.normal.shape == (3,) and hits.position.shape == (3,)
    expected = np.array([0.25, 0.5, 1]) / np.linalg.norm([0.25, 0.5, 1])
    np.testing.assert_allclose(hits.normal, expected, atol=1e-6)
    assert hits.geometric_normal.tolist() == [0, 0, 1]
    assert hits.uv.tolist() == [0.25, 1.0] and (hits.u, hits.v) == (0.25, 0.5)
    assert hits.material_id == 0
    # Normals move as surfaces do, not as directions; a mirror does not turn them inside.
    scene.set_transform(0, np.diag([1, 1, 4, 1]))
    hits = scene.closest_hit(*UP)
    expected = np.array([0.25, 0.5, 0.25]) / np.linalg.norm([0.25, 0.5, 0.25])
    np.testing.assert_allclose(hits.normal, expected, atol=1e-6)
    scene.set_transform(0, np.diag([1, 1, -1, 1]))
    hits = scene.closest_hit([0.25, 0.5, -5], [0, 0, 1])
    np.testing.assert_allclose(
        hits.normal * [1, 1, -1], [0.25, 0.5, 1] / np.linalg.norm([0.25, 0.5, 1]), atol=1e-6
    )
    assert hits.geometric_normal.tolist() == [0, 0, -1] and hits.front
    # Another mesh has none of it.
    scene.add(TRIANGLE + [0, 5, 0])
    hits = scene.closest_hit([[0.25, 0.5, -5], [0.25, 5.5, -5]], [0, 0, 1])
    assert np.isnan(hits.uv[1]).all() and not np.isnan(hits.uv[0]).any()
    assert hits.material_id.tolist() == [0, raysheaf.INVALID_ID]
    np.testing.assert_array_equal(hits.normal[1], [0, 0, 1])


def test_values_of_vertices():
    scene = raysheaf.Scene()
    mesh = scene.add(TRIANGLE)
    hits = scene.closest_hit([[0.25, 0.5, 0], [9, 9, 0]], [0, 0, 1])
    assert hits.interpolate(np.float32([1, 2, 3])).dtype == np.float32
    colors = hits.interpolate({mesh: np.eye(3)})
    np.testing.assert_allclose(colors[0], [0.25, 0.25, 0.5])
    assert np.isnan(colors[1]).all()
    np.testing.assert_allclose(hits.interpolate(scene.vertices(mesh))[0], hits.position[0])
    other = scene.add(TRIANGLE + [9, 9, 0])
    both = scene.closest_hit([[0.25, 0.5, 0], [9.25, 9.25, 0]], [0, 0, 1])
    with pytest.raises(TypeError, match=r"^values: one array is given for hits of meshes \[0, 1\]"):
        both.interpolate([1, 2, 3])
    found = both.interpolate({mesh: [1, 1, 1], other: [2, 2, 2]})
    assert found.tolist() == [1, 2]
    assert np.isnan(both.interpolate({mesh: [1, 1, 1]})[1])
    with pytest.raises(
        ValueError, match=r"^values: an array of shape \(2,\) is given; one with a row"
    ):
        both[:1].interpolate([1, 2])
    with pytest.raises(ValueError, match="rows of shapes"):
        both.interpolate({mesh: [1, 1, 1], other: np.eye(3)})
    with pytest.raises(ValueError, match=r"^values\[7\]"):
        both.interpolate({7: [1]})


def test_every_form_of_rays_and_indices():
    scene, setting = crowd(3)
    origins, directions = setting.origins.reshape(3, 100, 3), setting.directions.reshape(3, 100, 3)
    whole = scene.closest_hit(origins, directions)
    front, position = whole.front, whole.position
    packed = np.zeros((3, 100, 8), np.float32)
    packed[..., :3], packed[..., 4:7], packed[..., 7] = origins, directions, np.inf
    assert np.array_equal(scene.closest_hit(packed).front, front)
    far = scene.closest_hit(origins.astype(np.float64), np.asfortranarray(directions, np.float64))
    assert np.array_equal(far.front, front)
    out = raysheaf.Hits.empty((3, 100))
    scene.closest_hit(packed, out=out)
    assert np.array_equal(out.front, front)
    for index in [
        1,
        (1, 2),
        slice(1, 3),
        (slice(None), 4),
        ...,
        whole.hit,
        np.array([2, 0]),
        (1, [3, 4]),
    ]:
        assert np.array_equal(whole[index].front, front[index])
        np.testing.assert_array_equal(whole[index].position, position[index])
    assert np.array_equal(whole[1][5:9][::-1].front, front[1][5:9][::-1])
    assert [bool(one.front) for one in whole[2]] == front[2].tolist()
    chosen = whole.hit.copy()
    some = whole[chosen]
    chosen[:] = False
    assert np.array_equal(some.front, front[whole.hit])
    one = scene.closest_hit(origins, [1, 2, 3])
    assert np.array_equal(
        one.front, scene.closest_hit(origins, np.broadcast_to([1, 2, 3], (3, 100, 3))).front
    )
    rows = scene.all_hits(origins, directions)
    assert rows.hits.position.shape == (rows.hits.size, 3)
    for i in range(3):
        for k in range(0, 100, 17):
            if whole.hit[i, k]:
                assert rows[i, k][0].front == front[i, k]
                assert np.array_equal(rows[i, k].front[0], front[i, k])
    assert scene.closest_hit(np.zeros((0, 3)), [0, 0, 1]).position.shape == (0, 3)


def test_the_scene_must_be_as_it_was():
    scene = raysheaf.Scene()
    mesh = scene.add(TRIANGLE)
    hits = scene.closest_hit(*UP)
    scene.commit()
    assert hits.position.tolist() == [0.25, 0.5, 1]
    scene.update(mesh, TRIANGLE + 1)
    for ask in ("position", "normal", "front", "side", "uv", "material_id", "geometric_normal"):
        with pytest.raises(
            raysheaf.Error, match="^hits: the scene has changed since it was asked"
        ) as caught:
            getattr(hits, ask)
        assert caught.value.code == "wrong_state"
    for other in (
        pickle.loads(pickle.dumps(hits)),
        raysheaf.Hits(hits.array),
        raysheaf.Hits.empty(2),
    ):
        with pytest.raises(TypeError, match="^hits: the scene that was asked is not known"):
            other.position
    hits = scene.closest_hit(UP[0], UP[1])
    with pytest.raises(raysheaf.InvalidError):
        scene.update(mesh, TRIANGLE[:2])  # refused: nothing has changed
    assert not hits.hit and np.isnan(hits.position).all()


@pytest.mark.parametrize("offset", [0, 1e3, 1e5])
def test_rays_that_go_on_leave_their_surface(offset):
    setting = make_setting(9)
    scene = raysheaf.Scene()
    scene.add(setting.vertices + np.float32(offset), setting.triangles)
    hits = scene.closest_hit(setting.origins + np.float32(offset), setting.directions)
    some = hits[hits.hit]
    rng = np.random.default_rng(0)
    ways = rng.normal(size=(some.size, 3)).astype(np.float32)
    starts = some.start(ways)
    assert np.abs(starts - some.position).max() <= 3e-7 * (1 + offset) * 2
    rows = scene.all_hits(starts, ways)
    own = rows.hits.prim_id == some.prim_id[rows.ray_id]
    assert not own.any()
    many = some[:, None].start(np.broadcast_to(ways, (2, *ways.shape)).transpose(1, 0, 2))
    assert many.shape == (some.size, 2, 3)
