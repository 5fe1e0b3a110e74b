"""OpenCV's model of a lens: radial and tangential distortion, and the way back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays

Doubles = NDArray[np.float64]

_MOST_STEPS = 100
_CLOSE = 1e-12  # in units of the focal length: 10^-8 of a pixel where that is 10 000 pixels


class Lens:
    """Distorts points of the plane z = 1, by OpenCV's coefficients k1, k2, p1, p2, k3, k4, k5, k6.

    Source: the documentation of OpenCV's module calib3d, "Detailed Description". With r² = x² + y²,
    a = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶):
    x' = a x + 2 p1 x y + p2 (r² + 2 x²), y' = a y + p1 (r² + 2 y²) + 2 p2 x y.
    """

    def __init__(self, coefficients: Any) -> None:
        given = _arrays.doubles(coefficients, "distortion").reshape(-1)
        if given.size not in (0, 4, 5, 8) or not np.isfinite(given).all():
            raise ValueError(
                f"distortion: {given.tolist()} is given; 4, 5 or 8 finite coefficients are expected"
            )
        self.is_straight = not given.any()
        k1, k2, self._p1, self._p2, k3, k4, k5, k6 = np.pad(given, (0, 8 - given.size)).tolist()
        above = np.polynomial.Polynomial([1, k1, k2, k3])
        below = np.polynomial.Polynomial([1, k4, k5, k6])
        self._above, self._below = above, below  # of r²
        self._slope = above.deriv() * below - above * below.deriv()  # times below²
        # Where the radius in the image stops growing with that in the world, the image folds.
        r2 = np.polynomial.Polynomial([0, 1])
        folds = np.concatenate([(above * below + 2 * r2 * self._slope).roots(), below.roots()])
        real = folds.real[(np.abs(folds.imag) < 1e-9) & (folds.real > 0)]
        self._fold = float(real.min()) if len(real) else np.inf

    def _image(self, x: Doubles, y: Doubles) -> tuple[Doubles, Doubles]:
        r2 = x * x + y * y
        a = self._above(r2) / self._below(r2)
        both = 2 * x * y
        return (
            a * x + self._p1 * both + self._p2 * (r2 + 2 * x * x),
            a * y + self._p1 * (r2 + 2 * y * y) + self._p2 * both,
        )

    def undistorted(self, u: Doubles, v: Doubles) -> tuple[Doubles, Doubles]:
        """The points x, y whose image is (u, v), each by Newton's iteration until it converges.

        They are NaN for images that no point has before the model folds the plane over itself."""
        if self.is_straight:
            return u, v
        x, y, part = u.copy(), v.copy(), np.ones_like(u)
        with np.errstate(all="ignore"):
            du, dv = (a - b for a, b in zip(self._image(x, y), (u, v)))
            for _ in range(_MOST_STEPS):
                error = np.hypot(du, dv)
                if (error < _CLOSE).all():
                    break
                r2 = x * x + y * y
                below = self._below(r2)
                a, slope = self._above(r2) / below, 2 * self._slope(r2) / below**2
                xx = a + slope * x * x + 2 * self._p1 * y + 6 * self._p2 * x
                yy = a + slope * y * y + 6 * self._p1 * y + 2 * self._p2 * x
                xy = slope * x * y + 2 * self._p1 * x + 2 * self._p2 * y
                size = part / (xx * yy - xy * xy)
                next_x, next_y = x - size * (yy * du - xy * dv), y - size * (xx * dv - xy * du)
                next_du, next_dv = (a - b for a, b in zip(self._image(next_x, next_y), (u, v)))
                # A step that leads away is tried again, half as long.
                nearer = np.hypot(next_du, next_dv) < error
                part = np.where(nearer, np.minimum(2 * part, 1), part / 2)
                x, y = np.where(nearer, next_x, x), np.where(nearer, next_y, y)
                du, dv = np.where(nearer, next_du, du), np.where(nearer, next_dv, dv)
            found = (np.hypot(du, dv) < 100 * _CLOSE) & (x * x + y * y < self._fold)
        return np.where(found, x, np.nan), np.where(found, y, np.nan)
