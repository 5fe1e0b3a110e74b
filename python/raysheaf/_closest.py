"""The results of point queries."""

from __future__ import annotations

from typing import Any, Iterator, Union, overload

import numpy as np
from numpy.typing import NDArray

from ._hits import Records

CLOSEST_DTYPE = np.dtype(
    [
        ("distance", np.float64),
        ("point", np.float64, (3,)),
        ("u", np.float64),
        ("v", np.float64),
        ("prim_id", np.uint32),
        ("geom_id", np.uint32),
        ("inst_id", np.uint32),
        ("side", np.int32),
    ]
)
"""One closest point, 64 bytes."""


class ClosestPoints(Records):
    """Closest points in an array of the shape of the points that were asked.

    Each attribute is a view of one structured array, `array`, and writes through to it. Indexing
    works as it does with arrays, and gives `ClosestPoints` again; by the name of a field, that
    field.

    >>> import raysheaf
    >>> scene = raysheaf.Scene()
    >>> mesh = scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> found = scene.closest_point([[0.25, 0.25, 2], [0, 0, 9]], radius=5)
    >>> found.distance
    array([ 2., inf])
    >>> found[found.found].point
    array([[0.25, 0.25, 0.  ]])
    """

    __slots__ = ()

    array: NDArray[np.void]
    """The closest points themselves, of dtype `CLOSEST_DTYPE`."""

    def __init__(self, array: NDArray[np.void]) -> None:
        if isinstance(array, np.void) and array.dtype == CLOSEST_DTYPE:
            array = np.asarray(array)
        if not isinstance(array, np.ndarray) or array.dtype != CLOSEST_DTYPE:
            given = f"dtype {array.dtype}" if isinstance(array, np.ndarray) else type(array).__name__
            raise TypeError(f"array: {given} is given; an array of dtype CLOSEST_DTYPE is expected")
        self.array = array

    @property
    def distance(self) -> NDArray[np.float64]:
        """The distance; inf where nothing is within the radius."""
        return self.array["distance"]

    @property
    def point(self) -> NDArray[np.float64]:
        """The nearest point on a triangle, with a last axis of 3; NaN if none is within the radius."""
        return self.array["point"]

    @property
    def u(self) -> NDArray[np.float64]:
        """The weight of the triangle's second corner."""
        return self.array["u"]

    @property
    def v(self) -> NDArray[np.float64]:
        """The weight of the triangle's third corner; the first has 1 - u - v."""
        return self.array["v"]

    @property
    def side(self) -> NDArray[np.int32]:
        """1 where the triangle's corners run counter-clockwise as seen from the point, -1 where they
        run clockwise, 0 where the point lies in its plane, or the triangle has no area. Exact."""
        return self.array["side"]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether anything is within the radius."""
        return self._any()

    @overload
    def __getitem__(self, index: Union[str, list[str]]) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, index: Any) -> ClosestPoints: ...

    def __getitem__(self, index: Any) -> Union[ClosestPoints, NDArray[Any]]:
        found: NDArray[Any] = self.array[index]
        return ClosestPoints(np.asarray(found)) if found.dtype == CLOSEST_DTYPE else found

    def __iter__(self) -> Iterator[ClosestPoints]:
        if not self.array.ndim:
            raise TypeError("what is closest to a single point has no items")
        return (self[i] for i in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.array,)

    def __repr__(self) -> str:
        return (
            f"<raysheaf.ClosestPoints of shape {self.shape}: {int(self.found.sum())} of "
            f"{self.size} found>"
        )
