"""``python -m raysheaf.bench --sensors``: rays of one origin, compared with MuJoCo's mj_multiRay,
Warp on the CPU and Open3D if they are installed; then images, sweeps and worlds.

Times are medians of processor time of all threads, of interleaved rounds; figures
are for each second of it. A peer that is slow answers only every nth ray.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.metadata
import platform
import re
import time
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from . import Scene, __version__
from .bench import wavy_ball
from .sensors import DepthCamera, Rangefinders, SpinningLidar, Trajectory

Array = NDArray[Any]
Work = Callable[[], Array]

_MUJOCO_EVERY = 10  # of the rays
_ORIGIN = np.array([0.1, 0.2, -3.0])


def ball(triangles: int) -> tuple[Array, Array]:
    """A sphere of radius 1."""
    vertices, faces = wavy_ball(triangles)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def directions_of(count: int) -> Array:
    """Unit directions in random order, most of which meet the sphere."""
    across = np.random.default_rng(1).uniform(-0.4, 0.4, (count, 2))
    ways = np.concatenate([across, np.ones((count, 1))], axis=1)
    return np.asarray(ways / np.linalg.norm(ways, axis=1, keepdims=True))


def processor(text: str) -> str:
    """The name of the processor, from what Linux says in /proc/cpuinfo."""
    found = re.search(r"model name\s*:\s*(.+)", text)
    return found[1].strip() if found else platform.processor() or platform.machine()


# Programs that find the ranges of rays of one origin: inf for a miss.


def by_raysheaf(vertices: Array, faces: Array, ways: Array, threads: int) -> Work:
    scene = Scene(threads=threads)
    scene.add(vertices, faces)
    sensor, pose = Rangefinders(ways), np.eye(4)
    pose[:3, 3] = _ORIGIN
    return lambda: sensor.scan(scene, pose).range


def by_mujoco(vertices: Array, faces: Array, ways: Array, threads: int) -> Work:
    mujoco = importlib.import_module("mujoco")
    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="ball")
    mesh.uservert, mesh.userface = vertices.ravel().tolist(), faces.ravel().tolist()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="ball")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return lambda: multi_ray(mujoco, model, data, _ORIGIN, ways)[1]


def multi_ray(
    mujoco: Any, model: Any, data: Any, origin: Array, ways: Array
) -> tuple[Array, Array]:
    """The geoms and ranges of mj_multiRay; -1 and inf for misses."""
    count = len(ways)
    ids, far, normals = np.zeros(count, np.int32), np.zeros(count), np.zeros(3 * count)
    given = (model, data, origin, ways.ravel(), None, 1, -1, ids, far)
    try:
        mujoco.mj_multiRay(*given, normals, count, 1e10)
    except TypeError:  # before MuJoCo 3.4
        mujoco.mj_multiRay(*given, count, 1e10)
    return ids, np.where(ids < 0, np.inf, far)


def by_warp(vertices: Array, faces: Array, ways: Array, threads: int) -> Work:
    warp = importlib.import_module("warp")
    warp.config.quiet = True
    warp.init()

    def cast(mesh, start, ways, far):  # type: ignore[no-untyped-def]
        i = warp.tid()
        found = warp.mesh_query_ray(mesh, start, ways[i], 1.0e6)
        far[i] = warp.inf
        if found.result:
            far[i] = found.t

    rows = warp.array(dtype=warp.vec3)
    cast.__annotations__ = {
        "mesh": warp.uint64,
        "start": warp.vec3,
        "ways": rows,
        "far": warp.array(dtype=float),
    }
    kernel = warp.kernel(cast)

    def copied(array: Array, dtype: Any, kind: Any) -> Any:
        return warp.array(array.astype(dtype), dtype=kind, device="cpu")

    mesh = warp.Mesh(copied(vertices, np.float32, warp.vec3), copied(faces.ravel(), np.int32, int))
    far = warp.zeros(len(ways), dtype=float, device="cpu")
    inputs = [mesh.id, warp.vec3(*map(float, _ORIGIN)), copied(ways, np.float32, warp.vec3), far]

    def ask() -> Array:
        warp.launch(kernel, dim=len(ways), inputs=inputs, device="cpu")
        assert mesh is not None  # the kernel knows only its number
        return np.array(far.numpy())

    return ask


def by_open3d(vertices: Array, faces: Array, ways: Array, threads: int) -> Work:
    o3d = importlib.import_module("open3d")
    scene = o3d.t.geometry.RaycastingScene(nthreads=threads)
    tensor = o3d.core.Tensor
    scene.add_triangles(tensor(vertices.astype(np.float32)), tensor(faces.astype(np.uint32)))
    rays = np.concatenate([np.tile(_ORIGIN, (len(ways), 1)), ways], axis=1).astype(np.float32)
    return lambda: np.array(scene.cast_rays(tensor(rays))["t_hit"].numpy())


PEERS = {"raysheaf": by_raysheaf, "mujoco": by_mujoco, "warp-lang": by_warp, "open3d": by_open3d}
NAMES = {"mujoco": "mj_multiRay", "warp-lang": "Warp", "open3d": "Open3D"}


def seconds(works: dict[str, Callable[[], Any]], rounds: int) -> dict[str, float]:
    """The medians of processor time of each, interleaved, after a first round."""
    times: dict[str, list[float]] = {name: [] for name in works}
    for number in range(rounds + 1):
        for name, work in works.items():
            begin = time.process_time()
            work()
            if number > 0:
                times[name].append(time.process_time() - begin)
    return {name: float(np.median(each)) for name, each in times.items()}


def compare(given: argparse.Namespace) -> list[dict[str, Any]]:
    """Rays of one origin at a sphere, in all programs that are installed."""
    vertices, faces = ball(given.triangles)
    ways = directions_of(given.rays)
    works: dict[str, Work] = {}
    counts: dict[str, int] = {}
    versions = {"raysheaf": __version__}
    for name, make in PEERS.items():
        some = ways[:: _MUJOCO_EVERY if name == "mujoco" else 1]
        try:
            works[name], counts[name] = make(vertices, faces, some, given.threads), len(some)
        except ImportError as error:
            print(f"{NAMES[name]}: {error.name or error} is not installed")
            continue
        versions.setdefault(name, importlib.metadata.version(name) if name in NAMES else "")
    print(f"{len(faces)} triangles of a sphere, {len(ways)} rays of one origin in random order")
    ours = works["raysheaf"]()
    differences = {}
    for name, work in works.items():
        mine, theirs = ours[:: len(ways) // counts[name]], work()
        differences[name] = int(np.count_nonzero(np.isfinite(mine) != np.isfinite(theirs)))
    times = seconds(works, given.rounds)
    rows: list[dict[str, Any]] = []
    for name, time_s in times.items():
        rate = counts[name] / time_s
        rows.append(
            {
                "program": name,
                "version": versions[name],
                "rays": counts[name],
                "seconds": time_s,
                "rays_a_second": rate,
                "other_hits": differences[name],
            }
        )
        factor = rows[0]["rays_a_second"] / rate
        print(
            f"{NAMES.get(name, name):34} {rate / 1e6:10.2f} million rays, {factor:5.1f} times as long, "
            f"{differences[name]} other hits",
            flush=True,
        )
    return rows


def robots(count: int) -> str:
    """A model of bodies of all kinds of primitives over a plane, each with a free joint."""
    generator = np.random.default_rng(2)
    kinds = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
    bodies = [
        f'<body pos="{x:.3f} {y:.3f} {z:.3f}"><freejoint/>'
        f'<geom type="{kinds[k % 5]}" size=".3 .2 .25"/></body>'
        for k, (x, y, z) in enumerate(generator.uniform([-6, -6, 0.5], [6, 6, 4], (count, 3)))
    ]
    plane = '<geom type="plane" size="0 0 1"/>'
    return f"<mujoco><worldbody>{plane}{''.join(bodies)}</worldbody></mujoco>"


def own(given: argparse.Namespace) -> list[dict[str, Any]]:
    """Images, sweeps, worlds, and geoms of MuJoCo that all move before each scan."""
    rows: list[dict[str, Any]] = []

    def report(what: str, count: float, unit: str, works: dict[str, Callable[[], Any]]) -> None:
        for name, time_s in seconds(works, given.rounds).items():
            rows.append(
                {"scan": what, "program": name, "count": count, "unit": unit, "seconds": time_s}
            )
            print(f"{what + ', ' + name:34} {count / time_s:10.2f} {unit}", flush=True)

    scene = Scene(threads=given.threads)
    vertices, faces = wavy_ball(100_000)
    scene.add(vertices, faces)
    outside, still = np.eye(4), np.eye(4)
    outside[2, 3] = -2.4
    camera = DepthCamera([[525.0, 0.0, 319.5], [0.0, 525.0, 239.5], [0.0, 0.0, 1.0]], (640, 480))
    lidar, drive = SpinningLidar.with_rings(128), Trajectory([0, 0.1], [still, still])

    def image() -> Any:
        found = camera.scan(scene, outside)
        return found.depth, found.normal, found.geom_id, found.prim_id

    print(f"{len(faces)} triangles of a wavy sphere: a camera outside, a lidar inside")
    report("depth, normals, ids of 640x480", 1, "images", {"raysheaf": image})
    beams = 1800 * 128 / 1e6
    report(
        "1800x128 beams from a pose",
        beams,
        "million beams",
        {"raysheaf": lambda: lidar.scan(scene, still).range},
    )
    report(
        "1800x128 beams on a trajectory",
        beams,
        "million beams",
        {"raysheaf": lambda: lidar.scan(scene, drive).range},
    )

    generator = np.random.default_rng(3)
    hall = Scene(threads=given.threads)
    hall.add(*wavy_ball(55_000))
    mesh = hall.add(*ball(2000), place=False)
    ten = np.zeros((10, 2, 3, 4))
    ten[..., :3] = 0.1 * np.eye(3)
    ten[..., 3] = generator.uniform(-0.5, 0.5, (10, 1, 3))
    ten[:, 1, :, 3] += 0.05
    moving = hall.instances(mesh, ten[:, 0])

    def moved() -> Any:
        hall.set_transforms(moving, ten)
        return lidar.scan(hall, still, moving=(0, 0.1)).range

    def columns() -> None:
        rays = lidar.rays(still)
        for column, part_s in enumerate(np.linspace(0, 1, len(rays.directions))):
            hall.set_transforms(moving, ten[:, 0] + part_s * (ten[:, 1] - ten[:, 0]))
            hall.closest_hit(rays.origins[column], rays.directions[column])

    print("a wavy sphere of 55 000 triangles, and ten instances of 2 000 that stand still or move")
    for name, work in (
        ("still", lambda: lidar.scan(hall, still).range),
        ("they move", moved),
        ("they move, column by column", columns),
    ):
        report(f"1800x128 beams, {name}", beams, "million beams", {"raysheaf": work})

    sphere, triangles = ball(82_000)
    way = np.sin(3 * sphere[:, [1, 2, 0]] + np.arange(3))
    changing = Scene(threads=given.threads)
    shape = changing.add(sphere, triangles)
    print(f"{len(triangles)} triangles of a sphere that changes its shape during each sweep")
    for part in (0.0, 0.001, 0.01, 0.1, 0.5):

        def sweep(end: Array = sphere + 2 * part * way) -> Any:
            changing.update(shape, sphere, end=end)
            return lidar.scan(changing, still, moving=(0, 0.1)).range

        name = f"1800x128 beams, it moves by {100 * part:g} %"
        report(name, beams, "million beams", {"raysheaf": sweep})

    generator = np.random.default_rng(1)
    many = Scene(threads=given.threads)
    mesh = many.add(*ball(1000), place=False)
    turn = np.eye(3)[None].repeat(4096, axis=0)
    poses = np.concatenate([turn, generator.uniform(-0.3, 0.3, (4096, 3, 1))], axis=2)
    ids = many.instances(mesh, poses, worlds=range(4096))
    sensor, places = Rangefinders(generator.normal(size=(64, 3))), np.tile(np.eye(4), (4096, 1, 1))

    def step() -> Any:
        poses[..., 3] += 1e-3
        many.set_transforms(ids, poses)
        return sensor.scan(many, places, worlds=range(4096)).range

    print("4096 worlds of 1000 triangles, all moved, 64 beams each")
    report("64 beams in each world", 4096, "worlds", {"raysheaf": step})

    try:
        mujoco = importlib.import_module("mujoco")
    except ImportError:
        return rows
    adapter = importlib.import_module("raysheaf.mujoco")
    model = mujoco.MjModel.from_xml_string(robots(100))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    followed = adapter.ModelScene(model, threads=given.threads)
    eye, ways = np.array([0.0, 0.0, 2.0]), generator.normal(size=(10_000, 3))

    def ours() -> Any:
        followed.follow(data)
        return followed.multi_ray(eye, ways)

    print("a plane and 100 primitives of MuJoCo that all move, 10 000 rays of one origin")
    report(
        "10 000 rays after a step",
        1e-2,
        "million rays",
        {"raysheaf": ours, "mujoco": lambda: multi_ray(mujoco, model, data, eye, ways)},
    )
    return rows


def measured(given: argparse.Namespace) -> dict[str, Any]:
    """Prints all figures, and returns them for the file."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            name = processor(file.read())
    except OSError:
        name = processor("")
    print(f"raysheaf {__version__}, {given.threads} threads, {name}")
    print(f"for each second of processor time, medians of {given.rounds} interleaved rounds")
    return {
        "command": f"python -m raysheaf.bench --sensors --triangles {given.triangles} "
        f"--rays {given.rays} --threads {given.threads}",
        "processor": name,
        "threads": given.threads,
        "rounds": given.rounds,
        "triangles": given.triangles,
        "one_origin": compare(given),
        "scans": own(given),
    }
