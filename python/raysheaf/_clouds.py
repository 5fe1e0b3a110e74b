"""Writes structured arrays as point clouds, .ply and .pcd, binary."""

from __future__ import annotations

import os
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _values

_PLY = {"f4": "float", "f8": "double", "i4": "int", "u4": "uint"}


def _ply_header(cloud: NDArray[np.void]) -> str:
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(cloud)}"]
    lines += [f"property {_PLY[cloud.dtype[name].str[1:]]} {name}" for name in _names(cloud)]
    return "\n".join([*lines, "end_header", ""])


def _pcd_header(cloud: NDArray[np.void]) -> str:
    names = _names(cloud)
    kinds = [cloud.dtype[name].str[1:] for name in names]
    return "\n".join(
        [
            "VERSION 0.7",
            "FIELDS " + " ".join(names),
            "SIZE " + " ".join(kind[1] for kind in kinds),
            "TYPE " + " ".join(kind[0].upper() for kind in kinds),
            "COUNT " + " ".join("1" for _ in names),
            f"WIDTH {len(cloud)}",
            "HEIGHT 1",
            "VIEWPOINT 0 0 0 1 0 0 0",
            f"POINTS {len(cloud)}",
            "DATA binary",
            "",
        ]
    )


_HEADERS = {".ply": _ply_header, ".pcd": _pcd_header}


def _names(cloud: NDArray[np.void]) -> tuple[str, ...]:
    return cloud.dtype.names or ()


def write(path: Union[str, "os.PathLike[str]"], cloud: NDArray[Any]) -> None:
    """Writes a (n,) structured array of little-endian fields."""
    name = _values.file_name(path, "path")
    header = _HEADERS.get(os.path.splitext(name)[1].lower())
    if header is None:
        raise ValueError(f"path: {name!r} is given; a name that ends in .ply or .pcd is expected")
    with open(name, "wb") as file:
        file.write(header(cloud).encode("ascii"))
        file.write(cloud.tobytes())
