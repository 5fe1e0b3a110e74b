"""`Scene`: triangles that may move between any two batches of rays."""

from __future__ import annotations

from typing import Any, Literal, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._device import Device, device_array, is_cuda, require_cuda, room_there
from ._hits import HIT_DTYPE, HitRows, Hits
from ._rays import RayBatch, batch_of

ALL = 0xFFFFFFFF
_MOST_THREADS = 1024

Method = Literal["dual", "brute"]


def _wish(mask: int, method: str, check: bool, statistics: Optional[dict[str, Any]]) -> _core.Wish:
    if method not in ("dual", "brute"):
        raise ValueError(f'method: {method!r} is given; "dual" or "brute" is expected')
    if statistics is not None and not isinstance(statistics, dict):
        raise TypeError(f"statistics: {type(statistics).__name__} is given; a dict is expected")
    return _core.Wish(_arrays.integer(mask, "mask"), method == "brute", bool(check), statistics)


class Scene:
    """Meshes of triangles, placed in the world by instances, and the queries that rays ask of them.

    Changes show at the next query: it commits them. `commit` does it at a time that you choose.

    Nothing is ever wrong for a while: a query sees all changes that were made before it began. Any
    number of Python threads may use one scene. Queries and changes run without the interpreter's
    lock; a change waits until running queries are done, and queries wait for changes.

    Arrays are copied into the scene: what happens to yours afterwards does not matter to it.
    Vertices and rays are float32 inside; float64 is rounded to it. Lengths are in any unit.

    Parameters
    ----------
    threads : int
        How many threads queries use; 0 takes all cores that the process may use. 1024 at most.
    device : "cpu" or "cuda"
        Where rays meet triangles. On "cuda" rays and results may lie in the device's memory, as
        arrays of CuPy, PyTorch, Numba or JAX. Raises `UnsupportedError` where this build or this
        machine has none.

    Examples
    --------
    >>> import numpy as np, raysheaf
    >>> scene = raysheaf.Scene()
    >>> triangle = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1]], np.float32)
    >>> mesh = scene.add(triangle, [[0, 1, 2]])
    >>> scene.closest_hit([0.25, 0.25, 0], [0, 0, 1]).t
    array(1., dtype=float32)
    >>> for frame in range(3):
    ...     triangle[:, 2] += 1
    ...     scene.update(mesh, triangle)
    ...     print(scene.closest_hit([0.25, 0.25, 0], [0, 0, 1]).t)
    2.0
    3.0
    4.0
    """

    def __init__(self, *, threads: int = 0, device: Device = "cpu") -> None:
        self._core = _core.Scene(
            _arrays.integer(threads, "threads", _MOST_THREADS), is_cuda(device)
        )

    # What is in it.

    def add(
        self,
        vertices: ArrayLike,
        triangles: Optional[ArrayLike] = None,
        *,
        transform: Optional[ArrayLike] = None,
        mask: int = ALL,
        place: bool = True,
    ) -> int:
        """Add a mesh, and a first instance of it.

        Parameters
        ----------
        vertices : (n, 3) array of real numbers
            Finite, no farther out than 1e18. Without `triangles` each three in a row are one; then
            shape (m, 3, 3) will do as well.
        triangles : (m, 3) array of integers, optional
            Indices into `vertices`. Triangles without area are legal; nothing hits them.
        transform : (3, 4) or (4, 4) array, optional
            From the mesh's space to the world, for column vectors; the identity by default.
        mask : int
            The instance is seen by queries where ``mask & query mask`` is not 0.
        place : bool
            False: no instance yet; see `instance`.

        Returns
        -------
        int
            The mesh's id, which hits show as `geom_id`. The first is 0; none is used again.

        Raises
        ------
        InvalidError
            That names the first vertex, index or transform which is wrong. It is a `ValueError`.
        TypeError, ValueError
            For arrays of a wrong dtype or shape.
        """
        soup = triangles is None
        return self._core.add(
            _arrays.vertices(vertices, soup=soup),
            _arrays.triangles(triangles),
            bool(place),
            _arrays.transform(transform),
            _arrays.integer(mask, "mask"),
        )

    def replace(
        self, mesh: int, vertices: ArrayLike, triangles: Optional[ArrayLike] = None
    ) -> None:
        """Other vertices and other triangles, any number of them; id and instances stay.

        Raises as `add` does, and `NotFoundError` (a `LookupError`) for a mesh that is not there.
        """
        self._core.replace(
            _arrays.integer(mesh, "mesh"),
            _arrays.vertices(vertices, soup=triangles is None),
            _arrays.triangles(triangles),
        )

    def update(self, mesh: int, vertices: ArrayLike) -> None:
        """Move the vertices; the triangles stay. Made to be called in every frame.

        Parameters
        ----------
        mesh : int
            As `add` returned it.
        vertices : (n, 3) array of real numbers
            As many as the mesh has.

        Raises
        ------
        InvalidError
            For another number of vertices, or one that is not finite.
        NotFoundError
            For a mesh that is not there.
        """
        self._core.update(_arrays.integer(mesh, "mesh"), _arrays.vertices(vertices, soup=True))

    def remove(self, mesh: int) -> None:
        """Take the mesh and all its instances away. Raises `NotFoundError` where it is not there."""
        self._core.remove(_arrays.integer(mesh, "mesh"))

    def instance(self, mesh: int, transform: Optional[ArrayLike] = None, *, mask: int = ALL) -> int:
        """Place the mesh once more; returns the instance's id, which hits show as `inst_id`.

        Ids of instances count over all meshes of the scene. Raises `NotFoundError` for the mesh and
        `InvalidError` for a transform that is not finite.
        """
        return self._core.instance(
            _arrays.integer(mesh, "mesh"),
            _arrays.transform(transform),
            _arrays.integer(mask, "mask"),
        )

    def remove_instance(self, instance: int) -> None:
        """Take the instance away; its mesh stays."""
        self._core.remove_instance(_arrays.integer(instance, "instance"))

    def set_transform(self, instance: int, transform: Optional[ArrayLike]) -> None:
        """Move an instance: a (3, 4) or (4, 4) matrix from the mesh's space to the world."""
        self._core.set_transform(
            _arrays.integer(instance, "instance"), _arrays.transform(transform)
        )

    def set_mask(self, instance: int, mask: int) -> None:
        """Which queries see the instance: those where ``mask & query mask`` is not 0."""
        self._core.set_mask(_arrays.integer(instance, "instance"), _arrays.integer(mask, "mask"))

    def commit(self) -> None:
        """Make changes visible now, rather than at the next query.

        Raises `InvalidError` where a transform puts a vertex farther out than 1e18. The changes
        then wait for another commit, after the transform was set right.
        """
        self._core.commit()

    # Looking at it.

    @property
    def committed(self) -> bool:
        """Whether there is nothing for `commit` to do."""
        return self._core.is_committed()

    @property
    def threads(self) -> int:
        """How many threads queries use."""
        return self._core.threads()

    @property
    def device(self) -> Device:
        """Where rays meet triangles."""
        return "cuda" if self._core.is_on_cuda() else "cpu"

    @property
    def meshes(self) -> list[int]:
        """The ids of all meshes, ascending."""
        return self._core.meshes()

    def instances(self, mesh: int) -> list[int]:
        """The ids of the mesh's instances, ascending."""
        return self._core.instances(_arrays.integer(mesh, "mesh"))

    def mesh_of(self, instance: int) -> int:
        """The mesh that the instance places."""
        return self._core.mesh_of(_arrays.integer(instance, "instance"))

    def transform(self, instance: int) -> NDArray[np.float32]:
        """The instance's matrix, (3, 4)."""
        return self._core.transform(_arrays.integer(instance, "instance"))

    def mask(self, instance: int) -> int:
        """The instance's mask."""
        return self._core.mask(_arrays.integer(instance, "instance"))

    def vertex_count(self, mesh: int) -> int:
        """How many vertices the mesh has."""
        return self._core.vertex_count(_arrays.integer(mesh, "mesh"))

    def triangle_count(self, mesh: Optional[int] = None) -> int:
        """How many triangles the mesh has; without one, all instances together."""
        if mesh is None:
            return self._core.total_triangle_count()
        return self._core.triangle_count(_arrays.integer(mesh, "mesh"))

    @property
    def bounds(self) -> Optional[NDArray[np.float32]]:
        """The box of all instances' triangles, (2, 3): least and largest; None where there are none."""
        box = np.array(self._core.bounds(), np.float32)
        return box if (box[0] <= box[1]).all() else None

    @property
    def memory_bytes(self) -> int:
        """Arrays, hierarchies, and the room that queries keep for the next one."""
        return self._core.memory_bytes()

    def __contains__(self, mesh: object) -> bool:
        return self._core.contains(_arrays.integer(mesh, "mesh"))

    def __repr__(self) -> str:
        return (
            f"<raysheaf.Scene: {len(self.meshes)} meshes, {self._core.instance_count()} instances, "
            f"{self.triangle_count()} triangles>"
        )

    # Queries.

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: int = ALL,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> Hits:
        """The first thing that each ray meets.

        Ask many rays at once: one call with 100 000 of them is far faster than 100 000 calls.

        Parameters
        ----------
        origins : (..., 3) array of real numbers
            Or the whole rays, (..., 8), without `directions`: origin, t_min, direction, t_max. Those
            are read where they lie if they are float32 in C order; with ``device="cuda"`` that may
            be in the device's memory.
        directions : (..., 3) array of real numbers
            Need not be unit vectors. Broadcast with `origins`, `t_min` and `t_max`.
        t_min, t_max : arrays of shape (...), optional
            Hits lie in [t_min, t_max], in lengths of the direction; 0 and inf by default.
        mask : int
            Instances are seen where ``their mask & mask`` is not 0.
        method : "dual" or "brute"
            "brute" looks at every triangle for every ray, to check against; the answers are the
            same, bit for bit.
        check : bool
            False: the rays are known to be right. A wrong one then makes all results unspecified.
        statistics : dict, optional
            Filled with what the query did: counts, times in milliseconds, and the plan.
        out : Hits, or an array on a CUDA device, optional
            Of the rays' shape, in C order: written and returned, so that no memory is taken. On a
            device it has a last axis of 6 besides, and dtype float32: t, u, v, and the bits of
            prim_id, geom_id and inst_id.

        Returns
        -------
        Hits
            Of the rays' shape. A miss has t = inf and ids `INVALID_ID`. Where hits are equally far,
            that of the least (geom_id, inst_id, prim_id) counts. Both sides of triangles are met,
            and no ray slips through an edge that two triangles share.

        Raises
        ------
        InvalidError
            That names the first ray which is wrong: not finite, without direction, t_min negative
            or larger than t_max. It is a `ValueError`.
        TypeError, ValueError
            For arrays of a wrong dtype or of shapes that do not broadcast.

        Examples
        --------
        >>> import numpy as np, raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 5], [4, 0, 5], [0, 4, 5]], [[0, 1, 2]])
        >>> x, y = np.meshgrid([1.0, 2.0], [0.5, 1.0, 3.0])
        >>> origins = np.stack([x, y, np.zeros_like(x)], axis=-1)
        >>> scene.closest_hit(origins, [0, 0, 2]).t
        array([[2.5, 2.5],
               [2.5, 2.5],
               [2.5, inf]], dtype=float32)
        """
        batch = batch_of(self._core.context(), origins, directions, t_min, t_max)
        there = device_array(out, "out")
        require_cuda(self._core, batch.rays, there)
        room: Union[NDArray[np.float32], _core.Place]
        if there is not None:
            room = room_there(there, batch.shape + (6,), ("float32",)).place((6,))
        else:
            if out is None:
                out = Hits.empty(batch.shape)
            else:
                _check_out(out, batch)
            room = out.array.reshape(-1).view(np.float32).reshape(-1, 6)
        with batch.named():
            self._core.closest_hit(batch.asked, room, _wish(mask, method, check, statistics))
        given: Hits = out
        return given

    def any_hit(
        self,
        origins: ArrayLike,
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: int = ALL,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray meets anything: for shadows and visibility, faster than `closest_hit`.

        Parameters and exceptions are those of `closest_hit`. Returns booleans of the rays' shape:
        an array of numpy, or `out`, an array of dtype bool or uint8 on a CUDA device.

        From one point to another: ``scene.any_hit(a, b - a, t_max=1)``.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> scene.any_hit([0.25, 0.25, 0], [[0, 0, 1], [0, 0, -1]])
        array([ True, False])
        """
        batch = batch_of(self._core.context(), origins, directions, t_min, t_max)
        occluded = np.empty(batch.count if out is None else 0, np.uint8)
        room = _room(self._core, batch, out, occluded, ("bool", "uint8"))
        with batch.named():
            self._core.any_hit(batch.asked, room, _wish(mask, method, check, statistics))
        given: NDArray[np.bool_] = out
        return occluded.view(np.bool_).reshape(batch.shape) if out is None else given

    def all_hits(
        self,
        origins: ArrayLike,
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: int = ALL,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
    ) -> HitRows:
        """Everything that each ray meets, from near to far.

        Parameters and exceptions are those of `closest_hit`. A ray through an edge or a vertex
        meets all triangles that share it. The memory of rows that are gone is kept for the next
        ones until a scene goes.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> copy = scene.instance(mesh, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3]])
        >>> rows = scene.all_hits([0.25, 0.25, 0], [[0, 0, 1], [0, 0, -1]])
        >>> [row.t.tolist() for row in rows]
        [[1.0, 4.0], []]
        """
        batch = batch_of(self._core.context(), origins, directions, t_min, t_max)
        require_cuda(self._core, batch.rays)
        with batch.named():
            offsets, hits = self._core.all_hits(batch.asked, _wish(mask, method, check, statistics))
        return HitRows(
            offsets.view(np.int64), Hits(hits.view(HIT_DTYPE).reshape(len(hits))), batch.shape
        )

    def hit_counts(
        self,
        origins: ArrayLike,
        directions: Optional[ArrayLike] = None,
        *,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        mask: int = ALL,
        method: Method = "dual",
        check: bool = True,
        statistics: Optional[dict[str, Any]] = None,
        out: Any = None,
    ) -> NDArray[np.uint32]:
        """How many triangles each ray meets: the lengths of the rows of `all_hits`.

        Parameters and exceptions are those of `closest_hit`. Returns uint32 of the rays' shape: an
        array of numpy, or `out`, an array of dtype uint32 or int32 on a CUDA device.
        """
        batch = batch_of(self._core.context(), origins, directions, t_min, t_max)
        counts = np.empty(batch.count if out is None else 0, np.uint32)
        room = _room(self._core, batch, out, counts, ("uint32", "int32"))
        with batch.named():
            self._core.hit_counts(batch.asked, room, _wish(mask, method, check, statistics))
        given: NDArray[np.uint32] = out
        return counts.reshape(batch.shape) if out is None else given


def _room(
    scene: _core.Scene, batch: RayBatch, out: Any, own: NDArray[Any], dtypes: tuple[str, ...]
) -> Any:
    """Where a number a ray goes: `own`, or `out`, which lies on a device."""
    there = device_array(out, "out")
    require_cuda(scene, batch.rays, there)
    if there is not None:
        return room_there(there, batch.shape, dtypes).place(())
    if out is not None:
        raise TypeError(
            f"out: {type(out).__name__} is given; an array on a CUDA device, or None, is expected"
        )
    return own


def _check_out(out: Any, batch: RayBatch) -> None:
    if not isinstance(out, Hits):
        raise TypeError(f"out: {type(out).__name__} is given; Hits is expected")
    flags = out.array.flags
    if out.shape != batch.shape or not flags.c_contiguous or not flags.writeable:
        raise ValueError(
            f"out: {'writable' if flags.writeable else 'read-only'} Hits of shape {out.shape} "
            f"{'in C order' if flags.c_contiguous else 'not in C order'} are given; "
            f"writable ones of shape {batch.shape} in C order are expected"
        )
