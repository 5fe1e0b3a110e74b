"""Converts users' arrays to the numpy arrays that the extension takes, or raises an exception.

A copy is made only if the dtype or the layout requires it.
"""

from __future__ import annotations

import math
import operator
from typing import Any, Optional, Sequence

import numpy as np
from numpy.typing import NDArray

from ._device import device_array
from ._errors import UnsupportedError

_CPU = (1, 3)  # DLPack's kDLCPU and kDLCUDAHost: memory that the CPU can read
_MOST_IDS = 2**32
_MOST_ITEMS = 2**31 - 1  # of a batch


def _shape_of(array: NDArray[Any]) -> str:
    return f"an array of shape {array.shape} and dtype {array.dtype}"


def _unreadable(name: str, error: Exception) -> TypeError:
    return TypeError(f"{name}: cannot be read as an array: {error}")


def as_numpy(value: Any, name: str) -> NDArray[Any]:
    """The value as an array, by any protocol that it supports: numpy's, DLPack's, a buffer.

    Protocols are implemented by third-party code, which may raise any exception.
    """
    if type(value) is np.ndarray:
        return value
    if isinstance(value, np.ndarray):
        if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
            raise TypeError(
                f"{name}: {_shape_of(value)} is given, of which {np.count_nonzero(value.mask)} elements "
                "are masked; one without a mask is expected, as its filled() gives"
            )
        return np.asarray(value)
    there = device_array(value, name)
    if there is not None:
        raise TypeError(f"{name}: {there} is given; an array in the memory of the CPU is expected")
    refused: Optional[Exception] = None
    if hasattr(value, "__dlpack_device__"):
        try:
            kind, number = value.__dlpack_device__()
            kind = int(kind)
        except Exception as error:
            raise _unreadable(name, error) from error
        if kind not in _CPU:
            raise TypeError(
                f"{name}: lies on a device (DLPack device {kind}, {number}); "
                "an array in the memory of the CPU is expected"
            )
        try:
            return np.from_dlpack(value)
        except MemoryError:
            raise
        except Exception as error:
            refused = error  # older protocols, read-only memory: numpy has other ways
    try:
        array = np.asarray(value)
    except MemoryError:
        raise
    except Exception as error:
        raise _unreadable(name, error) from error
    if refused is not None and array.dtype == object:
        raise _unreadable(name, refused) from refused
    return array


def _is_handy(array: NDArray[Any]) -> bool:
    """Whether the extension can read the elements in place: they are aligned and whole elements
    apart."""
    size = array.itemsize
    for stride in array.strides:
        if stride % size:
            return False
    return array.flags.aligned


def rounding() -> np.errstate:
    """Values that a dtype cannot hold become inf or 0, regardless of numpy's error settings."""
    return np.errstate(over="ignore", under="ignore")


def _packed(array: NDArray[Any], dtype: Any) -> NDArray[Any]:
    """The elements in the dtype, aligned and contiguous in C order.

    Bytes of a file or a message are in C order but may begin at any address.
    """
    with rounding():
        packed = np.ascontiguousarray(array, dtype)
    return packed if packed.flags.aligned else packed.copy()


def floats(value: Any, name: str, expected: str) -> NDArray[Any]:
    """Numbers as native float32 or float64, of any shape and strides."""
    array = as_numpy(value, name)
    if array.dtype.kind not in "fiu":
        if array.size == 0 and array.dtype.kind != "c":
            return np.zeros(array.shape, np.float32)
        raise TypeError(
            f"{name}: {_shape_of(array)} is given; {expected} of real numbers is expected"
        )
    wanted = np.float32 if array.dtype.kind == "f" and array.itemsize <= 4 else np.float64
    if array.dtype != wanted:
        with rounding():
            array = np.asarray(array, wanted)
    return array if _is_handy(array) else array.copy()


def doubles(value: Any, name: str) -> NDArray[np.float64]:
    """Numbers as float64 in C order, of any shape."""
    array = as_numpy(value, name)
    if array.dtype.kind in "fiubO":
        try:
            return _packed(array, np.float64)
        except (TypeError, ValueError, OverflowError):
            pass  # objects that are not all numbers
    raise TypeError(
        f"{name}: {_shape_of(array)} is given; one of shape (n, 3) of real numbers is expected"
    )


def require_few(shape: tuple[int, ...], what: str, most_axes: int) -> None:
    """Raises before memory is allocated for more rays or points than a query can answer."""
    if math.prod(shape) > _MOST_ITEMS:
        raise UnsupportedError(
            "unsupported", f"{math.prod(shape)} {what} are more than 2^31 - 1", what
        )
    if len(shape) > most_axes:
        raise ValueError(
            f"{what}: a batch of {len(shape)} axes is given; {most_axes} at most are expected"
        )


def index_of(number: int, shape: tuple[int, ...], own: Sequence[int]) -> list[int]:
    """The index of item `number` of a batch in an array of the shape `own`, which broadcasts to
    that of the batch."""
    index = [int(i) for i in np.unravel_index(number, shape)] if shape else []
    return [0 if length == 1 else i for i, length in zip(index[len(index) - len(own) :], own)]


def with_last_axis(value: Any, name: str, length: int, expected: str) -> NDArray[Any]:
    """An array of `floats` with the shape (..., length)."""
    array = floats(value, name, expected)
    if array.ndim == 0 or array.shape[-1] != length:
        if array.size == 0 and array.ndim == 1:
            return array.reshape(0, length)  # [] has this shape
        raise ValueError(f"{name}: {_shape_of(array)} is given; {expected} is expected")
    return array


def vertices(value: Any, name: str = "vertices", soup: bool = False) -> NDArray[np.float32]:
    """(n, 3) float32 in C order. A soup may also be (m, 3, 3): the corners of m triangles."""
    expected = "one of shape (n, 3) or (m, 3, 3)" if soup else "one of shape (n, 3)"
    array = with_last_axis(value, name, 3, expected)
    if soup and array.ndim == 3 and array.shape[1] == 3:
        array = array.reshape(-1, 3)
    if array.ndim != 2:
        raise ValueError(f"{name}: {_shape_of(array)} is given; {expected} is expected")
    with rounding():
        return np.ascontiguousarray(array, np.float32)


def moving_vertices(value: Any, end: Any, count: int) -> NDArray[np.float32]:
    """(times, n, 3) float32 in C order, of a mesh of `count` vertices."""
    if end is None:
        array = with_last_axis(value, "vertices", 3, "one of shape (n, 3) or (times, n, 3)")
        if array.ndim == 3 and len(array) and array.shape[1] == count:
            return vertices(array.reshape(-1, 3)).reshape(array.shape)
        return vertices(array, soup=True)[None]
    both = vertices(value, soup=True), vertices(end, "end", soup=True)
    if len(both[0]) != len(both[1]):
        raise ValueError(
            f"end: {len(both[1])} vertices are given; as many as at time 0, {len(both[0])}, are "
            "expected"
        )
    return np.stack(both)


def triangles(value: Any, name: str = "triangles") -> Optional[NDArray[np.uint32]]:
    """(m, 3) uint32 in C order; None stays None."""
    if value is None:
        return None
    array = as_numpy(value, name)
    if array.size == 0 and array.shape in ((0,), (0, 3)):
        return np.zeros((0, 3), np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(
            f"{name}: {_shape_of(array)} is given; integers of shape (m, 3) are expected"
        )
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: {_shape_of(array)} is given; one of shape (m, 3) is expected")
    if array.dtype != np.uint32:
        wrong = (array < 0) | (array > _MOST_IDS - 1)
        if wrong.any():
            row, corner = np.argwhere(wrong)[0]
            raise ValueError(
                f"{name}: [{row}, {corner}] of {_shape_of(array)} is {array[row, corner]}; "
                "an index into the vertices is expected"
            )
    return _packed(array, np.uint32)


def transform(value: Any, name: str = "transform") -> NDArray[np.float32]:
    """(3, 4) float32 from a (3, 4) or (4, 4) matrix; the identity for None."""
    if value is None:
        return np.eye(3, 4, dtype=np.float32)
    expected = "one of shape (3, 4) or (4, 4)"
    array = with_last_axis(value, name, 4, expected)
    if array.shape == (4, 4):
        if not np.array_equal(array[3], (0, 0, 0, 1)):
            raise ValueError(
                f"{name}: the last row of a (4, 4) matrix is {array[3].tolist()}; [0, 0, 0, 1] is expected"
            )
        array = array[:3]
    if array.shape != (3, 4):
        raise ValueError(f"{name}: {_shape_of(array)} is given; {expected} is expected")
    with rounding():
        return np.ascontiguousarray(array, np.float32)


def transforms(
    value: Any, quaternions: Any = None, name: str = "transforms"
) -> NDArray[np.float32]:
    """(..., 3, 4) float32 from (..., 3, 4) or (..., 4, 4) matrices, or from positions and
    quaternions."""
    if quaternions is not None:
        return _posed(value, quaternions)
    expected = "one of shape (..., 3, 4) or (..., 4, 4)"
    array = with_last_axis(value, name, 4, expected)
    if array.ndim < 3 and array.size == 0:
        array = array.reshape(0, 3, 4)
    if array.ndim < 3 or array.shape[-2] not in (3, 4):
        raise ValueError(f"{name}: {_shape_of(array)} is given; {expected} is expected")
    if array.shape[-2] == 4:
        wrong = (array[..., 3, :] != (0, 0, 0, 1)).any(axis=-1)
        if wrong.any():
            first = tuple(int(i) for i in np.argwhere(wrong)[0])
            raise ValueError(
                f"{name}: the last row of matrix {list(first)} is {array[first][3].tolist()}; "
                "[0, 0, 0, 1] is expected"
            )
        array = array[..., :3, :]
    return _packed(array, np.float32)


def leading(value: Any, name: str, shape: tuple[int, ...]) -> NDArray[np.uint32]:
    """Integers for the elements of a shape whose first axes are theirs, in a row."""
    array = as_numpy(value, name)
    if array.size == 0 and array.ndim == 1:
        array = array.astype(np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(
            f"{name}: {_shape_of(array)} is given; an integer or an array of integers is expected"
        )
    try:
        wide = np.broadcast_to(array.reshape(array.shape + (1,) * (len(shape) - array.ndim)), shape)
    except ValueError:
        raise ValueError(
            f"{name}: {_shape_of(array)} is given; one whose axes are the first of {shape} is expected"
        ) from None
    if array.size and array.dtype != np.uint32 and not (0 <= array.min() and array.max() < _MOST_IDS):
        raise ValueError(f"{name}: a number is not from 0 to {_MOST_IDS - 1}")
    return np.ascontiguousarray(wide, np.uint32).reshape(-1)


def _posed(positions: Any, quaternions: Any) -> NDArray[np.float32]:
    """(..., 3, 4) float32: rotations by (x, y, z, w), of any length but 0, then translations."""
    at = with_last_axis(positions, "transforms", 3, "with quaternions, one of shape (..., 3)")
    turned = with_last_axis(quaternions, "quaternions", 4, "one of shape (..., 4)")
    if at.ndim < 2 or turned.shape[:-1] != at.shape[:-1]:
        raise ValueError(
            f"quaternions: {_shape_of(turned)} is given for positions of {_shape_of(at)}; "
            "shapes (..., 3) and (..., 4) are expected"
        )
    x, y, z, w = np.moveaxis(np.asarray(turned, np.float64), -1, 0)
    size = x * x + y * y + z * z + w * w
    if not (size > 0).all():
        first = tuple(int(i) for i in np.argwhere(~(size > 0))[0])
        raise ValueError(
            f"quaternions: {list(first)} is {turned[first].tolist()}, which is no rotation"
        )
    two = 2 / size
    matrices = np.empty((*size.shape, 3, 4), np.float32)
    with rounding():
        matrices[..., 0, 0] = 1 - two * (y * y + z * z)
        matrices[..., 0, 1] = two * (x * y - w * z)
        matrices[..., 0, 2] = two * (x * z + w * y)
        matrices[..., 1, 0] = two * (x * y + w * z)
        matrices[..., 1, 1] = 1 - two * (x * x + z * z)
        matrices[..., 1, 2] = two * (y * z - w * x)
        matrices[..., 2, 0] = two * (x * z - w * y)
        matrices[..., 2, 1] = two * (y * z + w * x)
        matrices[..., 2, 2] = 1 - two * (x * x + y * y)
        matrices[..., 3] = at
    return matrices


def ids(value: Any, name: str) -> NDArray[np.uint32]:
    """uint32 of any shape, in C order."""
    array = as_numpy(value, name)
    if array.size == 0 and array.ndim == 1:
        return np.zeros(0, np.uint32)
    if array.dtype.kind not in "iu" or array.ndim == 0:
        raise TypeError(f"{name}: {_shape_of(array)} is given; an array of integers is expected")
    if array.dtype != np.uint32:
        wrong = (array < 0) | (array > _MOST_IDS - 1)
        if wrong.any():
            raise ValueError(f"{name}: {array[wrong][0]} is given; an id is expected")
    return _packed(array, np.uint32)


def integer(value: Any, name: str, most: int = _MOST_IDS - 1, least: int = 0) -> int:
    """An integer from `least` to `most`, numpy's included."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: {value!r} is given; an integer is expected") from None
    if not least <= number <= most:
        raise ValueError(
            f"{name}: {number} is given; an integer from {least} to {most} is expected"
        )
    return number
