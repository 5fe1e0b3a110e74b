"""``python -m raysheaf.bench``: queries per second, compared with trimesh and Embree (embreex); with
`--points` closest points and signed distances, compared with trimesh and Open3D; with `--sensors`
rays of one origin, compared with MuJoCo, Warp and Open3D, and scans.

Three columns answer the same rays on the same mesh, interleaved in one process: trimesh with
embreex, trimesh with raysheaf, and `raysheaf.Scene` itself. Each figure is the median of the
rounds. The mesh is a wavy sphere. "moving": every vertex moves between any two queries, and the time
includes the cost of the change. Incoherent rays are the hardest; `--batch` selects more common ones.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import json
import math
import platform
import statistics
import sys
import time
from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from . import Error, Scene, __version__
from ._device import Device

Array = NDArray[Any]


@dataclass
class Task:
    """A measurement: the queries and the contenders that answer them."""

    unit: str  # "rays"
    items: tuple[Array, ...]  # the arguments of a query
    kinds: dict[str, str]  # the queries, by the words that contenders take
    names: dict[str, str]  # of contenders
    peers: tuple[str, ...]  # figures are compared with the fastest of these
    digits: int  # behind the point of a figure
    answer: str  # what contenders return: "hits"

    @property
    def count(self) -> int:
        return len(self.items[0])

    @property
    def width(self) -> int:
        return 1 + max(map(len, self.kinds.values()))


RAY_KINDS = {"first": "first hit", "any": "any hit", "all": "all hits"}
RAY_NAMES = {
    "embreex": "trimesh, embreex",
    "adapter": "trimesh, raysheaf",
    "scene": "raysheaf.Scene",
}


@dataclass
class Where:
    """The threads and the device that raysheaf uses."""

    threads: int = 0
    device: Device = "cpu"


def wavy_ball(triangles: int, phase: float = 0.0) -> tuple[Array, Array]:
    """A closed mesh of about `triangles` triangles, a sphere of radius 1 with waves of 0.1."""
    rings = max(3, round((triangles / 4) ** 0.5))
    columns = 2 * rings
    u = np.arange(columns) / columns * 2 * np.pi
    v = np.arange(1, rings + 1)[:, None] / (rings + 1) * np.pi
    radius = 1 + 0.1 * np.sin(7 * u + phase) * np.sin(v) ** 2 * np.cos(5 * v - phase)
    body = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v) + 0 * u], axis=-1)
    poles = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    vertices = np.concatenate([(radius[..., None] * body).reshape(-1, 3), poles])
    corner = np.arange(rings * columns).reshape(rings, columns)
    right = np.roll(corner, -1, axis=1)
    top, bottom = np.full(columns, len(vertices) - 2), np.full(columns, len(vertices) - 1)
    faces = [
        np.stack([corner[:-1], corner[1:], right[:-1]], axis=-1).reshape(-1, 3),
        np.stack([right[:-1], corner[1:], right[1:]], axis=-1).reshape(-1, 3),
        np.stack([top, corner[0], right[0]], axis=-1),
        np.stack([bottom, right[-1], corner[-1]], axis=-1),
    ]
    return vertices, np.concatenate(faces)


def rays_at(count: int, seed: int = 0) -> tuple[Array, Array]:
    """Incoherent rays from a sphere around the mesh to points near it: most of them hit."""
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = rng.uniform(-0.8, 0.8, (count, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return origins, directions


def rays_of_camera(count: int) -> tuple[Array, Array]:
    """Rays through the pixels of a square image that the mesh fills, row by row."""
    side = max(1, round(count**0.5))
    x, y = np.meshgrid(np.linspace(-0.32, 0.32, side), np.linspace(0.32, -0.32, side))
    directions = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.tile([0.0, 0.0, 3.0], (len(directions), 1)), directions


def rays_of_sweep(count: int, rings: int = 64) -> tuple[Array, Array]:
    """Rays of a rotating scanner inside the mesh: rings with elevations of up to 23 degrees, one by
    one."""
    around = np.linspace(0, 2 * np.pi, max(1, round(count / rings)), endpoint=False)
    turn, rise = np.meshgrid(around, np.linspace(-0.4, 0.4, rings))
    directions = np.stack(
        [np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)], axis=-1
    ).reshape(-1, 3)
    return np.zeros_like(directions), directions


BATCHES: dict[str, Callable[[int], tuple[Array, Array]]] = {
    "scattered": rays_at,
    "camera": rays_of_camera,
    "sweep": rays_of_sweep,
}


class Direct:
    """`raysheaf.Scene`, used directly with numpy."""

    every = 1

    def __init__(self, vertices: Array, faces: Array, where: Where) -> None:
        self._scene = Scene(threads=where.threads, device=where.device)
        self._mesh = self._scene.add(vertices, faces)

    def move(self, vertices: Array) -> None:
        self._scene.update(self._mesh, vertices)

    def ask(self, kind: str, origins: Array, directions: Array) -> int:
        if kind == "first":
            return int(np.count_nonzero(self._scene.closest_hit(origins, directions).hit))
        if kind == "any":
            return int(np.count_nonzero(self._scene.any_hit(origins, directions)))
        return self._scene.all_hits(origins, directions).hits.size


class ByTrimesh:
    """trimesh's interface, with either engine."""

    every = 1

    def __init__(self, vertices: Array, faces: Array, engine: Callable[[Any], Any]) -> None:
        trimesh = importlib.import_module("trimesh")
        self._mesh = trimesh.Trimesh(vertices, faces, process=False)
        self._ray = engine(self._mesh)

    def move(self, vertices: Array) -> None:
        self._mesh.vertices = vertices

    def ask(self, kind: str, origins: Array, directions: Array) -> int:
        if kind == "first":
            return int(np.count_nonzero(self._ray.intersects_first(origins, directions) >= 0))
        if kind == "any":
            return int(np.count_nonzero(self._ray.intersects_any(origins, directions)))
        return len(self._ray.intersects_location(origins, directions)[0])


def contenders(vertices: Array, faces: Array, where: Where) -> tuple[dict[str, Any], list[str]]:
    """The contenders, and a sentence for each one that is not available."""
    found: dict[str, Any] = {}
    notes = []
    if importlib.util.find_spec("trimesh") is None:
        notes.append("trimesh is not installed: only raysheaf.Scene is measured")
    else:
        if importlib.util.find_spec("embreex") is None:
            notes.append("embreex is not installed: trimesh runs without its Embree back end")
        else:
            peer = importlib.import_module("trimesh.ray.ray_pyembree").RayMeshIntersector
            found["embreex"] = ByTrimesh(vertices, faces, peer)
        ours = importlib.import_module("raysheaf.trimesh").RayMeshIntersector
        found["adapter"] = ByTrimesh(
            vertices, faces, lambda mesh: ours(mesh, threads=where.threads, device=where.device)
        )
    found["scene"] = Direct(vertices, faces, where)
    return found, notes


@dataclass
class Row:
    """One kind of query, static or moving: seconds for all items, and answers of each contender."""

    kind: str
    moving: bool
    seconds: dict[str, float]
    answers: dict[str, float]


def measure(who: dict[str, Any], kind: str, frames: list[Array], moving: bool, task: Task) -> Row:
    """Runs the contenders interleaved: one round to warm up, then one per frame. A contender that
    answers only every nth item has its time scaled."""
    times: dict[str, list[float]] = {name: [] for name in who}
    answers = dict.fromkeys(who, 0.0)
    for number, vertices in enumerate(frames):
        for name, one in who.items():
            some = [item[:: one.every] for item in task.items]
            copied = vertices.copy() if moving else vertices
            begin = time.perf_counter()
            if moving:
                one.move(copied)
            moved = time.perf_counter()
            answers[name] = one.ask(kind, *some)
            asking = time.perf_counter() - moved
            if number > 0:
                times[name].append(moved - begin + asking * task.count / len(some[0]))
    return Row(kind, moving, {name: statistics.median(t) for name, t in times.items()}, answers)


def line_of(row: Row, task: Task) -> str:
    """Each contender's millions of items per second, and its factor to the better peer's."""
    peers = [row.seconds[name] for name in task.peers if name in row.seconds]
    cells = []
    for name, seconds in row.seconds.items():
        cell = f"{task.count / seconds / 1e6:8.{task.digits}f}"
        if peers and name not in task.peers:
            cell += f" ({min(peers) / seconds:5.1f} x)"
        cells.append(f"{cell:>20}")
    kind = f"{task.kinds[row.kind]:<{task.width}}"
    return f"{kind} {'moving' if row.moving else 'static':<7}" + "".join(cells)


def run(task: Task, who: dict[str, Any], triangles: int, rounds: int) -> list[Row]:
    """Measures everything, and prints each row when it is known."""
    rows = []
    for moving in (False, True):
        frames = [wavy_ball(triangles, 0.3 * f if moving else 0.0)[0] for f in range(rounds + 1)]
        for one in who.values():
            one.move(frames[0])
        for kind in task.kinds:
            rows.append(measure(who, kind, frames, moving, task))
            print(line_of(rows[-1], task), flush=True)
    return rows


def whole(text: str) -> int:
    """A whole number, which may be written as 1e6."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if number.is_integer():
        return int(number)
    raise argparse.ArgumentTypeError(f"{text!r} is given; a whole number is expected")


def arguments_of(arguments: Optional[list[str]]) -> argparse.Namespace:
    """Parses the arguments. Anything that would make the run fail later ends it here with exit code
    2."""
    parser = argparse.ArgumentParser(
        prog="python -m raysheaf.bench",
        description="Queries per second of raysheaf, compared with trimesh and Embree in one run.",
    )
    parser.add_argument(
        "--rays", type=whole, default=1_000_000, help="rays per query (default: %(default)s)"
    )
    parser.add_argument(
        "--points",
        action="store_true",
        help="measure closest points and signed distances of --rays points instead, compared with "
        "trimesh and Open3D, on the CPU",
    )
    parser.add_argument(
        "--sensors",
        action="store_true",
        help="measure --rays rays of one origin by the processor time of all threads instead, "
        "compared with MuJoCo, Warp and Open3D, and scans of sensors, on the CPU",
    )
    parser.add_argument(
        "--triangles",
        type=whole,
        default=100_000,
        help="triangles of the mesh (default: %(default)s)",
    )
    parser.add_argument(
        "--threads", type=whole, default=0, help="threads of raysheaf; 0: all cores (default)"
    )
    parser.add_argument(
        "--batch",
        choices=tuple(BATCHES),
        default="scattered",
        help="kind of rays: incoherent, of a camera, or of a scanner (default: %(default)s)",
    )
    parser.add_argument(
        "--device",
        choices=("cpu", "cuda"),
        default="cpu",
        help="device of raysheaf (default: %(default)s)",
    )
    parser.add_argument(
        "--rounds",
        type=whole,
        default=5,
        help="rounds; the medians are printed (default: %(default)s)",
    )
    parser.add_argument("--json", metavar="FILE", help="also write the figures to this file")
    given = parser.parse_args(arguments)
    for name, least in (("rays", 1), ("triangles", 36), ("threads", 0), ("rounds", 1)):
        if getattr(given, name) < least:
            parser.error(f"--{name} must be at least {least}, not {getattr(given, name)}")
    try:
        Scene(threads=given.threads, device=given.device)
    except (Error, ValueError) as error:
        parser.error(str(error))
    if given.json:
        try:
            with open(given.json, "a", encoding="utf-8"):
                pass
        except (OSError, ValueError) as error:
            parser.error(f"--json: {error}")
    return given


def write(path: Optional[str], facts: dict[str, Any]) -> None:
    """Writes what was measured to the file, if there is one."""
    if path:
        with open(path, "w", encoding="utf-8") as file:
            json.dump(facts, file, indent=2)
            file.write("\n")


def main(arguments: Optional[list[str]] = None) -> int:
    given = arguments_of(arguments)
    if given.sensors:
        facts = importlib.import_module("raysheaf._bench_sensors").measured(given)
        write(given.json, facts)
        return 0
    vertices, faces = wavy_ball(given.triangles)
    batch = "cube" if given.points else given.batch
    if given.points:
        points = importlib.import_module("raysheaf._bench_points")
        task = Task("points", (points.points_at(given.rays),), *points.TASK)
        where = Where(given.threads)
        who, notes = points.contenders(vertices, faces, given.threads)
    else:
        rays = BATCHES[given.batch](given.rays)
        task = Task("rays", rays, RAY_KINDS, RAY_NAMES, ("embreex",), 2, "hits")
        where = Where(given.threads, given.device)
        who, notes = contenders(vertices, faces, where)
    for note in notes:
        print(note)
    print(
        f"raysheaf {__version__}, {Scene(threads=given.threads).threads} threads, {where.device}, "
        f"{platform.machine()}"
    )
    print(
        f"millions of {task.unit} a second, {task.count} {task.unit} ({batch}), medians of "
        f"{given.rounds} interleaved rounds"
    )
    header = "".join(f"{task.names[name]:>20}" for name in who)
    print(" " * (task.width + 8) + header, flush=True)
    rows = run(task, who, given.triangles, given.rounds)
    print(f"{len(faces)} triangles; moving: every vertex, before every query")
    facts = {
        task.unit: task.count,
        "batch": batch,
        "triangles": len(faces),
        "threads": given.threads,
        "device": where.device,
        "rounds": given.rounds,
        "rows": [
            {"kind": r.kind, "moving": r.moving, "seconds": r.seconds, task.answer: r.answers}
            for r in rows
        ],
    }
    write(given.json, facts)
    return 0


if __name__ == "__main__":
    sys.exit(main())
