"""The four ray queries of a scene: the base class of `Scene`."""

from __future__ import annotations

import math
from typing import Any, Literal, Optional, SupportsIndex, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core, _values
from ._asked import Asked
from ._cameras import Rays
from ._contents import Contents
from ._device import device_array, require_cuda, room_there
from ._errors import OutOfMemoryError
from ._hits import HIT_DTYPE, HitRows, Hits
from ._rays import Invalid, RayBatch, batch_of

ALL = 0xFFFFFFFF
ALL_WORLDS = 0xFFFFFFFF
"""The world of what is in all worlds."""

Method = Literal["dual", "brute"]


Sides = Literal["both", "front", "back"]
Mask = Union[SupportsIndex, ArrayLike]
Worlds = Union[SupportsIndex, ArrayLike]
_SIDES = ("both", "front", "back")
_PLAIN = _core.QueryRequest(ALL, False, True, None)  # that of a query without options
_FEW_HITS = 1024  # that need no pages of their own


def _request(
    mask: Any,
    method: str,
    check: bool,
    statistics: Optional[dict[str, Any]],
    sides: int = 0,
    masks: Optional[NDArray[np.uint32]] = None,
    skip: Optional[NDArray[np.uint32]] = None,
    worlds: Optional[Worlds] = None,
    shape: tuple[int, ...] = (),
    times: Optional[NDArray[np.float32]] = None,
) -> _core.QueryRequest:
    """`shape`: of the rays or points."""
    is_brute = _values.is_second(method, "method", "dual", "brute")
    if statistics is not None and not isinstance(statistics, dict):
        raise TypeError(f"statistics: {type(statistics).__name__} is given; a dict is expected")
    bits = _arrays.integer(mask, "mask")
    each, per_world = _items_in(worlds, shape)
    return _core.QueryRequest(
        bits, is_brute, bool(check), statistics, sides, masks, skip, each, per_world, times
    )


def _items_in(
    worlds: Optional[Worlds], shape: tuple[int, ...]
) -> tuple[Optional[NDArray[np.uint32]], int]:
    """The worlds of the rays or points; or how many in a row are in one, if these are counted."""
    if worlds is None or not math.prod(shape):
        return None, 0
    array = np.asarray(worlds) if isinstance(worlds, range) else _arrays.as_numpy(worlds, "worlds")
    if array.ndim == 1 and array.shape == shape[:1] and array.dtype.kind in "iu":
        if np.array_equal(array, np.arange(len(array))):
            return None, math.prod(shape[1:])
    return _arrays.leading(array, "worlds", shape), 0


def _ray_request(
    batch: RayBatch,
    mask: Any,
    method: str,
    check: bool,
    statistics: Optional[dict[str, Any]],
    sides: str,
    skip: Any,
    worlds: Any,
    times: Any,
) -> _core.QueryRequest:
    chooses = any(one is not None for one in (skip, worlds, times, statistics)) or mask is not ALL
    if not chooses and check is True and not batch.valid:
        if isinstance(sides, str) and sides == "both" and isinstance(method, str) and method == "dual":
            return _PLAIN
    if sides not in _SIDES:
        wrong = ValueError if isinstance(sides, str) else TypeError
        raise wrong(f'sides: {sides!r} is given; "both", "front" or "back" is expected')
    masks = None
    if isinstance(mask, (list, tuple)) or getattr(mask, "ndim", 0) != 0:
        masks, mask = _per_ray(_arrays.as_numpy(mask, "mask"), "mask", batch.shape, ()), ALL
    skipped = None if skip is None else _skipped(skip, batch.shape)
    side = _SIDES.index(sides)
    check = check and not batch.valid
    batch.times = None if times is None else _times(times, batch.shape)
    return _request(
        mask, method, check, statistics, side, masks, skipped, worlds, batch.shape, batch.times
    )


def _per_ray(
    array: NDArray[Any], name: str, shape: tuple[int, ...], tail: tuple[int, ...]
) -> NDArray[np.uint32]:
    """Integers of 32 bits for each ray, in a row."""
    if array.dtype.kind not in "iu":
        raise TypeError(
            f"{name}: an array of shape {array.shape} and dtype {array.dtype} is given; one of integers "
            "is expected"
        )
    try:
        wide = np.broadcast_to(array, shape + tail)
    except ValueError:
        raise ValueError(
            f"{name}: an array of shape {array.shape} is given; one that broadcasts to {shape + tail} "
            "is expected"
        ) from None
    if array.size and array.dtype != np.uint32 and not (0 <= array.min() and array.max() <= ALL):
        raise ValueError(f"{name}: a number is not from 0 to {ALL}")
    return np.ascontiguousarray(wide, np.uint32).reshape((-1, *tail))


def _times(times: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Those of the rays, in a row."""
    array = _arrays.floats(times, "times", "a number or an array")
    wrong = ~((array >= 0) & (array <= 1))
    if wrong.any():
        first = tuple(int(i) for i in np.argwhere(wrong)[0])
        place = f"times{list(first) or ''}"
        raise ValueError(f"{place}: {array[first]} is given; a number from 0 to 1 is expected")
    try:
        wide = np.broadcast_to(array, shape)
    except ValueError:
        raise ValueError(
            f"times: an array of shape {array.shape} is given; one that broadcasts to {shape} is "
            "expected"
        ) from None
    return np.ascontiguousarray(wide, np.float32).reshape(-1)


def _skipped(skip: Any, shape: tuple[int, ...]) -> NDArray[np.uint32]:
    """The (inst_id, prim_id) of each ray's triangle."""
    if isinstance(skip, Hits):
        skip = np.stack([skip.inst_id, skip.prim_id], axis=-1)
    return _per_ray(_arrays.as_numpy(skip, "skip"), "skip", shape, (2,))


class Queries(Contents):
    """The ray queries of `Scene`."""

    def closest_hit(
        self,
        origins: Union[Rays, ArrayLike],
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: Mask = ALL,
        sides: Sides = "both",
        skip: Optional[Union[Hits, ArrayLike]] = None,
        worlds: Optional[Worlds] = None,
        times: Optional[ArrayLike] = None,
        method: Method = "dual",
        check: bool = True,
        invalid: Invalid = "error",
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> Hits:
        """The closest hit of each ray.

        Put many rays into one call: one call with 100 000 rays is far faster than 100 000 calls.

        Parameters
        ----------
        origins : (..., 3) array of real numbers, or Rays
            Or whole rays, (..., 8), without `directions`: origin, t_min, direction, t_max. They are
            read in place if they are float32 in C order; with ``device="cuda"`` they may be in the
            device's memory.
        directions : (..., 3) array of real numbers
            They need not be unit vectors. They broadcast with `origins`, `t_min` and `t_max`.
        t_min, t_max : arrays of shape (...), optional
            Hits lie in [t_min, t_max], in lengths of the direction; 0 and inf by default.
        mask : int, or array of integers
            The query sees instances with ``their mask & mask`` not 0; of an array, each ray those
            of its own.
        sides : "both", "front" or "back"
            The sides of triangles that rays meet. The front is the side from which the corners run
            counter-clockwise; see `Hits.front`.
        skip : Hits, or (..., 2) array of integers, optional
            A triangle for each ray that it does not meet: that of a hit, or (inst_id, prim_id).
            Mostly the triangle that the ray starts from.
        worlds : int, or array of integers, optional
            The world that each ray is in, see `Scene.instances`: an array whose axes are the first
            of the rays', so that ``range(4096)`` fits rays of shape (4096, 64, 3), 64 in a world.
            Without worlds rays see the instances of all.
        times : array of shape (...) of numbers from 0 to 1, optional
            When each ray meets instances that move, see `Scene.set_transforms`; they broadcast to
            the rays' shape. The answer is that of a scene which stands still as it is at that time.
            Without times it is as it is at 0.
        method : "dual" or "brute"
            "brute" tests every ray with every triangle, to check against; the answers are the same,
            bit for bit.
        check : bool
            False skips the validation of rays. An invalid ray then makes all results unspecified.
        invalid : "error" or "miss"
            What becomes of a ray that is not finite, has a zero direction, or an empty interval:
            an `InvalidError`, or a miss. Rays on a device raise the error.
        statistics : dict, optional
            Receives counts of tests, times in milliseconds, and the plan.
        out : Hits, or an array on a CUDA device, optional
            An array of the rays' shape in C order, which is written and returned, so that nothing
            is allocated. On a device it has a last axis of 6 in addition, and dtype float32: t, u,
            v, and the bits of prim_id, geom_id and inst_id.

        Returns
        -------
        Hits
            Of the rays' shape. A miss has t = inf and ids `INVALID_ID`. Among hits at the same t,
            the one with the least (geom_id, inst_id, prim_id) counts. Rays hit both sides of
            triangles, and none passes between two triangles that share an edge.

        Raises
        ------
        InvalidError
            Names the first invalid ray, unless these are misses: not finite, a zero direction, t_min negative or larger than
            t_max. It is a `ValueError`.
        TypeError, ValueError
            For arrays of a wrong dtype or of shapes that do not broadcast.

        Examples
        --------
        >>> import numpy as np, raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 5], [4, 0, 5], [0, 4, 5]], [[0, 1, 2]])
        >>> x, y = np.meshgrid([1.0, 2.0], [0.5, 1.0, 3.0])
        >>> origins = np.stack([x, y, np.zeros_like(x)], axis=-1)
        >>> scene.closest_hit(origins, [0, 0, 2]).t
        array([[2.5, 2.5],
               [2.5, 2.5],
               [2.5, inf]], dtype=float32)

        Rays that go on from where others hit do not meet the triangle that they start from:

        >>> hits = scene.closest_hit([1, 1, 0], [0, 0, 1])
        >>> bool(scene.any_hit(hits.position, [0, 0, 1], skip=hits))
        False
        """
        batch = batch_of(origins, directions, t_min, t_max, invalid)
        there = device_array(out, "out")
        require_cuda(self._core, batch.rays, there)
        room: Union[NDArray[np.float32], _core.Place]
        if there is not None:
            room = room_there(there, batch.shape + (6,), ("float32",)).place((6,))
        else:
            if out is None:
                room = _room_for_hits(batch.count)
                out = Hits(np.ndarray(batch.shape, HIT_DTYPE, room))
            else:
                _check_out(out, batch)
                room = out.array.reshape(-1).view(np.float32).reshape(-1, 6)
        request = _ray_request(batch, mask, method, check, statistics, sides, skip, worlds, times)
        version = batch.ask(self._core.closest_hit, room, request)
        if isinstance(out, Hits):
            out._asked = Asked(self, version, batch.ways(), batch.times_of_hits())
        return cast(Hits, out)

    def any_hit(
        self,
        origins: Union[Rays, ArrayLike],
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: Mask = ALL,
        sides: Sides = "both",
        skip: Optional[Union[Hits, ArrayLike]] = None,
        worlds: Optional[Worlds] = None,
        times: Optional[ArrayLike] = None,
        method: Method = "dual",
        check: bool = True,
        invalid: Invalid = "error",
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything: for shadows and visibility, faster than `closest_hit`.

        Parameters and exceptions are those of `closest_hit`. Returns booleans of the rays' shape:
        a new numpy array, or `out`, an array of dtype bool or uint8 in C order, of numpy or on a
        CUDA device.

        From one point to another: ``scene.any_hit(a, b - a, t_max=1)``.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> scene.any_hit([0.25, 0.25, 0], [[0, 0, 1], [0, 0, -1]])
        array([ True, False])
        """
        batch = batch_of(origins, directions, t_min, t_max, invalid)
        room = _room(self._core, batch, out, ("bool", "uint8"))
        request = _ray_request(batch, mask, method, check, statistics, sides, skip, worlds, times)
        batch.ask(self._core.any_hit, room, request)
        new = out is None
        return cast(NDArray[np.bool_], room.view(np.bool_).reshape(batch.shape) if new else out)

    def all_hits(
        self,
        origins: Union[Rays, ArrayLike],
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: Mask = ALL,
        sides: Sides = "both",
        skip: Optional[Union[Hits, ArrayLike]] = None,
        worlds: Optional[Worlds] = None,
        times: Optional[ArrayLike] = None,
        method: Method = "dual",
        check: bool = True,
        invalid: Invalid = "error",
        statistics: Optional[dict[str, Any]] = None,
        most: Optional[SupportsIndex] = None,
    ) -> HitRows:
        """All hits of each ray, from near to far, or the first `most` of them.

        Other parameters, and exceptions, are those of `closest_hit`. A ray through an edge or a vertex
        hits all triangles that share it. Memory of deleted rows is reused for the next ones until
        a scene is deleted.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> copy = scene.instance(mesh, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3]])
        >>> rows = scene.all_hits([0.25, 0.25, 0], [[0, 0, 1], [0, 0, -1]])
        >>> scene.all_hits([0.25, 0.25, 0], [0, 0, 1], most=1).hits.t
        array([1.], dtype=float32)
        >>> [row.t.tolist() for row in rows]
        [[1.0, 4.0], []]
        """
        batch = batch_of(origins, directions, t_min, t_max, invalid)
        require_cuda(self._core, batch.rays)
        request = _ray_request(batch, mask, method, check, statistics, sides, skip, worlds, times)
        number = None if most is None else _arrays.integer(most, "most")
        found = batch.ask(self._core.all_hits, request, number)
        offsets, hits, version = found[0].view(np.int64), found[1].view(HIT_DTYPE), found[2]
        asked = Asked(self, version, batch.ways(), batch.times_of_hits()).of_rows(offsets)
        return HitRows(offsets, Hits(hits.reshape(len(hits)), asked), batch.shape)

    def hit_counts(
        self,
        origins: Union[Rays, ArrayLike],
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: Mask = ALL,
        sides: Sides = "both",
        skip: Optional[Union[Hits, ArrayLike]] = None,
        worlds: Optional[Worlds] = None,
        times: Optional[ArrayLike] = None,
        method: Method = "dual",
        check: bool = True,
        invalid: Invalid = "error",
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.uint32]:
        """The number of triangles that each ray hits: the lengths of the rows of `all_hits`.

        Parameters and exceptions are those of `closest_hit`. Returns uint32 of the rays' shape: a
        new numpy array, or `out`, an array of dtype uint32 or int32 in C order, of numpy or on a
        CUDA device.
        """
        batch = batch_of(origins, directions, t_min, t_max, invalid)
        room = _room(self._core, batch, out, ("uint32", "int32"))
        request = _ray_request(batch, mask, method, check, statistics, sides, skip, worlds, times)
        batch.ask(self._core.hit_counts, room, request)
        return cast(NDArray[np.uint32], room.reshape(batch.shape) if out is None else out)


def _room_for_hits(count: int) -> NDArray[np.float32]:
    if count <= _FEW_HITS:
        return np.empty((count, 6), np.float32)
    try:
        return _core.empty_hits(count)
    except MemoryError:
        raise OutOfMemoryError("out_of_memory", f"there is no room for {count} hits") from None


def _room(scene: _core.Scene, batch: RayBatch, out: Any, dtypes: tuple[str, ...]) -> Any:
    """The memory for one number per ray: new, or that of `out`, in host or device memory.

    All `dtypes` have the same size, and the extension takes unsigned integers of that size.
    """
    unsigned = f"u{np.dtype(dtypes[0]).itemsize}"
    there = device_array(out, "out")
    require_cuda(scene, batch.rays, there)
    if there is not None:
        return room_there(there, batch.shape, dtypes).place(())
    if out is None:
        return np.empty(batch.count, unsigned)
    if not isinstance(out, np.ndarray):
        raise TypeError(
            f"out: {type(out).__name__} is given; an array of numpy or on a CUDA device, or None, "
            "is expected"
        )
    if np.ma.is_masked(out):
        raise TypeError("out: an array with a mask is given; one without is expected")
    flags = out.flags
    fits = out.shape == batch.shape and out.dtype in map(np.dtype, dtypes)
    if not (fits and flags.c_contiguous and flags.aligned and flags.writeable):
        raise ValueError(
            f"out: {'an' if flags.writeable else 'a read-only'} array of shape {out.shape} and dtype "
            f"{out.dtype}{'' if flags.c_contiguous else ', not in C order,'}"
            f"{'' if flags.aligned else ', not aligned,'} is given; a writable one of shape "
            f"{batch.shape} and dtype {' or '.join(dtypes)} in C order is expected"
        )
    return np.asarray(out).reshape(-1).view(unsigned)


def _check_out(out: Any, batch: RayBatch) -> None:
    if not isinstance(out, Hits):
        raise TypeError(f"out: {type(out).__name__} is given; Hits is expected")
    flags = out.array.flags
    aligned = out.t.flags.aligned  # records of numpy need not be aligned
    if out.shape != batch.shape or not (flags.c_contiguous and aligned and flags.writeable):
        raise ValueError(
            f"out: {'writable' if flags.writeable else 'read-only'} Hits of shape {out.shape} "
            f"{'in C order' if flags.c_contiguous else 'not in C order'}"
            f"{'' if aligned else ', not aligned,'} are given; "
            f"writable ones of shape {batch.shape} in C order are expected"
        )
