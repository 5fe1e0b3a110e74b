"""The results of queries."""

from __future__ import annotations

import operator
from typing import Any, Iterator, Mapping, Optional, SupportsIndex, Union, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._asked import Asked, Points

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


class Records:
    """Results of rays or points: one structured array, whose fields are attributes."""

    __slots__ = ("array",)

    array: NDArray[np.void]

    @property
    def prim_id(self) -> NDArray[np.uint32]:
        """The triangle within its mesh; without one, all three ids are `INVALID_ID`."""
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
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    @property
    def size(self) -> int:
        return self.array.size

    def __len__(self) -> int:
        return len(self.array)

    def __array__(self, dtype: Any = None, copy: Any = None) -> NDArray[Any]:
        return np.array(self.array, dtype) if copy else np.asarray(self.array, dtype)

    def _any(self) -> NDArray[np.bool_]:
        return cast(NDArray[np.bool_], self.array["prim_id"] != INVALID_ID)


class Hits(Records):
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

    Hits that a query returned also have `position`, `normal`, `front`, `uv` and `interpolate`. These
    are computed from the scene when you access them, and raise an `Error` if it has changed since
    the query. For `front` and `side` the query copies the directions, 12 bytes for each ray.

    >>> hits.position[0], hits.normal[0], bool(hits.front[0])
    (array([0.25, 0.5 , 1.  ], dtype=float32), array([0., 0., 1.], dtype=float32), False)
    """

    __slots__ = ("_asked",)

    array: NDArray[np.void]
    """The hits themselves, of dtype `HIT_DTYPE`."""
    _asked: Optional[Asked]

    def __init__(self, array: NDArray[np.void], _asked: Optional[Asked] = None) -> None:
        if isinstance(array, np.void) and array.dtype == HIT_DTYPE:
            array = np.asarray(array)
        if not isinstance(array, np.ndarray):
            raise TypeError(
                f"array: {type(array).__name__} is given; an array of dtype HIT_DTYPE is expected"
            )
        if array.dtype != HIT_DTYPE:
            raise TypeError(f"array: dtype {array.dtype} is given; HIT_DTYPE is expected")
        self.array = array
        self._asked = _asked

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
    def hit(self) -> NDArray[np.bool_]:
        """Whether the ray hits anything."""
        return self._any()

    @property
    def position(self) -> NDArray[np.float32]:
        """(..., 3), where the rays hit, in the world; NaN for a miss, also for all below.

        It is computed from the triangle's corners by `u` and `v`, and so lies nearer to the
        triangle than ``origins + t * directions``.
        """
        return Points(self.array, self._asked).position()

    @property
    def normal(self) -> NDArray[np.float32]:
        """(..., 3), unit normals in the world, on the front of the surface.

        They are interpolated where the mesh has vertex normals, as those of files; elsewhere they
        are square to the triangle. ``hits.normal * hits.side[..., None]`` faces the ray.
        """
        return Points(self.array, self._asked).normal()

    @property
    def geometric_normal(self) -> NDArray[np.float32]:
        """(..., 3), unit normals in the world, square to the triangle, on its front."""
        return Points(self.array, self._asked).geometric_normal()

    @property
    def front(self) -> NDArray[np.bool_]:
        """Whether the ray comes from the front; False for a miss.

        The front is the side from which the corners run counter-clockwise in the mesh's own space;
        a transform that mirrors does not turn a mesh inside out. The answer is exact.
        """
        return Points(self.array, self._asked).front()

    @property
    def side(self) -> NDArray[np.int8]:
        """1 where the ray comes from the front, -1 where it comes from the back, 0 for a miss."""
        hit, front = self.hit, self.front
        return np.where(front, 1, np.where(hit, -1, 0)).astype(np.int8)

    @property
    def uv(self) -> NDArray[np.float32]:
        """(..., 2), texture coordinates, of meshes that have them; `u` and `v` are weights."""
        return Points(self.array, self._asked).uv()

    @property
    def material_id(self) -> NDArray[np.uint32]:
        """The index into `Scene.materials`; `INVALID_ID` for a mesh without a material."""
        return Points(self.array, self._asked).material_id()

    def interpolate(self, values: Union[ArrayLike, Mapping[int, ArrayLike]]) -> NDArray[Any]:
        """Values of vertices where the rays hit: colours, temperatures, anything.

        Parameters
        ----------
        values : (n, ...) array of real numbers, or a dict of them
            A row for each vertex of the mesh; where the hits are of several meshes, such an array
            for each of them, by id. Hits of other meshes are NaN.

        Returns
        -------
        array
            Of the hits' shape and a row's: float32, or float64 where the values are not float32.

        Examples
        --------
        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> hits = scene.closest_hit([[0.25, 0.5, 0], [9, 9, 0]], [0, 0, 1])
        >>> hits.interpolate([10.0, 20.0, 30.0])
        array([22.5,  nan])
        """
        return Points(self.array, self._asked).interpolate(values)

    def start(self, directions: ArrayLike) -> NDArray[np.float32]:
        """(..., 3), origins for rays that leave the surface along `directions`.

        They are the positions, moved to the side that the ray leaves to by as much as rounding
        asks for, so that the ray does not meet the triangle again that it starts from. A miss has
        none: take ``hits[hits.hit]``.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> hits = scene.closest_hit([0.3, 0.2, 0], [0.1, 0.05, 1])
        >>> bool(scene.any_hit(hits.start([0, 0, -1]), [0, 0, -1]))
        False
        """
        return Points(self.array, self._asked).start(directions)

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
        if found.dtype != HIT_DTYPE:
            return found
        return Hits(np.asarray(found), None if self._asked is None else self._asked.at(index))

    def __iter__(self) -> Iterator[Hits]:
        if not self.array.ndim:
            raise TypeError("the hit of a single ray has no items")
        return (self[i] for i in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        # Without the scene, which may be large.
        return type(self), (self.array,), getattr(self, "__dict__", None)

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
