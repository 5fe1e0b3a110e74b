"""Lidars, depth cameras and other range sensors of robots, over the ray queries of a scene.

`SpinningLidar`, `SolidStateLidar`, `DepthCamera`, `HeightScan` and `Rangefinders` are sensors;
``sensor.scan(scene, pose)`` casts all their beams in one query and returns a `Scan`: ranges,
points, normals, ids, labels, incidence, intensity and the time of each beam. The pose is a matrix,
many of them, or a `Trajectory`, along which each beam starts where the sensor is at its time.

>>> import numpy as np, raysheaf
>>> from raysheaf.sensors import SpinningLidar
>>> scene = raysheaf.Scene()
>>> ground = scene.add([[-99, -99, 0], [99, -99, 0], [0, 99, 0]])
>>> lidar = SpinningLidar(elevation=[-30, 0], steps=360)
>>> pose = np.eye(4)
>>> pose[2, 3] = 2.0                              # 2 m above the ground
>>> scan = lidar.scan(scene, pose)
>>> scan.range[0]
array([ 4., inf], dtype=float32)
>>> scan
<raysheaf.sensors.Scan of shape (360, 2): 360 returns of 720>
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import (
    Any,
    ClassVar,
    Generic,
    Literal,
    Optional,
    Protocol,
    Sequence,
    SupportsIndex,
    TypeVar,
    Union,
    cast,
)

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values
from ._asked import Points
from ._cameras import Rays, _direction
from ._hits import Hits
from ._lens import Lens
from ._poses import Doubles, Pose, Trajectory
from ._queries import ALL, Worlds
from ._scan import Beams, ByNumber, DepthImage, Echoes, Heights, Looks, Placing, Scan
from ._scan import cosines as _cosines, without as _without
from ._scene import Scene

__all__ = [
    "DepthCamera",
    "DepthImage",
    "HeightScan",
    "Heights",
    "Pattern",
    "Rangefinders",
    "Raster",
    "Rosette",
    "Scan",
    "Sensor",
    "SolidStateLidar",
    "SpinningLidar",
    "Trajectory",
]

Seed = Union[SupportsIndex, np.random.Generator]
Return = Literal["first", "last", "strongest"]

AScan = TypeVar("AScan", bound=Scan, covariant=True)

_RETURNS = ("first", "last", "strongest")
_GOLDEN = math.pi * (3 - math.sqrt(5))  # radians


def _number(value: Any, name: str, least: float, most: float = math.inf) -> float:
    number = _values.number(value, name)
    if not least <= number <= most:
        upper = "" if most == math.inf else f" to {most:g}"
        raise ValueError(f"{name}: {number:g} is given; a number from {least:g}{upper} is expected")
    return number


def _above(value: Any, name: str, most: float = math.inf) -> float:
    number = _values.number(value, name)
    if not 0 < number <= most or math.isinf(number):
        raise ValueError(f"{name}: {number:g} is given; a finite number above 0 is expected")
    return number


def _row(value: Any, name: str, count: Optional[int] = None) -> Doubles:
    """(n,) finite numbers."""
    row = np.atleast_1d(_arrays.doubles(value, name))
    if row.ndim != 1 or count not in (None, len(row)) or not np.isfinite(row).all():
        length = "n" if count is None else count
        raise ValueError(
            f"{name}: an array of shape {np.shape(value)} is given; finite numbers of shape ({length},) "
            "are expected"
        )
    return row.copy()


def _two(value: Any, name: str) -> tuple[float, float]:
    try:
        first, second = value
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {value!r} is given; two numbers are expected") from None
    return _above(first, name), _above(second, name)


def _vectors(x: Doubles, y: Doubles, z: Doubles) -> Doubles:
    """(..., 3), with all x in a row, then all y, all z: so they are turned fastest."""
    return np.moveaxis(np.stack([x, y, z]), 0, -1)


def _towards(azimuth: Any, elevation: Any) -> Doubles:
    """Unit directions for angles in degrees: x is ahead, y to the left, z up."""
    turn, lift = np.broadcast_arrays(np.radians(azimuth), np.radians(elevation))
    flat = np.cos(lift)
    return _vectors(flat * np.cos(turn), flat * np.sin(turn), np.sin(lift))


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensor(Generic[AScan]):
    """The base class of all sensors.

    Parameters
    ----------
    noise : float, or sequence of floats
        The standard deviation of ranges: a number, or the coefficients of 1, r, r², ... of a
        polynomial of the range r (for cameras, of the depth). A range that leaves the sensor's
        limits is a miss. 0 by default.
    dropout : float
        The probability with which a return is lost; 0 by default.
    """

    noise: Union[float, Sequence[float]] = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        self._keep(
            noise=tuple(_row(self.noise, "noise").tolist()),
            dropout=_number(self.dropout, "dropout", 0, 1),
        )

    def _keep(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    # Each kind of sensor defines these.

    _kind: ClassVar[type[Scan]] = Scan

    def _beams(self, start: float) -> Beams:
        raise NotImplementedError

    def _limits(self) -> tuple[float, float]:
        """The least and the largest t of a hit."""
        raise NotImplementedError

    def _placed(self, pose: Optional[Pose], start: float) -> Placing:
        return Placing.of(self._beams(start), pose, start)

    def _scanned(
        self, placing: Placing, hits: Hits, start: float, looks: Looks, seed: Optional[Seed]
    ) -> AScan:
        return self._measured(placing, hits, start, looks, seed)

    def rays(self, pose: Optional[Pose] = None, *, time: float = 0.0) -> Rays:
        """The rays of a scan in the world, for other queries; NaN for beams that see nothing.

        Parameters are those of `scan`. The shape is that of the poses, then of the beams, then of
        the subrays, if there are any.
        """
        placing = self._placed(pose, _values.number(time, "time"))
        origins, directions = placing.rays()
        near, far = self._limits()
        shape = np.broadcast_shapes(origins.shape, directions.shape)
        starts, ways = (
            np.broadcast_to(one.astype(np.float32), shape) for one in (origins, directions)
        )
        return Rays(starts, ways, near, far)

    def scan(
        self,
        scene: Scene,
        pose: Optional[Pose] = None,
        *,
        time: float = 0.0,
        moving: Optional[Sequence[float]] = None,
        worlds: Optional[Worlds] = None,
        mask: Any = ALL,
        labels: Optional[ByNumber] = None,
        reflectance: Optional[ByNumber] = None,
        seed: Optional[Seed] = None,
    ) -> AScan:
        """Cast all beams into the scene, in one query.

        Parameters
        ----------
        scene : Scene
            What the beams meet; it stands still unless `moving` is given.
        pose : (..., 4, 4) or (..., 3, 4) array, or Trajectory, optional
            From the sensor's frame to the world: a rotation and a translation, or many, for as many
            sensors. The frame has x ahead, y to the left and z up; that of a `DepthCamera` is
            OpenCV's. By default the sensor is at the world's origin. Along a trajectory, each beam
            starts where the sensor is at the beam's time.
        time : float
            Seconds: when the scan begins.
        moving : two floats, optional
            Seconds: when instances that move stand at the first of their matrices, and when at the
            last (`Scene.set_transform`). Each beam meets them where they are at its time.
        worlds : int, or array of integers, optional
            The world of each pose, as `Scene.closest_hit` takes it: ``range(4096)`` fits poses of
            shape (4096, 4, 4).
        mask : int
            The scan sees instances with ``their mask & mask`` not 0.
        labels : dict or array, optional
            An integer for each instance: by its id, or an array in the order of ids.
        reflectance : dict or array, optional
            A factor of the intensity for each label; 1 by default.
        seed : int or numpy.random.Generator, optional
            Where noise and drop-out come from; a sensor that has them needs it. The same integer
            gives the same scan.

        Returns
        -------
        Scan
            A `DepthImage` for cameras, `Heights` for height scans.

        Raises
        ------
        ValueError, TypeError
            For a pose that is not rigid, a beam's time outside of the trajectory or of `moving`, and
            for arrays of a wrong shape or dtype; the message names the argument.
        """
        if not isinstance(scene, Scene):
            raise TypeError(f"scene: {type(scene).__name__} is given; a Scene is expected")
        looks = Looks.of(labels, reflectance)
        start = _values.number(time, "time")
        if (any(self._noise) or self.dropout) and not _is_seed(seed):
            raise TypeError(
                f"seed: {seed!r} is given for noise or drop-out; an integer or a "
                "numpy.random.Generator is expected"
            )
        placing = self._placed(pose, start)
        origins, directions = placing.rays()
        near, far = self._limits()
        hits = scene.closest_hit(
            origins,
            directions,
            t_min=near,
            t_max=far,
            mask=mask,
            worlds=worlds,
            times=None if moving is None else placing.times_within(moving, start),
            invalid="error" if placing.beams.all_see else "miss",
        )
        return self._scanned(placing, hits, start, looks, seed)

    @property
    def _noise(self) -> tuple[float, ...]:
        return self.noise  # type: ignore[return-value]

    def _measured(
        self,
        placing: Placing,
        hits: Hits,
        start: float,
        looks: Looks,
        seed: Optional[Seed],
        t: Optional[Doubles] = None,
        **rest: Any,
    ) -> AScan:
        """The scan of returns at `t`, with noise and drop-out."""
        found: NDArray[Any] = hits.t if t is None else t
        if any(self._noise) or self.dropout:
            random = np.random.default_rng(seed)  # type: ignore[arg-type]
            lost = np.zeros(hits.shape, np.bool_)
            if any(self._noise):
                near, far = self._limits()
                with np.errstate(invalid="ignore"):
                    spread = np.abs(np.polynomial.Polynomial(self._noise)(found.astype(float)))
                    found = found + spread * random.standard_normal(hits.shape)
                    lost = ~((found >= near) & (found <= far))
            if self.dropout:
                lost |= random.random(hits.shape) < self.dropout
            hits, found = _without(hits, lost), np.where(lost, np.inf, found)
        return cast(AScan, self._kind(placing, hits, found, start, looks, **rest))


def _is_seed(seed: Any) -> bool:
    return isinstance(seed, (int, np.integer, np.random.Generator)) and not isinstance(seed, bool)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Lidar(Sensor[Scan]):
    """A sensor whose beams have a width and several returns, as `Rangefinders` describes them."""

    min_range: float = 0.0
    max_range: float = math.inf
    divergence: float = 0.0
    subrays: int = 1
    returns: Union[Return, Sequence[Return]] = "strongest"
    separation: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        near = _number(self.min_range, "min_range", 0)
        names = (self.returns,) if isinstance(self.returns, str) else tuple(self.returns)
        for name in names:
            if name not in _RETURNS:
                raise ValueError(
                    f'returns: {name!r} is given; "first", "last" or "strongest" is expected'
                )
        subrays = _arrays.integer(self.subrays, "subrays", 4096, least=1)
        divergence = _number(self.divergence, "divergence", 0, 90)
        if (subrays > 1) != (divergence > 0):
            raise ValueError(
                f"subrays: {subrays} of them are given for a divergence of {divergence:g} degrees; both or "
                "neither are expected"
            )
        if not names or (len(names) > 1 and subrays == 1):
            raise ValueError(
                f"returns: {len(names)} are given for a beam that is one ray; one is expected"
            )
        self._keep(
            min_range=near,
            max_range=_number(self.max_range, "max_range", near),
            returns=self.returns if isinstance(self.returns, str) else names,
            subrays=subrays,
            divergence=divergence,
            separation=_number(self.separation, "separation", 0),
        )

    def _limits(self) -> tuple[float, float]:
        return self.min_range, self.max_range

    def _spread(self, axes: Doubles) -> Optional[Doubles]:
        """Directions (b..., s, 3) in the cones: points of a disc in a sunflower's order, which have
        equal areas."""
        if self.subrays == 1:
            return None
        number = np.arange(self.subrays)
        radius = np.sqrt((number + 0.5) / self.subrays) * math.tan(math.radians(self.divergence) / 2)
        # Two vectors across the axis: the world's axis that is farthest from it, made square.
        least = np.eye(3)[np.argmin(np.abs(np.nan_to_num(axes)), axis=-1)]
        one = np.cross(axes, least)
        one /= np.linalg.norm(one, axis=-1, keepdims=True)
        two = np.cross(axes, one)
        across = radius * np.cos(_GOLDEN * number), radius * np.sin(_GOLDEN * number)
        rays: Doubles = (
            axes[..., None, :]
            + across[0][:, None] * one[..., None, :]
            + across[1][:, None] * two[..., None, :]
        )
        return _units(rays)

    def _made(self, axes: Doubles, origins: Any, times: Doubles) -> Beams:
        return Beams(axes, np.asarray(origins, np.float64), times, self._spread(axes))

    def _scanned(
        self, placing: Placing, hits: Hits, start: float, looks: Looks, seed: Optional[Seed]
    ) -> Scan:
        subrays = placing.beams.subrays
        if subrays is None:
            return super()._scanned(placing, hits, start, looks, seed)
        names = (self.returns,) if isinstance(self.returns, str) else self.returns
        shape = hits.shape[:-1]
        normals = Points(hits.array, hits._asked).facing_normal()
        each = looks.intensity(hits, _cosines(normals, placing.turned(subrays, extra=1)))
        far = hits.t.reshape(-1, self.subrays).astype(np.float64)
        power = each.reshape(far.shape) / self.subrays
        echoes = Echoes.of(far, power, self.separation, names)
        tail = shape if isinstance(self.returns, str) else (*shape, len(names))
        places = np.indices(tail, sparse=True)[: len(shape)]
        chosen = hits[(*places, echoes.subray.reshape(tail))]
        return self._measured(
            placing,
            chosen,
            start,
            looks,
            seed,
            echoes.t.reshape(tail),
            returned=echoes.intensity.reshape(tail),
            all_subrays=(far, power),
        )


# Rings, the lowest and the highest elevation, steps, range, seconds between two rings.
_PRESETS = {
    16: (-15.0, 15.0, 1800, 100.0, 2.304e-6),
    32: (-30.67, 10.67, 1800, 100.0, 1.152e-6),
    64: (-22.5, 22.5, 1024, 120.0, 0.0),
    128: (-25.0, 15.0, 1800, 200.0, 0.0),
}


@dataclass(frozen=True, eq=False)
class SpinningLidar(_Lidar):
    """A lidar whose head turns about its z axis, with rings of beams.

    Scans have the shape (steps, rings), in the order of time. Frame: x ahead, y to the left, z up.
    The beam of step k and ring j leaves the origin at the time k / (rate · steps) +
    ``time_offsets[j]``; its azimuth is that of the head at this time, plus ``azimuth_offsets[j]``.

    Parameters
    ----------
    elevation : (rings,) array
        Degrees above the plane across the axis.
    steps : int
        Steps of a revolution.
    rate : float
        Revolutions a second.
    azimuth_offsets, time_offsets : (rings,) arrays, optional
        Degrees, counter-clockwise from above, and seconds, as data sheets give them.
    first_azimuth : float
        Where the head is when the scan begins: degrees from x, counter-clockwise.
    clockwise : bool
        How the head turns, from above.

    The other parameters are those of `Rangefinders`: `min_range`, `max_range`, `divergence`,
    `subrays`, `returns`, `separation`, `noise`, `dropout`.

    >>> from raysheaf.sensors import SpinningLidar
    >>> SpinningLidar.with_rings(16, noise=0.03).scan_shape
    (1800, 16)
    """

    elevation: ArrayLike
    steps: int = 1800
    rate: float = 10.0
    azimuth_offsets: Optional[ArrayLike] = None
    time_offsets: Optional[ArrayLike] = None
    first_azimuth: float = 0.0
    clockwise: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        rings = _row(self.elevation, "elevation")
        offsets = {
            name: _row(getattr(self, name), name, len(rings))
            for name in ("azimuth_offsets", "time_offsets")
            if getattr(self, name) is not None
        }
        self._keep(
            elevation=rings,
            steps=_arrays.integer(self.steps, "steps", 2**24, least=1),
            rate=_above(self.rate, "rate"),
            first_azimuth=_values.number(self.first_azimuth, "first_azimuth"),
            **offsets,
        )

    @staticmethod
    def with_rings(rings: SupportsIndex, **options: Any) -> SpinningLidar:
        """A lidar with 16, 32, 64 or 128 evenly spaced rings, at 10 revolutions a second.

        ===== ================ ===== ===== ==================
        rings elevation        steps range between two rings
        ===== ================ ===== ===== ==================
        16    -15 to 15        1800  100 m 2.304 µs
        32    -30.67 to 10.67  1800  100 m 1.152 µs
        64    -22.5 to 22.5    1024  120 m 0
        128   -25 to 15        1800  200 m 0
        ===== ================ ===== ===== ==================

        These are the numbers of common data sheets; `options` replace them, and add the others that
        `SpinningLidar` has. Lengths are metres.
        """
        count = _arrays.integer(rings, "rings")
        if count not in _PRESETS:
            raise ValueError(f"rings: {count} is given; 16, 32, 64 or 128 is expected")
        low, high, steps, far, apart = _PRESETS[count]
        known: dict[str, Any] = {
            "elevation": np.linspace(low, high, count),
            "steps": steps,
            "max_range": far,
        }
        if apart:
            known["time_offsets"] = apart * np.arange(count)
        return SpinningLidar(**{**known, **options})

    @property
    def scan_shape(self) -> tuple[int, int]:
        """(steps, rings)."""
        return self.steps, len(self.elevation)  # type: ignore[arg-type]

    @cached_property
    def _fixed(self) -> Beams:
        times: Doubles = np.arange(float(self.steps))[:, None] / (self.rate * self.steps)
        if self.time_offsets is not None:
            times = times + np.asarray(self.time_offsets, np.float64)
        turn = -360.0 if self.clockwise else 360.0
        azimuth = self.first_azimuth + turn * self.rate * times
        if self.azimuth_offsets is not None:
            azimuth = azimuth + np.asarray(self.azimuth_offsets, np.float64)
        return self._made(_towards(azimuth, self.elevation), np.zeros(3), times)

    def _beams(self, start: float) -> Beams:
        return self._fixed


class Pattern(Protocol):
    """Where the beams of a `SolidStateLidar` go: `Raster`, `Rosette`, or a class of yours."""

    def beams(self, start: float) -> tuple[Doubles, Doubles]:
        """For a scan that begins at `start`: unit directions (..., 3) in the sensor's frame, and
        seconds from the start, of shape (...) or one that broadcasts to it with as many axes."""
        ...


@dataclass(frozen=True)
class Raster:
    """Rows of beams from the top, each from left to right: the shape is (rows, columns).

    `fov` has the degrees from the first to the last column and row. The scan takes `duration`
    seconds, beam after beam; 0: all beams leave at once.
    """

    columns: int
    rows: int
    fov: tuple[float, float] = (120.0, 25.0)
    duration: float = 0.1

    def __post_init__(self) -> None:
        _arrays.integer(self.columns, "columns", 2**24, least=1)
        _arrays.integer(self.rows, "rows", 2**24, least=1)
        _two(self.fov, "fov")
        _number(self.duration, "duration", 0)

    def beams(self, start: float) -> tuple[Doubles, Doubles]:
        """Unit directions and times."""
        wide, high = (angle / 2 for angle in _two(self.fov, "fov"))
        across = np.linspace(wide, -wide, self.columns) if self.columns > 1 else np.zeros(1)
        down = np.linspace(high, -high, self.rows) if self.rows > 1 else np.zeros(1)
        count = self.columns * self.rows
        times = np.linspace(0, self.duration, count, endpoint=False).reshape(self.rows, -1)
        return _towards(across, down[:, None]), times


@dataclass(frozen=True)
class Rosette:
    """The pattern of two prisms that turn: petals that fill a cone and do not repeat soon.

    `points` beams leave in `duration` seconds, at equal intervals; the shape is (points,). `fov` is
    the full angle of the cone in degrees, and `turns` has the revolutions a second of the prisms,
    each of which bends the beam by a quarter of `fov`. The prisms go on turning: the pattern
    depends on the time at which the scan begins.
    """

    points: int = 10_000
    fov: float = 38.4
    duration: float = 0.1
    turns: tuple[float, float] = (121.57, -77.73)

    def __post_init__(self) -> None:
        _arrays.integer(self.points, "points", 2**24, least=1)
        _above(self.fov, "fov", 180)
        _number(self.duration, "duration", 0)
        _row(self.turns, "turns", 2)

    def beams(self, start: float) -> tuple[Doubles, Doubles]:
        """Unit directions and times."""
        times = np.linspace(0, self.duration, self.points, endpoint=False)
        one, two = (2 * np.pi * ((turn * (start + times)) % 1) for turn in self.turns)
        left, up = (np.radians(self.fov / 4) * (f(one) + f(two)) for f in (np.cos, np.sin))
        angle = np.hypot(left, up)
        part = np.sinc(angle / np.pi)  # the sine over the angle
        return _vectors(np.cos(angle), part * left, part * up), times


@dataclass(frozen=True, eq=False)
class SolidStateLidar(_Lidar):
    """A lidar whose beams follow a pattern within a field of view.

    Scans have the shape of the pattern. Frame: x ahead, y to the left, z up.

    Parameters
    ----------
    pattern : Raster, Rosette, or another Pattern

    The other parameters are those of `Rangefinders`.

    >>> from raysheaf.sensors import Raster, Rosette, SolidStateLidar
    >>> SolidStateLidar(Raster(columns=240, rows=32)).rays().shape
    (32, 240)
    >>> SolidStateLidar(Rosette(points=10_000), max_range=90).rays(time=0.1).shape
    (10000,)
    """

    pattern: Pattern

    def __post_init__(self) -> None:
        super().__post_init__()
        if not hasattr(self.pattern, "beams"):
            raise TypeError(
                f"pattern: {self.pattern!r} is given; a Raster, a Rosette or a class with a method "
                "beams is expected"
            )

    def _beams(self, start: float) -> Beams:
        axes, times = self.pattern.beams(start)
        axes = _arrays.with_last_axis(axes, "pattern", 3, "directions of shape (..., 3)")
        at = np.asarray(_arrays.floats(times, "pattern", "times"), np.float64)
        fits = at.ndim == axes.ndim - 1 and all(n in (1, m) for n, m in zip(at.shape, axes.shape))
        if not fits:
            raise ValueError(
                f"pattern: times of shape {at.shape} are given for directions of shape {axes.shape}; ones "
                "that broadcast, with as many axes, are expected"
            )
        return self._made(_units(axes), np.zeros(3), at)


def _units(directions: NDArray[Any]) -> Doubles:
    """Vectors of length 1; NaN for those without a direction."""
    axes = np.asarray(directions, np.float64)
    length = np.linalg.norm(axes, axis=-1, keepdims=True)
    with np.errstate(all="ignore"):
        return np.where(np.isfinite(length) & (length > 0), axes / length, np.nan)


@dataclass(frozen=True, eq=False)
class Rangefinders(_Lidar):
    """Single beams, each somewhere on the robot: sonars, time-of-flight sensors, bumpers.

    Scans have the shape (n,). Frame: that of the robot, whose pose `scan` takes.

    Parameters
    ----------
    directions : (n, 3) array
        Where the beams go, of any length; NaN or zero for one that sees nothing.
    positions : (n, 3) or (3,) array
        Where they begin; the origin by default.
    min_range, max_range : float
        Nothing nearer or farther is seen.
    divergence : float
        The full angle of a beam's cone in degrees; 0 by default.
    subrays : int
        The number of rays, spread evenly over that cone, that stand for a beam; 1 by default.
    returns : str, or sequence of str
        "first", "last" or "strongest", the default: the echo that a beam reports. Several of them,
        for beams with subrays, give scans a last axis.
    separation : float
        Subrays whose ranges differ by no more than this are one echo, at their mean range, weighted
        by intensity; 0.5 by default.
    noise, dropout
        As `Sensor` has them.

    >>> from raysheaf.sensors import Rangefinders
    >>> sonars = Rangefinders([[1, 0, 0], [0, 1, 0]], max_range=4, divergence=15, subrays=32)
    >>> sonars.rays().shape
    (2, 32)
    """

    directions: ArrayLike
    positions: ArrayLike = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        ways = _arrays.with_last_axis(self.directions, "directions", 3, "one of shape (n, 3)")
        if ways.ndim != 2:
            raise ValueError(
                f"directions: an array of shape {ways.shape} is given; one of shape (n, 3) is expected"
            )
        places = _arrays.with_last_axis(self.positions, "positions", 3, "one of shape (n, 3)")
        if places.shape not in ((3,), ways.shape) or not np.isfinite(places).all():
            raise ValueError(
                f"positions: an array of shape {places.shape} is given; finite numbers of shape "
                f"{ways.shape} or (3,) are expected"
            )
        self._keep(directions=_units(ways), positions=places.astype(np.float64))

    @cached_property
    def _fixed(self) -> Beams:
        axes = np.asarray(self.directions, np.float64)
        return self._made(axes, self.positions, np.zeros(1))

    def _beams(self, start: float) -> Beams:
        return self._fixed


@dataclass(frozen=True, eq=False)
class DepthCamera(Sensor[DepthImage]):
    """A camera that measures depth, by OpenCV's model.

    `scan` returns a `DepthImage` of shape (height, width). Frame: OpenCV's optical frame, x to the
    right, y down, z ahead. The centre of the pixel in row i and column j is at (j, i).

    Parameters
    ----------
    matrix : (3, 3) array
        OpenCV's camera matrix, [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in pixels.
    size : (int, int)
        The width and the height in pixels.
    distortion : sequence of floats, optional
        OpenCV's coefficients k1, k2, p1, p2, or k1, k2, p1, p2, k3, or also k4, k5, k6. The ray of
        each pixel is found by iteration until it converges; a pixel without one is a miss.
    near, far : float
        Nothing at less or more depth is seen.
    readout : float
        Seconds from the time of the first row to that of the last: a rolling shutter. All pixels of
        a row have one time.
    noise, dropout
        As `Sensor` has them.

    >>> from raysheaf.sensors import DepthCamera
    >>> camera = DepthCamera([[525, 0, 320], [0, 525, 240], [0, 0, 1]], (640, 480))
    >>> camera.directions[240, 320]
    array([0., 0., 1.])
    """

    matrix: ArrayLike
    size: tuple[int, int]
    distortion: ArrayLike = ()
    near: float = 0.0
    far: float = math.inf
    readout: float = 0.0
    _kind = DepthImage

    def __post_init__(self) -> None:
        super().__post_init__()
        matrix = np.array(_arrays.doubles(self.matrix, "matrix"))
        expected = "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with fx and fy above 0"
        if matrix.shape != (3, 3):
            raise ValueError(
                f"matrix: an array of shape {matrix.shape} is given; {expected} is expected"
            )
        fixed = matrix[[0, 1, 2, 2, 2], [1, 0, 0, 1, 2]].tolist() == [0, 0, 0, 0, 1]
        if not (fixed and np.isfinite(matrix).all() and matrix[0, 0] > 0 and matrix[1, 1] > 0):
            raise ValueError(f"matrix: {matrix.tolist()} is given; {expected} is expected")
        try:
            wide, high = self.size
        except (TypeError, ValueError):
            raise ValueError(
                f"size: {self.size!r} is given; a width and a height are expected"
            ) from None
        near = _number(self.near, "near", 0)
        self._keep(
            matrix=matrix,
            size=tuple(_arrays.integer(side, "size", 2**16, least=1) for side in (wide, high)),
            near=near,
            far=_number(self.far, "far", near),
            readout=_number(self.readout, "readout", 0),
            _lens=Lens(self.distortion),
        )

    @cached_property
    def directions(self) -> Doubles:
        """(height, width, 3), the rays of the pixels in the camera's frame, of depth 1."""
        wide, high = self.size
        (fx, _, cx), (_, fy, cy), _ = np.asarray(self.matrix).tolist()
        u, v = np.meshgrid((np.arange(wide) - cx) / fx, (np.arange(high) - cy) / fy)
        lens: Lens = self._lens  # type: ignore[attr-defined]
        x, y = lens.undistorted(u, v)
        return _vectors(x, y, np.ones_like(x))

    @cached_property
    def _fixed(self) -> Beams:
        high = self.size[1]
        times = np.linspace(0, self.readout, high)[:, None]
        return Beams(self.directions, np.zeros(3), times)

    def _beams(self, start: float) -> Beams:
        return self._fixed

    def _limits(self) -> tuple[float, float]:
        return self.near, self.far


@dataclass(frozen=True, eq=False)
class HeightScan(Sensor[Heights]):
    """Heights of the ground on a grid around a robot.

    `scan` returns `Heights` of shape (nx, ny): x ahead and y to the left, both from the lowest on.
    Rays go down from a plane above the sensor's origin.

    Parameters
    ----------
    size : (float, float)
        The length along x and the width along y of the grid, whose middle is the origin.
    spacing : float
        The distance between two points of the grid.
    above : float
        The height above the origin at which the rays begin, so that they begin below a ceiling.
    reach : float
        How far down from there they go.
    align : "yaw" or "full"
        The grid stays level and turns with the robot's heading, or takes all its rotation.
    up : str or three floats
        The way that is up in the world, for "yaw": an axis such as "z", or a direction.
    noise, dropout
        As `Sensor` has them.

    >>> import numpy as np
    >>> from raysheaf.sensors import HeightScan
    >>> HeightScan(size=(1.6, 1.0), spacing=0.1).rays().shape
    (17, 11)
    """

    size: tuple[float, float] = (1.6, 1.0)
    spacing: float = 0.1
    above: float = 1.0
    reach: float = 100.0
    align: Literal["yaw", "full"] = "yaw"
    up: Union[str, Sequence[float]] = "z"
    _kind = Heights

    def __post_init__(self) -> None:
        super().__post_init__()
        _values.is_second(self.align, "align", "yaw", "full")
        self._keep(
            size=_two(self.size, "size"),
            spacing=_above(self.spacing, "spacing"),
            above=_number(self.above, "above", 0),
            reach=_number(self.reach, "reach", 0),
            _upward=_direction(self.up, "up"),
        )

    def _limits(self) -> tuple[float, float]:
        return 0.0, self.reach

    @cached_property
    def _fixed(self) -> Beams:
        steps = [int(side / self.spacing + 1e-9) for side in self.size]
        x, y = (self.spacing * (np.arange(n + 1) - n / 2) for n in steps)
        grid = np.stack(np.broadcast_arrays(x[:, None], y, self.above), axis=-1)
        axes = np.broadcast_to(np.array([0.0, 0.0, -1.0]), grid.shape)
        return Beams(axes, grid, np.zeros((1, 1)))

    def _beams(self, start: float) -> Beams:
        return self._fixed

    def _placed(self, pose: Optional[Pose], start: float) -> Placing:
        placing = super()._placed(pose, start)
        return placing if self.align == "full" else placing.aligned(self._level)

    def _level(self, turns: Doubles) -> Doubles:
        """Rotations with z upward and the heading of the given ones; where these have x upright,
        y has the heading."""
        up: Doubles = self._upward  # type: ignore[attr-defined]
        ahead, left = (axis - (axis @ up)[..., None] * up for axis in np.moveaxis(turns, -1, 0)[:2])
        upright = np.linalg.norm(ahead, axis=-1, keepdims=True) < 1e-6
        x = np.where(upright, np.cross(left, up), ahead)
        x /= np.linalg.norm(x, axis=-1, keepdims=True)
        return np.stack([x, np.cross(up, x), np.broadcast_to(up, x.shape)], axis=-1)
