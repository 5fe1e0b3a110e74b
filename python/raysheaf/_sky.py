"""Skies as directions with weights, and where the sun is."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any, Optional, Sequence, SupportsIndex, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values
from ._cameras import Number, Point, _direction

Doubles = NDArray[np.float64]
Up = Union[str, Point]

_ROWS = (30, 30, 24, 24, 18, 12, 6)  # patches of Tregenza's rows, from the horizon up
_CLEARNESS = (1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2)  # where the bins of Perez et al. begin

# R. Perez, R. Seals, J. Michalsky, "All-weather model for sky luminance distribution", Solar Energy
# 50 (1993), table 1: for each bin of clearness, x1 to x4 of a, b, c, d and e.
_PEREZ = np.array(
    """
    1.3525 -0.2576 -0.2690 -1.4366 -0.7670 0.0007 1.2734 -0.1233 2.8000 0.6004 1.2375 1.0000
    1.8734 0.6297 0.9738 0.2809 0.0356 -0.1246 -0.5718 0.9938
    -1.2219 -0.7730 1.4148 1.1016 -0.2054 0.0367 -3.9128 0.9156 6.9750 0.1774 6.4477 -0.1239
    -1.5798 -0.5081 -1.7812 0.1080 0.2624 0.0672 -0.2190 -0.4285
    -1.1000 -0.2515 0.8952 0.0156 0.2782 -0.1812 -4.5000 1.1766 24.7219 -13.0812 -37.7000 34.8438
    -5.0000 1.5218 3.9229 -2.6204 -0.0156 0.1597 0.4199 -0.5562
    -0.5484 -0.6654 -0.2672 0.7117 0.7234 -0.6219 -5.6812 2.6297 33.3389 -18.3000 -62.2500 52.0781
    -3.5000 0.0016 1.1477 0.1062 0.4659 -0.3296 -0.0876 -0.0329
    -0.6000 -0.3566 -2.5000 2.3250 0.2937 0.0496 -5.6812 1.8415 21.0000 -4.7656 -21.5906 7.2492
    -3.5000 -0.1554 1.4062 0.3988 0.0032 0.0766 -0.0656 -0.1294
    -1.0156 -0.3670 1.0078 1.4051 0.2875 -0.5328 -3.8500 3.3750 14.0000 -0.9999 -7.1406 7.5469
    -3.4000 -0.1078 -1.0750 1.5702 -0.0672 0.4016 0.3017 -0.4844
    -1.0000 0.0211 0.5025 -0.5119 -0.3000 0.1922 0.7023 -1.6317 19.0000 -5.0000 1.2438 -1.9094
    -4.0000 0.0250 0.3844 0.2656 1.0468 -0.3788 -2.4517 1.4656
    -1.0500 0.0289 0.4260 0.3590 -0.3250 0.1156 0.7781 0.0025 31.0625 -14.5000 -46.1148 55.3750
    -7.2312 0.4050 13.3500 0.6234 1.5000 -0.6426 1.8564 0.5636
    """.split(),
    np.float64,
).reshape(8, 5, 4)


@dataclass(frozen=True, eq=False)
class Sky:
    """Where radiation comes from, for `irradiance`.

    >>> from raysheaf.radiation import uniform_sky
    >>> sky = uniform_sky()
    >>> sky.directions.shape
    (2305, 3)
    >>> round(float((sky.weights * sky.directions[:, 1]).sum()), 6)     # pi, on the horizontal
    3.141593
    """

    directions: Doubles
    """(n, 3), unit vectors towards the sky, the sun and the ground."""
    weights: Doubles
    """(n,), the irradiance of a plane that faces each direction: radiance times solid angle."""


def _number(value: Any, name: str, most: float = np.inf) -> float:
    number = _values.number(value, name)
    if not 0 <= number <= most:
        raise ValueError(f"{name}: {number:g} is given; a number from 0 to {most:g} is expected")
    return number


def _axes(up: Any, north: Any) -> tuple[Doubles, Doubles, Doubles]:
    """East, north and up."""
    high = _direction(up, "up")
    if north is None:
        north = "y" if abs(high[2]) > 0.9 else "-z"
    ahead = _direction(north, "north")
    ahead = ahead - (ahead * high).sum() * high
    length = np.linalg.norm(ahead)
    if length < 1e-7:
        raise ValueError("north: it runs along up; another direction is expected")
    ahead = ahead / length
    return np.cross(ahead, high), ahead, high


def sky_patches(
    subdivision: SupportsIndex = 4, *, up: Up = "y", north: Optional[Up] = None
) -> tuple[Doubles, Doubles]:
    """The patches of the sky's hemisphere: their directions (n, 3) and solid angles (n,), sr.

    Rows of patches from the horizon up, in each from north by east, and a cap at the zenith: with
    subdivision 1 the 145 of P. R. Tregenza, "Subdivision of the sky hemisphere for luminance
    measurements", Lighting Research and Technology 19 (1987); with 2, 4, ... the 577, 2305, ... of
    C. F. Reinhart (Bourgeois, Reinhart, Ward, "Standard daylight coefficient model", 2008).

    >>> from raysheaf.radiation import sky_patches
    >>> [len(sky_patches(n)[0]) for n in (1, 2, 4)]
    [145, 577, 2305]

    Parameters
    ----------
    subdivision : int
        Into how many parts each side of Tregenza's patches is cut; 1 to 64.
    up, north : str or three floats
        The name of an axis or a direction. By default up is y and north -z, so that east is x; if
        up is z, north is y.

    The sine of a direction's elevation is the mean over its patch, so that the sums of solid
    angles and of their horizontal parts are 2 pi and pi.
    """
    parts = _arrays.integer(subdivision, "subdivision", 64, least=1)
    east, ahead, high = _axes(up, north)
    step = 90 / (7 * parts + 0.5)
    directions, angles = [], []
    for row in range(7 * parts + 1):
        count = _ROWS[row // parts] * parts if row < 7 * parts else 1
        low, top = np.sin(np.radians([row * step, min((row + 1) * step, 90)]))
        sine = (low + top) / 2 if count > 1 else 1.0
        turn = 2 * np.pi * np.arange(count) / count
        flat = ahead * np.cos(turn)[:, None] + east * np.sin(turn)[:, None]
        directions.append(np.sqrt(1 - sine * sine) * flat + sine * high)
        angles.append(np.full(count, 2 * np.pi * (top - low) / count))
    return np.concatenate(directions), np.concatenate(angles)


class _Dome:
    """A hemisphere of patches, and the ground below it as its mirror image."""

    def __init__(self, subdivision: Any, up: Any, north: Any) -> None:
        self.directions, self.angles = sky_patches(subdivision, up=up, north=north)
        self.up = _direction(up, "up")
        self.sines = (self.directions * self.up).sum(-1)

    def scaled(self, radiance: Doubles, horizontal: Any) -> Doubles:
        """The weights of patches whose horizontal irradiance is given; (..., n)."""
        weights = radiance * self.angles
        sums = (weights * self.sines).sum(-1, keepdims=True)
        wanted = np.asarray(horizontal, np.float64)[..., None]
        factors: Doubles = np.divide(wanted, sums, out=np.zeros_like(sums), where=sums > 0)
        return weights * factors

    def sky(
        self, weights: Doubles, albedo: Any, suns: Doubles = np.zeros((0, 3)), of_suns: Any = ()
    ) -> Sky:
        reflected = _number(albedo, "albedo", 1)
        beams = np.asarray(of_suns, np.float64)
        directions, all_weights = [self.directions, suns], [weights, beams]
        if reflected:
            total = (weights * self.sines).sum() + (beams * np.maximum(suns @ self.up, 0)).sum()
            directions.append(self.directions - 2 * self.sines[:, None] * self.up)
            all_weights.append(reflected * total / np.pi * self.angles)
        return Sky(np.concatenate(directions), np.concatenate(all_weights))


def uniform_sky(
    radiance: Number = 1.0,
    *,
    albedo: Number = 0.0,
    subdivision: SupportsIndex = 4,
    up: Up = "y",
    north: Optional[Up] = None,
) -> Sky:
    """A sky of the same radiance everywhere; an open horizontal plane has pi times this.

    Parameters
    ----------
    radiance : float
        W / (m2 sr), or any unit of radiance or luminance.
    albedo : float
        The share of the horizontal irradiance that an endless, diffuse ground reflects, which is
        seen below the horizon where nothing in the scene is in the way; 0: no ground.
    subdivision, up, north
        Those of `sky_patches`.
    """
    dome = _Dome(subdivision, up, north)
    weights = dome.scaled(np.ones(len(dome.sines)), np.pi * _number(radiance, "radiance"))
    return dome.sky(weights, albedo)


def overcast_sky(
    zenith: Number = 1.0,
    *,
    albedo: Number = 0.0,
    subdivision: SupportsIndex = 4,
    up: Up = "y",
    north: Optional[Up] = None,
) -> Sky:
    """The standard overcast sky of the CIE: radiance L = zenith (1 + 2 sin elevation) / 3, after
    P. Moon and D. E. Spencer, "Illumination from a non-uniform sky" (1942); ISO 15469, type 16.

    An open horizontal plane has 7 pi / 9 times the zenith's radiance. Parameters are those of
    `uniform_sky`.
    """
    dome = _Dome(subdivision, up, north)
    horizontal = 7 * np.pi / 9 * _number(zenith, "zenith")
    return dome.sky(dome.scaled(1 + 2 * dome.sines, horizontal), albedo)


def perez_sky(
    direct_normal: ArrayLike,
    diffuse_horizontal: ArrayLike,
    sun: ArrayLike,
    *,
    hours: ArrayLike = 1.0,
    extraterrestrial: ArrayLike = 1367.0,
    albedo: Number = 0.0,
    subdivision: SupportsIndex = 4,
    up: Up = "y",
    north: Optional[Up] = None,
) -> Sky:
    """The sun, and a sky as measured irradiances say that it is: R. Perez, R. Seals, J. Michalsky,
    "All-weather model for sky luminance distribution", Solar Energy 50 (1993), eqs. 1 to 8.

    For one moment, or the sum over many: of the hours of a year, for its irradiation.

    Parameters
    ----------
    direct_normal, diffuse_horizontal : (...)
        The irradiance of the sun on a plane that faces it, and of the sky on the horizontal,
        W / m2.
    sun : (..., 3)
        Directions to the sun, as of `sun_positions`. A sun below the horizon gives nothing.
    hours : (...)
        What each moment counts: with 1 for each hour, sums of W / m2 are Wh / m2.
    extraterrestrial : (...)
        The irradiance of the sun outside of the atmosphere, W / m2, for the sky's brightness.
    albedo : float
        That of `uniform_sky`.
    subdivision, up, north
        Those of `sky_patches`.

    Returns
    -------
    Sky
        The patches of the sky, then each sun, then the patches of the ground. The radiance of a
        patch is that at its middle, and all are scaled so that the horizontal irradiance is
        `diffuse_horizontal`. Brightness is at least 0.01, and 0.2 for clearness from 1.065 to 2.8,
        as Radiance's gendaylit has it (J.-J. Delaunay, 1994).

    >>> import numpy as np
    >>> from raysheaf.radiation import perez_sky
    >>> sky = perez_sky(800, 100, [0, 0.8, 0.6], subdivision=1)
    >>> sky.weights.shape, float(sky.weights[145])
    ((146,), 800.0)
    >>> round(float((sky.weights[:145] * sky.directions[:145, 1]).sum()), 6)
    100.0
    """
    dome = _Dome(subdivision, up, north)
    ways = _arrays.with_last_axis(sun, "sun", 3, "one of shape (..., 3)").astype(np.float64)
    lengths = np.linalg.norm(ways, axis=-1, keepdims=True)
    if not (np.isfinite(lengths) & (lengths > 0)).all():
        raise ValueError("sun: a vector without a direction is given; finite ones are expected")
    ways = ways / lengths
    given = {
        "direct_normal": direct_normal,
        "diffuse_horizontal": diffuse_horizontal,
        "hours": hours,
        "extraterrestrial": extraterrestrial,
    }
    numbers = [_arrays.floats(x, name, "a number or an array") for name, x in given.items()]
    for name, array in zip(given, numbers):
        if not (np.isfinite(array) & (array >= 0)).all():
            raise ValueError(f"{name}: a number is negative or not finite")
    try:
        shape = np.broadcast_shapes(ways.shape[:-1], *(array.shape for array in numbers))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(given, numbers))
        raise ValueError(
            f"{shapes}, sun {ways.shape}: shapes that broadcast are expected"
        ) from None
    direct, diffuse, each, outside = (
        np.broadcast_to(array, shape).reshape(-1).astype(np.float64) for array in numbers
    )
    suns = np.broadcast_to(ways, shape + (3,)).reshape(-1, 3)
    high = (suns * dome.up).sum(-1)
    direct = np.where(high > 0, direct, 0.0)

    weights = np.zeros(len(dome.sines))
    for begin in range(0, len(suns), 64):
        some = slice(begin, begin + 64)
        radiance = _perez(dome, suns[some], high[some], direct[some], diffuse[some], outside[some])
        weights += dome.scaled(radiance, diffuse[some] * each[some]).sum(0)
    return dome.sky(weights, albedo, suns, direct * each)


def _perez(
    dome: _Dome, suns: Doubles, high: Doubles, direct: Doubles, diffuse: Doubles, outside: Doubles
) -> Doubles:
    """(t, n), relative radiances of the patches."""
    zenith = np.minimum(np.arccos(np.clip(high, -1, 1)), np.radians(89.9))
    # F. Kasten, A. T. Young, "Revised optical air mass tables", Applied Optics 28 (1989), eq. 3.
    mass = 1 / (np.cos(zenith) + 0.50572 * (96.07995 - np.degrees(zenith)) ** -1.6364)
    cubed = 1.041 * zenith**3
    with np.errstate(invalid="ignore", divide="ignore"):
        clearness = ((diffuse + direct) / diffuse + cubed) / (1 + cubed)
        brightness = np.maximum(mass * diffuse / outside, 0.01)
    clearness = np.where(diffuse > 0, clearness, 1.0)
    brightness = np.where(np.isfinite(brightness), brightness, 0.01)
    middle = (clearness > 1.065) & (clearness < 2.8)
    brightness = np.where(middle, np.maximum(brightness, 0.2), brightness)
    bins = np.searchsorted(_CLEARNESS, clearness, side="right")
    x1, x2, x3, x4 = np.moveaxis(_PEREZ[bins], -1, 0)
    z, bright = zenith[:, None], brightness[:, None]
    a, b, c, d, e = (x1 + x2 * z + bright * (x3 + x4 * z)).T[..., None]
    low = (bins == 0)[:, None]  # eqs. 7 and 8
    c1, c2, c3, c4 = _PEREZ[0, 2]
    d1, d2, d3, d4 = _PEREZ[0, 3]
    c = np.where(low, np.exp(np.maximum(bright * (c1 + c2 * z), 0) ** c3) - c4, c)
    d = np.where(low, -np.exp(bright * (d1 + d2 * z)) + d3 + bright * d4, d)
    cosine = np.clip(sum(suns[:, None, k] * dome.directions[:, k] for k in range(3)), -1, 1)
    upper = 1 + a * np.exp(b / np.maximum(dome.sines, 0.01))
    around = 1 + c * np.exp(d * np.arccos(cosine)) + e * cosine * cosine
    return np.asarray(np.maximum(upper * around, 0.0), np.float64)


def sun_positions(
    times: Sequence[Any],
    latitude: Number,
    longitude: Number,
    *,
    altitude: Number = 0.0,
    up: Up = "y",
    north: Optional[Up] = None,
) -> Doubles:
    """Directions to the sun, by pvlib (``pip install pvlib``): I. Reda, A. Andreas, "Solar position
    algorithm for solar radiation applications", NREL (2003), with refraction.

    Parameters
    ----------
    times : pandas.DatetimeIndex, or sequence of datetimes
        With a time zone.
    latitude, longitude, altitude : float
        Degrees north, degrees east, metres.
    up, north
        Those of `sky_patches`: by default, x is east, y up and z south.

    Returns
    -------
    (n, 3) array of unit vectors
        Those of suns below the horizon point below it.

    Raises
    ------
    ImportError
        If pvlib is not installed.
    """
    east, ahead, high = _axes(up, north)
    place = [_values.number(latitude, "latitude"), _values.number(longitude, "longitude")]
    if not (abs(place[0]) <= 90 and abs(place[1]) <= 360):
        raise ValueError(
            f"latitude, longitude: {place[0]:g} and {place[1]:g} are given; degrees north, -90 to "
            "90, and east are expected"
        )
    try:
        solarposition = importlib.import_module("pvlib.solarposition")
        pandas = importlib.import_module("pandas")
    except ImportError as error:
        raise ImportError("sun_positions needs pvlib, which is not installed") from error
    index = pandas.DatetimeIndex(times)
    if index.tz is None:
        raise ValueError("times: they have no time zone; datetimes with a tzinfo are expected")
    found = solarposition.get_solarposition(
        index, *place, altitude=_values.number(altitude, "altitude")
    )
    lift = np.radians(np.asarray(found["apparent_elevation"], np.float64))[:, None]
    turn = np.radians(np.asarray(found["azimuth"], np.float64))[:, None]
    flat = np.cos(turn) * ahead + np.sin(turn) * east
    return np.cos(lift) * flat + np.sin(lift) * high
