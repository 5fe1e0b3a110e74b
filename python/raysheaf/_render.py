"""Images: the renderer behind `python -m raysheaf render`, and PNG files of arrays."""

from __future__ import annotations

import math
import operator
import os
import struct
import warnings
import zlib
from dataclasses import dataclass
from typing import (
    Any,
    Literal,
    NamedTuple,
    NoReturn,
    Optional,
    Sequence,
    SupportsFloat,
    SupportsIndex,
    Union,
)

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core, _values
from ._cameras import Camera, Rays
from ._device import Device, is_cuda
from ._errors import NotFoundError
from ._look import Light
from ._scene import Scene

_MOST_THREADS = 1024
_MOST_WARNINGS = 8
Number = Union[SupportsFloat, SupportsIndex]
Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]


def png_bytes(image: Any) -> bytes:
    """An image as a PNG file: (h, w) grey, (h, w, 3) colours or (h, w, 4) with alpha.

    uint8 is written unchanged; real numbers from 0 to 1 become 0 to 255, and values outside are
    clipped; booleans become white (true) and black.
    """
    pixels = _arrays.as_numpy(image, "image")
    if pixels.dtype == np.bool_:
        pixels = pixels * np.uint8(255)
    elif pixels.dtype.kind == "f":
        pixels = np.rint(np.clip(np.nan_to_num(pixels), 0, 1) * 255).astype(np.uint8)
    if pixels.dtype != np.uint8:
        raise TypeError(
            f"image: dtype {pixels.dtype} is given; uint8, real numbers or booleans are expected"
        )
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    if pixels.ndim not in (2, 3) or channels not in (1, 3, 4) or 0 in pixels.shape:
        raise ValueError(
            f"image: shape {pixels.shape} is given; (h, w), (h, w, 3) or (h, w, 4) is expected"
        )
    height, width = pixels.shape[:2]
    # each row begins with its PNG filter type: none
    rows = np.zeros((height, 1 + width * channels), np.uint8)
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


def write_png(path: Path, image: Any) -> None:
    """Write an image as `png_bytes` makes it."""
    name, data = _values.file_name(path, "path"), png_bytes(image)
    with open(name, "wb") as file:
        file.write(data)


class Gbuffer(NamedTuple):
    """The paper's four targets as OpenGL drew them, (h, w, 4) each.

    Where edges pass, a pixel may be another triangle's than in the picture, which is exact.
    """

    position: NDArray[np.float32]
    """The visible point in world space; the fourth number is -1 if the pixel sees nothing."""
    normal: NDArray[np.float32]
    """The unit shading normal at that point."""
    diffuse: NDArray[np.float32]
    """The diffuse reflectance; the fourth number is 1, or 0 if the pixel sees nothing."""
    specular: NDArray[np.float32]
    """The same for the specular reflectance."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A rendered frame: arrays of h x w pixels, rows from the top. A notebook displays it.

    Two pictures are equal if all their arrays and their exposures are equal. Where an array is
    expected, it is `image`: ``np.asarray(picture)``, or ``plt.imshow(picture)``.

    >>> import numpy as np, raysheaf
    >>> np.asarray(raysheaf.render("builtin:cornell", width=8, height=6)).shape
    (6, 8, 3)
    """

    image: NDArray[np.uint8]
    """(h, w, 3), exposed and tone-mapped sRGB; (h, w, 4) with a transparent background."""
    beauty: NDArray[np.float32]
    """(h, w, 3), linear radiance, Rec. 709 primaries."""
    position: NDArray[np.float32]
    """(h, w, 3), the visible point in world space; 0 if the pixel sees nothing."""
    normal: NDArray[np.float32]
    """(h, w, 3), the shading normal at that point."""
    albedo: NDArray[np.float32]
    """(h, w, 3), diffuse plus specular reflectance at that point."""
    shadow: NDArray[np.float32]
    """(h, w), the part of the lights in front of the surface that reaches it."""
    inst_id: NDArray[np.uint32]
    """(h, w), the visible instance; all three ids are `INVALID_ID` if the pixel sees nothing."""
    geom_id: NDArray[np.uint32]
    """(h, w), the visible mesh."""
    prim_id: NDArray[np.uint32]
    """(h, w), the visible triangle."""
    exposure: float
    """The factor on `beauty` before tone mapping."""
    gbuffer: Optional[Gbuffer] = None
    """The paper's four targets, if `render` was asked for them."""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Picture):
            return NotImplemented
        mine, theirs = dict(vars(self)), dict(vars(other))
        targets = mine.pop("gbuffer"), theirs.pop("gbuffer")
        if any(target is None for target in targets):
            if targets != (None, None):
                return False
        elif not all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*targets)):
            return False
        return all(np.array_equal(mine[name], theirs[name], equal_nan=True) for name in mine)

    __hash__ = None  # type: ignore[assignment]

    def __array__(self, dtype: Any = None, copy: Any = None) -> NDArray[Any]:
        return np.array(self.image, dtype) if copy else np.asarray(self.image, dtype)

    def _repr_png_(self) -> bytes:
        return png_bytes(self.image)

    def save(self, path: Path) -> None:
        """Write the picture as its name says: .png and .jpg have `image`, .exr has the other arrays.

        An OpenEXR file has the layers that the command line writes: `beauty` as R, G, B, then
        position.X and so on. Raises `ValueError` for any other ending.
        """
        name = _values.path_in_utf8(path, "path")
        ending = os.path.splitext(name)[1].lower()
        if ending == ".png":
            write_png(name, self.image)
        elif ending in (".jpg", ".jpeg"):
            height, width, channels = self.image.shape
            rgba = np.full((height, width, 4), 255, np.uint8)
            rgba[..., :channels] = self.image
            _core.write_jpeg(name, rgba)
        elif ending == ".exr":
            layers = [
                ("", "RGB", self.beauty),
                ("position.", "XYZ", self.position),
                ("normal.", "XYZ", self.normal),
                ("albedo.", "RGB", self.albedo),
                ("shadow.", "V", self.shadow[..., None]),
            ]
            if self.gbuffer is not None:
                for target, letters in zip(Gbuffer._fields, ("XYZ", "XYZ", "RGB", "RGB")):
                    layers.append((f"gbuffer_{target}.", letters, getattr(self.gbuffer, target)))
            arrays = [(name, chars, np.ascontiguousarray(x)) for name, chars, x in layers]
            _core.write_exr(name, arrays)
        else:
            raise ValueError(
                f"path: {name!r} is given; a name that ends in .png, .jpg, .jpeg or .exr is expected"
            )

    def __repr__(self) -> str:
        return f"<raysheaf.Picture {self.image.shape[1]}x{self.image.shape[0]}>"


class Animation:
    """A scene that moves: glTF with its nodes, skins and morph targets, or a sequence of files.

    `render` makes its images; each costs only what has changed since the previous one. Python
    threads may share an animation; one renders at a time.

    Parameters
    ----------
    scene : str, bytes or path
        A glTF or GLB file, a JSON file that describes a sequence, or a pattern of files such as
        ``"frame_*.obj"``; any other scene that `render` reads is static.

    Raises
    ------
    InvalidError
        For an invalid file.
    NotFoundError
        For a missing file, and for a pattern that matches none.

    Examples
    --------
    >>> import raysheaf
    >>> still = raysheaf.Animation("builtin:cornell")
    >>> still.start, still.end, still.clips
    (0.0, 0.0, [])
    >>> raysheaf.render(still, time=0, width=32, height=32)
    <raysheaf.Picture 32x32>
    """

    def __init__(self, scene: Path) -> None:
        self._name = _values.path_in_utf8(scene, "scene")
        self._film = _core.Film(self._name, True)

    @property
    def start(self) -> float:
        """The first time, in seconds."""
        return self._film.start

    @property
    def end(self) -> float:
        """The last time, in seconds."""
        return self._film.end

    @property
    def frame_times(self) -> list[float]:
        """The times of the frames of a sequence; empty if every time has a frame."""
        return self._film.frame_times

    @property
    def clips(self) -> list[str]:
        """The clips. One plays at a time; clips that drive different things count as one."""
        return self._film.clips

    def play(self, clip: Union[str, SupportsIndex]) -> None:
        """Choose the clip of later images, by name or number; `start` and `end` are then its times.

        Raises
        ------
        NotFoundError
            There is no such clip.
        """
        if isinstance(clip, str):
            if clip not in self.clips:
                known = ", ".join(self.clips) or "none"
                raise NotFoundError("not_found", f"there is no {clip!r}; there is {known}", "clip")
            clip = self.clips.index(clip)
        self._film.play(_arrays.integer(clip, "clip"))

    def __getstate__(self) -> NoReturn:
        raise TypeError("an animation can neither be copied nor pickled; make another of its file")

    def __repr__(self) -> str:
        return f"<raysheaf.Animation {self._name!r}, {self.start:g} to {self.end:g} s>"


def _light(light: Any) -> dict[str, Any]:
    if not isinstance(light, Light):
        raise TypeError(f"lights: {light!r} is given; a Light is expected")
    return light._described()


def _size(width: Optional[SupportsIndex], height: Optional[SupportsIndex]) -> tuple[int, int]:
    """0 for what is not given, which the extension derives from the camera's aspect ratio."""
    wide = 0 if width is None else _arrays.integer(width, "width", least=1)
    high = 0 if height is None else _arrays.integer(height, "height", least=1)
    return wide, high


def _viewpoint(
    request: _core.PictureRequest,
    view: Optional[str],
    up: Optional[str],
    camera_position: Optional[Sequence[Number]],
    look_at: Optional[Sequence[Number]],
    fov: Optional[Number],
    orthographic: bool,
    zoom: Number,
    camera: Any,
) -> None:
    """Sets the viewpoint of a picture, or the camera that it has of its own."""
    given: dict[str, Any] = {
        "view": None if view is None else _values.text(view, "view"),
        "up": None if up is None else _values.text(up, "up"),
        "position": None
        if camera_position is None
        else _values.point(camera_position, "camera_position"),
        "look_at": None if look_at is None else _values.point(look_at, "look_at"),
        "fov": None if fov is None else math.radians(_values.number(fov, "fov")),
        "orthographic": bool(orthographic),
        "zoom": _values.number(zoom, "zoom"),
    }
    own = [name for name in list(given)[:6] if given[name] not in (None, False)]
    if own and not (isinstance(camera, str) and camera == ""):
        name = own[0].replace("position", "camera_position")
        raise ValueError(f"{name}: camera is given, too; a camera of the scene has its own place")
    request.look_from(**given)
    request.seen_from = repr(given)
    if isinstance(camera, Camera):
        described = camera._described()
        request.look_through(described)
        request.seen_from += repr(described)


def _camera(
    camera: Any, width: Optional[SupportsIndex], height: Optional[SupportsIndex]
) -> tuple[Any, Optional[SupportsIndex], Optional[SupportsIndex]]:
    """The camera of rays, and their size where none is given."""
    if not isinstance(camera, Rays):
        return camera, width, height
    if camera.camera is None:
        raise ValueError("camera: Rays of no camera are given; those of a camera are expected")
    high, wide = camera.shape
    if width is None:
        width = wide if height is None else max(round(operator.index(height) * wide / high), 1)
    if height is None:
        height = max(round(operator.index(width) * high / wide), 1)
    return camera.camera, width, height


def render(
    scene: Union[Path, Scene, Animation],
    *,
    time: Optional[Number] = None,
    width: Optional[SupportsIndex] = None,
    height: Optional[SupportsIndex] = None,
    camera: Union[str, SupportsIndex, Camera, Rays] = "",
    lights: Optional[Sequence[Light]] = None,
    method: str = "dual",
    primary: Literal["trace", "raster"] = "trace",
    bounces: SupportsIndex = 2,
    threads: SupportsIndex = 0,
    device: Device = "cpu",
    exposure: Optional[Number] = None,
    samples: SupportsIndex = 0,
    aperture: Optional[Number] = None,
    focus: Optional[Number] = None,
    environment: Optional[Path] = None,
    sun: Optional[Sequence[Any]] = None,
    view: Optional[str] = None,
    up: Optional[str] = None,
    camera_position: Optional[Sequence[Number]] = None,
    look_at: Optional[Sequence[Number]] = None,
    fov: Optional[Number] = None,
    orthographic: bool = False,
    zoom: Number = 1,
    background: Optional[str] = None,
    ground: bool = False,
    gbuffer: bool = False,
) -> Picture:
    """Render a frame of a scene: a file, a built-in one, or a `Scene`.

    Ctrl-C stops it: immediately in brute force, otherwise between batches of rays.

    Parameters
    ----------
    scene : str, bytes, path, Scene or Animation
        A glTF, GLB, OBJ, PLY or STL file; or ``"builtin:office"``, ``"builtin:cornell"``,
        ``"builtin:atrium"``; or a `Scene` as it is now: all instances whose masks are not 0. If it
        has no camera, or its first one shows the scene small, an automatic camera fills the
        image with it; if it has no light, it gets the three lights of a studio.
        For several pictures of one scene pass an `Animation`: a path is loaded every time. A
        `UserWarning` names each thing of a file that is ignored or missing: the first eight, and
        how many more there are.
    time : float, optional
        Seconds, clamped to the animation's `start` and `end`. By default, a file is shown in its
        rest pose, and an `Animation` at its start.
    width, height : int, optional
        Pixels, 1 to 16384 each. A side that is not given follows from the camera's aspect ratio, or
        the picture is square; without both, the longer side has 512.
    camera : str, int, Camera, or Rays
        Name or number; by default the first, if it shows the scene. An int is tried as a number first, a str as a name.
        Or a camera of your own, such as what `pinhole` and `orthographic` give.
    lights : sequence of Light, optional
        In the place of the scene's lights; not of an `Animation`, which moves its own.
    method : str
        ``"dual"``, ``"crsh"``, ``"rah"``, ``"gl10"`` or ``"brute"``; the image is the same.
    primary : "trace" or "raster"
        How primary visibility is found: by rays, or by OpenGL, the command line's default.
    bounces : int
        The largest number of successive reflections and refractions, 0 to 32.
    threads : int
        Number of threads; 0 uses all cores.
    device : "cpu" or "cuda"
        Where the image is rendered. The image is the same.
    exposure : float, optional
        A factor on radiance before tone mapping; by default it is chosen for each image. For a film
        pass one value, such as that of the first image.
    samples : int
        Rays per pixel, 1 to 65536. 0 stands for 4, for 16 with an environment or a lens, and for 1
        for a built-in scene.
    aperture : float, optional
        Diameter of the lens; by default the camera's, which is usually 0: everything is sharp.
    focus : float, optional
        The depth that is sharp; by default the camera's, or the depth at the image's centre.
    environment : str, bytes or path, optional
        Light from all directions: a ``.hdr`` or ``.exr`` file, +y up. A `UserWarning` names what
        of it is read as something else, such as negative radiance.
    sun : three floats, or two floats and a datetime, optional
        The sun in a clear sky, in the place of an environment: the direction to it, or a place in
        degrees north and east and a time with its zone, as in
        ``(48.1, 11.6, datetime(2026, 6, 21, 12, tzinfo=timezone.utc))``. A viewer who looks at the
        front of the model looks north. The scene keeps its lights.
    view : str, optional
        The side that is seen: ``"front"``, ``"back"``, ``"left"``, ``"right"``, ``"top"``,
        ``"bottom"`` or ``"iso"``. This argument and the five below replace the scene's cameras.
    up : str, optional
        The axis that points up: ``"x"``, ``"y"`` (the default), ``"z"``, ``"-x"``, ``"-y"`` or
        ``"-z"``.
    camera_position : three floats, optional
        The camera's position; by default the nearest one from which the whole scene is visible.
    look_at : three floats, optional
        The point at which the camera of `camera_position` looks; by default the scene's centre.
    fov : float, optional
        The vertical field of view in degrees, between 0 and 180; 40 by default.
    orthographic : bool
        Parallel rays instead of a perspective.
    zoom : float
        Magnifies the picture around its centre, with any camera.
    background : str, optional
        ``"white"``, ``"black"``, ``"transparent"`` or ``"#rrggbb"`` in sRGB, behind the scene in
        `image`. By default the environment, or without one a neutral light grey.
    ground : bool
        The scene casts its shadow on a ground at its lowest point, square to `up` and otherwise
        invisible: where the shadow lies, the background is darker; a transparent one is partly
        opaque there.
    gbuffer : bool
        With `primary="raster"` OpenGL draws the paper's four targets, which become the picture's
        `gbuffer`. The image is the same.

    Raises
    ------
    InvalidError
        For invalid options or files.
    NotFoundError
        For a missing file, camera or built-in scene.
    Error
        With code ``"io"`` for a file that cannot be read, ``"no_graphics"`` for "raster" without
        OpenGL, ``"unsupported"`` for "cuda" without a device.

    Examples
    --------
    >>> import raysheaf
    >>> picture = raysheaf.render("builtin:cornell", width=48, height=32)
    >>> picture.image.shape, picture.image.dtype
    ((32, 48, 3), dtype('uint8'))

    A mesh of your own:

    >>> scene = raysheaf.Scene()
    >>> red = raysheaf.Material(base_color=(0.8, 0.1, 0.1))
    >>> mesh = scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], material=red)
    >>> raysheaf.render(scene, camera=raysheaf.pinhole((0, 0, 4), (0, 0, 0), width=32, height=32))
    <raysheaf.Picture 32x32>
    """
    camera, width, height = _camera(camera, width, height)
    at = None if time is None else _values.number(time, "time")
    if at is not None and math.isnan(at):
        raise ValueError("time: NaN is given; seconds are expected")
    request = _core.PictureRequest(
        *_size(width, height),
        *_values.text_or_index("" if isinstance(camera, Camera) else camera, "camera"),
        _values.text(method, "method"),
        _values.is_second(primary, "primary", "trace", "raster"),
        _arrays.integer(bounces, "bounces"),
        _arrays.integer(threads, "threads", _MOST_THREADS),
        is_cuda(device),
        None if exposure is None else _values.number(exposure, "exposure"),
        _arrays.integer(samples, "samples"),
        None if aperture is None else _values.number(aperture, "aperture"),
        None if focus is None else _values.number(focus, "focus"),
        "" if environment is None else _values.path_in_utf8(environment, "environment"),
    )
    _viewpoint(request, view, up, camera_position, look_at, fov, orthographic, zoom, camera)
    if sun is not None:
        if environment is not None:
            raise ValueError("sun: environment is given, too; one of them is expected")
        request.shine(*_values.sun(sun, "sun"))
    if background is not None:
        request.background = _values.background(background, "background")
    request.has_ground = bool(ground)
    request.gbuffer = bool(gbuffer)
    if lights is not None:
        if isinstance(scene, Animation):
            raise ValueError("lights: an Animation moves its own lights; None is expected")
        request.light_by([_light(light) for light in lights])
    mesh_ids = instance_ids = None
    if isinstance(scene, Animation):
        made = scene._film.render(request, scene.start if at is None else at)
    elif isinstance(scene, Scene):
        if at is not None:
            raise ValueError("time: a Scene is at one time only; None is expected")
        described, mesh_ids, instance_ids = scene._described()
        made = _core.Film(described).render(request, None)
    else:
        film = _core.Film(_values.path_in_utf8(scene, "scene"), at is not None)
        made = film.render(request, at)
    told = made["warnings"]
    for sentence in told[:_MOST_WARNINGS]:
        warnings.warn(sentence, stacklevel=2)
    if len(told) > _MOST_WARNINGS:
        more = f"{len(told) - _MOST_WARNINGS} more; `load` has all of them in `Scene.warnings`"
        warnings.warn(more, stacklevel=2)
    ids = made["ids"]
    if mesh_ids is not None and instance_ids is not None:
        own = ids.copy()
        own[..., 0] = instance_ids[np.minimum(ids[..., 0], len(instance_ids) - 1)]
        own[..., 1] = mesh_ids[np.minimum(ids[..., 1], len(mesh_ids) - 1)]
        ids = own
    return Picture(
        image=np.ascontiguousarray(made["rgba"][..., : 4 if background == "transparent" else 3]),
        beauty=made["beauty"],
        position=made["position"],
        normal=made["normal"],
        albedo=made["albedo"],
        shadow=made["shadow"],
        inst_id=ids[..., 0],
        geom_id=ids[..., 1],
        prim_id=ids[..., 2],
        exposure=made["exposure"],
        gbuffer=Gbuffer(*made["gbuffer"]) if "gbuffer" in made else None,
    )
