"""The results of queries."""

from __future__ import annotations

import operator
from typing import Any, Iterator, SupportsIndex, Union, overload

import numpy as np
from numpy.typing import NDArray

INVALID_ID = 0xFFFFFFFF
"""The ids of a ray that hits nothing."""

HIT_DTYPE = np.dtype(
    [
        ("t", np.float32),
        ("u", np.float32),
        ("v", np.float32),
        ("prim_id", np.uint32),
        ("geom_id", np.uint32),
        ("inst_id", np.uint32),
    ]
)
"""One hit, 24 bytes."""


def _is_index(part: Any) -> bool:
    """Whether numpy takes the value as a single index of an array, even one out of range."""
    if part is None or part is Ellipsis or isinstance(part, slice):
        return True
    array = np.asarray(part)
    return array.dtype.kind in "iub" or array.shape == (0,)


class Hits:
    """Hits in an array of the shape of the rays.

    Each attribute is a view of one structured array, `array`, and writes through to it. Indexing
    works as it does with arrays, and gives `Hits` again; by the name of a field, that field.

    >>> import numpy as np, raysheaf
    >>> scene = raysheaf.Scene()
    >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
    >>> hits = scene.closest_hit([[0.25, 0.5, 0], [9, 9, 0]], [0, 0, 1])
    >>> hits.t
    array([ 1., inf], dtype=float32)
    >>> hits.hit
    array([ True, False])
    >>> hits[hits.hit].prim_id
    array([0], dtype=uint32)
    """

    __slots__ = ("array",)

    array: NDArray[np.void]
    """The hits themselves, of dtype `HIT_DTYPE`."""

    def __init__(self, array: NDArray[np.void]) -> None:
        if isinstance(array, np.void) and array.dtype == HIT_DTYPE:
            array = np.asarray(array)
        if not isinstance(array, np.ndarray):
            raise TypeError(
                f"array: {type(array).__name__} is given; an array of dtype HIT_DTYPE is expected"
            )
        if array.dtype != HIT_DTYPE:
            raise TypeError(f"array: dtype {array.dtype} is given; HIT_DTYPE is expected")
        self.array = array

    @classmethod
    def empty(cls, shape: Union[SupportsIndex, tuple[SupportsIndex, ...]]) -> Hits:
        """Memory for results, for ``closest_hit(..., out=...)``. At first, all hits are misses.

        >>> import raysheaf
        >>> raysheaf.Hits.empty(3)
        <raysheaf.Hits of shape (3,): 0 of 3 hit>
        """
        array = np.zeros(shape, HIT_DTYPE)
        array["t"] = np.inf
        for name in ("prim_id", "geom_id", "inst_id"):
            array[name] = INVALID_ID
        return cls(array)

    @property
    def t(self) -> NDArray[np.float32]:
        """The position along the ray, in lengths of its direction; inf for a miss."""
        return self.array["t"]

    @property
    def u(self) -> NDArray[np.float32]:
        """The weight of the triangle's second corner."""
        return self.array["u"]

    @property
    def v(self) -> NDArray[np.float32]:
        """The weight of the triangle's third corner; the first has 1 - u - v."""
        return self.array["v"]

    @property
    def prim_id(self) -> NDArray[np.uint32]:
        """The triangle within its mesh; for a miss, all three ids are `INVALID_ID`."""
        return self.array["prim_id"]

    @property
    def geom_id(self) -> NDArray[np.uint32]:
        """The mesh: the id that `Scene.add` returned."""
        return self.array["geom_id"]

    @property
    def inst_id(self) -> NDArray[np.uint32]:
        """The instance of the mesh."""
        return self.array["inst_id"]

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether the ray hits anything."""
        hit: NDArray[np.bool_] = self.array["prim_id"] != INVALID_ID
        return hit

    @property
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    @property
    def size(self) -> int:
        return self.array.size

    def __len__(self) -> int:
        return len(self.array)

    @overload
    def __getitem__(self, index: Union[str, list[str]]) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, index: Any) -> Hits: ...

    def __getitem__(self, index: Any) -> Union[Hits, NDArray[Any]]:
        try:
            found: NDArray[Any] = self.array[index]
        except IndexError:
            if all(map(_is_index, index if isinstance(index, tuple) else (index,))):
                raise
            raise TypeError(
                f"index: {index!r} is given; integers, slices, arrays of integers or booleans, "
                "or names of fields are expected"
            ) from None
        return Hits(np.asarray(found)) if found.dtype == HIT_DTYPE else found

    def __iter__(self) -> Iterator[Hits]:
        if not self.array.ndim:
            raise TypeError("the hit of a single ray has no items")
        return (self[i] for i in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.array,), getattr(self, "__dict__", None)

    def __array__(self, dtype: Any = None, copy: Any = None) -> NDArray[Any]:
        return np.array(self.array, dtype) if copy else np.asarray(self.array, dtype)

    def __repr__(self) -> str:
        return f"<raysheaf.Hits of shape {self.shape}: {int(self.hit.sum())} of {self.size} hit>"


class HitRows:
    """All hits of all rays, stored ray by ray: compressed rows.

    The hits of ray i, counted in C order, are ``hits[offsets[i]:offsets[i + 1]]``, from near to far.

    >>> import raysheaf
    >>> scene = raysheaf.Scene()
    >>> for z in (1, 2, 3):
    ...     mesh = scene.add([[0, 0, z], [1, 0, z], [0, 1, z]], [[0, 1, 2]])
    >>> rows = scene.all_hits([[0.25, 0.25, 0], [9, 9, 0]], [0, 0, 1])
    >>> rows.counts
    array([3, 0])
    >>> rows[0].t
    array([1., 2., 3.], dtype=float32)
    >>> rows.ray_id
    array([0, 0, 0])
    """

    __slots__ = ("offsets", "hits", "shape")

    offsets: NDArray[np.int64]
    """One entry more than there are rays; the first is 0, the last the number of hits."""
    hits: Hits
    """The hits of all rays."""
    shape: tuple[int, ...]
    """The shape of the batch of rays."""

    def __init__(self, offsets: NDArray[np.int64], hits: Hits, shape: tuple[int, ...]) -> None:
        self.offsets = offsets
        self.hits = hits
        self.shape = shape

    @property
    def counts(self) -> NDArray[np.int64]:
        """How many hits each ray has, in the shape of the rays."""
        return np.diff(self.offsets).reshape(self.shape)

    @property
    def ray_id(self) -> NDArray[np.int64]:
        """The ray of each hit, counted in C order."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))

    def __len__(self) -> int:
        if not self.shape:
            raise TypeError("the hits of a single ray have no length; use .hits")
        return self.shape[0]

    def __getitem__(self, index: Union[SupportsIndex, tuple[SupportsIndex, ...]]) -> Hits:
        """The hits of one ray, by its index in the batch."""
        axes = index if isinstance(index, tuple) else (index,)
        if len(axes) != len(self.shape):
            raise IndexError(f"{index} does not name one ray of a batch of shape {self.shape}")
        ray = 0
        for at, length in zip(map(operator.index, axes), self.shape):
            if not -length <= at < length:
                raise IndexError(f"{index} lies outside a batch of shape {self.shape}")
            ray = ray * length + at % length
        return self.hits[self.offsets[ray] : self.offsets[ray + 1]]

    def __iter__(self) -> Iterator[Hits]:
        """The rows of all rays, in C order."""
        for begin, end in zip(self.offsets[:-1], self.offsets[1:]):
            yield self.hits[begin:end]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.offsets, self.hits, self.shape)

    def __repr__(self) -> str:
        return f"<raysheaf.HitRows of shape {self.shape}: {self.hits.size} hits>"
