"""Long calculations in batches that fit a stated memory, and report their progress."""

from __future__ import annotations

from typing import Any, Callable, Iterator, Optional

from . import _values

Progress = Callable[[int, int], object]

MEMORY = 256e6  # bytes
TILE = 1 << 12  # rays whose answers are summed at once, whatever the batch
_PER_RAY = 256  # bytes, of all arrays that a ray has a part in


class Batches:
    """Ranges of rays, and how many of all rays are done."""

    def __init__(self, memory: Any, progress: Optional[Progress], total: int) -> None:
        size = _values.number(memory, "memory")
        if not size > 0:
            raise ValueError(f"memory: {size:g} is given; bytes above 0 are expected")
        if progress is not None and not callable(progress):
            raise TypeError(
                f"progress: {progress!r} is given; a function of two integers is expected"
            )
        self.most = max(TILE, int(min(size / _PER_RAY, 2**30)))
        self._progress, self._done, self._total = progress, 0, total

    def ranges(self, count: int, rays_each: int = 1) -> Iterator[tuple[int, int]]:
        """Cuts `count` items of so many rays; an item that is too large is a batch by itself."""
        step = max(1, self.most // max(rays_each, 1))
        for begin in range(0, count, step):
            end = min(begin + step, count)
            yield begin, end
            self._add((end - begin) * rays_each)

    def grid(self, points: int, rays_each: int) -> Iterator[tuple[slice, slice]]:
        """Points and some of their rays, tiles of which are never cut."""
        if rays_each <= self.most:
            for begin, end in self.ranges(points, rays_each):
                yield slice(begin, end), slice(0, rays_each)
            return
        step = self.most // TILE * TILE
        for point in range(points):
            for begin in range(0, rays_each, step):
                end = min(begin + step, rays_each)
                yield slice(point, point + 1), slice(begin, end)
                self._add(end - begin)

    def _add(self, rays: int) -> None:
        self._done += rays
        if self._progress is not None and rays:
            self._progress(self._done, self._total)
