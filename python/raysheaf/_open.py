"""Rays from many points: what they are, and sums of what they find."""

from __future__ import annotations

from typing import Any, Mapping, SupportsFloat, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _values
from ._batches import TILE, Batches
from ._patches import ROUNDING, Bools, Doubles, Ints, cosine_lobe, frames, lifted_off
from ._scene import Scene
from ._sobol import REPLICATES, Bits, mixed, point_sets, unit

Reflectance = Union[SupportsFloat, Mapping[int, SupportsFloat]]


class Points:
    """Points and unit normals in a row; those that are NaN have no answers."""

    def __init__(self, scene: Scene, points: Any, normals: Any, side: float = 1.0) -> None:
        if not isinstance(scene, Scene):
            raise TypeError(f"scene: {type(scene).__name__} is given; a Scene is expected")
        at = _arrays.with_last_axis(points, "points", 3, "one of shape (..., 3)")
        ways = _arrays.with_last_axis(normals, "normals", 3, "one of shape (..., 3)")
        try:
            self.shape = np.broadcast_shapes(at.shape, ways.shape)[:-1]
        except ValueError:
            raise ValueError(
                f"points {at.shape}, normals {ways.shape}: shapes that broadcast are expected"
            ) from None
        at = np.broadcast_to(at, self.shape + (3,)).reshape(-1, 3).astype(np.float64)
        ways = np.broadcast_to(ways, self.shape + (3,)).reshape(-1, 3).astype(np.float64)
        self.valid = np.isfinite(at).all(-1) & np.isfinite(ways).all(-1)
        ways = ways[self.valid]
        lengths = np.linalg.norm(ways, axis=-1, keepdims=True)
        if not (lengths > 0).all():
            raise ValueError("normals: a normal is 0; vectors with a direction are expected")
        self.normals = ways / lengths * side
        self.starts = _lifted(scene, at[self.valid], self.normals).astype(np.float32)

    def __len__(self) -> int:
        return len(self.normals)

    def shaped(self, values: NDArray[Any], tail: tuple[int, ...] = ()) -> Doubles:
        """Answers in the shape that the points were given in."""
        all_of_them = np.full((len(self.valid), *tail), np.nan)
        all_of_them[self.valid] = values.reshape(len(self), *tail)
        return all_of_them.reshape(self.shape + tail)


def _lifted(scene: Scene, points: Doubles, normals: Doubles) -> Doubles:
    """Points on a surface, or as near to it as rounding brings them, a little in front of it."""
    bounds = scene.bounds
    if bounds is None or not len(points):
        return points
    extent = float(np.abs(bounds).max())
    near = scene.closest_point(points, radius=ROUNDING * extent)
    above = points + normals * np.where(near.found, 2 * near.distance, 0.0)[:, None]
    return np.where(near.found[:, None], lifted_off(above, normals, least=extent), points)


def _tiles(values: NDArray[Any]) -> Doubles:
    """(k, tiles): sums over tiles of rays, which are the same for all batches."""
    starts = np.arange(0, values.shape[1], min(TILE, max(values.shape[1], 1)))
    return np.asarray(np.add.reduceat(values, starts, axis=1, dtype=np.float64))


class _Spread:
    """Directions around a normal, turned about it for each point."""

    def __init__(self, log2: int, cosines: Doubles) -> None:
        """`cosines` : those of angles to the normal, for each sample."""
        angle = 2 * np.pi * unit(point_sets(log2, 2).reshape(-1, 2)[:, 1])
        radius = np.sqrt(1 - cosines * cosines)
        self._local = np.stack([radius * np.cos(angle), radius * np.sin(angle), cosines])

    def around(self, normals: Doubles, numbers: Ints, samples: slice) -> NDArray[np.float32]:
        first, second = frames(normals)
        turn = (2 * np.pi * unit(mixed(numbers)))[:, None]
        first, second = (
            first * np.cos(turn) + second * np.sin(turn),
            second * np.cos(turn) - first * np.sin(turn),
        )
        x, y, z = self._local[:, samples]
        ways = np.empty((len(normals), len(x), 3), np.float32)
        for k in range(3):
            ways[..., k] = first[:, k, None] * x + second[:, k, None] * y + normals[:, k, None] * z
        return ways


def free_shares(
    scene: Scene, points: Points, log2: int, radius: float, work: Batches
) -> tuple[Doubles, Doubles]:
    """The share of cosine-distributed rays that hit nothing within the radius, and its error."""
    each = REPLICATES << log2
    spread = _Spread(log2, np.sqrt(unit(point_sets(log2, 2).reshape(-1, 2)[:, 0])))
    free = np.zeros((len(points), REPLICATES))
    for some, samples in work.grid(len(points), each):
        numbers = np.arange(some.start, some.stop)
        ways = spread.around(points.normals[some], numbers, samples)
        open_rays = ~scene.any_hit(points.starts[some, None], ways, t_max=radius)
        replicate = np.arange(samples.start, samples.stop) >> log2
        firsts = np.flatnonzero(np.diff(replicate, prepend=-1))
        free[some, replicate[firsts]] += np.add.reduceat(open_rays, firsts, axis=1, dtype=np.int64)
    counts = free.sum(1)
    part = (counts + 1) / (each + 2)  # of few rays that are free, or few that are not
    rare = np.minimum(counts, each - counts) < 64
    shares = free / (each / REPLICATES)
    variance = np.where(rare, part * (1 - part) / each, shares.var(1, ddof=1) / REPLICATES)
    return counts / each, np.sqrt(variance)


def mean_lengths(scene: Scene, points: Points, log2: int, angle: float, work: Batches) -> Doubles:
    """The mean distance that rays in a cone go; inf where none hits."""
    each = REPLICATES << log2 if angle else 1
    u = unit(point_sets(log2, 2).reshape(-1, 2)[:, 0])
    spread = _Spread(log2, 1 - u * (1 - np.cos(angle)) if angle else np.ones_like(u))
    sums = np.zeros((2, len(points)))
    for some, samples in work.grid(len(points), each):
        numbers = np.arange(some.start, some.stop)
        ways = spread.around(points.normals[some], numbers, samples)
        t = scene.closest_hit(points.starts[some, None], ways).t
        hit = np.isfinite(t)
        for row, values in enumerate((np.where(hit, t, 0), hit)):
            for tile in _tiles(values).T:
                sums[row, some] += tile
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(sums[1] > 0, sums[0] / sums[1], np.inf)


def sums_of_visible(
    scene: Scene,
    points: Points,
    directions: Doubles,
    weights: Doubles,
    by_cosine: bool,
    work: Batches,
) -> Doubles:
    """(n, k): the sums of weights (k, d) of the directions (d, 3) that each point sees above its
    plane, by the cosine to the normal if wanted."""
    found = np.zeros((len(points), len(weights)))
    ways = directions.astype(np.float32)
    for some, part in work.grid(len(points), len(directions)):
        cosine = np.zeros((some.stop - some.start, part.stop - part.start))
        for k in range(3):
            cosine += points.normals[some, k, None] * directions[part, k]
        above = cosine > 0
        reach = np.where(above, np.float32(np.inf), np.float32(0))
        hidden = scene.any_hit(points.starts[some, None], ways[part], t_max=reach)
        seen = np.where(above & ~hidden, cosine if by_cosine else 1.0, 0.0)
        for row in range(len(weights)):
            for tile in _tiles(seen * weights[row, part]).T:
                found[some, row] += tile
    return found


class Bounces:
    """Light that diffuse surfaces reflect once or more before it arrives."""

    def __init__(
        self, scene: Scene, reflectance: Reflectance, directions: Doubles, weights: Doubles
    ) -> None:
        self.scene = scene
        self.directions = directions
        self._upto = np.cumsum(weights)
        meshes = scene.meshes
        self._factors = np.zeros(max(meshes, default=0) + 1)
        given = (
            reflectance if isinstance(reflectance, Mapping) else dict.fromkeys(meshes, reflectance)
        )
        for mesh, value in given.items():
            name = f"reflectance[{mesh}]" if isinstance(reflectance, Mapping) else "reflectance"
            factor = _values.number(value, name)
            if not 0 <= factor <= 1:
                raise ValueError(f"{name}: {factor:g} is given; a number from 0 to 1 is expected")
            if mesh not in scene:
                raise ValueError(f"{name}: the scene has no mesh {mesh}")
            self._factors[mesh] = factor

    def irradiance(
        self, points: Points, log2: int, bounces: int, work: Batches
    ) -> tuple[Doubles, Doubles]:
        """The mean over paths, and its error."""
        each = REPLICATES << log2
        total = self._upto[-1] if len(self._upto) else 0.0
        sums = np.zeros((len(points), REPLICATES))
        for some, samples in work.grid(len(points), each):
            shape = some.stop - some.start, samples.stop - samples.start
            carried = self._carried(points, some, samples, log2, bounces).reshape(shape)
            replicate = np.arange(samples.start, samples.stop) >> log2
            edges = np.flatnonzero(np.diff(replicate, prepend=-1))
            for begin, end in zip(edges, [*edges[1:], shape[1]]):
                for tile in _tiles(carried[:, begin:end]).T:
                    sums[some, replicate[begin]] += tile
        means = sums * (total / (each / REPLICATES))
        return means.mean(1), np.sqrt(means.var(1, ddof=1) / REPLICATES)

    def _carried(
        self, points: Points, some: slice, samples: slice, log2: int, bounces: int
    ) -> Doubles:
        """The light of each path, in units of the sum of all weights. At each of its ends one
        direction of the sky is tested, chosen by its weight."""
        count = samples.stop - samples.start
        number = np.repeat(np.arange(some.start, some.stop), count)
        start, normal = points.starts[number], points.normals[number]
        sample = np.tile(np.arange(samples.start, samples.stop), some.stop - some.start)
        found = np.zeros(len(number))
        path = np.arange(len(number))
        factor = np.ones(len(number))
        for bounce in range(bounces):
            sets = point_sets(log2, 3, seed=1 + bounce).reshape(-1, 3)
            keys = mixed(number[path] * np.int64(64) + bounce)
            shifts: Bits = np.stack([mixed(keys + np.uint32(k)) for k in range(3)], axis=-1)
            x = sets[sample[path]] ^ shifts
            ways = cosine_lobe(normal, x[:, :2])
            hits = self.scene.closest_hit(start, ways)
            rest = np.flatnonzero(hits.hit)
            rest = rest[self._factors[hits.geom_id[rest]] > 0]
            hits, path = hits[rest], path[rest]
            if not len(path):
                break
            factor = factor[rest] * self._factors[hits.geom_id]
            normal = hits.geometric_normal.astype(np.float64) * hits.side[:, None]
            chosen = np.searchsorted(self._upto, unit(x[rest, 2]) * self._upto[-1], side="right")
            to = self.directions[np.minimum(chosen, len(self._upto) - 1)]
            cosine = (normal * to).sum(-1)
            reach = np.where(cosine > 0, np.float32(np.inf), np.float32(0))
            seen = (cosine > 0) & ~self.scene.any_hit(hits.start(normal), to, t_max=reach)
            found[path] += np.where(seen, factor * cosine, 0.0)
            start = hits.start(normal)
        return found


def visible(scene: Scene, start: Doubles, stop: Doubles) -> Bools:
    """Whether nothing lies between points (n, 3), except surfaces at the points themselves."""
    way = stop - start
    length = np.linalg.norm(way, axis=-1)
    ends = np.maximum(np.abs(start).max(-1), np.abs(stop).max(-1))
    with np.errstate(invalid="ignore", divide="ignore"):
        margin = np.minimum(4 * ROUNDING * ends / length, 0.5)
    here = ~(margin < 0.5)
    margin = np.where(here, 0.5, margin)
    way = np.where(here[:, None], [1.0, 0.0, 0.0], way)
    near, far = margin.astype(np.float32), (1 - margin).astype(np.float32)
    return np.asarray(here | ~scene.any_hit(start, way, t_min=near, t_max=np.maximum(near, far)))


def flat_pairs(points: Any, others: Any) -> tuple[tuple[int, ...], NDArray[Any], NDArray[Any]]:
    """The shape of two arrays of points that broadcast, and both in that shape."""
    ends = [
        _arrays.with_last_axis(one, name, 3, "one of shape (..., 3)")
        for one, name in ((points, "points"), (others, "others"))
    ]
    try:
        shape = np.broadcast_shapes(*(one.shape for one in ends))
    except ValueError:
        raise ValueError(
            f"points {ends[0].shape}, others {ends[1].shape}: shapes that broadcast are expected"
        ) from None
    start, stop = (np.broadcast_to(one, shape) for one in ends)
    return shape[:-1], start, stop


def rows_of(array: NDArray[Any], begin: int, end: int) -> Doubles:
    """Points `begin` to `end` of a broadcast array (..., 3), counted in C order."""
    index = np.unravel_index(np.arange(begin, end), array.shape[:-1])
    return np.asarray(array[index], np.float64).reshape(-1, 3)
