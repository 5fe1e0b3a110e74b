"""``python -m raysheaf.bench --points``: closest points and signed distances per second, compared
with trimesh and Open3D if they are installed.

trimesh needs about a thousand times as long per point, so it answers only every hundredth point.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from . import Scene

Array = NDArray[Any]
_TRIMESH_EVERY = 100

TASK = (
    {"closest": "closest point", "signed": "signed distance"},
    {
        "open3d": "Open3D",
        "trimesh": "trimesh",
        "adapter": "trimesh, raysheaf",
        "scene": "raysheaf.Scene",
    },
    ("open3d", "trimesh"),
    4,
    "distance",
)
"""The fields of `bench.Task` after the points."""


def points_at(count: int) -> Array:
    """In and around the sphere: most are outside, some near its centre, the hardest place."""
    return np.random.default_rng(0).uniform(-1.5, 1.5, (count, 3))


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
            notes.append(f"trimesh answers every {_TRIMESH_EVERY}th point, and its time is scaled")
        except ImportError as error:
            notes.append(f"trimesh's own proximity queries need {error.name}, which is not installed")
        ours = importlib.import_module("raysheaf.trimesh").ProximityQuery
        found["adapter"] = ByTrimesh(
            vertices, faces, lambda mesh: ours(mesh, threads=threads), every=1
        )
    found["scene"] = Ours(vertices, faces, threads)
    return found, notes
