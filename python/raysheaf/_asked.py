"""The question that hits are the answer to: the scene and the rays."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._look import Surface

if TYPE_CHECKING:
    from ._contents import Contents

Floats = NDArray[np.float32]
_WAY = np.dtype([("way", np.float32, (3,))])
_NOBODY = 0xFFFFFFFF


class Asked:
    """A scene as it was when it was asked, the directions of the rays: the shape of the hits, each
    item three floats, and their times, if they had any. Directions are a copy, or are made of one
    when they are needed; None where the rays lie on a device."""

    __slots__ = ("scene", "version", "times", "_make", "_ways")

    def __init__(
        self,
        scene: Contents,
        version: int,
        ways: Union[NDArray[Any], None, Callable[[], Optional[NDArray[Any]]]],
        times: Optional[Floats] = None,
    ) -> None:
        self.scene = scene
        self.version = version
        self.times = times
        self._make = ways if callable(ways) else None
        self._ways = None if callable(ways) else ways

    @property
    def ways(self) -> Optional[NDArray[Any]]:
        """None where the rays lie on a device."""
        if self._make is not None:
            self._ways, self._make = self._make(), None
        return self._ways

    def at(self, index: Any) -> Asked:
        """The question of the hits at an index."""
        kept = _copied(index)

        def make() -> Optional[NDArray[Any]]:
            return None if self.ways is None else np.asarray(self.ways[kept])

        times = None if self.times is None else np.array(self.times[kept])
        return Asked(self.scene, self.version, make, times)

    def of_rows(self, offsets: NDArray[np.int64]) -> Asked:
        """The question of all hits of each ray."""

        def of_rays(array: NDArray[Any]) -> NDArray[Any]:
            return np.repeat(array.reshape(-1), np.diff(offsets))

        def make() -> Optional[NDArray[Any]]:
            return None if self.ways is None else of_rays(self.ways)

        times = None if self.times is None else of_rays(self.times)
        return Asked(self.scene, self.version, make, times)


def _copied(index: Any) -> Any:
    """An index that stays as it is."""
    if isinstance(index, tuple):
        return tuple(map(_copied, index))
    return np.array(index) if isinstance(index, (list, np.ndarray)) else index


def ways_of(directions: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """A copy of directions as items of a batch's shape; what repeats there is copied once."""
    with _arrays.rounding():
        packed = np.array(directions, np.float32, order="C")
    return np.broadcast_to(packed.view(_WAY)[..., 0], shape)


class Points:
    """Positions, normals, corners and sides of hits, one after another."""

    def __init__(self, array: NDArray[np.void], asked: Optional[Asked]) -> None:
        if asked is None:
            raise TypeError(
                "hits: the scene that was asked is not known to hits of another origin: copies, "
                "pickles, and what was filled by hand; those that a query returned are expected"
            )
        self.shape = array.shape
        self._hits = np.ascontiguousarray(array.reshape(-1))
        self._scene, self._asked, self._times = asked.scene, asked, asked.times
        # Read before the points are made, which raises if the scene has changed by then.
        self._surfaces: dict[int, Surface] = dict(asked.scene._surfaces)

    def _rows(self, needs_ways: bool = False, of: Any = _core.hit_points) -> Floats:
        ways = self._asked.ways
        if ways is None:
            if needs_ways:
                raise TypeError(
                    "hits: their rays lie on a device, and their directions are unknown"
                )
            directions = np.broadcast_to(np.ones(1, np.float32), (len(self._hits), 3))
        else:
            directions = np.ascontiguousarray(ways.reshape(-1)).view(np.float32).reshape(-1, 3)
        rows: Floats = of(
            self._scene._core,
            self._hits.view(np.float32).reshape(-1, 6),
            directions,
            self._asked.version,
            None if self._times is None else self._times.reshape(-1),
        )
        return rows

    def _shaped(self, rows: NDArray[Any], *tail: int) -> NDArray[Any]:
        return np.ascontiguousarray(rows).reshape((*self.shape, *tail))

    def position(self) -> Floats:
        return self._shaped(self._rows()[:, :3], 3)

    def geometric_normal(self) -> Floats:
        return self._shaped(self._rows()[:, 3:6], 3)

    def facing_normal(self) -> Floats:
        """The geometric normals, turned to the side that the rays come from."""
        return self._shaped(self._rows(needs_ways=True, of=_core.facing_normals), 3)

    def front(self) -> NDArray[np.bool_]:
        rows = self._rows(needs_ways=True)
        return self._shaped(rows.view(np.uint8)[:, 40] != 0)

    def start(self, directions: Any) -> Floats:
        expected = f"one that broadcasts to {(*self.shape, 3)}"
        ways = _arrays.with_last_axis(directions, "directions", 3, expected)
        shape = np.broadcast_shapes(self.shape, ways.shape[:-1])
        rows = self._rows()
        position, normal = (self._shaped(rows[:, i : i + 3], 3) for i in (0, 3))
        clearance = self._shaped(rows[:, 6])
        # As off_surface of C++ does it, in float32.
        ways32 = ways.astype(np.float32)
        steps = np.where(np.sum(ways32 * normal, axis=-1) < 0, -clearance, clearance)
        starts: Floats = (position + normal * steps[..., None]).astype(np.float32)
        return np.broadcast_to(starts, (*shape, 3))

    def normal(self) -> Floats:
        """Interpolated in the mesh's space, then brought to the world as normals are: by the
        cofactors of the transform, to the side that they were on."""
        of = {mesh: s.normals for mesh, s in self._surfaces.items() if s.normals is not None}
        scene = self._scene._core
        numbers, which = np.unique(self._hits["inst_id"], return_inverse=True)
        maps = np.zeros((len(numbers), 3, 3))
        moving: dict[int, Floats] = {}
        times = np.zeros(0, np.float32) if self._times is None else self._times.reshape(-1)
        for i, number in enumerate(numbers.tolist()):
            if of and scene.has_instance(number):
                matrices = scene.transforms(number)
                maps[i] = _normal_map(matrices[0])
                if len(matrices) > 1 and self._times is not None:
                    moving[i] = matrices
        rows = self._rows()
        flat: Floats = rows[:, 3:6]
        if not of:
            return self._shaped(flat, 3)
        mixed = self._mixed(rows, of, (3,), np.float64)
        with np.errstate(all="ignore"):
            turned = np.einsum("nij,nj->ni", maps[which.reshape(-1)], mixed)
            for i, matrices in moving.items():
                some = np.flatnonzero(which.reshape(-1) == i)
                there = _cofactors(_matrices_at(matrices, times[some]))
                turned[some] = np.einsum("nij,nj->ni", there, mixed[some])
            turned /= np.linalg.norm(turned, axis=1, keepdims=True)
            turned[np.sum(turned * flat, axis=1) < 0] *= -1
        return self._shaped(np.where(np.isfinite(turned), turned, flat).astype(np.float32), 3)

    def uv(self) -> Floats:
        of = {mesh: s.uv for mesh, s in self._surfaces.items() if s.uv is not None}
        return self._shaped(self._mixed(self._rows(), of, (2,), np.float32), 2)

    def material_id(self) -> NDArray[np.uint32]:
        found = np.full(len(self._hits), _NOBODY, np.uint32)
        self._rows()  # raises where the scene has changed
        for mesh, some in self._by_mesh():
            materials = self._surfaces.get(mesh, Surface()).materials
            if materials is not None and len(materials):
                prims = self._hits["prim_id"][some]
                found[some] = materials[prims if len(materials) > 1 else np.zeros_like(prims)]
        return self._shaped(found)

    def interpolate(self, values: Union[ArrayLike, Mapping[int, ArrayLike]]) -> NDArray[Any]:
        rows = self._rows()
        if not isinstance(values, Mapping):
            meshes = [mesh for mesh, _ in self._by_mesh()]
            if len(meshes) > 1:
                raise TypeError(
                    f"values: one array is given for hits of meshes {meshes}; an array for each mesh, "
                    "as in {mesh: array}, is expected"
                )
            values = {mesh: values for mesh in meshes} if meshes else {0: values}
            named = False
        else:
            named = True
        of: dict[int, NDArray[Any]] = {}
        for mesh, value in values.items():
            name = f"values[{mesh}]" if named else "values"
            array = _arrays.floats(value, name, "an array with a row for each vertex")
            count = (
                self._scene._core.vertex_count(mesh) if mesh in self._scene._core.meshes() else 0
            )
            if array.ndim == 0 or (len(array) != count and len(self._hits)):
                raise ValueError(
                    f"{name}: an array of shape {array.shape} is given; one with a row for each of "
                    f"{count} vertices is expected"
                )
            of[int(mesh)] = array
        tails = {array.shape[1:] for array in of.values()}
        if len(tails) > 1:
            raise ValueError(
                f"values: rows of shapes {sorted(tails)} are given; one shape is expected"
            )
        tail = tails.pop() if tails else ()
        single = all(array.dtype == np.float32 for array in of.values())
        return self._shaped(
            self._mixed(rows, of, tail, np.float32 if single else np.float64), *tail
        )

    def _by_mesh(self) -> list[tuple[int, NDArray[np.intp]]]:
        """The places of the hits of each mesh."""
        meshes = self._hits["geom_id"]
        return [
            (mesh, np.flatnonzero(meshes == mesh))
            for mesh in np.unique(meshes[meshes != _NOBODY]).tolist()
        ]

    def _mixed(
        self, rows: Floats, of: Mapping[int, NDArray[Any]], tail: tuple[int, ...], dtype: Any
    ) -> NDArray[Any]:
        """The corners' values by the weights of the hits; NaN for misses and for other meshes."""
        found = np.full((len(self._hits), *tail), np.nan, dtype)
        vertices = rows.view(np.uint32)[:, 7:10]
        for mesh, some in self._by_mesh():
            values = of.get(mesh)
            if values is None:
                continue
            a, b, c = (values[vertices[some, k]] for k in range(3))
            one = (slice(None),) + (None,) * len(tail)
            u, v = (self._hits[name][some].astype(np.float64)[one] for name in ("u", "v"))
            with np.errstate(all="ignore"):
                found[some] = (1 - u - v) * a + u * b + v * c
        return found


def _normal_map(matrix: Floats) -> NDArray[np.float64]:
    """The cofactors of a map, on the side of its determinant."""
    cofactors = _cofactors(matrix)
    return -cofactors if _mirrors(matrix) else cofactors


def _cofactors(matrices: Floats) -> NDArray[np.float64]:
    """(..., 3, 3), of matrices (..., 3, 4)."""
    x, y, z = np.moveaxis(matrices[..., :3].astype(np.float64), -1, 0)
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)


def _matrices_at(matrices: Floats, times: Floats) -> Floats:
    """(n, 3, 4), where an instance is at n times, as `transform_at` of C++ has it."""
    x = times.astype(np.float64) * (len(matrices) - 1)
    j = np.minimum(x.astype(np.intp), len(matrices) - 2)
    f = (x - j)[:, None, None]
    mixed: Floats = ((1 - f) * matrices[j] + f * matrices[j + 1]).astype(np.float32)
    return mixed


def _mirrors(matrix: Floats) -> bool:
    """Whether the determinant is negative, exactly."""
    rows = matrix[:, :3].tolist()

    def terms(number: Callable[[float], Any]) -> list[Any]:
        (a, b, c), (d, e, f), (g, h, i) = (map(number, row) for row in rows)
        return [a * e * i, b * f * g, c * d * h, -a * f * h, -b * d * i, -c * e * g]

    rounded = terms(float)
    if abs(sum(rounded)) > 2.0**-49 * sum(map(abs, rounded)):  # 8 roundings of 2^-53 at most
        return bool(sum(rounded) < 0)
    return bool(sum(terms(Fraction)) < 0)
