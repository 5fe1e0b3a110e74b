"""Sensors: what they measure in scenes whose answers are formulas, and in many worlds at once."""

from __future__ import annotations

import numpy as np
import pytest

import raysheaf
from raysheaf.sensors import (
    DepthCamera,
    HeightScan,
    Rangefinders,
    Raster,
    Rosette,
    SolidStateLidar,
    SpinningLidar,
    Trajectory,
)

BOX = np.array([[-3.0, -4, -1], [5, 6, 2]])
K = np.array([[500.0, 0, 320.5], [0, 480, 230], [0, 0, 1]])
FIVE = [-0.28, 0.07, 0.001, -0.0007, 0.01]
EIGHT = [0.9, 0.3, 0.0004, -0.0006, 0.02, 1.1, 0.45, 0.05]


def box_mesh(low, high):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [f for a, b, c, d in quads for f in ([a, b, c], [a, c, d])]
    return np.asarray(low) + corners * (np.asarray(high) - low), np.array(faces)


def room(**options) -> raysheaf.Scene:
    scene = raysheaf.Scene(**options)
    scene.add(*box_mesh(*BOX))
    return scene


def wall(x: float, size: float = 100.0) -> list[list[float]]:
    """One triangle across x."""
    return [[x, -size, -size], [x, 2 * size, -size], [x, -size, 2 * size]]


def rotation(rng: np.random.Generator) -> np.ndarray:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.linalg.det(turn)


def some_pose(rng: np.random.Generator, spread: float = 0.8) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(rng), rng.uniform(-spread, spread, 3)
    return pose


def at(x: float, y: float, z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def to_walls(origins, directions):
    """The distance to the walls of the room, in lengths of the directions."""
    with np.errstate(divide="ignore"):
        return np.where(directions > 0, BOX[1] - origins, BOX[0] - origins) / directions


def project(points, k, coefficients):
    """OpenCV's projectPoints for points in the camera's frame, as its documentation has it."""
    k1, k2, p1, p2, k3, k4, k5, k6 = np.pad(coefficients, (0, 8 - len(coefficients)))
    x, y = points[..., 0] / points[..., 2], points[..., 1] / points[..., 2]
    r = x**2 + y**2
    a = (1 + k1 * r + k2 * r**2 + k3 * r**3) / (1 + k4 * r + k5 * r**2 + k6 * r**3)
    u = x * a + 2 * p1 * x * y + p2 * (r + 2 * x**2)
    v = y * a + p1 * (r + 2 * y**2) + 2 * p2 * x * y
    return np.stack([k[0, 0] * u + k[0, 2], k[1, 1] * v + k[1, 2]], axis=-1)


SENSORS = {
    "spinning": SpinningLidar(np.linspace(-60, 60, 9), 40, time_offsets=np.arange(9) * 1e-4),
    "raster": SolidStateLidar(Raster(31, 17, fov=(100, 70))),
    "rosette": SolidStateLidar(Rosette(500)),
    "camera": DepthCamera(K / [[10], [10], [1]], (64, 48), FIVE),
    "rangefinders": Rangefinders([[3, 0, 0], [0, 1, 1], [-1, 0.5, 0]], [[0.1, 0, 0]] * 3),
    "cones": SpinningLidar([-20, 10], 30, divergence=0.5, subrays=16),
    "heights": HeightScan((0.8, 0.6), 0.2, above=0.1, align="full"),
}


@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_room(name, seed):
    """Ranges, points, normals and angles in a box, from any pose, are those of formulas."""
    sensor, scene = SENSORS[name], room()
    pose = some_pose(np.random.default_rng(seed))
    scan = sensor.scan(scene, pose, time=2.0)
    rays = sensor.rays(pose, time=2.0)
    beams = rays.shape[: len(scan.shape)]
    assert scan.shape == beams and scan.hit.all() and scan.range.dtype == np.float32
    unit = rays.directions / np.linalg.norm(rays.directions, axis=-1, keepdims=True)
    walls = to_walls(rays.origins, unit)
    far = walls.min(axis=-1)
    if name == "cones":  # a mean over the cone
        np.testing.assert_allclose(scan.range, far.mean(axis=-1), rtol=0.02)
    else:
        np.testing.assert_allclose(scan.range, far, rtol=2e-6)
        np.testing.assert_allclose(scan.position, rays.origins + far[..., None] * unit, atol=1e-5)
        axis = np.argmin(walls, axis=-1)[..., None]
        cosine = np.abs(np.take_along_axis(unit, axis, -1)[..., 0])
        np.testing.assert_allclose(np.cos(np.radians(scan.incidence)), cosine, atol=1e-5)
        np.testing.assert_allclose(scan.intensity, cosine, atol=1e-5)
        assert (np.sum(scan.normal * unit, axis=-1) < 0).all()
        assert np.allclose(np.take_along_axis(np.abs(scan.normal), axis, -1), 1)
    moved = scan.local_position @ pose[:3, :3].T + pose[:3, 3]
    np.testing.assert_allclose(moved, scan.position, atol=1e-5)
    np.testing.assert_allclose(scan.local_normal @ pose[:3, :3].T, scan.normal, atol=1e-5)
    assert (scan.geom_id == 0).all() and (scan.inst_id == 0).all() and (scan.prim_id < 12).all()
    assert scan.time.shape == scan.shape and scan.time.min() == 2.0


def test_rings_over_the_ground():
    scene = raysheaf.Scene()
    scene.add([[-1e4, -1e4, 0], [2e4, -1e4, 0], [-1e4, 2e4, 0]])
    lidar = SpinningLidar(
        [-30, -10, 5],
        8,
        rate=5,
        azimuth_offsets=[0, 10, 0],
        time_offsets=[0, 0, 0.005],
        first_azimuth=90,
        max_range=100,
    )
    scan = lidar.scan(scene, at(0, 0, 2), time=7)
    expected = 2 / np.sin(np.radians([30, 10, 5]))
    np.testing.assert_allclose(scan.range[:, :2], np.broadcast_to(expected[:2], (8, 2)), rtol=1e-5)
    assert not scan.hit[:, 2].any() and np.isinf(scan.range[:, 2]).all()
    assert np.isnan(scan.position[:, 2]).all() and np.isnan(scan.normal[:, 2]).all()
    assert (scan.geom_id[:, 2] == raysheaf.INVALID_ID).all() and (scan.intensity[:, 2] == 0).all()
    angle = np.degrees(np.arctan2(scan.position[..., 1], scan.position[..., 0]))
    np.testing.assert_allclose(angle[[0, 1, 7], 0], [90, 135, 45], atol=1e-3)
    np.testing.assert_allclose(angle[0, 1], 100, atol=1e-3)
    np.testing.assert_allclose(scan.time[:, 0], 7 + np.arange(8) / 40)
    np.testing.assert_allclose(scan.time[:, 2], 7.005 + np.arange(8) / 40)
    ways = lidar.rays().directions[0, 2]  # in 5 ms at 5 turns a second the head turns 9 degrees
    assert np.degrees(np.arctan2(ways[1], ways[0])) == pytest.approx(99, abs=1e-4)
    other = SpinningLidar([0], 4, clockwise=True).rays().directions[1, 0]
    np.testing.assert_allclose(other, [0, -1, 0], atol=1e-6)


@pytest.mark.parametrize("rings", [16, 32, 64, 128])
def test_lidars_by_their_numbers(rings):
    lidar = SpinningLidar.with_rings(rings, rate=20, steps=90)
    scan = lidar.scan(room(), at(0, 0, 0))
    assert scan.shape == lidar.scan_shape == (90, rings) and scan.hit.all()
    assert (np.diff(lidar.elevation) > 0).all() and scan.time.max() < 0.05


def test_patterns():
    raster = SolidStateLidar(Raster(5, 3, fov=(90, 20), duration=0.15))
    ways = raster.rays().directions
    np.testing.assert_allclose(ways[1, 0], [np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-6)
    assert ways[0, 2, 2] == pytest.approx(np.sin(np.radians(10)))
    scan = raster.scan(room())
    np.testing.assert_allclose(scan.time.reshape(-1), np.arange(15) / 100)
    rosette = SolidStateLidar(Rosette(5000, fov=40, duration=0.1))
    one, two = (rosette.rays(time=t).directions for t in (0, 0.1))
    angle = np.degrees(np.arccos(one[:, 0]))
    assert 19.9 < angle.max() < 20.001 and angle.min() < 1
    assert np.abs(one - two).max() > 0.1
    long = SolidStateLidar(Rosette(10_000, fov=40, duration=0.2)).rays().directions
    np.testing.assert_allclose(long, np.concatenate([one, two]), atol=1e-6)


@pytest.mark.parametrize("coefficients", [[], FIVE[:4], FIVE, EIGHT])
def test_pixels_are_those_of_opencv(coefficients):
    camera = DepthCamera(K, (641, 470), coefficients)
    pixels = np.stack(np.meshgrid(np.arange(641.0), np.arange(470.0)), axis=-1)
    ways = camera.directions
    assert ways.shape == (470, 641, 3) and (ways[..., 2] == 1).all()
    assert np.abs(project(ways, K, coefficients) - pixels).max() < 1e-5
    cv2 = pytest.importorskip("cv2")
    rows = (4 * ways.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), K, np.array(coefficients))
    found = cv2.projectPoints(*rows)[0].reshape(pixels.shape)
    assert np.abs(found - pixels).max() < 1e-5


def test_pixels_that_no_point_has():
    """Where the model folds the image, farther pixels have no ray: they are misses."""
    camera = DepthCamera(K, (640, 480), [-0.9, 0, 0, 0])
    u, v = (np.arange(640) - K[0, 2]) / K[0, 0], (np.arange(480)[:, None] - K[1, 2]) / K[1, 1]
    fold = np.sqrt(1 / 2.7)
    seen = np.hypot(u, v) < fold * (1 - 0.9 * fold**2)
    known = np.isfinite(camera.directions[..., 0])
    assert 0 < seen.sum() < seen.size and np.array_equal(known, seen)
    image = camera.scan(room())
    assert np.array_equal(image.hit, seen) and np.isinf(image.range[~seen]).all()
    assert np.isinf(image.depth[~seen]).all() and np.isnan(image.normal[~seen]).all()


def test_images():
    scene = raysheaf.Scene()
    scene.add([[-99, -99, 4], [99, -99, 4], [0, 99, 4]])
    camera = DepthCamera(K, (640, 480), FIVE, far=20)
    image = camera.scan(scene, labels={0: 7})
    np.testing.assert_allclose(image.depth, 4, rtol=1e-6)
    lengths = np.linalg.norm(camera.directions, axis=-1)
    np.testing.assert_allclose(image.range, 4 * lengths, rtol=1e-6)
    assert (image.label == 7).all() and (image.normal == [0, 0, -1]).all()
    assert not DepthCamera(K, (64, 48), far=3.9).scan(scene).hit.any()
    assert not DepthCamera(K, (64, 48), near=4.1).scan(scene).hit.any()
    assert repr(image) == "<raysheaf.sensors.DepthImage of shape (480, 640): 307200 returns of 307200>"


def drive(rng: np.random.Generator, count: int = 5) -> Trajectory:
    return Trajectory(
        np.cumsum(rng.uniform(0.02, 0.05, count)), [some_pose(rng) for _ in range(count)]
    )


@pytest.mark.parametrize("name", [n for n in SENSORS if n not in ("rangefinders", "heights")])
def test_each_beam_starts_where_the_sensor_is(name):
    sensor, scene, moving = SENSORS[name], room(), drive(np.random.default_rng(4), 6)
    if name == "camera":
        sensor = DepthCamera(K / [[10], [10], [1]], (64, 48), FIVE, readout=0.09)
    start = moving.times[0]
    scan = sensor.scan(scene, moving, time=start)
    flat = scan.time.reshape(-1)
    for beam in range(0, flat.size, flat.size // 50):
        still = sensor.scan(scene, moving.at(flat[beam]), time=start)
        for field in "range", "position", "local_position", "normal", "local_normal", "incidence":
            one, other = (
                getattr(x, field).reshape(flat.size, -1)[beam] for x in (scan, still)
            )
            np.testing.assert_allclose(one, other, atol=2e-5 if field != "incidence" else 0.05)


def test_a_drive_towards_a_wall():
    scene = raysheaf.Scene()
    scene.add(wall(10))
    drive = Trajectory([0, 1], [at(0, 0, 0), at(8, 0, 0)])
    beams = SolidStateLidar(Raster(1, 5, fov=(1, 1e-6), duration=1.0))
    np.testing.assert_allclose(beams.scan(scene, drive).range[:, 0], 10 - 8 * np.arange(5) / 5)
    with pytest.raises(ValueError, match=r"^times: 1.1 s is given; .* from 0.0 to 1.0 s"):
        beams.scan(scene, drive, time=0.3)


@pytest.mark.parametrize("angle", [0, 1e-9, 0.1, 3.1, np.pi - 1e-9, np.pi])
def test_between_two_poses(angle):
    """The turn is about one axis, in proportion to time; the origin moves along a line."""
    rng = np.random.default_rng(9)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])

    def turn(by):
        return np.eye(3) + np.sin(by) * cross + (1 - np.cos(by)) * cross @ cross

    first, last = some_pose(rng), some_pose(rng)
    last[:3, :3] = first[:3, :3] @ turn(angle)
    found = Trajectory([3, 5], [first, last]).at([3, 3.5, 5])
    assert np.array_equal(found[0], first[:3])
    np.testing.assert_allclose(found[2], last[:3], atol=1e-9)
    np.testing.assert_allclose(found[1, :, 3], 0.75 * first[:3, 3] + 0.25 * last[:3, 3])
    ways = [first[:3, :3] @ turn(by / 4) for by in (angle, -angle)]
    errors = [np.abs(found[1, :, :3] - way).max() for way in ways]
    assert errors[0] < 1e-8 or (angle > 3.14 and min(errors) < 1e-8)


def test_many_poses_are_many_scans():
    rng, scene = np.random.default_rng(3), room()
    poses = np.stack([[some_pose(rng) for _ in range(3)] for _ in range(2)])
    for name, sensor in SENSORS.items():
        scan = sensor.scan(scene, poses)
        assert scan.shape[:2] == (2, 3), name
        for i in np.ndindex(2, 3):
            one = sensor.scan(scene, poses[i])
            assert np.array_equal(scan.hits[i].array, one.hits.array), name
            assert np.array_equal(scan.range[i], one.range), name
            assert np.allclose(scan.position[i], one.position, atol=1e-6), name
            assert np.allclose(scan.local_normal[i], one.local_normal, atol=1e-6), name


def make_worlds(count: int):
    """One scene of so many worlds, a scene for each of them, and a pose in each."""
    rng = np.random.default_rng(8)
    places = np.tile(np.eye(3, 4), (count, 3, 1, 1))
    places[..., :3] = [[rotation(rng) for _ in range(3)] for _ in range(count)]
    places[..., 3] = rng.uniform(-4, 4, (count, 3, 3))
    poses = np.stack([some_pose(rng) for _ in range(count)])
    corners, faces = box_mesh([-1, -1, -1], [1, 1, 1])
    scene = raysheaf.Scene()
    shared = scene.add(*box_mesh(BOX[0], BOX[1]))
    mesh = scene.add(corners, faces, place=False)
    ids = scene.instances(mesh, places, worlds=range(count))
    single = []
    for i in range(count):
        one = raysheaf.Scene()
        one.add(*box_mesh(BOX[0], BOX[1]))
        one.instances(one.add(corners, faces, place=False), places[i])
        single.append(one)
    assert shared == 0
    return scene, single, poses, ids


@pytest.mark.parametrize("name", SENSORS)
def test_worlds_are_scenes(name):
    scene, single, poses, ids = make_worlds(20)
    sensor = SENSORS[name]
    label = np.concatenate([[5], np.tile([1, 2, 3], 20)])
    scan = sensor.scan(scene, poses, worlds=range(20), labels=label)
    for i, one in enumerate(single):
        alike = sensor.scan(one, poses[i], labels=[5, 1, 2, 3])
        assert np.array_equal(scan.range[i], alike.range)
        assert np.array_equal(scan.prim_id[i], alike.prim_id)
        assert np.array_equal(scan.label[i], alike.label)
        np.testing.assert_allclose(scan.position[i], alike.position, atol=1e-5)
        np.testing.assert_allclose(scan.intensity[i], alike.intensity, atol=1e-5)
    turned = np.array([np.argsort(np.random.default_rng(1).random(20))])[0]
    mixed = sensor.scan(scene, poses[turned], worlds=turned)
    assert np.array_equal(mixed.range, scan.range[turned])


def test_trajectories_in_worlds():
    scene, single, poses, _ = make_worlds(4)
    moves = np.stack([poses, np.roll(poses, 1, axis=0)], axis=1)
    sensor = SENSORS["spinning"]
    scan = sensor.scan(scene, Trajectory([0, 0.2], moves), worlds=range(4))
    assert scan.shape == (4, 40, 9)
    for i, one in enumerate(single):
        alike = sensor.scan(one, Trajectory([0, 0.2], moves[i]))
        assert np.array_equal(scan.range[i], alike.range)
        np.testing.assert_allclose(scan.position[i], alike.position, atol=1e-6)
        np.testing.assert_allclose(scan.normal[i], alike.normal, atol=1e-6)


@pytest.mark.parametrize("deforms", [False, True])
@pytest.mark.parametrize("name", SENSORS)
def test_beams_meet_what_moves_at_their_time(name, deforms):
    scene = raysheaf.Scene()
    begin, faces = box_mesh(*BOX)
    walls = scene.add(begin, faces)
    if deforms:
        move, end = scene.update, box_mesh(*(BOX * [1.3, 1.1, 0.9]))[0]
    else:
        move, begin, end = scene.set_transform, np.eye(3, 4), np.eye(3, 4)
        end[:, 3] = 0.2, -0.1, 0.3
    move(walls, np.stack([begin, end]))
    sensor, pose = SENSORS[name], some_pose(np.random.default_rng(3))
    scan = sensor.scan(scene, pose, time=3.0, moving=(2.5, 4.5))
    normal = scan.normal  # while the scene is as it was asked
    assert scan.hit.all()
    for time in np.unique(scan.time)[::20]:
        move(walls, begin + (end - begin) * (time - 2.5) / 2)
        still = sensor.scan(scene, pose, time=3.0)
        then = scan.time == time
        np.testing.assert_allclose(scan.range[then], still.range[then], rtol=1e-5)
        np.testing.assert_allclose(normal[then], still.normal[then], atol=1e-5)


def test_beams_outside_of_the_motion_are_named():
    scene = raysheaf.Scene()
    scene.add(wall(4))
    sensor = SENSORS["spinning"]
    with pytest.raises(ValueError, match=r"^moving: 0 to 0.01 is given; seconds that hold those"):
        sensor.scan(scene, moving=(0, 0.01))
    with pytest.raises(ValueError, match="^moving: 5 is given; two numbers are expected"):
        sensor.scan(scene, moving=5)


def edge() -> raysheaf.Scene:
    """A wall at 10, and one at 4 that covers the left half of what is ahead."""
    scene = raysheaf.Scene()
    scene.add(wall(10))
    scene.add([[4, 0, -99], [4, 0, 99], [4, 99, 0]])
    return scene


def test_returns():
    beam = {"divergence": 2.0, "subrays": 64, "returns": ("first", "last", "strongest")}
    sensor = Rangefinders([[1, 0, 0], [1, 0.5, 0], [0, 0, 1]], **beam)
    labels, reflectance = {0: 1, 1: 2}, {1: 0.9, 2: 0.5}
    scan = sensor.scan(edge(), labels=labels, reflectance=reflectance)
    assert scan.shape == (3, 3)
    np.testing.assert_allclose(scan.range[0], [4, 10, 10], rtol=1e-3)
    assert scan.label[0].tolist() == [2, 1, 1] and scan.inst_id[0].tolist() == [1, 0, 0]
    np.testing.assert_allclose(scan.intensity[0], [0.25, 0.45, 0.45], rtol=0.04)
    assert np.ptp(scan.range[1]) == 0 and np.isinf(scan.range[2]).all()
    np.testing.assert_allclose(scan.position[0, :, 0], scan.range[0], rtol=1e-5)
    bins = scan.waveform([0, 3, 5, 9, 11])
    assert bins.shape == (3, 4)
    np.testing.assert_allclose(bins[0], [0, 0.25, 0, 0.45], rtol=0.04)
    np.testing.assert_allclose(bins[0].sum(), scan.intensity[0, :2].sum(), rtol=1e-5)
    assert not bins[2].any()
    merged = Rangefinders([[1, 0, 0]], **{**beam, "separation": 7}).scan(edge())
    assert np.ptp(merged.range) == 0 and 6.5 < merged.range[0, 0] < 7.5
    one = Rangefinders([[1, 0, 0]], divergence=2, subrays=64, returns="first").scan(edge())
    assert one.shape == (1,) and one.range[0] == scan.range[0, 0]
    black = sensor.scan(edge(), labels=labels, reflectance={1: 0, 2: 0})
    np.testing.assert_allclose(black.range[0, :2], [4, 10], rtol=1e-3)
    assert not black.intensity.any()


def test_the_waveform_of_a_ray():
    sensor = Rangefinders([[2, 0, 0], [0, 0, 1]])
    found = sensor.scan(edge(), at(0, -1, 0)).waveform([9.9, 10, 10.1])
    np.testing.assert_allclose(found, [[0, 1], [0, 0]], rtol=1e-6)


def test_subrays_fill_their_cone_evenly():
    sensor = Rangefinders([[1, 2, -3], [0, 0, 1]], divergence=10, subrays=500)
    ways = sensor.rays().directions
    axes = np.array([[1, 2, -3], [0, 0, 1]]) / [[np.sqrt(14)], [1]]
    cosine = np.sum(ways * axes[:, None], axis=-1)
    radius = np.tan(np.arccos(np.minimum(cosine, 1))) / np.tan(np.radians(5))
    assert 0.99 < radius.max() < 1.001
    np.testing.assert_allclose(np.mean(radius**2, axis=1), 0.5, atol=0.01)  # of a disc
    np.testing.assert_allclose(np.mean(ways, axis=1), axes, atol=3e-3)


def test_noise_and_drop_out():
    scene = raysheaf.Scene()
    scene.add(wall(10))
    pattern = Raster(200, 100, fov=(20, 20))
    clean = SolidStateLidar(pattern).scan(scene)
    noisy = SolidStateLidar(pattern, noise=[0.01, 0.002], dropout=0.3, max_range=50)
    scan, again, other = (noisy.scan(scene, seed=seed) for seed in (5, 5, 6))
    assert np.array_equal(scan.range, again.range) and not np.array_equal(scan.range, other.range)
    assert 0.68 < scan.hit.mean() < 0.72 and np.array_equal(scan.hit, np.isfinite(scan.range))
    error = (scan.range - clean.range)[scan.hit]
    assert abs(error.mean()) < 1e-3 and error.std() == pytest.approx(0.03, rel=0.03)
    assert np.array_equal(scan.hits.t[scan.hit], clean.hits.t[scan.hit])
    np.testing.assert_allclose(
        np.linalg.norm(scan.position[scan.hit], axis=-1), scan.range[scan.hit], rtol=1e-6
    )
    stream = np.random.default_rng(5)
    first, second = (noisy.scan(scene, seed=stream).range for _ in range(2))
    assert np.array_equal(first, scan.range) and not np.array_equal(first, second)
    short = SolidStateLidar(pattern, noise=1.0, max_range=10.2).scan(scene, seed=1)
    assert short.range[short.hit].max() <= 10.2 and 0.1 < short.hit.mean() < 0.9
    image = DepthCamera(K, (64, 48), noise=[0, 0, 0.001]).scan(
        scene, [[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0]], seed=3
    )
    assert (image.depth - 10).std() == pytest.approx(0.1, rel=0.05)  # grows with the square
    with pytest.raises(TypeError, match="^seed: None is given"):
        noisy.scan(scene)


def test_threads_change_nothing():
    one, two = (
        SENSORS["cones"].scan(room(threads=n), at(0.1, 0.2, 0.3), labels=[1]) for n in (1, 2)
    )
    for field in "range", "intensity", "prim_id", "position":
        assert np.array_equal(getattr(one, field), getattr(two, field))


def stairs(up: int) -> raysheaf.Scene:
    """Ground at 0, and at 0.5 where x is above 0.25; `up` is the axis that is up."""
    scene = raysheaf.Scene()
    low = np.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0.0]])
    high = low + [9.25, 0, 0.5]
    for corners in low, high:
        scene.add(np.roll(corners, up - 2, axis=1), [[0, 1, 2], [0, 2, 3]])
    return scene


@pytest.mark.parametrize("up", [0, 1, 2])
def test_heights(up):
    """A robot that leans measures the same heights, on a grid that turns with its heading."""
    sensor = HeightScan((1.0, 0.4), 0.2, above=0.3, up="xyz"[up])
    order = np.roll(np.eye(3), up - 2, axis=0)  # from a world whose z is up
    heading, lean = np.radians(180), np.radians(25)
    c, s = np.cos(heading), np.sin(heading)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    a, b = np.cos(lean), np.sin(lean)
    tilt = np.array([[a, 0, b], [0, 1, 0], [-b, 0, a]])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = order @ turn @ tilt, order @ [0, 0, 0.6]
    scan = sensor.scan(stairs(up), pose)
    assert scan.shape == scan.height.shape == (6, 3)
    steps = np.where(-np.linspace(-0.5, 0.5, 6) > 0.25, -0.1, -0.6)  # it looks back
    np.testing.assert_allclose(scan.height, np.broadcast_to(steps[:, None], (6, 3)), atol=1e-5)
    np.testing.assert_allclose(scan.position[..., up], scan.height + 0.6, atol=1e-5)
    full = HeightScan((0.2, 0.2), 0.1, align="full").scan(stairs(up), pose)
    assert np.ptp(full.height) > 0.01


def test_a_robot_that_stands_on_its_head():
    pose = at(0, 0, 0.6)
    pose[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # x is up
    heights = HeightScan((0.2, 0.2), 0.1).scan(stairs(2), pose)
    np.testing.assert_allclose(heights.height, -0.6, atol=1e-6)
    np.testing.assert_allclose(heights.position[-1, 1], [0.1, 0, 0], atol=1e-6)


def test_beams_that_see_nothing():
    sensor = Rangefinders([[1, 0, 0], [0, 0, 0], [np.nan, 0, 1]], divergence=1, subrays=4)
    scan = sensor.scan(edge(), at(0, -1, 0))
    assert scan.hit.tolist() == [True, False, False]
    assert np.isnan(sensor.rays().directions[1:]).all()


def test_normals_ask_the_scene_as_it_was():
    scene = room()
    scan = SENSORS["spinning"].scan(scene, at(0, 0, 0))
    later, normal = SENSORS["spinning"].scan(scene, at(0, 0, 0)), scan.normal
    scene.update(0, box_mesh(BOX[0] * 2, BOX[1] * 2)[0])
    assert scan.normal is normal and np.isfinite(scan.incidence).all()
    assert np.array_equal(later.range, scan.range) and np.isfinite(later.position).all()
    with pytest.raises(raysheaf.Error):
        _ = later.incidence


def read_pcd(path):
    head, data = path.read_bytes().split(b"DATA binary\n", 1)
    lines = {line.split()[0]: line.split()[1:] for line in head.decode().splitlines()}
    kinds = [f"<{t.lower()}{s}" for t, s in zip(lines["TYPE"], lines["SIZE"])]
    cloud = np.frombuffer(data, list(zip(lines["FIELDS"], kinds)))
    assert lines["POINTS"] == lines["WIDTH"] == [str(len(cloud))] and set(lines["COUNT"]) == {"1"}
    return cloud


def read_ply(path):
    head, data = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    assert lines[1] == ["format", "binary_little_endian", "1.0"]
    names = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4"}
    cloud = np.frombuffer(data, [(x[2], names[x[1]]) for x in lines if x[0] == "property"])
    assert lines[2] == ["element", "vertex", str(len(cloud))]
    return cloud


@pytest.mark.parametrize("ending, read", [("pcd", read_pcd), ("PLY", read_ply)])
def test_files(tmp_path, ending, read):
    lidar = SpinningLidar([-40, 0, 80], 10, max_range=4.5)
    scan = lidar.scan(room(), at(1, 0, 0), labels=[9])
    seen = scan.hit
    assert 0 < seen.sum() < seen.size
    cloud = scan.cloud()
    names = ("x", "y", "z", "range", "time", "beam", "inst_id", "prim_id", "label")
    assert cloud.dtype.names == names and cloud.shape == (seen.sum(),)
    assert np.array_equal(np.stack([cloud[n] for n in "xyz"], -1), scan.position[seen])
    assert np.array_equal(cloud["beam"], np.flatnonzero(seen)) and (cloud["label"] == 9).all()
    path = tmp_path / f"scan.{ending}"
    scan.save(path)
    assert np.array_equal(read(path), cloud) and read(path).dtype == cloud.dtype
    scan.save(path, ["normal", "position", "pose", "intensity", "incidence"], frame="sensor")
    local = read(path)
    assert np.array_equal(local["x"], scan.local_position[seen][:, 0])
    assert np.array_equal(local["normal_z"], scan.local_normal[seen][:, 2])
    if ending == "PLY":
        trimesh = pytest.importorskip("trimesh")
        found = trimesh.load(str(path), file_type="ply")
        np.testing.assert_allclose(found.vertices, scan.local_position[seen], atol=1e-6)


def test_clouds_of_returns_and_poses():
    sensor = Rangefinders(
        [[1, 0, 0], [0, 0, 1]], divergence=2, subrays=16, returns=["last", "first"]
    )
    cloud = sensor.scan(edge(), [at(0, 0, 0), at(1, 0, 0)]).cloud(["range", "beam", "pose"])
    assert cloud["pose"].tolist() == [0, 0, 1, 1] and not cloud["beam"].any()
    np.testing.assert_allclose(cloud["range"], [10, 4, 9, 3], rtol=1e-3)


class Half:
    def beams(self, start):
        return np.ones((4, 2, 3)), np.zeros(4)


def mirrored():
    return np.diag([1.0, 1, -1, 1])


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: SpinningLidar([[1]]), r"^elevation: .*\(1, 1\) is given; finite numbers of shape"),
        (lambda: SpinningLidar([np.nan]), "^elevation: "),
        (lambda: SpinningLidar([1, 2], time_offsets=[1]), r"^time_offsets: .*\(2,\) are expected"),
        (lambda: SpinningLidar([1], steps=0), "^steps: 0 is given"),
        (lambda: SpinningLidar([1], rate=0), "^rate: 0 is given; a finite number above 0"),
        (lambda: SpinningLidar([1], max_range=-1), "^max_range: -1 is given"),
        (lambda: SpinningLidar([1], min_range=5, max_range=4), "^max_range: 4 is given; .* from 5"),
        (lambda: SpinningLidar([1], subrays=4), "^subrays: 4 of them are given for a divergence"),
        (lambda: SpinningLidar([1], divergence=1), "^subrays: 1 of them are given"),
        (lambda: SpinningLidar([1], returns="second"), "^returns: 'second' is given"),
        (lambda: SpinningLidar([1], returns=["first", "last"]), "^returns: 2 are given for a beam"),
        (lambda: SpinningLidar([1], dropout=1.5), "^dropout: 1.5 is given; .* from 0 to 1"),
        (lambda: SpinningLidar([1], noise=np.inf), "^noise: "),
        (lambda: SpinningLidar.with_rings(20), "^rings: 20 is given; 16, 32, 64 or 128"),
        (lambda: SolidStateLidar(3), "^pattern: 3 is given"),
        (lambda: SolidStateLidar(Half()).rays(), r"^pattern: times of shape \(4,\) are given"),
        (lambda: Raster(4, 0), "^rows: 0 is given"),
        (lambda: Raster(4, 4, fov=3), "^fov: 3 is given; two numbers"),
        (lambda: Rosette(10, fov=-1), "^fov: -1 is given"),
        (lambda: Rangefinders([1, 0, 0]), r"^directions: .*\(n, 3\)"),
        (lambda: Rangefinders([[1, 0, 0]], [[0, 0]]), r"^positions: .*\(n, 3\)"),
        (lambda: DepthCamera(np.eye(4), (4, 4)), r"^matrix: an array of shape \(4, 4\)"),
        (lambda: DepthCamera(K + [[0, 1, 0], [0] * 3, [0] * 3], (4, 4)), r"^matrix: \[\[500.0, 1.0"),
        (lambda: DepthCamera(K, 640), "^size: 640 is given; a width and a height"),
        (lambda: DepthCamera(K, (640, 0)), "^size: 0 is given"),
        (lambda: DepthCamera(K, (4, 4), [1, 2, 3]), r"^distortion: \[1.0, 2.0, 3.0\] is given; 4, 5 or 8"),
        (lambda: DepthCamera(K, (4, 4), near=2, far=1), "^far: 1 is given"),
        (lambda: HeightScan((1, -1)), "^size: -1 is given"),
        (lambda: HeightScan(align="roll"), "^align: 'roll' is given"),
        (lambda: HeightScan(up="w"), "^up: 'w' is given"),
        (lambda: Trajectory([0], [np.eye(4)]), "^times: two or more"),
        (lambda: Trajectory([0, 0], [np.eye(4)] * 2), "^times: two or more, each later"),
        (lambda: Trajectory([0, 1], [np.eye(4)] * 3), r"^poses: .*\(3, 4, 4\) is given for times"),
        (lambda: Trajectory([0, 1], [np.eye(4), mirrored()]), r"^poses\[1\]: .* a rotation"),
        (lambda: SENSORS["raster"].scan(room(), np.zeros(4)), r"^pose: .*\(4,\)"),
        (lambda: SENSORS["raster"].scan(room(), 2 * np.eye(4)), r"^pose: \[\[2.0, .* a rotation and"),
        (lambda: SENSORS["raster"].scan(room(), mirrored()), "^pose: .* a rotation and"),
        (lambda: SENSORS["raster"].scan(room(), at(0, np.nan, 0)), "^pose: .* a rotation and"),
        (lambda: SENSORS["raster"].scan(room(), worlds=[1, 2]), "^worlds: "),
        (lambda: SENSORS["raster"].scan(3), "^scene: int is given"),
        (lambda: SENSORS["raster"].scan(room(), seed=1, labels={0: 0.5}), "^labels: .* a number for"),
        (lambda: SENSORS["raster"].scan(room(), reflectance=[1]), "^reflectance: .* labels"),
        (lambda: SENSORS["raster"].scan(room()).label, "^labels: none were given"),
        (lambda: SENSORS["raster"].scan(room()).cloud(["colour"]), "^fields: 'colour' is given"),
        (lambda: SENSORS["raster"].scan(room()).cloud(frame="moon"), "^frame: 'moon' is given"),
        (lambda: SENSORS["raster"].scan(room()).save("scan.las"), "^path: 'scan.las' is given"),
        (lambda: SENSORS["raster"].scan(room()).waveform([3, 1]), "^edges: two or more"),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises((ValueError, TypeError), match=words):
        call()
