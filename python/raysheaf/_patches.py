"""Patches: parts of a scene's surface, as triangles in the world."""

from __future__ import annotations

from typing import Any, Iterable, NamedTuple, Optional, Sequence, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._asked import _mirrors
from ._hits import Hits
from ._scene import Scene
from ._sobol import Bits, unit

Doubles = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ROUNDING = 2.0**-21  # of coordinates: some units in the last place of float32


def dots(a: Doubles, b: Doubles) -> Doubles:
    """The scalar products of vectors, (..., 3)."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])


def lifted_off(points: Doubles, normals: Doubles, reach: Any = 0.0, least: float = 0.0) -> Doubles:
    """Points that are in front of their planes in float32, too, also after sums with coordinates
    up to `reach`; they move by 2^-30 of `least` or more."""
    size = np.maximum(np.abs(points), reach)
    lift = ROUNDING * (dots(np.abs(normals), size) + 2.0**-9 * np.maximum(size.max(-1), least))
    return np.asarray(points + normals * lift[..., None])


class Patch(NamedTuple):
    """A part of the surface of a scene: a mesh, some of its triangles, some of its instances.

    >>> from raysheaf.radiation import Patch
    >>> Patch(3, triangles=[0, 1]).mesh
    3
    """

    mesh: SupportsIndex
    """The id that `Scene.add` returned."""
    triangles: Optional[ArrayLike] = None
    """Their numbers, the `prim_id` of hits; None: all."""
    instances: Optional[ArrayLike] = None
    """Ids of the mesh's instances, the `inst_id` of hits; None: all."""


def world_corners(scene: Scene, mesh: int, instance: int) -> Doubles:
    """(m, 3, 3), the triangles of an instance at time 0. Their front is where the corners run
    counter-clockwise: the second and the third are exchanged where the matrix mirrors."""
    matrix = scene.transform(instance)
    vertices = scene.vertices(mesh).astype(np.float64)
    with np.errstate(all="ignore"):  # unused vertices may have any value
        moved = (vertices[:, None, :] * matrix[:, :3].astype(np.float64)).sum(-1) + matrix[:, 3]
    corners: Doubles = moved[scene.triangles(mesh)]
    return corners[:, [0, 2, 1]] if _mirrors(matrix) else corners


class Surfaces:
    """The triangles of some patches, one patch after another, and where they are in the scene."""

    def __init__(self, scene: Scene, patches: Sequence[Patch]) -> None:
        corners: list[Doubles] = []
        ids: list[Ints] = []
        counts: list[int] = []
        whole: dict[tuple[int, int], Doubles] = {}
        for number, patch in enumerate(patches):
            name = f"patches[{number}]"
            mesh = _arrays.integer(patch.mesh, f"{name}.mesh")
            placed = scene.instances(mesh)
            count = scene.triangle_count(mesh)
            prims = _chosen(patch.triangles, f"{name}.triangles", np.arange(count))
            counts.append(0)
            for instance in _chosen(
                patch.instances, f"{name}.instances", np.array(placed)
            ).tolist():
                if (mesh, instance) not in whole:
                    whole[mesh, instance] = world_corners(scene, mesh, instance)
                corners.append(whole[mesh, instance][prims])
                ids.append(np.stack([np.full(len(prims), instance), prims], axis=-1))
                counts[-1] += len(prims)
        self.corners = np.concatenate(corners) if corners else np.zeros((0, 3, 3))
        self.ids = np.concatenate(ids) if ids else np.zeros((0, 2), np.int64)
        self.ends = np.cumsum(counts, dtype=np.int64)
        self.starts = self.ends - counts
        self.owner = np.repeat(np.arange(len(patches)), counts)
        a, b, c = np.moveaxis(self.corners, 1, 0)
        cross = np.cross(b - a, c - a)
        twice = np.linalg.norm(cross, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            self.normals = np.where(twice[:, None] > 0, cross / twice[:, None], 0.0)
        self._upto = np.concatenate([[0.0], np.cumsum(twice / 2)])
        self.areas = self._upto[self.ends] - self._upto[self.starts]
        if not (self.areas > 0).all():
            number = int(np.argmin(self.areas > 0))
            raise ValueError(
                f"patches[{number}]: it has no area; triangles with an area are expected"
            )
        self._normals32 = np.concatenate([self.normals, np.zeros((1, 3))]).astype(np.float32)
        self._find_owners()

    def _find_owners(self) -> None:
        """A table from (inst_id, prim_id) to rows; one more row stands for all others."""
        instances, which = np.unique(self.ids[:, 0], return_inverse=True)
        longest = np.zeros(len(instances), np.int64)
        np.maximum.at(longest, which.reshape(-1), self.ids[:, 1] + 1)
        bases = np.concatenate([[0], np.cumsum(longest)])
        none = len(self.ids)
        self._rows = np.full(bases[-1] + 1, none, np.int64)
        places = bases[which.reshape(-1)] + self.ids[:, 1]
        self._rows[places] = np.arange(none)
        twice = np.flatnonzero(self._rows[places] != np.arange(none))
        if len(twice):
            first, (instance, prim) = twice[0], self.ids[twice[0]].tolist()
            both = sorted(map(int, self.owner[[first, self._rows[places[first]]]]))
            raise ValueError(
                f"patches: triangle {prim} of instance {instance} is in patches {both}; patches "
                "without a triangle in common are expected"
            )
        most = int(instances[-1]) + 2 if len(instances) else 1
        self._begin = np.full(most, bases[-1], np.int64)
        self._length = np.zeros(most, np.int64)
        self._begin[instances], self._length[instances] = bases[:-1], longest

    def seen(self, hits: Hits, directions: NDArray[np.float32]) -> Ints:
        """The patch whose front each ray hits first; -1 for its back, -2 for other triangles, -3
        for nothing."""
        array = hits.array
        instance = np.minimum(array["inst_id"], len(self._begin) - 1)
        prim = array["prim_id"]
        inside = prim < self._length[instance]
        rows = self._rows[np.where(inside, self._begin[instance] + prim, len(self._rows) - 1)]
        owners = np.append(self.owner, -2)[rows]
        normals = self._normals32[rows]
        behind = (normals * directions).sum(-1) >= 0
        found: Ints = np.where(hits.hit, np.where(behind & (owners >= 0), -1, owners), -3)
        return found

    def spread(self, patches: Ints, x: Bits) -> tuple[Doubles, Ints]:
        """Points (n, 3) spread evenly over patches (n,), and their rows, from x (n, 2)."""
        u, v = unit(x[:, 0]), unit(x[:, 1])
        area = self._upto[self.starts[patches]] + u * self.areas[patches]
        rows = np.searchsorted(self._upto, area, side="right") - 1
        rows = np.clip(rows, self.starts[patches], self.ends[patches] - 1)
        size = self._upto[rows + 1] - self._upto[rows]
        with np.errstate(invalid="ignore", divide="ignore"):
            part = np.where(size > 0, (area - self._upto[rows]) / size, 0.0)
        a = np.sqrt(np.clip(part, 0.0, 1.0))  # P. Shirley, C. Wang (1992)
        p, q, r = np.moveaxis(self.corners[rows], 1, 0)
        points: Doubles = p * (1 - a)[:, None] + q * (a * (1 - v))[:, None] + r * (a * v)[:, None]
        return points, rows


def _chosen(given: Any, name: str, known: Ints) -> Ints:
    """Some of the ascending numbers that are known, all of them for None."""
    if given is None:
        return known
    numbers = _arrays.ids(given, name).reshape(-1).astype(np.int64)
    places = np.minimum(np.searchsorted(known, numbers), len(known) - 1)
    wrong = known[places] != numbers if len(known) else np.ones(len(numbers), np.bool_)
    if wrong.any():
        raise ValueError(f"{name}: {numbers[wrong][0]} is given, which the mesh does not have")
    return numbers


def patches_of(scene: Scene, given: Any, name: str) -> list[Patch]:
    """Patches from ids of meshes and `Patch`es."""
    if isinstance(given, (str, bytes, Patch)) or not isinstance(given, Iterable):
        raise TypeError(f"{name}: {given!r} is given; a sequence of meshes or Patches is expected")
    found = []
    for number, one in enumerate(given):
        patch = one if isinstance(one, Patch) else Patch(one)
        mesh = _arrays.integer(patch.mesh, f"{name}[{number}]")
        if mesh not in scene:
            raise ValueError(f"{name}[{number}]: the scene has no mesh {mesh}")
        found.append(Patch(mesh, patch.triangles, patch.instances))
    return found


def frames(normals: Doubles) -> tuple[Doubles, Doubles]:
    """Two unit vectors perpendicular to each unit normal and to each other: T. Duff et al.,
    "Building an Orthonormal Basis, Revisited", JCGT 6 (2017)."""
    x, y, z = np.moveaxis(normals, -1, 0)
    sign = np.copysign(1.0, z)
    a = -1 / (sign + z)
    b = x * y * a
    first = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    return first, np.stack([b, sign + y * y * a, -y], axis=-1)


def cosine_lobe(normals: Doubles, x: Bits) -> NDArray[np.float32]:
    """Directions around normals (n, 3), with a density of cosine / pi, from x (n, 2)."""
    first, second = frames(normals)
    u, angle = unit(x[:, 0]), 2 * np.pi * unit(x[:, 1])
    radius = np.sqrt(u)
    across = first * (radius * np.cos(angle))[:, None] + second * (radius * np.sin(angle))[:, None]
    ways: NDArray[np.float32] = (across + normals * np.sqrt(1 - u)[:, None]).astype(np.float32)
    return ways
