"""The point queries of a scene: a base class of `Scene`."""

from __future__ import annotations

import contextlib
import math
import re
from dataclasses import dataclass
from typing import Any, Iterator, Literal, Optional, SupportsIndex, TypeAlias, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core, _values
from ._closest import CLOSEST_DTYPE, ClosestPoints
from ._device import DeviceArray, device_array, points_there, require_cuda, room_there
from ._errors import InvalidError, OutOfMemoryError
from ._queries import ALL, Method, Worlds, _request

InsideRule = Literal["nonzero", "evenodd"]

_Request: TypeAlias = _core.QueryRequest  # in a class that has a `_core` of its own
_MOST_AXES = 30  # of batches: numpy's iterators have 32, points an axis of their own, `nearest` one
_MOST_NEAREST = 65536


@dataclass
class _PointBatch:
    """Points in a row, and the shape that their results take."""

    points: _core.PointArrays
    shape: tuple[int, ...]
    given: dict[str, tuple[int, ...]]
    there: Optional[DeviceArray] = None  # the points, if they are on a device

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    @contextlib.contextmanager
    def named(self) -> Iterator[None]:
        """Errors about point 7 speak of the argument and the index that the user knows."""
        try:
            yield
        except InvalidError as error:
            match = re.fullmatch(r"(points|radii)\[(\d+)\]", error.place)
            if match is None:
                raise
            name = "radius" if match[1] == "radii" else "points"
            index = _arrays.index_of(int(match[2]), self.shape, self.given.get(name, ()))
            raise InvalidError(error.code, error.sentence, f"{name}{index or ''}") from None


def _batch_there(array: DeviceArray, radius: Optional[ArrayLike]) -> _PointBatch:
    """Points in the memory of a device."""
    points_there(array)
    _arrays.require_few(array.shape[:-1], "points", _MOST_AXES)
    radii = _arrays.floats(np.inf if radius is None else radius, "radius", "a number")
    if radii.ndim != 0:
        raise TypeError(
            f"radius: an array of shape {radii.shape} is given besides points on a CUDA device; one "
            "number is expected"
        )
    arrays = _core.PointArrays(array.place((3,)), array.dtype == "float64", float(radii))
    return _PointBatch(arrays, array.shape[:-1], {"points": array.shape[:-1], "radius": ()}, array)


def _batch(points: ArrayLike, radius: Optional[ArrayLike] = None) -> _PointBatch:
    there = device_array(points, "points")
    if there is not None:
        return _batch_there(there, radius)
    places = _arrays.with_last_axis(points, "points", 3, "one of shape (..., 3)")
    radii = _arrays.floats(np.inf if radius is None else radius, "radius", "a number or an array")
    given = {"points": places.shape[:-1], "radius": radii.shape}
    try:
        shape = np.broadcast_shapes(*given.values())
    except ValueError:
        raise ValueError(
            f"points {places.shape}, radius {radii.shape}: shapes that broadcast are expected"
        ) from None
    _arrays.require_few(shape, "points", _MOST_AXES)
    arrays = _core.PointArrays(
        np.broadcast_to(places, shape + (3,)).reshape(-1, 3),
        np.broadcast_to(radii, shape).reshape(-1),
    )
    return _PointBatch(arrays, shape, given)


def _empty(shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
    try:
        return np.empty(shape, dtype)
    except MemoryError:
        raise OutOfMemoryError(
            "out_of_memory", f"there is no room for {math.prod(shape)} results"
        ) from None


def _room(
    scene: _core.Scene,
    batch: _PointBatch,
    out: Any,
    shape: tuple[int, ...],
    row: tuple[int, ...],
    dtypes: tuple[str, ...],
) -> Optional[_core.Place]:
    """The place of `out` on a device, which has this shape and these rows; None if there is no
    `out`."""
    there = device_array(out, "out")
    require_cuda(scene, batch.there, there)
    if there is not None:
        return room_there(there, shape + row, dtypes).place(row)
    if out is None:
        return None
    raise TypeError(
        f"out: {type(out).__name__} is given; an array on a CUDA device, or None, is expected"
    )


class PointQueries:
    """The part of `Scene` that points are handed to."""

    _core: _core.Scene

    def closest_point(
        self,
        points: ArrayLike,
        *,
        radius: Optional[ArrayLike] = None,
        mask: SupportsIndex = ALL,
        worlds: Optional[Worlds] = None,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> ClosestPoints:
        """The nearest point on a triangle for each point.

        Put many points into one call, as with rays. float64 points are not rounded. Triangles
        without area count: they are segments or points.

        Parameters
        ----------
        points : (..., 3) array of real numbers
            Finite, at most 1e18 in absolute value; components smaller than 1e-60 count as 0. With
            ``device="cuda"`` they may be in the device's memory, float32 or float64 in C order, and
            are read in place.
        radius : array of shape (...), optional
            What is farther away is not found; inf by default. It broadcasts with `points`; it is
            one number if these are in a device's memory.
        mask : int
            The query sees instances with ``their mask & mask`` not 0.
        worlds : int, or array of integers, optional
            The world that each point is in, see `Scene.instances`: an array whose axes are the first
            of the points'. A point sees the instances of its world, and is inside what only these
            enclose. Without worlds points see the instances of all.
        method : "dual" or "brute"
            "brute" tests every point with every triangle, to check against; the answers are the
            same, bit for bit.
        check : bool
            False skips the validation of points. An invalid one then makes all results unspecified.
        statistics : dict, optional
            Receives times in milliseconds, and the plan; `rays` is the number of points.
        out : array on a CUDA device, optional
            Is written and returned. It has the points' shape with a last axis of 8, in C order, and
            dtype float64: distance, point, u, v, and the bits of prim_id, geom_id, inst_id and
            side, two to a number.

        Returns
        -------
        ClosestPoints
            Of the points' shape. Where nothing is within the radius, the distance is inf, the point
            NaN, and ids are `INVALID_ID`. Among triangles at the same distance, the one with the
            least (geom_id, inst_id, prim_id) counts. The distance differs from the exact one by at
            most 2^-48 of itself and of the triangle's longest edge together.

        Raises
        ------
        InvalidError
            Names the first invalid point or radius. It is a `ValueError`.
        TypeError, ValueError
            For arrays of a wrong dtype or of shapes that do not broadcast.

        Examples
        --------
        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> found = scene.closest_point([[1, 1, 2], [-3, -4, 0], [1, 1, -0.5]])
        >>> found.distance
        array([2. , 5. , 0.5])
        >>> found.point
        array([[1., 1., 0.],
               [0., 0., 0.],
               [1., 1., 0.]])
        >>> found.side
        array([ 1,  0, -1], dtype=int32)
        """
        batch = _batch(points, radius)
        request = _request(mask, method, check, statistics, worlds=worlds, shape=batch.shape)
        return self._ask_nearest(batch, batch.shape, 1, request, out)

    def nearest(
        self,
        points: ArrayLike,
        k: SupportsIndex,
        radius: Optional[ArrayLike] = None,
        *,
        mask: SupportsIndex = ALL,
        worlds: Optional[Worlds] = None,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> ClosestPoints:
        """The `k` nearest triangles of each point, 1 to 65536, and the nearest point on each.

        Other parameters and exceptions are those of `closest_point`. Returns `ClosestPoints` of the
        points' shape and a last axis of `k` (an `out` has another of 8 behind it), sorted by (distance, geom_id, inst_id, prim_id); if
        fewer are within the radius, distances of inf and ids of `INVALID_ID` follow.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> for z in (1, 2, 3):
        ...     mesh = scene.add([[0, 0, z], [1, 0, z], [0, 1, z]], [[0, 1, 2]])
        >>> found = scene.nearest([0.25, 0.25, 0], 4, radius=2.5)
        >>> found.distance
        array([ 1.,  2., inf, inf])
        >>> found[found.found].geom_id
        array([0, 1], dtype=uint32)
        """
        number = _arrays.integer(k, "k", _MOST_NEAREST, least=1)
        batch = _batch(points, radius)
        request = _request(mask, method, check, statistics, worlds=worlds, shape=batch.shape)
        return self._ask_nearest(batch, (*batch.shape, number), number, request, out)

    def signed_distance(
        self,
        points: ArrayLike,
        *,
        radius: Optional[ArrayLike] = None,
        inside: InsideRule = "nonzero",
        mask: SupportsIndex = ALL,
        worlds: Optional[Worlds] = None,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.float64]:
        """The distance to the nearest triangle, negative inside (as `contains` defines it).

        Other parameters and exceptions are those of `closest_point` and `contains`. Returns float64
        of the points' shape, as an `out` has it; beyond the radius inf, or -inf inside.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> corners = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]
        >>> mesh = scene.add(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> scene.signed_distance([[1, 2, 1], [-2, 1, 1], [2, 2, 0]])
        array([-1.,  2.,  0.])
        """
        batch = _batch(points, radius)
        place = _room(self._core, batch, out, batch.shape, (), ("float64",))
        new = _empty(batch.shape if place is None else (), np.float64)
        with batch.named():
            self._core.signed_distance(
                batch.points,
                _values.is_second(inside, "inside", "nonzero", "evenodd"),
                new.reshape(-1) if place is None else place,
                _request(mask, method, check, statistics, worlds=worlds, shape=batch.shape),
            )
        return cast(NDArray[np.float64], new if place is None else out)

    def contains(
        self,
        points: ArrayLike,
        *,
        inside: InsideRule = "nonzero",
        mask: SupportsIndex = ALL,
        worlds: Optional[Worlds] = None,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.bool_]:
        """Whether each point is inside the surface, decided by integers: there is no tolerance.

        A point is inside by the number of times that the surface winds around it, which a ray from
        it counts exactly. If the surface is closed, any ray tells; if it is open, the six rays along
        the axes vote. If solids share a face, exactly one of them contains each point of it.

        Parameters
        ----------
        points : (..., 3) array of real numbers
        inside : "nonzero" or "evenodd"
            "nonzero": where the winding number is not 0; of open surfaces, where its mean over the
            six rays exceeds 1/2 in absolute value. Solids may overlap. "evenodd": where the number
            of crossings is odd; of open surfaces, for more than three of the six rays. For triangles
            that face either way at random.

        Other parameters and exceptions are those of `closest_point`. Returns booleans of the points'
        shape; an `out` has dtype bool or uint8.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> corners = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]
        >>> mesh = scene.add(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> scene.contains([[1, 1, 1], [3, 3, 3]])
        array([ True, False])
        """
        batch = _batch(points)
        place = _room(self._core, batch, out, batch.shape, (), ("bool", "uint8"))
        new = _empty(batch.shape if place is None else (), np.uint8)
        with batch.named():
            self._core.inside(
                batch.points,
                _values.is_second(inside, "inside", "nonzero", "evenodd"),
                new.reshape(-1) if place is None else place,
                _request(mask, method, check, statistics, worlds=worlds, shape=batch.shape),
            )
        return cast(NDArray[np.bool_], new.view(np.bool_) if place is None else out)

    def occupancy(self, points: ArrayLike, **options: Any) -> NDArray[np.float32]:
        """`contains` as numbers, 1 inside and 0 outside: what networks are trained on.

        A new numpy array, also for points in a device's memory; `contains` can write there.

        >>> import raysheaf
        >>> raysheaf.Scene().occupancy([[0, 0, 0]])
        array([0.], dtype=float32)
        """
        if options.get("out") is not None:
            raise TypeError("out: occupancy makes a new array; contains writes to an array")
        return self.contains(points, **options).astype(np.float32)

    def _ask_nearest(
        self, batch: _PointBatch, shape: tuple[int, ...], k: int, request: _Request, out: Any
    ) -> ClosestPoints:
        place = _room(self._core, batch, out, shape, (8,), ("float64",))
        found = _empty(shape if place is None else (), CLOSEST_DTYPE)
        records: Union[NDArray[np.uint8], _core.Place]
        if place is None:
            records = found.reshape(-1).view(np.uint8).reshape(-1, CLOSEST_DTYPE.itemsize)
        else:
            records = place
        with batch.named():
            self._core.nearest(batch.points, k, records, request)
        return cast(ClosestPoints, ClosestPoints(found) if place is None else out)
