"""Converts rays as users write them to the arrays that the library reads."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any, Callable, Literal, Optional, Sequence, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core, _values
from ._asked import ways_of
from ._cameras import Rays
from ._device import DeviceArray, device_array, rays_there
from ._errors import InvalidError

Invalid = Literal["error", "miss"]
_Answer = TypeVar("_Answer")

_FEW = 1024  # rays: to copy them takes less time than to describe where they lie
_MOST_AXES = 31  # of batches: numpy's iterators allow 32, and rays use an axis of their own

_NEAR, _FAR = np.zeros((), np.float32), np.full((), np.inf, np.float32)
_NO_HIT = np.array([0, 0, 0, np.inf, 0, 0, 1, np.inf], np.float32)  # no hit has t = inf
_FIELDS = {"origin": "origins", "direction": "directions", "t_min": "t_min", "t_max": "t_max"}


@dataclass
class RayBatch:
    """Rays in a row, and the shape of their results."""

    # (n, 8) in C order; (..., 8) on a device; or as separate arrays
    rays: Union[NDArray[np.float32], _core.Parts, DeviceArray]
    shape: tuple[int, ...]
    packed: bool  # given as eight numbers per ray, not as separate arguments
    # shapes of the separate arguments
    given: dict[str, tuple[int, ...]] = field(default_factory=dict)
    # as they were passed, if `rays` are parts
    directions: Optional[NDArray[Any]] = None
    valid: bool = False  # known to be so
    times: Optional[NDArray[np.float32]] = None  # in a row

    @property
    def asked(self) -> Union[NDArray[np.float32], _core.Parts, _core.Place]:
        """The rays in the form that the extension takes."""
        return self.rays.place((8,)) if isinstance(self.rays, DeviceArray) else self.rays

    def ways(self) -> Union[NDArray[Any], None, Callable[[], NDArray[Any]]]:
        """The directions, as `Asked` takes them; None on a device."""
        rays, shape = self.rays, self.shape
        if not isinstance(rays, np.ndarray):
            return None if self.directions is None else ways_of(self.directions, shape)
        ways = rays[:, 4:7]
        kept = ways.copy() if self.packed else ways  # which belong to the caller, or to the batch
        return lambda: ways_of(kept.reshape(*shape, 3), shape)

    def times_of_hits(self) -> Optional[NDArray[np.float32]]:
        """The times, in the shape of the hits."""
        return None if self.times is None else self.times.reshape(self.shape)

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    def ask(self, query: Callable[..., _Answer], *more: Any) -> _Answer:
        """`query(rays, *more)`, whose errors about ray i name the user's argument and index."""
        try:
            return query(self.asked, *more)
        except InvalidError as error:
            raise self._named(error) from None

    def _named(self, error: InvalidError) -> InvalidError:
        match = re.fullmatch(r"rays\[(\d+)\]\.(\w+)", error.place)
        if match is None:
            return error
        name = match[2]
        sentence = error.sentence
        if sentence == "t_min is larger than t_max" and self._says_more("t_max", "t_min"):
            name, sentence = "t_max", "t_max is smaller than t_min"
        elif name in ("origin", "direction"):
            sentence += " in float32"
        return InvalidError(error.code, sentence, self._place(name, int(match[1])))

    def _says_more(self, name: str, other: str) -> bool:
        """Whether argument `name` varies over rays, more than `other` does if both were given."""
        if self.packed or name not in self.given:
            return False
        return other not in self.given or math.prod(self.given[name]) > math.prod(self.given[other])

    def _place(self, name: str, ray: int) -> str:
        """The argument with the index of its element for this ray."""
        if self.packed:
            return f"rays{_arrays.index_of(ray, self.shape, self.shape) or ''}.{name}"
        own = self.given.get(_FIELDS[name], ())
        return f"{_FIELDS[name]}{_arrays.index_of(ray, self.shape, own) or ''}"


def _stride(lengths: Sequence[int], strides: Sequence[int]) -> Optional[int]:
    """The stride of some axes as one; None if they cannot be one."""
    joined: Optional[int] = None
    count = 1
    for length, stride in zip(reversed(lengths), reversed(strides)):
        if length == 1:
            continue
        if joined is None:
            joined = stride
        elif stride != joined * count:
            return None
        count *= length
    return joined or 0


class _Wide:
    """An array that is broadcast to the shape of a batch."""

    def __init__(self, array: NDArray[Any], shape: tuple[int, ...], tail: tuple[int, ...]) -> None:
        self.array = np.broadcast_to(array, shape + tail)
        self.shape, self.tail = shape, tail

    def strides(self, axis: int) -> Optional[tuple[int, int]]:
        """Those of the axes before `axis` as one, and of the others as one."""
        found = [
            _stride(self.shape[part], self.array.strides[: len(self.shape)][part])
            for part in (slice(axis), slice(axis, None))
        ]
        outer, inner = found
        return None if outer is None or inner is None else (outer, inner)

    def blocks(self, axis: int) -> NDArray[Any]:
        """The batch as blocks of rays; a copy where the axes cannot be joined, in float32, which is
        the final dtype."""
        size = math.prod(self.shape[:axis]), math.prod(self.shape[axis:])
        strides = self.strides(axis)
        if strides is None:
            with _arrays.rounding():
                return np.ascontiguousarray(self.array, np.float32).reshape(size + self.tail)
        wide = strides + self.array.strides[len(self.shape) :]
        return np.lib.stride_tricks.as_strided(
            self.array, size + self.tail, wide, writeable=False
        )


def _blocks(arrays: Sequence[_Wide], shape: tuple[int, ...]) -> list[NDArray[Any]]:
    """The arrays as blocks of rays, cut at the axis at which the fewest are copied."""

    def copied(axis: int) -> int:
        return sum(math.prod(one.tail) for one in arrays if one.strides(axis) is None)

    axis = min(range(max(len(shape), 1)), key=copied)
    return [one.blocks(axis) for one in arrays]


def _packed(
    shape: tuple[int, ...], starts: NDArray[Any], ways: NDArray[Any], least: Any, most: Any
) -> NDArray[np.float32]:
    """A copy of the rays, eight numbers each."""
    rays = np.empty((*shape, 8), np.float32)
    with _arrays.rounding():
        rays[..., :3], rays[..., 3] = starts, least
        rays[..., 4:7], rays[..., 7] = ways, most
    return rays


def _without_invalid(rays: NDArray[np.float32]) -> RayBatch:
    """Packed rays of shape (..., 8); those that the library would refuse hit nothing instead."""
    starts, ways, t_min, t_max = rays[..., :3], rays[..., 4:7], rays[..., 3], rays[..., 7]
    right = np.isfinite(starts).all(-1) & np.isfinite(ways).all(-1) & ways.any(-1)
    right &= (t_min >= 0) & (t_min <= t_max)
    rays[~right] = _NO_HIT
    return RayBatch(rays.reshape(-1, 8), rays.shape[:-1], packed=True, valid=True)


def _parts(origins: Any, directions: Any, t_min: Any, t_max: Any, lenient: bool) -> RayBatch:
    starts = _arrays.with_last_axis(origins, "origins", 3, "one of shape (..., 3)")
    ways = _arrays.with_last_axis(directions, "directions", 3, "one of shape (..., 3)")
    given = {"origins": starts.shape[:-1], "directions": ways.shape[:-1]}
    least: NDArray[Any] = _NEAR
    most: NDArray[Any] = _FAR
    if t_min is not None:
        least = _arrays.floats(t_min, "t_min", "a number or an array")
        given["t_min"] = least.shape
    if t_max is not None:
        most = _arrays.floats(t_max, "t_max", "a number or an array")
        given["t_max"] = most.shape
    for one in given.values():
        _arrays.require_few(one, "rays", _MOST_AXES)
    shape = given["origins"]
    try:
        if any(one != shape for one in given.values()):
            shape = np.broadcast_shapes(*given.values())
    except ValueError:
        raise ValueError(
            f"origins {starts.shape}, directions {ways.shape}, t_min {least.shape}, "
            f"t_max {most.shape}: shapes that broadcast are expected"
        ) from None
    _arrays.require_few(shape, "rays", _MOST_AXES)
    if lenient:
        return _without_invalid(_packed(shape, starts, ways, least, most))
    if math.prod(shape) <= _FEW:
        rays = _packed(shape, starts, ways, least, most).reshape(-1, 8)
        return RayBatch(rays, shape, packed=False, given=given)
    wide = [_Wide(array, shape, (3,)) for array in (starts, ways)]
    wide += [_Wide(array, shape, ()) for array in (least, most)]
    parts = _core.Parts(*_blocks(wide, shape))
    return RayBatch(parts, shape, packed=False, given=given, directions=ways)


def batch_of(
    origins: Any, directions: Any, t_min: Any, t_max: Any, invalid: Invalid = "error"
) -> RayBatch:
    """The batch of `origins` and `directions`, of `Rays`, or of packed rays if `directions` is
    None."""
    lenient = _values.is_second(invalid, "invalid", "error", "miss")
    if isinstance(origins, Rays):
        if directions is not None:
            raise TypeError("directions: Rays have their own; None is expected")
        least = origins.t_min if t_min is None else t_min
        most = origins.t_max if t_max is None else t_max
        return _parts(origins.origins, origins.directions, least, most, lenient)
    there = device_array(origins, "rays")
    if directions is not None:
        if there is not None:
            raise TypeError(
                f"origins: {there} is given besides directions; on a device rays come whole, as one "
                "array of shape (..., 8) and dtype float32"
            )
        return _parts(origins, directions, t_min, t_max, lenient)
    if t_min is not None or t_max is not None:
        raise TypeError(
            "t_min, t_max: packed rays of shape (..., 8) have their own; None is expected"
        )
    if there is not None:
        if lenient:
            raise TypeError(f'invalid: "miss" is given for {there}; "error" is expected')
        return RayBatch(rays_there(there), there.shape[:-1], packed=True)
    rays = _arrays.with_last_axis(
        origins, "rays", 8, "one of shape (..., 8), or directions besides origins,"
    )
    shape = rays.shape[:-1]
    _arrays.require_few(shape, "rays", _MOST_AXES)
    with _arrays.rounding():
        if lenient:
            return _without_invalid(rays.astype(np.float32, order="C"))
        packed = np.ascontiguousarray(rays, np.float32).reshape(-1, 8)
    return RayBatch(packed, shape, packed=True)
