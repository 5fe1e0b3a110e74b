"""Rays as cameras and scanners send them out."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator, Optional, Sequence, SupportsFloat, SupportsIndex, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values

Number = Union[SupportsFloat, SupportsIndex]
Point = Union[Sequence[Number], NDArray[Any]]

_MOST_PIXELS = 16384
_AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
_AXES.update({f"-{name}": (-x, -y, -z) for name, (x, y, z) in list(_AXES.items())})


@dataclass(frozen=True, eq=False)
class Rays:
    """A batch of rays: what every query takes in the place of origins and directions.

    >>> import raysheaf
    >>> rays = raysheaf.pinhole((0, 0, 5), (0, 0, 0), width=4, height=3)
    >>> rays
    <raysheaf.Rays of shape (3, 4)>
    >>> scene = raysheaf.Scene()
    >>> mesh = scene.add([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]])
    >>> scene.closest_hit(rays).t.shape
    (3, 4)
    >>> origins, directions = rays
    >>> directions.shape
    (3, 4, 3)

    They can be indexed and reshaped as arrays are, joined, and moved:

    >>> rays[0, ::2].shape, rays.reshape(12).shape
    ((2,), (12,))
    >>> beams = raysheaf.lidar(azimuth=[0, 90], elevation=[0])
    >>> raysheaf.Rays.join([rays, beams]).shape
    (14,)
    >>> beams.transformed([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]]).origins[0, 0]
    array([5., 0., 0.], dtype=float32)
    """

    origins: NDArray[np.float32]
    """(..., 3), where the rays begin."""
    directions: NDArray[np.float32]
    """(..., 3), where they go; not always of length 1."""
    t_min: Union[float, NDArray[np.float32]] = 0.0
    """Hits lie from here on, a number or an array of the batch's shape,"""
    t_max: Union[float, NDArray[np.float32]] = math.inf
    """to here, in lengths of the direction."""
    camera: Optional[Camera] = None
    """The camera whose pixels they belong to: `render` takes it, too."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the batch, without the last axis of the arrays."""
        return self.directions.shape[:-1]

    def _each(self, change: Callable[[NDArray[Any]], NDArray[Any]]) -> Rays:
        """The rays of no camera whose arrays are changed, with items in the batch's shape."""

        def changed(value: Any, *tail: int) -> Any:
            if not tail and np.ndim(value) == 0:
                return value
            return change(np.broadcast_to(value, self.shape + tail))

        return Rays(
            changed(self.origins, 3),
            changed(self.directions, 3),
            changed(self.t_min),
            changed(self.t_max),
        )

    def __getitem__(self, index: Any) -> Rays:
        """Some of the rays, by any index of numpy's for an array of the batch's shape."""
        places = np.arange(math.prod(self.shape)).reshape(self.shape)[index]
        return self._each(lambda array: array.reshape(-1, *array.shape[len(self.shape) :])[places])

    def reshape(self, *shape: Union[SupportsIndex, tuple[SupportsIndex, ...]]) -> Rays:
        """The same rays in another shape, as numpy's ``reshape`` has it."""
        wanted = np.empty(self.shape, np.bool_).reshape(*shape).shape  # type: ignore[arg-type]
        return self._each(lambda array: array.reshape(wanted + array.shape[len(self.shape) :]))

    @staticmethod
    def join(batches: Sequence[Rays]) -> Rays:
        """The rays of all batches in a row, of shape (n,)."""
        for one in batches:
            if not isinstance(one, Rays):
                raise TypeError(f"batches: {type(one).__name__} is given; Rays are expected")

        def joined(name: str, *tail: int) -> NDArray[np.float32]:
            parts = [np.zeros((0, *tail), np.float32)]
            for one in batches:
                array = np.broadcast_to(getattr(one, name), one.shape + tail)
                parts.append(np.asarray(array, np.float32).reshape(-1, *tail))
            return np.concatenate(parts)

        return Rays(
            joined("origins", 3), joined("directions", 3), joined("t_min"), joined("t_max")
        )

    def transformed(self, matrix: ArrayLike) -> Rays:
        """The rays, moved by a (3, 4) or (4, 4) matrix, as `Scene.add` takes it.

        Directions change with it and are not normalized, so that `t` of a point on a ray stays.
        """
        turn, shift = np.split(_arrays.transform(matrix, "matrix").astype(np.float64), [3], axis=1)
        origins = self.origins @ turn.T + shift[:, 0]
        directions = self.directions @ turn.T
        return Rays(
            origins.astype(np.float32), directions.astype(np.float32), self.t_min, self.t_max
        )

    def __iter__(self) -> Iterator[NDArray[np.float32]]:
        return iter((self.origins, self.directions))

    def __repr__(self) -> str:
        return f"<raysheaf.Rays of shape {self.shape}>"


@dataclass(eq=False)
class Camera:
    """A camera that looks along its own -z, with +y up in the picture.

    `pinhole` and `orthographic` make cameras that stand somewhere and look somewhere; `Scene.cameras`
    lists those of a file.

    >>> import raysheaf
    >>> raysheaf.Camera(fov=30).rays(320, 240).shape
    (240, 320)
    """

    to_world: ArrayLike = field(default_factory=lambda: np.eye(3, 4, dtype=np.float32))
    """(3, 4) or (4, 4), from the camera's space to the world."""
    fov: Number = 60.0
    """The vertical field of view in degrees, of a perspective."""
    orthographic: bool = False
    """Parallel rays instead of a perspective."""
    size: Number = 2.0
    """The height of what is seen, of parallel rays."""
    near: Number = 0.01
    """Nothing nearer is seen; above 0 for a perspective,"""
    far: Number = math.inf
    """and nothing farther."""
    aspect_ratio: Number = 0.0
    """The least width over height of what is seen in any picture; 0: any."""
    aperture: Number = 0.0
    """The diameter of a thin lens, for `render`; 0 makes everything sharp."""
    focus: Number = 0.0
    """The depth that is sharp; 0: that of what the picture's middle shows."""
    name: str = ""
    """`render` finds it by this name."""

    def rays(
        self, width: Optional[SupportsIndex] = None, height: Optional[SupportsIndex] = None
    ) -> Rays:
        """The rays through the centres of the pixels, of shape (height, width), rows from the top.

        They are the ones that `render` begins with. Their directions have length 1 along the
        camera's axis, so that `t` of a hit is its depth. A side that is not given
        follows from `aspect_ratio`, or the picture is square; without both, the longer side has 512.
        """
        wide, high = self._size(width, height)
        matrix = _arrays.transform(self.to_world, "to_world")
        axes = matrix[:, :3].astype(np.float64)
        lengths = np.linalg.norm(axes, axis=0)
        if not (np.isfinite(matrix).all() and lengths.all()):
            raise ValueError(
                "to_world: the matrix has no three axes; an invertible one is expected"
            )
        right, up, back = np.ascontiguousarray((axes / lengths).T, np.float32)
        half = np.float32(_values.number(self.size, "size")) / np.float32(2)
        if not self.orthographic:
            half = np.tan(np.float32(self._fov()) * np.float32(0.5))
        shape = np.float32(wide) / np.float32(high)
        wanted = np.float32(_values.number(self.aspect_ratio, "aspect_ratio"))
        if shape < wanted:
            half = half * (wanted / shape)
        across = right * (_centers(wide) * (half * shape))[:, None]
        aside: NDArray[np.float32] = across[None] - up * (_centers(high) * half)[:, None, None]
        eye = np.broadcast_to(matrix[:, 3], aside.shape)
        if self.orthographic:
            origins, directions = eye + aside, np.broadcast_to(-back, aside.shape)
        else:
            origins, directions = eye, aside - back
        near = max(_values.number(self.near, "near"), 0.0)
        return Rays(origins, directions, near, _values.number(self.far, "far"), self)

    def _fov(self) -> float:
        fov = _values.number(self.fov, "fov")
        if not 0 < fov < 180:
            raise ValueError(f"fov: {self.fov!r} is given; degrees between 0 and 180 are expected")
        return math.radians(fov)

    def _size(
        self, width: Optional[SupportsIndex], height: Optional[SupportsIndex]
    ) -> tuple[int, int]:
        aspect = _values.number(self.aspect_ratio, "aspect_ratio") or 1.0
        if width is None and height is None:
            return max(round(512 * min(aspect, 1)), 1), max(round(512 * min(1 / aspect, 1)), 1)
        given = [
            None if side is None else _arrays.integer(side, name, _MOST_PIXELS, least=1)
            for name, side in (("width", width), ("height", height))
        ]
        wide, high = given
        return (
            wide or min(max(round((high or 0) * aspect), 1), _MOST_PIXELS),
            high or min(max(round((wide or 0) / aspect), 1), _MOST_PIXELS),
        )

    def _described(self) -> dict[str, Any]:
        """As the extension has cameras."""
        matrix = _arrays.transform(self.to_world, "to_world")
        return {
            "name": _values.text(self.name, "name"),
            "to_world": tuple(matrix.ravel().tolist()),
            "orthographic": bool(self.orthographic),
            "y_fov": self._fov() if not self.orthographic else 1.0,
            "y_mag": _values.number(self.size, "size") / 2,
            "aspect_ratio": _values.number(self.aspect_ratio, "aspect_ratio"),
            "z_near": _values.number(self.near, "near"),
            "z_far": _values.number(self.far, "far"),
            "aperture": _values.number(self.aperture, "aperture"),
            "focus": _values.number(self.focus, "focus"),
        }

    def __repr__(self) -> str:
        x, y, z = np.asarray(self.to_world, np.float64)[:3, 3].tolist()
        kind = f"size {self.size:g}" if self.orthographic else f"fov {self.fov:g}"
        return f"<raysheaf.Camera {self.name!r} at ({x:g}, {y:g}, {z:g}), {kind}>"


def camera_from(described: dict[str, Any]) -> Camera:
    """The extension's dictionary as a camera."""
    return Camera(
        to_world=np.array(described["to_world"], np.float32).reshape(3, 4),
        fov=math.degrees(described["y_fov"]),
        orthographic=described["orthographic"],
        size=2 * described["y_mag"],
        near=described["z_near"],
        far=described["z_far"],
        aspect_ratio=described["aspect_ratio"],
        aperture=described["aperture"],
        focus=described["focus"],
        name=described["name"],
    )


def _centers(count: int) -> NDArray[np.float32]:
    """Where the centres of pixels lie between the picture's edges at -1 and 1."""
    twice = 2 * np.arange(count) + 1 - count
    return twice.astype(np.float32) / np.float32(count)


def _direction(value: Any, name: str) -> NDArray[np.float64]:
    """A unit vector of a vector, or of the name of an axis."""
    if isinstance(value, str):
        if value not in _AXES:
            raise ValueError(
                f"{name}: {value!r} is given; {', '.join(map(repr, _AXES))} or three numbers are expected"
            )
        return np.array(_AXES[value], np.float64)
    vector = np.array(_values.point(value, name), np.float64)
    length = np.linalg.norm(vector)
    if not (np.isfinite(length) and length > 0):
        raise ValueError(f"{name}: {value!r} is given; a vector with a direction is expected")
    return np.asarray(vector / length)


def _looking(position: Any, look_at: Any, up: Any) -> tuple[NDArray[np.float64], float]:
    """The matrix of a camera, and how far it looks."""
    eye = np.array(_values.point(position, "position"), np.float64)
    target = np.array(_values.point(look_at, "look_at"), np.float64)
    way = eye - target
    distance = float(np.linalg.norm(way))
    if not (math.isfinite(distance) and distance > 0):
        raise ValueError(
            "look_at: it is where the camera is, or not finite; another point is expected"
        )
    back = way / distance
    right = np.cross(_direction(up, "up"), back)
    length = np.linalg.norm(right)
    if length < 1e-7:
        raise ValueError("up: the camera looks along it; another direction is expected")
    right /= length
    return np.stack([right, np.cross(back, right), back, eye], axis=1), distance


def pinhole(
    position: Point,
    look_at: Point,
    *,
    up: Union[str, Point] = "y",
    fov: Number = 40.0,
    width: SupportsIndex = 512,
    height: SupportsIndex = 512,
    near: Optional[Number] = None,
) -> Rays:
    """The rays of a camera: from one point through the centres of the pixels of a picture.

    Parameters
    ----------
    position, look_at : three floats
        Where the camera is, and the point in the middle of the picture.
    up : str or three floats
        What is up in the picture: ``"x"``, ``"y"``, ``"z"``, ``"-x"``, ``"-y"``, ``"-z"``, or a
        direction.
    fov : float
        The vertical field of view in degrees.
    width, height : int
        Pixels.
    near : float, optional
        Hits begin at this depth; by default at 1e-4 of the distance to `look_at`.

    Returns
    -------
    Rays
        Of shape (height, width), rows from the top. `t` of a hit is its depth along the camera's
        axis. `render` takes them as a camera, too.

    Examples
    --------
    >>> import raysheaf
    >>> scene = raysheaf.load("builtin:cornell")
    >>> rays = raysheaf.pinhole((0, 1, 3.4), (0, 1, 0), width=32, height=24)
    >>> depth = scene.closest_hit(rays).t
    >>> depth.shape
    (24, 32)
    >>> raysheaf.render(scene, camera=rays)
    <raysheaf.Picture 32x24>
    """
    matrix, distance = _looking(position, look_at, up)
    hither = 1e-4 * distance if near is None else _values.number(near, "near")
    return Camera(matrix, fov=fov, near=hither).rays(width, height)


def orthographic(
    position: Point,
    look_at: Point,
    *,
    up: Union[str, Point] = "y",
    size: Number = 2.0,
    width: SupportsIndex = 512,
    height: SupportsIndex = 512,
) -> Rays:
    """Parallel rays through the centres of the pixels of a picture, which is `size` high.

    The rays begin in the plane through `position`. All else is as `pinhole` has it.

    >>> import raysheaf
    >>> scene = raysheaf.Scene()
    >>> mesh = scene.add([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> above = raysheaf.orthographic((0, 0, 9), (0, 0, 0), size=4, width=4, height=4)
    >>> scene.any_hit(above).astype(int)
    array([[0, 0, 0, 0],
           [0, 1, 1, 0],
           [0, 1, 1, 0],
           [0, 0, 0, 0]])
    """
    matrix, _ = _looking(position, look_at, up)
    return Camera(matrix, orthographic=True, size=size, near=0.0).rays(width, height)


def lidar(
    position: Point = (0.0, 0.0, 0.0),
    *,
    azimuth: Optional[ArrayLike] = None,
    elevation: Optional[ArrayLike] = None,
    up: Union[str, Point] = "y",
    forward: Optional[Union[str, Point]] = None,
    t_max: Number = math.inf,
) -> Rays:
    """The beams of a scanner that turns about an axis.

    Parameters
    ----------
    position : three floats
        Where the scanner is.
    azimuth : (n,) array of degrees, optional
        Counter-clockwise about `up`, from `forward` on; 0, 1, ... 359 by default.
    elevation : (m,) array of degrees, optional
        Above the plane across `up`; 16 from -15 to 15 by default.
    up, forward : str or three floats
        The axis that the scanner turns about, and the way of azimuth 0: an axis such as ``"z"`` or
        ``"-x"``, or a direction. By default y, as for cameras, and the axis after `up`: z
        for y, x for z. The part of `forward` across `up` counts.
    t_max : float
        The range: directions have length 1, so that `t` of a hit is its distance.

    Returns
    -------
    Rays
        Of shape (n, m).

    Examples
    --------
    >>> import raysheaf
    >>> beams = raysheaf.lidar((0, 0, 1), azimuth=[0, 90, 180, 270], elevation=[-45, 0], up="z")
    >>> beams.shape
    (4, 2)
    >>> beams.directions[1].round(2) + 0
    array([[ 0.  ,  0.71, -0.71],
           [ 0.  ,  1.  ,  0.  ]], dtype=float32)
    >>> scene = raysheaf.Scene()
    >>> ground = scene.add([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]])
    >>> scene.closest_hit(beams).t[0]
    array([1.4142135,       inf], dtype=float32)
    """
    axis = _direction(up, "up")
    if forward is None:
        forward = np.roll(axis, 1)
    ahead = _direction(forward, "forward")
    ahead = ahead - np.dot(ahead, axis) * axis
    length = np.linalg.norm(ahead)
    if length < 1e-7:
        raise ValueError("forward: it runs along up; another direction is expected")
    ahead /= length
    if azimuth is None:
        azimuth = np.arange(360.0)
    turn = np.radians(_angles(azimuth, "azimuth"))[:, None, None]
    if elevation is None:
        elevation = np.linspace(-15.0, 15.0, 16)
    lift = np.radians(_angles(elevation, "elevation"))[None, :, None]
    flat = np.cos(turn) * ahead + np.sin(turn) * np.cross(axis, ahead)
    directions = (np.cos(lift) * flat + np.sin(lift) * axis).astype(np.float32)
    eye = np.array(_values.point(position, "position"), np.float32)
    return Rays(
        np.broadcast_to(eye, directions.shape), directions, 0.0, _values.number(t_max, "t_max")
    )


def _angles(value: Any, name: str) -> NDArray[np.float64]:
    angles = _arrays.floats(value, name, "an array of degrees").astype(np.float64)
    if angles.ndim > 1:
        raise ValueError(f"{name}: an array of shape {angles.shape} is given; (n,) is expected")
    return np.atleast_1d(angles)
