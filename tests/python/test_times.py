"""Instances that move while rays are cast: rays with times."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import raysheaf

SQUARE = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]
FACES = [[0, 1, 2], [0, 2, 3]]


def at(*place):
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, 3] = place
    return matrix


def falling(*heights):
    scene = raysheaf.Scene()
    mesh = scene.add(SQUARE, FACES, place=False)
    one = scene.instance(mesh)
    scene.set_transform(one, [at(0, 0, height) for height in heights])
    return scene, one


def test_each_ray_meets_what_moves_at_its_time():
    scene, one = falling(5, 3, -3)
    times = np.array([[0], [0.25], [0.5], [0.75], [1]])
    hits = scene.closest_hit([1, 0, 10], np.zeros((5, 3, 3)) + [0, 0, -1], times=times)
    assert hits.t[:, 2].tolist() == [5, 6, 7, 10, 13]
    assert hits.position[:, 0, 2].tolist() == [5, 4, 3, 0, -3]
    np.testing.assert_allclose(hits[1].position[2], [1, 0, 4], atol=1e-5)
    assert hits[2:][hits.t[2:] > 9].position[:, 2].tolist() == [0] * 3 + [-3] * 3
    down = [[0, 0, -1]] * 2
    assert scene.any_hit([1, 0, 10], down, t_max=6.5, times=[0.25, 0.5]).tolist() == [True, False]
    assert scene.hit_counts([1, 0, 0.5], [[0, 0, 1]] * 2, times=[0, 1]).tolist() == [1, 0]
    rows = scene.all_hits([1, 0, 10], down, times=[0.5, 0.75])
    assert rows.hits.position[:, 2].tolist() == [3, 0]
    assert scene.closest_hit([0, 0, 10], [0, 0, -1]).t == 5
    assert scene.closest_point([0, 0, 6]).distance == 1
    assert scene.transforms(one).shape == (3, 3, 4)
    assert scene.transform(one)[2, 3] == 5
    scene.set_transform(one, at(0, 0, 1))
    assert scene.closest_hit([0, 0, 10], [0, 0, -1], times=0.5).t == 9
    assert len(scene.transforms(one)) == 1


def test_times_are_those_of_scenes_that_stand_still():
    generator = np.random.default_rng(1)
    vertices = generator.normal(size=(60, 3)).astype(np.float32)
    scene, still = raysheaf.Scene(), raysheaf.Scene()
    for one in (scene, still):
        mesh = one.add(vertices, place=False)
        ids = one.instances(mesh, np.tile(np.eye(3, 4), (4, 1, 1)), worlds=[0, 1, 0, 1])
    matrices = generator.normal(size=(4, 3, 3, 4)).astype(np.float32)
    scene.set_transforms(ids, matrices)
    rays = generator.normal(size=(40, 8, 2, 3))
    times = (generator.integers(0, 9, 40) / 8)[:, None]
    worlds = generator.integers(0, 2, (40, 8))
    hits = scene.closest_hit(rays[:, :, 0], rays[:, :, 1], times=times, worlds=worlds)
    brute = scene.closest_hit(
        rays[:, :, 0], rays[:, :, 1], times=times, worlds=worlds, method="brute"
    )
    assert hits.hit.any() and (hits.array == brute.array).all()
    for row, time in enumerate(times[:, 0]):
        j = min(int(2 * time), 1)
        f = 2 * time - j
        wide = matrices.astype(np.float64)
        still.set_transforms(ids, ((1 - f) * wide[:, j] + f * wide[:, j + 1]).astype(np.float32))
        there = still.closest_hit(rays[row, :, 0], rays[row, :, 1], worlds=worlds[row])
        assert (there.array == hits[row].array).all()
        for name in ("position", "normal", "front"):
            np.testing.assert_array_equal(getattr(there, name), getattr(hits[row], name))


def test_copies_and_pickles_move():
    scene, _ = falling(5, 3)
    for other in (scene.copy(), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        hits = other.closest_hit([0, 0, 10], [[0, 0, -1]] * 3, times=[0, 0.5, 1])
        assert hits.t.tolist() == [5, 6, 7]


def test_normals_of_vertices_turn_with_the_instance(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text(
        "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nvn 0 0.6 0.8\nf 1//1 2//1 3//1\n", encoding="utf-8"
    )
    scene = raysheaf.load(path)
    one = scene.instances(0)[0]
    turned = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], np.float32)
    scene.set_transform(one, [np.eye(4), turned])
    hits = scene.closest_hit([1, -1, 5], [[0, 0, -1]] * 2, times=[0, 1])
    np.testing.assert_allclose(hits.normal[0], [0, 0.6, 0.8], atol=1e-6)
    hits = scene.closest_hit([1, 1, 5], [[0, 0, -1]] * 2, times=[0, 1])
    np.testing.assert_allclose(hits.normal[1], [-0.6, 0, 0.8], atol=1e-6)


@pytest.mark.parametrize(
    "times, error, words",
    [
        ([0, 1, 2], ValueError, r"times\[2\]: 2"),
        (-0.5, ValueError, "times: -0.5 is given; a number from 0 to 1"),
        (np.nan, ValueError, "times: nan"),
        ([0, 1], ValueError, r"shape \(2,\) is given; one that broadcasts to \(3,\)"),
        ("now", TypeError, "times: "),
    ],
)
def test_wrong_times_are_named(times, error, words):
    scene, _ = falling(5, 3)
    with pytest.raises(error, match=words):
        scene.closest_hit([[0, 0, 10]] * 3, [0, 0, -1], times=times)


def test_wrong_transforms_are_named():
    scene, one = falling(5, 3)
    with pytest.raises(ValueError, match="equal shapes, or one axis of times more"):
        scene.set_transforms([one, one], np.zeros((3, 2, 3, 4)))
    with pytest.raises(ValueError, match="transform: "):
        scene.set_transform(one, np.zeros((2, 3, 3)))
    with pytest.raises(raysheaf.InvalidError, match="not finite"):
        scene.set_transform(one, [np.eye(3, 4), np.eye(3, 4) * np.nan])


def test_vertices_move_while_rays_are_cast():
    generator = np.random.default_rng(2)
    times = generator.normal(size=(3, 60, 3)).astype(np.float32)
    scene, still = raysheaf.Scene(), raysheaf.Scene()
    for one in (scene, still):
        mesh = one.add(times[0], np.arange(60).reshape(-1, 3), uv=times[0, :, :2])
        one.instance(mesh, at(1, 0, 2))
    scene.update(mesh, times)
    scene.set_transform(1, [at(1, 0, 2), at(0, 1, 0)])
    rays = generator.normal(size=(30, 8, 2, 3))
    when = (generator.integers(0, 9, 30) / 8)[:, None]
    for other in (scene, scene.copy(), pickle.loads(pickle.dumps(scene))):
        hits = other.closest_hit(rays[:, :, 0], rays[:, :, 1], times=when)
        brute = other.closest_hit(rays[:, :, 0], rays[:, :, 1], times=when, method="brute")
        assert hits.hit.any() and (hits.array == brute.array).all()
        for row, time in enumerate(when[:, 0]):
            still.update(mesh, scene.vertices(mesh, time), normals=None)
            still.set_transform(1, at(1 - time, time, 2 - 2 * time))
            there = still.closest_hit(rays[row, :, 0], rays[row, :, 1])
            assert (there.array == hits[row].array).all()
            for name in ("position", "normal", "front", "uv"):
                np.testing.assert_array_equal(getattr(there, name), getattr(hits[row], name))
    wide = times.astype(np.float64)
    mixed = (0.75 * wide[0] + 0.25 * wide[1]).astype(np.float32)
    np.testing.assert_array_equal(scene.vertices(mesh, 0.125), mixed)
    np.testing.assert_array_equal(scene.vertices(mesh), times[0])
    scene.update(mesh, times[1], end=times[2])
    np.testing.assert_array_equal(scene.vertices(mesh, 1), times[2])
    scene.update(mesh, times[1].reshape(-1, 3, 3))
    np.testing.assert_array_equal(scene.vertices(mesh, 1), times[1])


def test_wrong_moving_vertices_are_named():
    scene = raysheaf.Scene()
    mesh = scene.add(SQUARE, FACES)
    with pytest.raises(ValueError, match="end: 3 vertices are given; as many as at time 0, 4, are"):
        scene.update(mesh, SQUARE, end=SQUARE[:3])
    with pytest.raises(ValueError, match="normals: they are given for vertices at 2 times"):
        scene.update(mesh, [SQUARE, SQUARE], normals=SQUARE)
    with pytest.raises(raysheaf.InvalidError, match=r"meshes\[0\].times\[1\].positions\[2\]"):
        wrong = np.array([SQUARE, SQUARE], float)
        wrong[1, 2, 0] = np.nan
        scene.update(mesh, wrong)
    with pytest.raises(ValueError, match="vertices: an array of shape"):
        scene.update(mesh, [SQUARE[:2]] * 2)
    with pytest.raises(raysheaf.InvalidError, match="time: the time is not from 0 to 1"):
        scene.vertices(mesh, 2)
