"""``python -m raysheaf.bench --points``: closest points and signed distances per second, compared
with trimesh and Open3D if they are installed.

trimesh needs about a thousand times as long per point, so it answers only every hundredth point.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import platform
import statistics
import time
from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from . import Scene, __version__

Array = NDArray[Any]
KINDS = {"closest": "closest point", "signed": "signed distance"}
NAMES = {
    "open3d": "Open3D",
    "trimesh": "trimesh",
    "adapter": "trimesh, raysheaf",
    "scene": "raysheaf.Scene",
}
PEERS = ("open3d", "trimesh")
_TRIMESH_EVERY = 100


class Ours:
    """The scene itself."""

    every = 1

    def __init__(self, vertices: Array, faces: Array, threads: int) -> None:
        self._scene = Scene(threads=threads)
        self._mesh = self._scene.add(vertices, faces)

    def move(self, vertices: Array) -> None:
        self._scene.update(self._mesh, vertices)

    def ask(self, kind: str, points: Array) -> float:
        if kind == "closest":
            return float(self._scene.closest_point(points).distance.mean())
        return float(self._scene.signed_distance(points).mean())


class ByTrimesh:
    """trimesh's interface, by its own query or ours."""

    def __init__(
        self, vertices: Array, faces: Array, query: Callable[[Any], Any], every: int
    ) -> None:
        trimesh = importlib.import_module("trimesh")
        self._mesh = trimesh.Trimesh(vertices, faces, process=False)
        self._query = query(self._mesh)
        self.every = every

    def move(self, vertices: Array) -> None:
        self._mesh.vertices = vertices

    def ask(self, kind: str, points: Array) -> float:
        if kind == "closest":
            return float(self._query.on_surface(points)[1].mean())
        return -float(self._query.signed_distance(points).mean())


class ByOpen3D:
    """`RaycastingScene`, which is created again for a mesh that has moved."""

    every = 1

    def __init__(self, vertices: Array, faces: Array, threads: int) -> None:
        self._o3d = importlib.import_module("open3d")
        self._faces, self._threads = faces.astype(np.uint32), threads
        self.move(vertices)

    def move(self, vertices: Array) -> None:
        tensor = self._o3d.core.Tensor
        self._scene = self._o3d.t.geometry.RaycastingScene(nthreads=self._threads)
        self._scene.add_triangles(tensor(vertices.astype(np.float32)), tensor(self._faces))

    def ask(self, kind: str, points: Array) -> float:
        asked = self._o3d.core.Tensor(points.astype(np.float32))
        if kind == "closest":
            found = self._scene.compute_closest_points(asked)["points"].numpy()
            return float(np.linalg.norm(found - points, axis=1).mean())
        return float(self._scene.compute_signed_distance(asked).numpy().mean())


def contenders(vertices: Array, faces: Array, threads: int) -> tuple[dict[str, Any], list[str]]:
    """The programs that take part, and a sentence for each that does not."""
    found: dict[str, Any] = {}
    notes = []
    try:
        found["open3d"] = ByOpen3D(vertices, faces, threads)
    except ImportError:
        notes.append("Open3D is not installed, or cannot be imported")
    if importlib.util.find_spec("trimesh") is None:
        notes.append("trimesh is not installed")
    else:
        try:
            for name in ("scipy", "rtree"):
                importlib.import_module(name)
            theirs = importlib.import_module("trimesh.proximity").ProximityQuery
            found["trimesh"] = ByTrimesh(vertices, faces, theirs, _TRIMESH_EVERY)
        except ImportError as error:
            notes.append(f"trimesh's own proximity queries need {error.name}, which is not installed")
        ours = importlib.import_module("raysheaf.trimesh").ProximityQuery
        found["adapter"] = ByTrimesh(
            vertices, faces, lambda mesh: ours(mesh, threads=threads), every=1
        )
    found["scene"] = Ours(vertices, faces, threads)
    return found, notes


@dataclass
class Row:
    """One kind of query, static or moving: seconds for all points, and mean distances."""

    kind: str
    moving: bool
    seconds: dict[str, float]
    distance: dict[str, float]


def measure(who: dict[str, Any], kind: str, frames: list[Array], moving: bool, points: Array) -> Row:
    """Interleaved: one round before the first that counts, then one per frame."""
    times: dict[str, list[float]] = {name: [] for name in who}
    distance = dict.fromkeys(who, 0.0)
    for number, vertices in enumerate(frames):
        for name, one in who.items():
            some = points[:: one.every]
            copied = vertices.copy() if moving else vertices
            begin = time.perf_counter()
            if moving:
                one.move(copied)
            moved = time.perf_counter()
            distance[name] = one.ask(kind, some)
            end = time.perf_counter()
            if number > 0:
                times[name].append(moved - begin + (end - moved) * len(points) / len(some))
    return Row(kind, moving, {name: statistics.median(t) for name, t in times.items()}, distance)


def line_of(row: Row, points: int) -> str:
    """Millions of points a second of each, and how many times the better peer's."""
    peers = [row.seconds[name] for name in PEERS if name in row.seconds]
    cells = []
    for name, seconds in row.seconds.items():
        cell = f"{points / seconds / 1e6:8.4f}"
        if peers and name not in PEERS:
            cell += f" ({min(peers) / seconds:5.1f} x)"
        cells.append(f"{cell:>20}")
    return f"{KINDS[row.kind]:<16} {'moving' if row.moving else 'static':<7}" + "".join(cells)


def run(
    count: int,
    triangles: int,
    threads: int,
    rounds: int,
    mesh: Callable[..., tuple[Array, Array]],
    json_path: Optional[str],
) -> int:
    """Measures everything and prints it. `mesh(triangles, phase)` makes vertices and faces."""
    vertices, faces = mesh(triangles)
    # In and around the sphere: most are outside, some near its centre, which is the hardest place.
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (count, 3))
    who, notes = contenders(vertices, faces, threads)
    for note in notes:
        print(note)
    print(f"raysheaf {__version__}, {Scene(threads=threads).threads} threads, {platform.machine()}")
    print(f"millions of points a second, {count} points, medians of {rounds} interleaved rounds")
    if "trimesh" in who:
        print(f"trimesh answers every {_TRIMESH_EVERY}th point, and its time is scaled")
    print(" " * 24 + "".join(f"{NAMES[name]:>20}" for name in who), flush=True)
    rows = []
    for moving in (False, True):
        frames = [mesh(triangles, 0.3 * f if moving else 0.0)[0] for f in range(rounds + 1)]
        for one in who.values():
            one.move(frames[0])
        for kind in KINDS:
            rows.append(measure(who, kind, frames, moving, points))
            print(line_of(rows[-1], count), flush=True)
    print(f"{len(faces)} triangles; moving: every vertex, before every query")
    if json_path:
        with open(json_path, "w", encoding="utf-8") as file:
            json.dump(
                {
                    "points": count,
                    "triangles": len(faces),
                    "threads": threads,
                    "rounds": rounds,
                    "rows": [vars(row) for row in rows],
                },
                file,
                indent=2,
            )
    return 0
