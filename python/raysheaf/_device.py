"""Arrays in the memory of a CUDA device: CuPy's, PyTorch's, Numba's, JAX's.

They are read and written in place. All of these libraries describe their arrays by
`__cuda_array_interface__` (https://numba.readthedocs.io/en/stable/cuda/cuda_array_interface.html).
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from typing import Any, Literal, Optional

import numpy as np

from . import _core
from ._values import is_second

Device = Literal["cpu", "cuda"]


def is_cuda(device: str) -> bool:
    """Whether the device is "cuda"."""
    return is_second(device, "device", "cpu", "cuda")


@dataclass
class DeviceArray:
    """A validated description of an array on a CUDA device."""

    name: str  # of the argument
    pointer: int
    shape: tuple[int, ...]
    dtype: str  # "float32"
    writable: bool
    stream: int  # a cudaStream_t; 0: no stream to wait for

    def __str__(self) -> str:
        return f"an array of shape {self.shape} and dtype {self.dtype} on a CUDA device"

    def place(self, row: tuple[int, ...]) -> _core.Place:
        """The array's place, as rows of the shape `row`."""
        rows = self.shape[: len(self.shape) - len(row)]
        return _core.Place(self.pointer, math.prod(rows), self.stream)


_DTYPES = {
    "<f4": "float32",
    "<f8": "float64",
    "<f2": "float16",
    "|u1": "uint8",
    "|b1": "bool",
    "<u4": "uint32",
    "<i4": "int32",
    "<i8": "int64",
}


_LEGACY_DEFAULT = 1  # the interface's value for CUDA's legacy default stream


def _stream_of(value: Any, said: dict[str, Any]) -> int:
    """The stream of the interface: a handle, 1 or 2 for a default stream, None without one to wait
    for.

    0 should not occur and can only mean a default stream. PyTorch's tensors use version 2 of the
    interface, which has no stream: they belong to the current one.
    """
    if "stream" in said:
        stream = said["stream"]
        return 0 if stream is None else int(stream) or _LEGACY_DEFAULT
    torch = sys.modules.get("torch")
    if torch is not None and isinstance(value, torch.Tensor):
        return int(torch.cuda.current_stream(value.device).cuda_stream) or _LEGACY_DEFAULT
    return 0


def device_array(value: Any, name: str) -> Optional[DeviceArray]:
    """The description of an array on a CUDA device; None for any other value."""
    if value is None or type(value) is np.ndarray:
        return None
    try:
        said = getattr(value, "__cuda_array_interface__", None)
    except RuntimeError as error:  # a tensor that requires gradients
        raise TypeError(f"{name}: cannot be read as an array: {error}") from error
    if said is None:
        return None
    pointer, read_only = said["data"]
    dtype = _DTYPES.get(said["typestr"], said["typestr"])
    array = DeviceArray(
        name,
        int(pointer or 0),
        tuple(said["shape"]),
        dtype,
        not read_only,
        _stream_of(value, said),
    )
    item = int(said["typestr"][2:])
    strides, step = said.get("strides"), item
    for length, stride in zip(reversed(array.shape), reversed(strides or ())):
        if length > 1 and stride != step and math.prod(array.shape):
            raise ValueError(
                f"{name}: {array} is given, not in C order; one in C order is expected"
            )
        step *= length
    return array


def rays_there(array: DeviceArray) -> DeviceArray:
    """Raises an exception unless the array holds packed rays."""
    if array.dtype != "float32" or not array.shape or array.shape[-1] != 8:
        raise ValueError(
            f"{array.name}: {array} is given; on a device one of shape (..., 8) and dtype float32 "
            "is expected: origin, t_min, direction, t_max of each ray"
        )
    return array


def points_there(array: DeviceArray) -> DeviceArray:
    """Raises an exception unless the array holds points."""
    if array.dtype not in ("float32", "float64") or not array.shape or array.shape[-1] != 3:
        raise ValueError(
            f"{array.name}: {array} is given; on a device one of shape (..., 3) and dtype float32 or "
            "float64 is expected"
        )
    return array


def room_there(array: DeviceArray, shape: tuple[int, ...], dtypes: tuple[str, ...]) -> DeviceArray:
    """Raises an exception unless the array can receive the results."""
    if array.dtype not in dtypes or array.shape != shape or not array.writable:
        raise ValueError(
            f"{array.name}: {'' if array.writable else 'read-only '}{array} is given; a writable one "
            f"of shape {shape} and dtype {' or '.join(dtypes)} is expected"
        )
    return array


def require_cuda(scene: _core.Scene, *arrays: Any) -> None:
    """Raises an exception if an array is on a device but the scene is not."""
    for array in arrays:
        if isinstance(array, DeviceArray) and not scene.is_on_cuda():
            raise TypeError(
                f"{array.name}: {array} is given to a scene of the CPU; "
                'one made by Scene(device="cuda") is expected'
            )
