"""Rays of cameras and scanners."""

from __future__ import annotations

import inspect
import math

import numpy as np
import pytest

import raysheaf


def test_a_pinhole_looks_where_it_is_told():
    rays = raysheaf.pinhole((1, 2, 3), (1, 2, -7), fov=90, width=5, height=3)
    assert rays.shape == (3, 5) and rays.t_min == pytest.approx(1e-3)
    assert (rays.origins == [1, 2, 3]).all()
    np.testing.assert_allclose(rays.directions[1, 2], [0, 0, -1], atol=1e-6)
    assert rays.directions[0, 2, 1] > 0 and rays.directions[1, 4, 0] > 0
    np.testing.assert_allclose(rays.directions[..., 2], -1)
    np.testing.assert_allclose(rays.directions[0, :, 1], 2 / 3, rtol=1e-5)  # of tan(45 degrees)


@pytest.mark.parametrize("up, axis", [("z", 2), ((0, 0, 3), 2), ("y", 1), ("-x", 0)])
def test_up(up, axis):
    rays = raysheaf.pinhole((3, 3, 3), (0, 0, 0), up=up, width=3, height=3)
    rise = rays.directions[0, 1] - rays.directions[2, 1]
    assert (rise[axis] < 0) == (up == "-x") and rise[axis] != 0


def test_parallel_rays():
    rays = raysheaf.orthographic((0, 5, 0), (0, 0, 0), up="z", size=3, width=6, height=3)
    np.testing.assert_allclose(rays.directions, np.broadcast_to([0, -1, 0], (3, 6, 3)), atol=1e-6)
    assert np.ptp(rays.origins[..., 2]) == pytest.approx(2)
    assert np.ptp(rays.origins[..., 0]) == pytest.approx(5)


def test_depth():
    scene = raysheaf.Scene()
    scene.add([[-99, -99, -4], [99, -99, -4], [0, 99, -4]])
    depth = scene.closest_hit(raysheaf.pinhole((0, 0, 1), (0, 0, 0), width=8, height=8)).t
    np.testing.assert_allclose(depth, 5, rtol=1e-6)


def test_a_scanner():
    beams = raysheaf.lidar(
        (1, 0, 0), azimuth=[0, 90], elevation=[0, 30, 90], up="y", forward=(0, 0, 2), t_max=5
    )
    assert beams.shape == (2, 3) and beams.t_max == 5
    np.testing.assert_allclose(np.linalg.norm(beams.directions, axis=-1), 1, rtol=1e-6)
    np.testing.assert_allclose(beams.directions[0, 0], [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(beams.directions[1, 0], [1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(beams.directions[1, 2], [0, 1, 0], atol=1e-6)
    assert beams.directions[0, 1, 1] == pytest.approx(0.5)
    assert raysheaf.lidar(azimuth=0, elevation=0).shape == (1, 1)
    assert raysheaf.lidar().shape == (360, 16)
    np.testing.assert_allclose(raysheaf.lidar().directions[0, :, 0], 0, atol=1e-7)


def test_up_has_one_default():
    for make in raysheaf.pinhole, raysheaf.orthographic, raysheaf.lidar:
        assert inspect.signature(make).parameters["up"].default == "y"
        assert len(str(inspect.signature(make))) < 500  # help begins with it


def test_rays_are_arrays():
    camera = raysheaf.pinhole((1, 2, 3), (0, 0, 0), width=4, height=3)
    beams = raysheaf.lidar(azimuth=[0, 90], elevation=[0, 10, 20], t_max=5)
    row = camera[1]
    assert row.shape == (4,) and row.camera is None and row.t_min == camera.t_min
    assert np.array_equal(row.directions, camera.directions[1])
    assert camera[..., None, ::2].shape == (3, 1, 2) and camera[0, 0].shape == ()
    some = camera[np.eye(3, 4) > 0]
    assert np.array_equal(some.origins, camera.origins[np.eye(3, 4) > 0])
    assert np.array_equal(camera.reshape(-1).directions, camera.directions.reshape(-1, 3))
    assert camera.reshape((2, 6)).shape == camera.reshape(2, -1).shape == (2, 6)
    both = raysheaf.Rays.join([camera, beams])
    assert both.shape == (18,) and raysheaf.Rays.join([]).shape == (0,)
    assert both.t_max[-1] == 5 and both.t_max[0] == np.inf
    assert np.array_equal(both[12:].reshape(2, 3).directions, beams.directions)
    assert both[-1].t_max == 5
    with pytest.raises(IndexError):
        camera[3]
    with pytest.raises(TypeError, match="^batches: list is given"):
        raysheaf.Rays.join([[1]])


def test_rays_move():
    scene, moved = raysheaf.Scene(), raysheaf.Scene()
    triangle = [[-9, -9, -4], [9, -9, -4], [0, 9, -4]]
    matrix = [[0, -2, 0, 1], [2, 0, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]]
    scene.add(triangle)
    moved.add(triangle, transform=matrix)
    rays = raysheaf.pinhole((0, 0, 1), (0, 0, 0), width=8, height=8)
    there = rays.transformed(matrix)
    np.testing.assert_allclose(
        moved.closest_hit(there).t, scene.closest_hit(rays).t, rtol=1e-6
    )
    assert there.t_min == rays.t_min and there.camera is None


def test_one_side_of_a_size_follows_from_the_camera():
    wide = raysheaf.Camera(aspect_ratio=2)
    assert wide.rays(width=64).shape == (32, 64) and wide.rays(height=64).shape == (64, 128)
    assert raysheaf.Camera().rays(width=64).shape == (64, 64)


def test_rays_are_what_queries_take():
    scene = raysheaf.Scene()
    scene.add([[-9, -9, 2], [9, -9, 2], [0, 9, 2]])
    rays = raysheaf.lidar(up="y", forward="z", azimuth=[0], elevation=[0, 1], t_max=1)
    assert not scene.any_hit(rays).any()
    assert scene.any_hit(rays, t_max=9).all()
    assert scene.hit_counts(*rays).tolist() == [[1, 1]]
    assert scene.all_hits(rays, t_max=math.inf).counts.tolist() == [[1, 1]]
    with pytest.raises(TypeError, match="^directions: Rays have their own"):
        scene.any_hit(rays, [0, 0, 1])


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: raysheaf.pinhole((0, 0, 0), (0, 0, 0)), "^look_at: it is where the camera is"),
        (lambda: raysheaf.pinhole((0, 1, 0), (0, 0, 0)), "^up: the camera looks along it"),
        (lambda: raysheaf.pinhole((0, 0, 1), (0, 0, 0), up="w"), "^up: 'w' is given"),
        (lambda: raysheaf.pinhole((0, 0, 1), (0, 0, 0), fov=180), "^fov: 180 is given"),
        (lambda: raysheaf.pinhole((0, 0, 1), (0, 0, 0), width=0), "^width: 0 is given"),
        (lambda: raysheaf.pinhole((0, 0), (0, 0, 0)), r"^position: \(0, 0\) is given"),
        (lambda: raysheaf.lidar(forward="y"), "^forward: it runs along up"),
        (lambda: raysheaf.lidar(azimuth=np.zeros((2, 2))), r"^azimuth: .*\(2, 2\)"),
        (lambda: raysheaf.Camera(np.zeros((3, 4))).rays(2, 2), "^to_world: the matrix has no"),
        (
            lambda: raysheaf.render("builtin:cornell", camera=raysheaf.lidar()),
            "^camera: Rays of no camera",
        ),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()
