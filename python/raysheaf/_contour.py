"""Exchange areas of plane patches without anything between them, by integrals along their edges.

The exchange area of two patches is the area of the first times the view factor to the second:

    A F = 1 / (2 pi)  sum over edges e, f of  de . df  integral of ln |p(s) - q(t)| ds dt

E. M. Sparrow, "A new and simpler formulation for radiative angle factors", J. Heat Transfer 85
(1963), eq. 8. The integral along the longer edge of each pair is in closed form (G. P. Mitalas,
D. G. Stephenson, "Fortran IV programs to calculate radiant energy interchange factors", 1966); that
along the other is by Gauss's rule where the edges are far from each other, and by a double
exponential rule between all places where its derivative may jump where they are near.
"""

from __future__ import annotations

import math
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from ._patches import dots

Doubles = NDArray[np.float64]
Ints = NDArray[np.int64]

_AT_ONCE = 1 << 14  # pairs of edges
_NEAR_AT_ONCE = 1 << 10  # which have hundreds of points each: 16 MB


def _gauss(count: int) -> tuple[Doubles, Doubles]:
    x, weights = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, weights / 2


def _double_exponential(step: float = 0.17, steps: int = 19) -> tuple[Doubles, Doubles]:
    """H. Takahasi, M. Mori (1974), on [0, 1]: derivatives may be infinite at the ends."""
    t = step * np.arange(-steps, steps + 1)
    x = 0.5 * (1 + np.tanh(0.5 * np.pi * np.sinh(t)))
    weights = 0.25 * step * np.pi * np.cosh(t) / np.cosh(0.5 * np.pi * np.sinh(t)) ** 2
    return x, weights / weights.sum()


# The rule for pairs whose distance is at least so many lengths of the shorter edge. Gauss's rule of
# n points errs by (2 d + sqrt(4 d^2 + 1))^(-2 n): 1e-10 in each of them.
_RULES = ((24.0, _gauss(3)), (6.0, _gauss(4)), (1.0, _gauss(8)))
_NEAR = _double_exponential()


def outline(corners: Doubles) -> Doubles:
    """(k, 2, 3), the edges of triangles (m, 3, 3) that no other of them has the other way round."""
    points, names = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    begins = names.reshape(-1, 3)
    ends = np.roll(begins, -1, axis=1)
    count = len(points)
    codes, directed = np.unique(
        np.concatenate([begins * count + ends, ends * count + begins]).reshape(-1),
        return_inverse=True,
    )
    half = 3 * len(corners)
    net = np.bincount(directed.reshape(-1)[:half], minlength=len(codes))
    net = net - np.bincount(directed.reshape(-1)[half:], minlength=len(codes))
    kept = np.repeat(codes, np.maximum(net, 0))
    begin, end = np.divmod(kept, count)
    edges: Doubles = np.stack([points[begin], points[end]], axis=1)[begin != end]
    return edges


def clipped(corners: Doubles, normals: Doubles, heights: Doubles) -> Doubles:
    """(m, 4, 2, 3): the edges of the parts of triangles (m, 3, 3) where normals . p > heights."""
    above = (corners * normals[:, None]).sum(-1) - heights[:, None]
    begin, end = corners, np.roll(corners, -1, axis=1)
    below_begin, below_end = above, np.roll(above, -1, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        at = np.clip(below_begin / (below_begin - below_end), 0.0, 1.0)
    at = np.where(np.isfinite(at), at, 0.0)[..., None]
    cut = begin * (1 - at) + end * at
    first, last = (below_begin >= 0)[..., None], (below_end >= 0)[..., None]
    starts = np.where(first, begin, cut)
    stops = np.where(last, end, np.where(first, cut, starts))
    leaves, enters = first & ~last, ~first & last
    closing = np.stack([(cut * leaves).sum(1), (cut * enters).sum(1)], axis=1)[:, None]
    return np.concatenate([np.stack([starts, stops], axis=2), closing], axis=1)


def _along(points: Doubles, begin: Doubles, way: Doubles, length: Doubles) -> Doubles:
    """The mean of ln |p - q| over q on the edges from `begin` along unit vectors; p (..., n, 3)."""
    to = points - begin
    s = dots(to, way)
    to = to - s[..., None] * way
    d = np.sqrt(dots(to, to))
    rest = length - s
    least = np.finfo(float).tiny
    inside = rest * np.log(np.maximum(rest * rest + d * d, least))
    inside += s * np.log(np.maximum(s * s + d * d, least))
    inside = 0.5 * inside + d * np.arctan2(d * length, d * d - s * rest)
    means: Doubles = inside / length - 1
    return means


def _breaks(
    begin: Doubles, step: Doubles, other: Doubles, way: Doubles, length: Doubles
) -> Doubles:
    """(m, 5): 0, 1, and where on the edges the mean over the other ones may have a kink: at
    the projections of their ends, and where the lines come closest."""
    square = dots(step, step)
    to = other - begin
    along = dots(step, way)
    ends = [dots(step, to + k * way) / square for k in (0.0 * length[:, None], length[:, None])]
    across = square - along * along
    with np.errstate(invalid="ignore", divide="ignore"):
        nearest = (dots(to, step) - along * dots(to, way)) / across
    nearest = np.where(across > 1e-12 * square, nearest, 0.0)
    inner = np.clip(np.stack([*ends, nearest], axis=-1), 0.0, 1.0)
    zero = np.zeros((len(square), 1))
    return np.sort(np.concatenate([zero, inner, zero + 1], axis=1), axis=1)


def _means(e: Doubles, f: Doubles, scale: Doubles) -> Doubles:
    """The means of ln(|p - q| / scale) over pairs of edges e, f (m, 2, 3)."""
    length_e, length_f = (_lengths(x[:, 1] - x[:, 0]) for x in (e, f))
    swap = (length_e > length_f)[:, None, None]
    e, f = np.where(swap, f, e), np.where(swap, e, f)
    short, length = np.minimum(length_e, length_f), np.maximum(length_e, length_f)
    way = (f[:, 1] - f[:, 0]) / length[:, None]
    step = e[:, 1] - e[:, 0]
    across = e[:, 0] + e[:, 1] - f[:, 0] - f[:, 1]
    apart = (_lengths(across) - short - length) / 2
    found = np.empty(len(e))
    left = np.ones(len(e), np.bool_)
    for least, (x, weights) in _RULES:
        some = np.flatnonzero(left & (apart >= least * short))
        left[some] = False
        ends = e[some, 0], step[some], f[some, 0], way[some], length[some]
        found[some] = sum(
            weight * _along(ends[0] + at * ends[1], *ends[2:]) for at, weight in zip(x, weights)
        )
    x, weights = _NEAR
    near = np.flatnonzero(left)
    for at in range(0, len(near), _NEAR_AT_ONCE):
        some = near[at : at + _NEAR_AT_ONCE]
        breaks = _breaks(e[some, 0], step[some], f[some, 0], way[some], length[some])
        widths = np.diff(breaks, axis=1)
        places = (breaks[:, :-1, None] + widths[..., None] * x).reshape(len(some), 4 * len(x))
        points = e[some, None, 0] + places[..., None] * step[some, None]
        values = _along(points, f[some, None, 0], way[some, None], length[some, None])
        found[some] = (values * (widths[..., None] * weights).reshape(values.shape)).sum(-1)
    return found - np.log(scale)


def _lengths(vectors: Doubles) -> Doubles:
    return np.asarray(np.sqrt(dots(vectors, vectors)))


def exchange_areas(
    edges: tuple[Doubles, Doubles], counts: tuple[Ints, Ints], scale: Doubles
) -> Doubles:
    """(n,), of n pairs of patches that face each other everywhere, and see all of each other.

    edges : (k, 2, 3) and (l, 2, 3), those of the first patches of all pairs in a row, and those of
    the second ones; counts : two of (n,), how many belong to each pair; scale : (n,), a length of
    each pair.
    """
    pairs = counts[0] * counts[1]
    ends = np.cumsum(pairs)
    starts = [np.cumsum(one) - one for one in counts]
    found = np.zeros(len(pairs))
    begin = 0
    while begin < len(pairs):
        before = int(ends[begin] - pairs[begin])
        end = max(begin + 1, int(np.searchsorted(ends, before + _AT_ONCE, side="right")))
        which = np.repeat(np.arange(begin, end), pairs[begin:end])
        number = np.arange(len(which)) - (ends[which] - pairs[which] - before)
        row, column = np.divmod(number, counts[1][which])
        sums: Optional[Doubles] = None
        for at in range(0, len(which), _AT_ONCE):  # one pair may have more
            part = slice(at, at + _AT_ONCE)
            e = edges[0][starts[0][which[part]] + row[part]]
            f = edges[1][starts[1][which[part]] + column[part]]
            turned = dots(e[:, 1] - e[:, 0], f[:, 1] - f[:, 0])
            some = np.flatnonzero(turned)
            values = turned[some] * _means(e[some], f[some], scale[which[part][some]])
            added = np.bincount(which[part][some] - begin, values, end - begin)
            sums = np.asarray(added if sums is None else sums + added, np.float64)
        if sums is not None:
            found[begin:end] = sums
        begin = end
    return np.maximum(found / (2 * math.pi), 0.0)
