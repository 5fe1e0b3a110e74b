"""View factors: how they are put together from integrals along edges, rays and lines of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence, SupportsIndex, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._batches import TILE, Batches, Progress
from ._facing import Facing, facing, nothing_known
from ._patches import (
    Bools,
    Doubles,
    Ints,
    Patch,
    Surfaces,
    cosine_lobe,
    dots,
    lifted_off,
    patches_of,
)
from ._scene import Scene
from ._sobol import REPLICATES, Bits, log2_at_least, mixed, point_sets

_TO_FIND_GAPS = 1 << 12  # rays that say whether a patch is in a closed room; for many patches,
_GAPS_OF_ALL = 1 << 19  # fewer
_LEAK = 1e-3  # the share of rays that may leave a closed room, through gaps that rounding leaves
_FEWEST_LINES = 2  # of each replicate of a pair
_FEW_HITS = 64
_MANY_PAIRS = 1 << 14  # whose integrals take as long as 8 samples for each patch of a row


@dataclass(frozen=True, eq=False)
class ViewFactors:
    """View factors F[i, j]: the share of what leaves patch i, by diffuse radiation from its front,
    that arrives at the front of patch j without another surface between. ``np.asarray`` gives
    `factors`, and an index those of the factors."""

    factors: Doubles
    """(n, m), from 0 to 1. ``areas[i] * F[i, j] == areas[j] * F[j, i]``."""
    errors: Doubles
    """(n, m), standard errors: 0 where the factor is that of integrals along edges."""
    areas: Doubles
    """(n,), of the patches, in the square of the scene's unit of length."""
    closed: Bools
    """(n,): all that leaves the patch arrives at fronts of patches, and its row sums to 1."""

    @property
    def shape(self) -> tuple[int, ...]:
        """(n, m)."""
        return self.factors.shape

    def __getitem__(self, index: Any) -> Any:
        return self.factors[index]

    def __len__(self) -> int:
        return len(self.factors)

    def __array__(self, dtype: Any = None, copy: Any = None) -> NDArray[Any]:
        return np.array(self.factors, dtype) if copy else np.asarray(self.factors, dtype)

    def __repr__(self) -> str:
        return (
            f"<raysheaf.radiation.ViewFactors of shape {self.shape}: {int(self.closed.sum())} rows "
            f"closed, errors up to {self.errors.max(initial=0):.1e}>"
        )


def _key(patch: Patch) -> tuple[Any, ...]:
    return tuple(
        one if one is None or isinstance(one, int) else tuple(np.ravel(np.asarray(one)).tolist())
        for one in patch
    )


def view_factors(
    scene: Scene,
    patches: Sequence[Union[Patch, SupportsIndex]],
    *,
    samples: SupportsIndex = 2**14,
    to: Optional[Sequence[Union[Patch, SupportsIndex]]] = None,
    exact: Optional[bool] = None,
    memory: float,
    progress: Optional[Progress] = None,
) -> ViewFactors:
    """`raysheaf.radiation.view_factors`."""
    count = _arrays.integer(samples, "samples", 2**30, least=1)
    own = patches_of(scene, patches, "patches")
    targets = own if to is None else patches_of(scene, to, "to")
    numbers: dict[tuple[Any, ...], int] = {}
    for one in own:
        if _key(one) in numbers:
            raise ValueError(f"patches: {one} is given twice; different ones are expected")
        numbers[_key(one)] = len(numbers)
    columns = np.array([numbers.setdefault(_key(one), len(numbers)) for one in targets], np.int64)
    unique = {_key(one): one for one in (*own, *targets)}
    surfaces = Surfaces(scene, [unique[key] for key in numbers])

    rows = np.arange(len(own))
    wanted = np.zeros((len(numbers), len(numbers)), np.bool_)
    wanted[np.ix_(rows, columns)] = True
    wanted = wanted | wanted.T
    if exact is None:
        exact = len(own) * len(targets) <= _MANY_PAIRS or count >= 8 * len(targets)
    known = facing(scene, surfaces, wanted) if exact else nothing_known(len(numbers))
    work = _Work(scene, surfaces, rows, wanted, known, log2_at_least(count))
    exchange, variance = work.run(memory, progress)

    closed: Bools = work.closed if to is None else np.zeros(len(own), np.bool_)
    if closed.any():
        exchange = _closed(exchange, variance, surfaces.areas, closed)
    areas = surfaces.areas[: len(own), None]
    return ViewFactors(
        exchange[np.ix_(rows, columns)] / areas,
        np.sqrt(variance[np.ix_(rows, columns)]) / areas,
        areas[:, 0],
        closed,
    )


class _Work:
    """The exchange areas of pairs of patches, and their variances."""

    def __init__(
        self,
        scene: Scene,
        surfaces: Surfaces,
        rows: Ints,
        wanted: Bools,
        known: Facing,
        log2_samples: int,
    ) -> None:
        self.scene, self.surfaces, self.rows, self.known = scene, surfaces, rows, known
        self.log2_samples = log2_samples
        areas = surfaces.areas
        unsure = wanted & ~known.hidden & ~known.clear
        # Lines of sight between two patches err less than rays from them if the patches are apart.
        each = max(int(unsure.sum(1).max(initial=1)), 1)
        self.log2_lines = max(log2_samples - (each - 1).bit_length(), _FEWEST_LINES - 1)
        lines = unsure & np.isfinite(known.exchange) & known.apart
        factor = known.exchange / np.minimum(areas[:, None], areas)
        with np.errstate(invalid="ignore"):
            lines &= factor * 2.0 ** (log2_samples - 1) < 2.0**self.log2_lines * 4
        np.fill_diagonal(lines, False)
        self.lines = np.array(np.nonzero(np.triu(lines)))
        self.by_rays = unsure & ~lines
        self.full: Bools = np.asarray(self.by_rays.any(1))[rows]  # rows that need all their rays

    def run(self, memory: float, progress: Optional[Progress]) -> tuple[Doubles, Doubles]:
        few = max(min(_TO_FIND_GAPS, _GAPS_OF_ALL // len(self.rows)), 1 << 8)
        few = min(self.log2_samples, log2_at_least(few))
        total = int(self.full.sum()) << self.log2_samples
        total += int((~self.full).sum()) << few
        total = (total + (self.lines.shape[1] << self.log2_lines)) * REPLICATES
        work = Batches(memory, progress, total)
        areas = self.surfaces.areas
        exchange = np.where(self.known.hidden, 0.0, self.known.exchange)
        variance = np.zeros_like(exchange)

        # Rays: a row's counts estimate its factors, and those of both rows together the exchange.
        count = len(areas)
        sums, squares = np.zeros((count, count)), np.zeros((count, count))
        weight = np.zeros(count)
        self.closed = np.zeros(len(self.rows), np.bool_)
        for some, log2 in ((self.rows[self.full], self.log2_samples), (self.rows[~self.full], few)):
            if not len(some):
                continue
            hits, squares_of_hits = self._rays(some, log2, work)
            each = REPLICATES << log2
            self.closed[some] = each - hits.sum(1) <= _LEAK * each
            sums[some] = hits / each
            weight[some] = 1.0
            # The variance of the mean of the replicates, or that of random rays where few count.
            spread = (squares_of_hits - hits**2 / REPLICATES) / (REPLICATES - 1)
            spread *= REPLICATES / each**2
            part = (hits + 1) / (each + 2)
            rare = np.minimum(hits, each - hits) < _FEW_HITS
            squares[some] = np.where(rare, part * (1 - part) / each, spread)
        # Both rows see the exchange area, each with a variance that its own area multiplies.
        weights = weight / areas
        with np.errstate(invalid="ignore", divide="ignore"):
            both = weights[:, None] + weights
            mixed_sums = (sums * weight[:, None] + (sums * weight[:, None]).T) / both
            mixed_squares = (squares * weight[:, None] + (squares * weight[:, None]).T) / both**2
        diagonal = np.diag_indices(count)
        mixed_sums[diagonal] = sums[diagonal] * areas
        mixed_squares[diagonal] = squares[diagonal] * areas**2
        exchange[self.by_rays] = mixed_sums[self.by_rays]
        variance[self.by_rays] = mixed_squares[self.by_rays]

        i, j = self.lines
        if len(i):
            share, spread = self._lines(work)
            full = self.known.exchange[i, j]
            exchange[i, j] = exchange[j, i] = full * share
            variance[i, j] = variance[j, i] = full**2 * spread
        return exchange, variance

    def _rays(self, rows: Ints, log2: int, work: Batches) -> tuple[Doubles, Doubles]:
        """How many rays of each patch see each, (k, n), and the sum over the replicates of the
        squares of these numbers."""
        shape, each = (len(rows), len(self.surfaces.areas)), 1 << log2
        hits, squares = np.zeros(shape), np.zeros(shape)
        shifts = _shifts(rows)
        for base in point_sets(log2, 4):
            counts = np.zeros(len(rows) * shape[1], np.int64)
            for begin, end in work.ranges(len(rows) * each):
                row, sample = np.divmod(np.arange(begin, end), each)
                x = base[sample] ^ shifts[row]
                points, triangles = self.surfaces.spread(rows[row], x[:, :2])
                normals = self.surfaces.normals[triangles]
                ways = cosine_lobe(normals, x[:, 2:])
                closest = self.scene.closest_hit(lifted_off(points, normals), ways)
                found = self.surfaces.seen(closest, ways)
                some = found >= 0
                first, last = begin // each, (end - 1) // each + 1
                cells = (row[some] - first) * shape[1] + found[some]
                part = slice(first * shape[1], last * shape[1])
                counts[part] += np.bincount(cells, minlength=part.stop - part.start)
            now = counts.reshape(shape).astype(np.float64)
            hits += now
            squares += now * now
        return hits, squares

    def _lines(self, work: Batches) -> tuple[Doubles, Doubles]:
        """The share of the exchange of each pair that nothing is in the way of, and its variance:
        a mean of visibility, weighted by the kernel cos cos / (pi r^2)."""
        patches, both = np.unique(self.lines, return_inverse=True)
        i, j = both.reshape(self.lines.shape)
        m = 1 << self.log2_lines
        each = REPLICATES * m
        block, tile = min(each, TILE), min(m, TILE)
        base = point_sets(self.log2_lines, 4, seed=1).reshape(-1, 4)
        shifts = _shifts(patches + len(self.surfaces.areas))
        reach = np.abs(self.surfaces.corners).max((0, 1))
        # Sums of the kernel, of the kernel of free lines, and numbers of free lines.
        sums = np.zeros((3, len(i), REPLICATES))
        for begin in range(0, each, block):
            x = (base[begin : begin + block] ^ shifts[:, None]).reshape(-1, 4)
            which = np.repeat(np.arange(len(patches)), block)
            ends, normals, lifted = [], [], []
            for side in (x[:, :2], x[:, 2:]):
                points, triangles = self.surfaces.spread(patches[which], side)
                normals.append(self.surfaces.normals[triangles].reshape(-1, block, 3))
                lifted.append(
                    lifted_off(points, normals[-1].reshape(-1, 3), reach).reshape(-1, block, 3)
                )
                ends.append(points.reshape(-1, block, 3))
            replicates = slice(begin // m, begin // m + block // tile)
            for first, last in work.ranges(len(i), block):
                one, other = i[first:last], j[first:last]
                way = ends[1][other] - ends[0][one]
                cosines = [np.maximum(dots(way, normals[0][one]), 0.0)]
                cosines.append(np.maximum(-dots(way, normals[1][other]), 0.0))
                kernel = cosines[0] * cosines[1] / dots(way, way) ** 2
                start = lifted[0][one]
                free = ~self.scene.any_hit(start, lifted[1][other] - start, t_max=1)
                for row, values in enumerate((kernel, kernel * free, free & (kernel > 0))):
                    tiles = values.reshape(len(one), -1, tile).sum(2)
                    sums[row, first:last, replicates] += tiles
        whole, free_part, lines = sums
        total = np.maximum(whole.sum(1), np.finfo(float).tiny)
        share = free_part.sum(1) / total
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = np.where(whole > 0, free_part / whole, share[:, None])
        spread = shares.var(1, ddof=1) / REPLICATES
        visible = lines.sum(1)
        part = (visible + 1) / (each + 2)
        rare = np.minimum(visible, each - visible) < _FEW_HITS
        return share, np.where(rare, np.maximum(spread, part * (1 - part) / each), spread)


def _shifts(numbers: Ints) -> Bits:
    """(n, 4): a shift of the digits of the samples of each patch or pair."""
    keys = mixed(numbers)
    return np.stack([mixed(keys + np.uint32(k)) for k in range(4)], axis=-1)


def _closed(exchange: Doubles, variance: Doubles, areas: Doubles, closed: Bools) -> Doubles:
    """The symmetric matrix nearest to the estimates, in units of their variance, whose closed rows
    sum to the areas: least squares with a multiplier for each row (R. P. Taylor et al.,
    "Uncertainty analysis of metal-casting view factors", J. Thermophysics 9 (1995)), by conjugate
    gradients."""
    both = closed[:, None] & closed
    # Estimates by counts err by the root of what they estimate, and so no entry changes its sign.
    weights = np.where(variance > 0, exchange, 0.0)
    weights *= closed[:, None] | closed
    wrong = np.where(closed, areas - exchange.sum(1), 0.0)
    diagonal = np.where(closed, weights.sum(1), 0.0)
    usable = diagonal > 0
    wrong = np.where(usable, wrong, 0.0)
    inside = np.where(both, weights, 0.0)
    np.fill_diagonal(inside, 0.0)
    diagonal = np.where(usable, diagonal * (1 + 1e-9), 1.0)
    found, rest = np.zeros(len(areas)), wrong
    ahead = scaled = rest / diagonal
    size = (rest * scaled).sum()
    for _ in range(10 * len(areas) + 100):
        if not size > 1e-32 * (areas * areas / diagonal).sum():
            break
        image = np.where(usable, diagonal * ahead + (inside * ahead).sum(1), 0.0)
        step = size / (ahead * image).sum()
        found = found + step * ahead
        rest = rest - step * image
        scaled = rest / diagonal
        size, before = (rest * scaled).sum(), size
        ahead = scaled + size / before * ahead
    shift = found[:, None] + found
    np.fill_diagonal(shift, found)
    return np.maximum(exchange + weights * shift, 0.0)
