"""Maps a float64 mesh into a float32 scene: centred, with a size of about 1."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ._scene import Scene

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Followed:
    """A mesh and its representation in the scene."""

    hash: int
    vertices: Floats
    faces: Ints
    corners: Optional[Bools]  # which vertices are corners of faces; None: all
    used: Optional[Bools]  # which of them belong to faces that can be hit; None: all vertices
    met: Ints  # the faces; those that cannot be hit are degenerate
    bounds: Floats  # (2, 3): minimum and maximum of the box of the faces that can be hit
    center: Floats  # of the box
    size: float  # its diagonal
    unit: float  # a power of two, about 1 / size: multiplying by it is exact
    origin: Floats  # the point that is the scene's origin
    scale: float  # length in the scene per length in the mesh

    @property
    def moved(self) -> Floats:
        """The vertices in the scene's space; unused ones lie at its origin."""
        with np.errstate(all="ignore"):
            moved: Floats = (self.vertices - self.origin) * self.scale
        if self.used is not None:
            moved[~self.used] = 0.0
        return moved


def _corners(faces: Ints, count: int) -> Optional[Bools]:
    corners = np.zeros(count, np.bool_)
    corners[faces] = True
    return None if corners.all() else corners


def _box(vertices: Floats, used: Optional[Bools]) -> tuple[Floats, Floats]:
    some = vertices if used is None else vertices[used]
    if not len(some):
        return np.zeros(3), np.zeros(3)
    with np.errstate(all="ignore"):
        return some.min(axis=0), some.max(axis=0)


def followed(
    now: int, vertices: Floats, faces: Ints, centered: bool, old: Optional[Followed]
) -> Followed:
    """The mesh whose hash is `now`; `old` is the previous one, which usually had the same faces.

    Faces with a corner that is not finite are never hit. They do not count for the box, nor do
    vertices without a face.
    """
    count = len(vertices)
    corners: Optional[Bools]
    if old is not None and count == len(old.vertices) and np.array_equal(faces, old.faces):
        faces, corners = old.faces, old.corners
    elif faces.size and (faces.min() < 0 or faces.max() >= count):
        corners = np.zeros(count, np.bool_)  # the scene reports the invalid index
    else:
        corners = _corners(faces, count)
    used, met = corners, faces
    least, most = _box(vertices, used)
    if not (np.isfinite(least).all() and np.isfinite(most).all()):
        finite: Any = np.isfinite(vertices).all(axis=1)
        good: Any = finite[faces].all(axis=1)
        used = np.zeros(count, np.bool_)
        used[faces[good]] = True
        met = np.where(good[:, None], faces, 0)
        least, most = _box(vertices, used)
    with np.errstate(all="ignore"):
        center, size = (least + most) / 2, math.hypot(*(most - least).tolist())
    unit = math.ldexp(1.0, min(-math.frexp(size)[1], 1023)) if 0 < size < math.inf else 1.0
    origin, scale = (center, unit) if centered else (np.zeros(3), 1.0)
    bounds = np.stack([least, most])
    return Followed(
        now, vertices, faces, corners, used, met, bounds, center, size, unit, origin, scale
    )


def hand_over(scene: Scene, new: Followed, old: Optional[Followed]) -> None:
    """Makes `new` the scene's only mesh. The scene contains `old`; None: anything, or no mesh."""
    if 0 not in scene:
        scene.add(new.moved, new.met)
    elif old is not None and (
        new.met is old.met
        or (len(new.vertices) == len(old.vertices) and np.array_equal(new.met, old.met))
    ):
        scene.update(0, new.moved)
    else:
        scene.replace(0, new.moved, new.met)
