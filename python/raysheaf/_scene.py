"""`Scene`: triangles that may move between any two batches of rays."""

from __future__ import annotations

import dataclasses
import operator
import os
from typing import Any, Optional, Protocol, SupportsIndex, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._device import Device, is_cuda
from ._errors import Error
from ._look import Material, Surface, per_vertex, surface_of
from ._point_queries import PointQueries
from ._queries import ALL, ALL_WORLDS, Queries

_MOST_THREADS = 1024


class MeshLike(Protocol):
    """A mesh of triangles."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


def _mesh(vertices: Any, triangles: Any) -> tuple[NDArray[np.float32], Optional[NDArray[np.uint32]]]:
    """The arrays of a mesh, given as two or as one object."""
    if isinstance(vertices, (str, bytes, os.PathLike)):
        raise TypeError(
            f"vertices: {vertices!r} is given; an array is expected, and raysheaf.load reads files"
        )
    if triangles is None and hasattr(vertices, "vertices") and hasattr(vertices, "faces"):
        return (
            _arrays.vertices(vertices.vertices, "vertices.vertices"),
            _arrays.triangles(vertices.faces, "vertices.faces"),
        )
    return _arrays.vertices(vertices, soup=triangles is None), _arrays.triangles(triangles)


class Scene(Queries, PointQueries):
    """Meshes of triangles, placed in the world by instances, and queries of rays and points on them.

    A query sees all changes that were made before it began: the first query after a change commits
    it. Call `commit` to choose that moment yourself.

    Any number of Python threads may use one scene. Queries and changes release the interpreter's
    lock; a change waits for running queries, and queries wait for changes.

    The scene copies arrays, so later changes of your arrays do not affect it. Vertices and rays are
    float32 inside; float64 is rounded. Lengths are in any unit.

    Parameters
    ----------
    threads : int
        Number of threads of queries, at most 1024; 0 uses all cores that the process may use.
    device : "cpu" or "cuda"
        Where queries run. On "cuda" rays and results may reside in the device's memory, as arrays
        of CuPy, PyTorch, Numba or JAX. Raises `UnsupportedError` if this build or this machine has
        no CUDA device.

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

    def __init__(self, *, threads: SupportsIndex = 0, device: Device = "cpu") -> None:
        number = _arrays.integer(threads, "threads", _MOST_THREADS)
        self._core = _core.Scene(number, is_cuda(device))
        self._begin(number)

    # Changes.

    def add(
        self,
        vertices: Union[ArrayLike, MeshLike],
        triangles: Optional[ArrayLike] = None,
        *,
        transform: Optional[ArrayLike] = None,
        mask: SupportsIndex = ALL,
        world: SupportsIndex = ALL_WORLDS,
        place: bool = True,
        normals: Optional[ArrayLike] = None,
        uv: Optional[ArrayLike] = None,
        colors: Optional[ArrayLike] = None,
        material: Optional[Union[Material, ArrayLike]] = None,
    ) -> int:
        """Add a mesh, and a first instance of it.

        Parameters
        ----------
        vertices : (n, 3) array of real numbers
            Finite, at most 1e18 in absolute value; vertices that no triangle uses may have any
            value. Without `triangles`, each three rows are a triangle; (m, 3, 3) is then valid too.
            Or a mesh: any object with `vertices` and `faces`, such as trimesh's.
        triangles : (m, 3) array of integers, optional
            Indices into `vertices`. Triangles without area are legal; nothing hits them.
        transform : (3, 4) or (4, 4) array, optional
            From the mesh's space to the world, for column vectors; the identity by default.
        mask : int
            A query sees the instance if ``mask & query mask`` is not 0.
        world : int
            The world that the instance is in; `ALL_WORLDS`: in all of them. See `instances`.
        place : bool
            False adds no instance yet; see `instance`.
        normals, uv, colors : (n, 3), (n, 2), (n, 3) arrays of real numbers, optional
            A normal, texture coordinates and a linear colour for each vertex: `Hits` interpolates
            the first two, `render` shows all of them.
        material : Material, or integers, optional
            What `render` shows: a `Material`, which is appended to `materials`, or an index into
            `materials` for the mesh, or for each triangle.

        Returns
        -------
        int
            The mesh's id, the `geom_id` of hits. The first is 0; ids are never reused.

        Raises
        ------
        InvalidError
            Names the first vertex, index or transform that is invalid. It is a `ValueError`.
        TypeError, ValueError
            For arrays of a wrong dtype or shape.
        """
        corners, faces = _mesh(vertices, triangles)
        matrix, bits = _arrays.transform(transform), _arrays.integer(mask, "mask")
        surface = self._surface(corners, faces, normals, uv, colors, material)
        number = _arrays.integer(world, "world")
        mesh = self._core.add(corners, faces, bool(place), matrix, bits, number)
        if surface is not None:
            self._surfaces[mesh] = surface
        return mesh

    def _surface(
        self,
        corners: NDArray[np.float32],
        faces: Optional[NDArray[np.uint32]],
        normals: Optional[ArrayLike],
        uv: Optional[ArrayLike],
        colors: Optional[ArrayLike],
        material: Any,
    ) -> Optional[Surface]:
        if normals is None and uv is None and colors is None and material is None:
            return None
        count = len(corners) // 3 if faces is None else len(faces)
        materials = self._add_material(material, count)
        return surface_of(len(corners), count, normals, uv, colors, materials)

    def replace(
        self,
        mesh: SupportsIndex,
        vertices: Union[ArrayLike, MeshLike],
        triangles: Optional[ArrayLike] = None,
        *,
        normals: Optional[ArrayLike] = None,
        uv: Optional[ArrayLike] = None,
        colors: Optional[ArrayLike] = None,
        material: Optional[Union[Material, ArrayLike]] = None,
    ) -> None:
        """Give the mesh other vertices and triangles, any number; it keeps its id and instances.

        Its vertex normals, texture coordinates and colours are removed, unless you give others; a
        single material stays.
        Raises as `add` does, and `NotFoundError` (a `LookupError`) for a mesh that does not exist.
        """
        number = _arrays.integer(mesh, "mesh")
        corners, faces = _mesh(vertices, triangles)
        before = self._surfaces.get(number, Surface())
        if material is None and before.materials is not None and len(before.materials) == 1:
            material = before.materials
        surface = self._surface(corners, faces, normals, uv, colors, material)
        self._core.replace(number, corners, faces)
        if surface is not None:
            self._surfaces[number] = dataclasses.replace(surface, name=before.name)
        else:
            self._surfaces.pop(number, None)

    def update(
        self,
        mesh: SupportsIndex,
        vertices: ArrayLike,
        end: Optional[ArrayLike] = None,
        *,
        normals: Optional[ArrayLike] = None,
    ) -> None:
        """Move the vertices; the triangles stay. Call it in every frame.

        Parameters
        ----------
        mesh : int
            The id that `add` returned.
        vertices : (n, 3) array of real numbers
            The same number of vertices as the mesh has. With one axis more, (times, n, 3), they
            move while rays are cast: from the first, at time 0, to the last, at 1, at equal
            distances of time, along straight lines in between. Queries with `times` meet the
            vertices of then, all others those at time 0.
        end : (n, 3) array of real numbers, optional
            Those at time 1, where `vertices` are those at time 0.
        normals : (n, 3) array of real numbers, optional
            Their normals now. Without them the mesh has no vertex normals from now on, for those
            that it had are those of another shape. Vertices at several times have none.

        Raises
        ------
        InvalidError
            For a different number of vertices, or a triangle's vertex that is not finite.
        NotFoundError
            For a mesh that does not exist.

        Examples
        --------
        A sheet rises, and three rays see it at three times:

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> sheet = [[0, 0, 0], [9, 0, 0], [0, 9, 0]]
        >>> mesh = scene.add(sheet, [[0, 1, 2]])
        >>> scene.update(mesh, sheet, end=[[0, 0, 4], [9, 0, 4], [0, 9, 4]])
        >>> scene.closest_hit([[1, 1, 9]] * 3, [0, 0, -1], times=[0, 0.25, 1]).t
        array([9., 8., 5.], dtype=float32)
        """
        number = _arrays.integer(mesh, "mesh")
        times = _arrays.moving_vertices(vertices, end, self._core.vertex_count(number))
        turned = per_vertex(normals, "normals", 3, times.shape[1])
        if turned is not None and len(times) > 1:
            raise ValueError(
                f"normals: they are given for vertices at {len(times)} times; vertices at one time, or "
                "no normals, are expected"
            )
        self._core.update(number, times.reshape(-1, 3), len(times))
        surface = self._surfaces.get(number, Surface())
        if turned is not None or surface.normals is not None:
            self._surfaces[number] = dataclasses.replace(surface, normals=turned)

    def remove(self, mesh: SupportsIndex) -> None:
        """Remove the mesh and all its instances. Raises `NotFoundError` if it does not exist."""
        number = _arrays.integer(mesh, "mesh")
        self._core.remove(number)
        self._surfaces.pop(number, None)

    def instance(
        self,
        mesh: SupportsIndex,
        transform: Optional[ArrayLike] = None,
        *,
        mask: SupportsIndex = ALL,
        world: SupportsIndex = ALL_WORLDS,
    ) -> int:
        """Place the mesh once more; returns the instance's id, the `inst_id` of hits.

        `instances` makes many at once, and says what worlds are. Ids of instances count over all meshes of the scene. Raises `NotFoundError` for the mesh and
        `InvalidError` for a transform that is not finite.
        """
        return self._core.instance(
            _arrays.integer(mesh, "mesh"),
            _arrays.transform(transform),
            _arrays.integer(mask, "mask"),
            _arrays.integer(world, "world"),
        )

    def remove_instance(self, instance: SupportsIndex) -> None:
        """Remove the instance; its mesh stays."""
        self._core.remove_instance(_arrays.integer(instance, "instance"))

    def set_transform(self, instance: SupportsIndex, transform: Optional[ArrayLike]) -> None:
        """Move an instance: a (3, 4) or (4, 4) matrix from the mesh's space to the world.

        Two or more of them, (times, 4, 4), let it move from time 0 to time 1, see
        `set_transforms`.
        """
        number = np.array([_arrays.integer(instance, "instance")], np.uint32)
        if np.ndim(transform) == 3:  # type: ignore[arg-type]
            matrices = _arrays.transforms(transform, name="transform")
        else:
            matrices = _arrays.transform(transform)[None]
        self._core.set_transforms(number, matrices, len(matrices))

    def set_transforms(
        self,
        instances: ArrayLike,
        transforms: ArrayLike,
        quaternions: Optional[ArrayLike] = None,
    ) -> None:
        """Move many instances, all or none.

        Parameters
        ----------
        instances : (...) integers
            Their ids, at least one axis.
        transforms : (..., 4, 4) or (..., 3, 4)
            Matrices from the meshes' spaces to the world; with `quaternions`, (..., 3): positions.
            With one axis more, (..., times, 4, 4), instances move: from the first matrix, at time
            0, to the last, at 1, at equal distances of time, entries mixed in between. Corners move
            along straight lines, so that an instance that turns needs a matrix every few degrees.
            Queries with `times` meet it where it is then, all others at time 0.
        quaternions : (..., 4), optional
            Rotations about the meshes' origins as (x, y, z, w), as scipy and glTF have them; their
            length does not matter.

        Raises `NotFoundError` for an instance, `InvalidError` for a transform that is not finite,
        and ValueError for shapes.

        Examples
        --------
        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], place=False)
        >>> links = [scene.instance(mesh) for _ in range(3)]
        >>> scene.set_transforms(links, [[0, 0, 1], [0, 0, 2], [0, 0, 3]], [[0, 0, 0, 1]] * 3)
        >>> int(scene.closest_hit([0.2, 0.2, 9], [0, 0, -1]).inst_id)
        2

        The last link falls, and three rays see it at three times:

        >>> scene.set_transforms(links[2:], [[[0, 0, 3], [0, 0, -5]]], [[[0, 0, 0, 1]] * 2])
        >>> scene.closest_hit([[0.2, 0.2, 9]] * 3, [0, 0, -1], times=[0, 0.125, 1]).t
        array([6., 7., 7.], dtype=float32)
        """
        numbers = _arrays.ids(instances, "instances")
        matrices = _arrays.transforms(transforms, quaternions)
        moves = matrices.ndim == numbers.ndim + 3 and matrices.shape[-3] > 0
        if matrices.shape[: -3 if moves else -2] != numbers.shape:
            raise ValueError(
                f"transforms: {matrices.shape[:-2]} transforms are given for instances of shape "
                f"{numbers.shape}; equal shapes, or one axis of times more, are expected"
            )
        each = matrices.shape[-3] if moves else 1
        self._core.set_transforms(numbers.reshape(-1), matrices.reshape(-1, 3, 4), each)

    def set_mask(self, instance: SupportsIndex, mask: SupportsIndex) -> None:
        """Set which queries see the instance: those with ``mask & query mask`` not 0."""
        self._core.set_mask(_arrays.integer(instance, "instance"), _arrays.integer(mask, "mask"))

    def set_world(self, instance: SupportsIndex, world: SupportsIndex) -> None:
        """Set the world that the instance is in; `ALL_WORLDS`: in all of them."""
        self._core.set_world(_arrays.integer(instance, "instance"), _arrays.integer(world, "world"))

    def commit(self) -> None:
        """Make changes visible now instead of at the next query.

        Raises `InvalidError` if a transform moves a vertex farther out than 1e18. The changes then
        wait for another commit, after you have corrected the transform.
        """
        self._core.commit()

    # Contents.

    @property
    def committed(self) -> bool:
        """Whether no changes wait for `commit`."""
        return self._core.is_committed()

    @property
    def threads(self) -> int:
        """Number of threads of queries. A scene that a child of `os.fork` makes has one."""
        return self._core.threads()

    @property
    def device(self) -> Device:
        """Where queries run: "cpu" or "cuda"."""
        return "cuda" if self._core.is_on_cuda() else "cpu"

    @property
    def meshes(self) -> list[int]:
        """The ids of all meshes, ascending."""
        return self._core.meshes()

    @overload
    def instances(self, mesh: SupportsIndex) -> list[int]: ...

    @overload
    def instances(
        self,
        mesh: SupportsIndex,
        transforms: ArrayLike,
        quaternions: Optional[ArrayLike] = None,
        *,
        worlds: Optional[ArrayLike] = None,
        mask: SupportsIndex = ALL,
    ) -> NDArray[np.uint32]: ...

    def instances(
        self,
        mesh: SupportsIndex,
        transforms: Optional[ArrayLike] = None,
        quaternions: Optional[ArrayLike] = None,
        *,
        worlds: Optional[ArrayLike] = None,
        mask: SupportsIndex = ALL,
    ) -> Union[list[int], NDArray[np.uint32]]:
        """Place the mesh once for each transform; without transforms, the ids of its instances.

        A scene may hold thousands of small ones, its worlds, which share meshes and are asked in
        one call: a ray or a point sees an instance if both are in the same world, or if one of the
        two is in `ALL_WORLDS`. Queries without `worlds` see the instances of all.

        Parameters
        ----------
        mesh : int
            The id that `add` returned.
        transforms : (..., 3, 4) or (..., 4, 4)
            Matrices from the mesh's space to the world; with `quaternions`, (..., 3): positions.
        quaternions : (..., 4), optional
            Rotations as `set_transforms` takes them.
        worlds : int, or array of integers, optional
            The world of each instance: an array whose axes are the first of the transforms', so
            that ``range(4096)`` fits transforms of shape (4096, 10, 3, 4). `ALL_WORLDS` by default.
        mask : int
            A query sees the instances if ``mask & query mask`` is not 0.

        Returns
        -------
        array of uint32
            The ids, in the shape of the transforms without their matrices. Without transforms, a
            list of the ids of all of the mesh's instances, ascending.

        Raises `NotFoundError` for the mesh, `InvalidError` for a transform that is not finite; then
        no instance is made.

        Examples
        --------
        Three worlds of two triangles each, and a ray in each world:

        >>> import numpy as np, raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], place=False)
        >>> places = np.zeros((3, 2, 3))
        >>> places[:, :, 2] = [[1, 2], [3, 4], [5, 6]]
        >>> scene.instances(mesh, places, np.broadcast_to([0, 0, 0, 1], (3, 2, 4)), worlds=range(3))
        array([[0, 1],
               [2, 3],
               [4, 5]], dtype=uint32)
        >>> scene.closest_hit([[0.2, 0.2, 9]] * 3, [0, 0, -1], worlds=range(3)).inst_id
        array([1, 3, 5], dtype=uint32)
        """
        number = _arrays.integer(mesh, "mesh")
        if transforms is None:
            return self._core.instances(number)
        matrices = _arrays.transforms(transforms, quaternions)
        shape = matrices.shape[:-2]
        homes = None if worlds is None else _arrays.leading(worlds, "worlds", shape)
        rows, bits = matrices.reshape(-1, 3, 4), _arrays.integer(mask, "mask")
        first = self._core.make_instances(number, rows, homes, bits)
        return np.arange(first, first + len(rows), dtype=np.uint32).reshape(shape)

    def mesh_of(self, instance: SupportsIndex) -> int:
        """The mesh that the instance places."""
        return self._core.mesh_of(_arrays.integer(instance, "instance"))

    def transform(self, instance: SupportsIndex) -> NDArray[np.float32]:
        """The instance's matrix, (3, 4); at time 0 if it moves."""
        first: NDArray[np.float32] = self.transforms(instance)[0]
        return first

    def transforms(self, instance: SupportsIndex) -> NDArray[np.float32]:
        """The instance's matrices, (times, 3, 4); one if it does not move."""
        return self._core.transforms(_arrays.integer(instance, "instance"))

    def mask(self, instance: SupportsIndex) -> int:
        """The instance's mask."""
        return self._core.mask(_arrays.integer(instance, "instance"))

    def world(self, instance: SupportsIndex) -> int:
        """The world that the instance is in; `ALL_WORLDS`: in all of them."""
        return self._core.world(_arrays.integer(instance, "instance"))

    def vertex_count(self, mesh: SupportsIndex) -> int:
        """Number of vertices of the mesh."""
        return self._core.vertex_count(_arrays.integer(mesh, "mesh"))

    def triangle_count(self, mesh: Optional[SupportsIndex] = None) -> int:
        """Number of triangles of the mesh; without `mesh`, of all instances together."""
        if mesh is None:
            return self._core.total_triangle_count()
        return self._core.triangle_count(_arrays.integer(mesh, "mesh"))

    @property
    def bounds(self) -> Optional[NDArray[np.float32]]:
        """The box of all instances' triangles, (2, 3): minimum, maximum; None without triangles."""
        box = np.array(self._core.bounds(), np.float32)
        return box if (box[0] <= box[1]).all() else None

    @property
    def memory_bytes(self) -> int:
        """Bytes of arrays, hierarchies, and memory that is kept for the next query."""
        return self._core.memory_bytes()

    def __contains__(self, mesh: object) -> bool:
        try:
            number = operator.index(mesh)  # type: ignore[arg-type]
        except TypeError:
            return False
        return 0 <= number <= ALL and self._core.has_mesh(number)

    def __repr__(self) -> str:
        counts = (
            f"{len(self.meshes)} meshes, {self._core.instance_count()} instances, "
            f"{self.triangle_count()} triangles"
        )
        try:
            bounds = self.bounds
        except Error as error:  # a change that cannot be committed
            return f"<raysheaf.Scene: {counts}; {error}>"
        if bounds is None:
            return f"<raysheaf.Scene: {counts}>"
        least, most = (", ".join(f"{x:.4g}" for x in corner) for corner in bounds.tolist())
        return f"<raysheaf.Scene: {counts}, from ({least}) to ({most})>"
