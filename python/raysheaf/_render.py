"""Pictures: the renderer behind `python -m raysheaf render`, and PNG files of arrays."""

from __future__ import annotations

import os
import struct
import zlib
from dataclasses import dataclass
from typing import Any, Literal, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core

_MOST_THREADS = 1024


def png_bytes(image: Any) -> bytes:
    """An image as a PNG file: (h, w) grey, (h, w, 3) colours or (h, w, 4) with alpha.

    uint8 is taken as it is; real numbers from 0 to 1 become 0 to 255, and what is beyond is clipped.
    """
    pixels = np.asarray(image)
    if pixels.dtype.kind == "f":
        pixels = np.rint(np.clip(np.nan_to_num(pixels), 0, 1) * 255).astype(np.uint8)
    if pixels.dtype != np.uint8:
        raise TypeError(f"image: dtype {pixels.dtype} is given; uint8 or real numbers are expected")
    channels = 1 if pixels.ndim == 2 else pixels.shape[-1]
    if pixels.ndim not in (2, 3) or channels not in (1, 3, 4) or 0 in pixels.shape:
        raise ValueError(
            f"image: shape {pixels.shape} is given; (h, w), (h, w, 3) or (h, w, 4) is expected"
        )
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + width * channels), np.uint8)  # each begins with its filter: none
    rows[:, 1:] = pixels.reshape(height, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    colour = {1: 0, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
        + chunk(b"IEND", b"")
    )


def write_png(path: Union[str, os.PathLike[str]], image: Any) -> None:
    """Write an image as `png_bytes` makes it."""
    data = png_bytes(image)
    with open(path, "wb") as file:
        file.write(data)


@dataclass(frozen=True)
class Picture:
    """A rendered frame: arrays of h x w pixels, rows from the top. A notebook shows it by itself."""

    image: NDArray[np.uint8]
    """(h, w, 3), for people; exposed, tone-mapped, sRGB."""
    beauty: NDArray[np.float32]
    """(h, w, 3), linear radiance, Rec. 709 primaries."""
    position: NDArray[np.float32]
    """(h, w, 3), what the pixel sees, in the world; 0 for nothing."""
    normal: NDArray[np.float32]
    """(h, w, 3), the shading normal there."""
    albedo: NDArray[np.float32]
    """(h, w, 3), diffuse and specular reflectance there."""
    shadow: NDArray[np.float32]
    """(h, w), the part of the lights facing it that reaches it."""
    inst_id: NDArray[np.uint32]
    """(h, w), its instance; `INVALID_ID` for nothing, as the two below."""
    geom_id: NDArray[np.uint32]
    """(h, w), its mesh."""
    prim_id: NDArray[np.uint32]
    """(h, w), its triangle."""
    exposure: float
    """The factor from `beauty` to what was tone-mapped."""

    def _repr_png_(self) -> bytes:
        return png_bytes(self.image)

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Write `image` as a PNG file."""
        write_png(path, self.image)

    def __repr__(self) -> str:
        return f"<raysheaf.Picture {self.image.shape[1]}x{self.image.shape[0]}>"


def render(
    scene: Union[str, os.PathLike[str]],
    *,
    width: int = 512,
    height: int = 512,
    camera: Union[str, int] = "",
    method: str = "dual",
    primary: Literal["trace", "raster"] = "trace",
    bounces: int = 2,
    threads: int = 0,
    exposure: Optional[float] = None,
    samples: int = 0,
    aperture: Optional[float] = None,
    focus: Optional[float] = None,
    environment: Union[str, os.PathLike[str], None] = None,
) -> Picture:
    """Render a frame of a scene file or of a built-in scene.

    Ctrl-C stops it: in brute force at once, else between batches of rays.

    Parameters
    ----------
    scene : str or path
        A glTF, GLB, OBJ, PLY or STL file; or ``"builtin:office"``, ``"builtin:cornell"``,
        ``"builtin:atrium"``. Where it has no camera or no light, one that shows all of it is added.
    width, height : int
        Pixels, 1 to 16384 each.
    camera : str or int
        By name or number; the first by default.
    method : str
        ``"dual"``, ``"crsh"``, ``"rah"``, ``"gl10"`` or ``"brute"``; the picture is the same.
    primary : "trace" or "raster"
        How the camera sees: by rays, or by OpenGL, as the command line does.
    bounces : int
        Reflections and refractions in a row, 0 to 32.
    threads : int
        0: all cores.
    exposure : float, optional
        A factor on radiance before tone mapping; found by itself by default.
    samples : int
        Rays a pixel, 1 to 65536; 0: 1, or 16 with an environment or a lens.
    aperture : float, optional
        Diameter of the lens; the camera's own by default, which mostly is 0: all is sharp.
    focus : float, optional
        The depth that is sharp; by default the camera's own, or that of what the middle shows.
    environment : str or path, optional
        Light from all around: a ``.hdr`` or ``.exr`` file of all directions, +y up.

    Raises
    ------
    InvalidError
        For options, and for what is wrong in the file.
    NotFoundError
        For the file, the camera or the built-in scene.
    Error
        With code ``"io"`` for a file that cannot be read, ``"no_graphics"`` for "raster" where
        there is no OpenGL.

    Examples
    --------
    >>> import raysheaf
    >>> picture = raysheaf.render("builtin:cornell", width=48, height=32)
    >>> picture.image.shape, picture.image.dtype
    ((32, 48, 3), dtype('uint8'))
    """
    if primary not in ("trace", "raster"):
        raise ValueError(f'primary: {primary!r} is given; "trace" or "raster" is expected')
    made = _core.render(
        os.fspath(scene),
        _arrays.integer(width, "width"),
        _arrays.integer(height, "height"),
        str(camera),
        str(method),
        primary == "raster",
        _arrays.integer(bounces, "bounces"),
        _arrays.integer(threads, "threads", _MOST_THREADS),
        None if exposure is None else float(exposure),
        _arrays.integer(samples, "samples"),
        None if aperture is None else float(aperture),
        None if focus is None else float(focus),
        "" if environment is None else os.fspath(environment),
    )
    ids = made["ids"]
    return Picture(
        image=np.ascontiguousarray(made["rgba"][..., :3]),
        beauty=made["beauty"],
        position=made["position"],
        normal=made["normal"],
        albedo=made["albedo"],
        shadow=made["shadow"],
        inst_id=ids[..., 0],
        geom_id=ids[..., 1],
        prim_id=ids[..., 2],
        exposure=made["exposure"],
    )
