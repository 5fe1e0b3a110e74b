"""Rays as users write them, as the arrays that the library reads."""

from __future__ import annotations

import contextlib
import math
import re
from dataclasses import dataclass
from typing import Any, Iterator, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core
from ._device import DeviceArray, device_array, rays_there
from ._errors import InvalidError

_FIELDS = {"origin": "origins", "direction": "directions", "t_min": "t_min", "t_max": "t_max"}


@dataclass
class RayBatch:
    """Rays in a row, and the shape that their results take."""

    # (n, 8), C order; (..., 8) on a device; or in parts
    rays: Union[NDArray[np.float32], _core.Parts, DeviceArray]
    shape: tuple[int, ...]
    packed: bool  # came as eight numbers a ray, and not in four arguments

    @property
    def asked(self) -> Union[NDArray[np.float32], _core.Parts, _core.Place]:
        """As the extension takes them."""
        return self.rays.place((8,)) if isinstance(self.rays, DeviceArray) else self.rays

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    @contextlib.contextmanager
    def named(self) -> Iterator[None]:
        """Errors about ray 7 speak of the argument and the index that the user knows."""
        try:
            yield
        except InvalidError as error:
            match = re.fullmatch(r"rays\[(\d+)\]\.(\w+)", error.place)
            if match is None:
                raise
            index = (
                [int(i) for i in np.unravel_index(int(match[1]), self.shape)] if self.shape else ""
            )
            field = match[2]
            place = f"rays{index}.{field}" if self.packed else f"{_FIELDS[field]}{index}"
            sentence = error.sentence
            if field in ("origin", "direction"):
                sentence += " in float32"
            raise InvalidError(error.code, sentence, place) from None


def _spread(array: NDArray[Any], shape: tuple[int, ...], tail: tuple[int, ...]) -> NDArray[Any]:
    """Broadcast to shape + tail, then all of shape in one axis."""
    wide = np.broadcast_to(array, shape + tail)
    return wide if len(shape) == 1 else wide.reshape((-1,) + tail)


def _parts(origins: Any, directions: Any, t_min: Any, t_max: Any) -> RayBatch:
    starts = _arrays.with_last_axis(origins, "origins", 3, "one of shape (..., 3)")
    ways = _arrays.with_last_axis(directions, "directions", 3, "one of shape (..., 3)")
    least = _arrays.floats(t_min, "t_min", "a number or an array")
    most = _arrays.floats(t_max, "t_max", "a number or an array")
    try:
        shape = np.broadcast_shapes(starts.shape[:-1], ways.shape[:-1], least.shape, most.shape)
    except ValueError:
        raise ValueError(
            f"origins {starts.shape}, directions {ways.shape}, t_min {least.shape}, "
            f"t_max {most.shape}: shapes that broadcast are expected"
        ) from None
    parts = _core.Parts(
        _spread(starts, shape, (3,)),
        _spread(ways, shape, (3,)),
        _spread(least, shape, ()),
        _spread(most, shape, ()),
    )
    return RayBatch(parts, shape, packed=False)


def batch_of(origins: Any, directions: Any, t_min: Any, t_max: Any) -> RayBatch:
    """The batch of `origins` and `directions`, or of packed rays where there are no directions."""
    there = device_array(origins, "rays")
    if directions is not None:
        if there is not None:
            raise TypeError(
                f"origins: {there} is given besides directions; on a device rays come whole, as one "
                "array of shape (..., 8) and dtype float32"
            )
        return _parts(
            origins,
            directions,
            0.0 if t_min is None else t_min,
            np.inf if t_max is None else t_max,
        )
    if t_min is not None or t_max is not None:
        raise TypeError(
            "t_min, t_max: packed rays of shape (..., 8) have their own; None is expected"
        )
    if there is not None:
        return RayBatch(rays_there(there), there.shape[:-1], packed=True)
    rays = _arrays.with_last_axis(
        origins, "rays", 8, "one of shape (..., 8), or directions besides origins,"
    )
    shape = rays.shape[:-1]
    with np.errstate(over="ignore"):
        packed = np.ascontiguousarray(rays, np.float32).reshape(-1, 8)
    return RayBatch(packed, shape, packed=True)
