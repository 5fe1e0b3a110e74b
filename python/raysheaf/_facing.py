"""Which pairs of patches see nothing of each other, which see all, and their exchange areas."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._contour import clipped, exchange_areas, outline
from ._patches import ROUNDING, Bools, Doubles, Ints, Surfaces, dots, world_corners
from ._scene import Scene

_MOST_TRIANGLES = 2048  # of a patch with exact factors
_MOST_TESTS = 2**30  # of a corner of a patch and a plane
_MOST_EDGE_PAIRS = 2**22  # of two patches
_ROWS = 256  # of planes that are tested at a time

# Half of the directions to the faces, edges and corners of a cube; the others are opposite.
_AXES = np.array([d for d in itertools.product((-1, 0, 1), repeat=3) if d > (0, 0, 0)], float)


class Facing(NamedTuple):
    """Pairs of patches, by their geometry; all arrays are (n, n)."""

    hidden: Bools
    """Each lies behind the other: the factor is 0."""
    exchange: Doubles
    """The area times the factor as if nothing were between them; NaN where it is not known."""
    clear: Bools
    """Nothing is between them."""
    apart: Bools
    """A quarter of their size or more is between them, so that the kernel varies little."""


def nothing_known(count: int) -> Facing:
    shape = count, count
    none = np.zeros(shape, np.bool_)
    return Facing(none, np.full(shape, np.nan), none.copy(), none.copy())


def all_triangles(scene: Scene) -> Doubles:
    """(m, 3, 3), of all instances."""
    parts = [
        world_corners(scene, mesh, instance)
        for mesh in scene.meshes
        for instance in scene.instances(mesh)
        if scene.mask(instance)
    ]
    return np.concatenate(parts) if parts else np.zeros((0, 3, 3))


def _areas(corners: Doubles) -> Doubles:
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.cross(b - a, c - a) / 2


def _rounding(normals: Doubles, reach: Doubles) -> Doubles:
    """How far coordinates up to `reach` may be from where they were, along a normal."""
    return ROUNDING * dots(np.abs(normals), reach)


class _Planes:
    """Corners of patches, and on which side of planes they are."""

    def __init__(self, surfaces: Surfaces, some: Ints) -> None:
        parts = [surfaces.corners[surfaces.starts[i] : surfaces.ends[i]] for i in some]
        parts = [one[np.any(_areas(one), axis=-1)] for one in parts]
        self.corners = parts
        points = [np.unique(one.reshape(-1, 3), axis=0) for one in parts]
        self.points = np.concatenate(points)
        self.starts = np.cumsum([0, *map(len, points[:-1])])
        self.reach = np.array([np.abs(one).max(0) for one in points])
        # The plane of a patch is that of all its triangles; a patch may not have one.
        sums = np.array([_areas(one).sum(0) for one in parts])
        lengths = np.linalg.norm(sums, axis=-1)
        self.normals = sums / np.maximum(lengths, np.finfo(float).tiny)[:, None]
        origins = np.array([one.reshape(-1, 3).mean(0) for one in parts])
        self.heights = (self.normals * origins).sum(-1)
        self.plane = np.zeros(len(parts), np.bool_)
        for i, one in enumerate(parts):
            off = np.abs((one * self.normals[i]).sum(-1) - self.heights[i]).max()
            turned = (_areas(one) * self.normals[i]).sum(-1).min() <= 0
            slack = 2 * _rounding(self.normals[i], self.reach[i])
            self.plane[i] = lengths[i] > 0 and off <= slack and not turned

    def sides(self, normals: Doubles, heights: Doubles, reach: Doubles) -> tuple[Bools, Bools]:
        """(k, n): whether patches are in front of planes, and behind them; on them is both."""
        ahead = np.empty((len(normals), len(self.starts)), np.bool_)
        after = np.empty_like(ahead)
        for at in range(0, len(normals), _ROWS):
            rows = slice(at, at + _ROWS)
            distances = self._distances(normals[rows], heights[rows])
            slack = _rounding(normals[rows, None], self.reach + reach[rows, None])
            ahead[rows] = np.minimum.reduceat(distances, self.starts, axis=1) >= -slack
            after[rows] = np.maximum.reduceat(distances, self.starts, axis=1) <= slack
        return ahead, after

    def _distances(self, normals: Doubles, heights: Doubles) -> Doubles:
        """(k, p), of the points from planes."""
        distances = -np.repeat(heights[:, None], len(self.points), axis=1)
        for k in range(3):
            distances += normals[:, k, None] * self.points[:, k]
        return distances

    def apart(self) -> Bools:
        """By the planes of the patches and by their boxes."""
        gaps = np.full((len(self.starts), len(self.starts)), -np.inf)
        for at in range(0, len(gaps), _ROWS):
            rows = slice(at, at + _ROWS)
            distances = self._distances(self.normals[rows], self.heights[rows])
            least = np.minimum.reduceat(distances, self.starts, axis=1)
            gaps[rows] = np.where(self.plane[rows, None], least, -np.inf)
        low, high = (f.reduceat(self.points, self.starts) for f in (np.minimum, np.maximum))
        steps = np.maximum(np.maximum(low[:, None] - high, low - high[:, None]), 0.0)
        gaps = np.maximum(np.maximum(gaps, gaps.T), np.sqrt(dots(steps, steps)))
        sizes = np.sqrt(dots(high - low, high - low))
        return np.asarray(gaps >= 0.25 * np.maximum(sizes[:, None], sizes))


def facing(scene: Scene, surfaces: Surfaces, wanted: Bools) -> Facing:
    """`wanted` : (n, n), the pairs that matter."""
    count = len(surfaces.areas)
    known = nothing_known(count)
    some = np.flatnonzero(surfaces.ends - surfaces.starts <= _MOST_TRIANGLES)
    triangles = all_triangles(scene)
    if not len(some):
        return known
    planes = _Planes(surfaces, some)
    if len(planes.points) * len(triangles) > _MOST_TESTS:
        return known
    wanted = wanted[np.ix_(some, some)]

    # Sides of the planes of the patches' own triangles.
    owner = np.repeat(np.arange(len(some)), list(map(len, planes.corners)))
    own = np.concatenate(planes.corners)
    normals = _areas(own)
    normals /= np.linalg.norm(normals, axis=-1)[:, None]
    normals = np.where(planes.plane[owner, None], planes.normals[owner], normals)
    heights = np.where(planes.plane[owner], planes.heights[owner], (normals * own[:, 0]).sum(-1))
    firsts = np.flatnonzero(np.diff(owner, prepend=-1))
    ahead, after = planes.sides(normals, heights, np.abs(own).max(1))
    behind = np.logical_and.reduceat(after, firsts, axis=0)
    before = np.logical_and.reduceat(ahead, firsts, axis=0)
    hidden = behind | behind.T
    whole = before & before.T & ~hidden
    both_plane = planes.plane[:, None] & planes.plane
    exchange = _exchanges(planes, np.triu(wanted & ~hidden & (whole | both_plane), 1), whole)
    clear = _clear(planes, triangles, wanted & np.isfinite(exchange))

    for array, part in zip(known, (hidden, exchange, clear, planes.apart())):
        array[np.ix_(some, some)] = part
    return known


def _exchanges(planes: _Planes, wanted: Bools, whole: Bools) -> Doubles:
    outlines = [outline(one) for one in planes.corners]
    sizes = np.array(list(map(len, outlines)))
    triangles = np.array(list(map(len, planes.corners)))
    found = np.full(wanted.shape, np.nan)

    def add(pairs: Ints, counts: tuple[Ints, Ints], edges: tuple[Doubles, Doubles]) -> None:
        i, j = pairs
        centers = np.add.reduceat(planes.points, planes.starts, axis=0)
        centers /= np.diff(planes.starts, append=len(planes.points))[:, None]
        apart = np.linalg.norm(centers[i] - centers[j], axis=-1)
        scale = np.maximum(apart, ROUNDING * np.maximum(planes.reach[i], planes.reach[j]).max(-1))
        found[i, j] = found[j, i] = exchange_areas(edges, counts, scale)

    few = sizes[:, None] * sizes <= _MOST_EDGE_PAIRS
    pairs = np.array(np.nonzero(wanted & whole & few))
    if pairs.size:
        all_edges, starts = np.concatenate(outlines), np.cumsum(sizes) - sizes
        gathered = [all_edges[_ragged(starts[one], sizes[one])] for one in pairs]
        add(pairs, (sizes[pairs[0]], sizes[pairs[1]]), (gathered[0], gathered[1]))
    few = 16 * triangles[:, None] * triangles <= _MOST_EDGE_PAIRS
    pairs = np.array(np.nonzero(wanted & ~whole & few))
    if pairs.size:
        all_corners, starts = np.concatenate(planes.corners), np.cumsum(triangles) - triangles
        parts = []
        for one, other in (pairs, pairs[::-1]):
            which = np.repeat(other, triangles[one])
            corners = all_corners[_ragged(starts[one], triangles[one])]
            edges = clipped(corners, planes.normals[which], planes.heights[which])
            parts.append(edges.reshape(-1, 2, 3))
        counts = [4 * triangles[one] for one in pairs]
        for side in (0, 1):  # without edges of no length
            kept = (parts[side][:, 0] != parts[side][:, 1]).any(-1)
            number = np.repeat(np.arange(len(counts[side])), counts[side])
            counts[side] = np.bincount(number[kept], minlength=len(counts[side]))
            parts[side] = parts[side][kept]
        add(pairs, (counts[0], counts[1]), (parts[0], parts[1]))
    return found


def _ragged(starts: Ints, counts: Ints) -> Ints:
    """starts[0], starts[0] + 1, ... (counts[0] of them), starts[1], ..."""
    ends = np.cumsum(counts)
    return np.asarray(np.arange(ends[-1]) + np.repeat(starts - (ends - counts), counts))


def _clear(planes: _Planes, triangles: Doubles, wanted: Bools) -> Bools:
    """Whether each triangle is apart from the convex hull of each wanted pair: behind the plane of
    one of the two, or on the other side of a plane from both. False also where this is not found.
    """
    areas = _areas(triangles)
    sizes = np.linalg.norm(areas, axis=-1)
    solid = (sizes > 0) & np.isfinite(sizes)
    triangles, normals = triangles[solid], areas[solid] / sizes[solid, None]
    reach = np.abs(triangles).max(1)
    heights = (normals * triangles[:, 0]).sum(-1)
    ahead, after = planes.sides(normals, heights, reach)
    apart = [ahead.T, after.T]
    for axis in _AXES:
        own, other = ((one * axis).sum(-1) for one in (planes.points, triangles))
        least, most = (f.reduceat(own, planes.starts) for f in (np.minimum, np.maximum))
        slack = _rounding(axis, planes.reach[:, None] + reach)
        apart.append(least[:, None] >= other.max(1) - slack)
        apart.append(most[:, None] <= other.min(1) + slack)
    under = np.zeros((len(planes.starts), len(triangles)), np.bool_)
    for i in np.flatnonzero(planes.plane).tolist():
        off = (triangles * planes.normals[i]).sum(-1).max(1) - planes.heights[i]
        under[i] = off <= _rounding(planes.normals[i], planes.reach[i] + reach)
    bits = [_packed(one) for one in apart]
    below = _packed(under)
    clear = np.zeros(wanted.shape, np.bool_)
    for i in range(len(wanted)):
        others = i + np.flatnonzero(wanted[i, i:])
        if len(others):
            found = below[i] | below[others]
            for one in bits:
                found |= one[i] & one[others]
            clear[i, others] = clear[others, i] = (found == 0xFF).all(1)
    return clear


def _packed(flags: Bools) -> NDArray[np.uint8]:
    """Eight in a byte; those that are missing in the last byte are set."""
    missing = -flags.shape[1] % 8
    return np.packbits(np.pad(flags, ((0, 0), (0, missing)), constant_values=True), axis=1)
