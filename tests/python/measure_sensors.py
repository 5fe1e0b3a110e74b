"""Measures sensors: images, sweeps and worlds a second; and the rays of one origin compared with
MuJoCo's mj_multiRay and Warp on the CPU, if these are installed (`pip install mujoco warp-lang`).

Times are medians of processor time, of all threads; figures are for each second of it.
"""

import argparse
import importlib
import time

import numpy as np

import raysheaf
from raysheaf.bench import wavy_ball
from raysheaf.sensors import DepthCamera, Rangefinders, SpinningLidar, Trajectory


def seconds(work, rounds):
    """The medians of processor time and of wall-clock time."""
    times = []
    for _ in range(rounds):
        begin = time.process_time(), time.perf_counter()
        work()
        times.append((time.process_time() - begin[0], time.perf_counter() - begin[1]))
    return np.median(times, axis=0)


def report(name, count, unit, times):
    cpu, wall = count / times
    print(f"{name:34} {cpu:12,.1f} {unit} a second of a core, {wall:12,.1f} by the clock", flush=True)


def ball(triangles):
    vertices, faces = wavy_ball(triangles)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def by_raysheaf(vertices, faces, origin, directions):
    scene = raysheaf.Scene(threads=1)
    scene.add(vertices, faces)
    sensor, pose = Rangefinders(directions), np.eye(4)
    pose[:3, 3] = origin
    return lambda: sensor.scan(scene, pose).range


def by_mujoco(vertices, faces, origin, directions):
    mujoco = importlib.import_module("mujoco")
    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="ball")
    mesh.uservert, mesh.userface = vertices.ravel().tolist(), faces.ravel().tolist()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="ball")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    count = len(directions)
    ids, far, ways = np.zeros(count, np.int32), np.zeros(count), directions.ravel().copy()
    normals = np.zeros(3 * count)

    def ask():
        begin = (model, data, np.asarray(origin, float), ways, None, 1, -1, ids, far)
        try:
            mujoco.mj_multiRay(*begin, normals, count, 1e10)
        except TypeError:  # before MuJoCo 3.4
            mujoco.mj_multiRay(*begin, count, 1e10)
        return np.where(ids < 0, np.inf, far)

    return ask


def by_warp(vertices, faces, origin, directions):
    warp = importlib.import_module("warp")
    warp.config.quiet = True
    warp.init()

    @warp.kernel
    def cast(
        mesh: warp.uint64,
        start: warp.vec3,
        ways: warp.array(dtype=warp.vec3),
        far: warp.array(dtype=float),
    ):
        i = warp.tid()
        found = warp.mesh_query_ray(mesh, start, ways[i], 1.0e6)
        far[i] = warp.inf
        if found.result:
            far[i] = found.t

    points = warp.array(vertices.astype(np.float32), dtype=warp.vec3, device="cpu")
    indices = warp.array(faces.astype(np.int32).ravel(), dtype=int, device="cpu")
    mesh = warp.Mesh(points, indices)
    ways = warp.array(directions.astype(np.float32), dtype=warp.vec3, device="cpu")
    far = warp.zeros(len(directions), dtype=float, device="cpu")
    inputs = [mesh.id, warp.vec3(*map(float, origin)), ways, far]

    def ask():
        warp.launch(cast, dim=len(directions), inputs=inputs, device="cpu")
        assert mesh is not None
        return far.numpy().copy()

    return ask


def compare(rounds, count):
    vertices, faces = ball(82_000)
    rng = np.random.default_rng(1)
    origin = np.array([0.1, 0.2, -3.0])
    directions = np.concatenate([rng.uniform(-0.4, 0.4, (count, 2)), np.ones((count, 1))], axis=1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    print(f"{len(faces)} triangles of a sphere, {count} rays of one origin, one thread")
    ranges = {}
    for name, make in {"raysheaf": by_raysheaf, "mj_multiRay": by_mujoco, "warp": by_warp}.items():
        try:
            work = make(vertices, faces, origin, directions)
        except ImportError as error:
            print(f"{name}: {error.name} is not installed")
            continue
        ranges[name] = work()
        report(name, count / 1e6, "million rays", seconds(work, rounds))
    hit = np.isfinite(ranges["raysheaf"])
    for name, other in ranges.items():
        alike = np.isfinite(other) == hit
        both = hit & alike
        error = np.abs(other[both] - ranges["raysheaf"][both]).max()
        print(f"{name}: {np.count_nonzero(~alike)} rays hit otherwise, ranges differ by {error:.1e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--threads", type=int, default=2)
    given = parser.parse_args()
    scene = raysheaf.Scene(threads=given.threads)
    vertices, faces = wavy_ball(100_000)
    scene.add(vertices, faces)
    outside = np.eye(4)
    outside[2, 3] = -2.4
    camera = DepthCamera([[525, 0, 319.5], [0, 525, 239.5], [0, 0, 1]], (640, 480))

    def image():
        found = camera.scan(scene, outside)
        return found.depth, found.normal, found.geom_id, found.prim_id

    image()
    print(f"{len(faces)} triangles, {given.threads} threads")
    report("depth, normals, ids of 640x480", 1, "images", seconds(image, given.rounds))
    lidar, still = SpinningLidar.with_rings(128), np.eye(4)
    beams = 1800 * 128 / 1e6
    sweep = seconds(lambda: lidar.scan(scene, still).range, given.rounds)
    report("1800x128 beams from a pose", beams, "million beams", sweep)
    drive = Trajectory([0, 0.1], [still, still])
    sweep = seconds(lambda: lidar.scan(scene, drive).range, given.rounds)
    report("1800x128 beams on a trajectory", beams, "million beams", sweep)

    rng = np.random.default_rng(1)
    many = raysheaf.Scene(threads=given.threads)
    mesh = many.add(*ball(1000), place=False)
    turn = np.eye(3)[None].repeat(4096, axis=0)
    poses = np.concatenate([turn, rng.uniform(-0.3, 0.3, (4096, 3, 1))], axis=2)
    ids = many.instances(mesh, poses, worlds=range(4096))
    sensor = Rangefinders(rng.normal(size=(64, 3)))

    def step():
        poses[..., 3] += 1e-3
        many.set_transforms(ids, poses)
        return sensor.scan(many, np.tile(np.eye(4), (4096, 1, 1)), worlds=range(4096)).range

    step()
    report("4096 worlds, moved, 64 beams each", 4096, "worlds", seconds(step, given.rounds))
    compare(given.rounds, 200_000)


if __name__ == "__main__":
    main()
