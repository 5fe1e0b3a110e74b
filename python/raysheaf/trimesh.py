"""Queries for trimesh: ``mesh.ray = raysheaf.trimesh.RayMeshIntersector(mesh)`` answers rays,
``mesh.nearest = raysheaf.trimesh.ProximityQuery(mesh)`` points.

>>> import trimesh
>>> from raysheaf.trimesh import RayMeshIntersector
>>> mesh = trimesh.creation.box()
>>> mesh.ray = RayMeshIntersector(mesh)
>>> locations, index_ray, index_tri = mesh.ray.intersects_location([[0.1, 0.2, -2]], [[0, 0, 1]])
>>> locations.tolist()
[[0.1, 0.2, -0.5], [0.1, 0.2, 0.5]]
>>> _ = mesh.apply_translation([0, 0, 9])
>>> locations, index_ray, index_tri = mesh.ray.intersects_location([[0.1, 0.2, -2]], [[0, 0, 1]])
>>> locations.tolist()
[[0.1, 0.2, 8.5], [0.1, 0.2, 9.5]]
>>> from raysheaf.trimesh import ProximityQuery
>>> mesh.nearest = ProximityQuery(mesh)
>>> mesh.nearest.signed_distance([[0.1, 0.2, 9], [0.1, 0.2, 7]])
array([ 0.3, -1.5])
"""

from __future__ import annotations

import operator
import os
import threading
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, Literal, Optional, SupportsIndex, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh.constants import tol
from trimesh.ray.ray_util import contains_points

from . import _arrays, _core
from ._device import Device
from ._hits import INVALID_ID, Hits
from ._mesh_space import Floats, Followed, Ints, followed, hand_over
from ._scene import Scene

# If two hits of one ray on faces that share a corner are closer than this fraction of the mesh's
# size, they count as one: a ray through an edge hits both triangles there.
_SAME_PLACE = 1e-6
# Rays with origins farther away than this multiple of the mesh's size start nearer, so that float32
# keeps its digits for the mesh.
_FAR = 4.0
# Directions with lengths in this range keep their digits in float32.
_SHORT, _LONG = 1e-15, 1e15
_MOST_HITS = 2**62
# Attributes that each intersector creates itself.
_NOT_COPIED = ("_scene", "_followed", "_lock", "_process")
_Own = TypeVar("_Own", bound="RayMeshIntersector")


def _most(max_hits: Optional[SupportsIndex]) -> Optional[int]:
    """How many hits a ray may have; negative numbers mean none, as in trimesh's other back end."""
    if max_hits is None:
        return None
    try:
        return max(0, min(operator.index(max_hits), _MOST_HITS))
    except TypeError:
        raise TypeError(
            f"max_hits: {max_hits!r} is given; an integer or None is expected"
        ) from None


def _points(points: ArrayLike) -> Floats:
    places = _arrays.doubles(points, "points")
    if places.shape == (0,):
        places = places.reshape(0, 3)
    if places.ndim != 2 or places.shape[1] != 3:
        raise ValueError(f"points {places.shape}: an array of shape (n, 3) is expected")
    return places


@dataclass(frozen=True)
class _Batch:
    """Rays in the mesh's space; and, in the scene's space, those that the scene can answer."""

    origins: Floats
    directions: Floats  # of any length
    rays: NDArray[np.float32]  # (n, 8), packed
    asked: Optional[Ints]  # the indices of the rays to query; None: all


class RayMeshIntersector:
    """The interface of `trimesh.ray.ray_pyembree.RayMeshIntersector`, implemented by raysheaf.

    Rays hit both sides of faces. A ray that hits several faces at one point, an edge or a vertex,
    reports one of them: hits on faces that share a corner count as one if they are closer than a
    millionth of the diagonal of the mesh's box. Results are sorted by ray, then from near to far, and locations are
    computed in float64. Directions need not be unit vectors; rays that are not finite, or whose
    direction is zero, hit nothing, and faces with a vertex that is not finite are never hit.

    Parameters
    ----------
    geometry : trimesh.Trimesh
        The mesh. It may change: the next query notices, and if the faces are the same it updates
        only the vertices.
    scale_to_box : bool
        Query relative to the mesh's centre and at a size of about 1, which gives float32 its best
        precision wherever the mesh is. False: in the mesh's own coordinates.
    threads : int
        Number of threads of queries; 0 uses all cores.
    device : "cpu" or "cuda"
        Where queries run; arrays are numpy's on both.
    """

    def __init__(
        self,
        geometry: Any,
        scale_to_box: bool = True,
        *,
        threads: SupportsIndex = 0,
        device: Device = "cpu",
    ) -> None:
        # In trimesh 5, a primitive creates its engine before it has data, so properties of its
        # class must not be evaluated.
        if not all(hasattr(type(geometry), n) or hasattr(geometry, n) for n in ("vertices", "faces")):
            raise TypeError(
                f"geometry: {type(geometry).__name__} is given; a trimesh.Trimesh is expected"
            )
        self.mesh = geometry
        self._scale_to_box = bool(scale_to_box)
        self._threads = threads
        self._device: Device = device
        self._begin()

    def _begin(self) -> None:
        self._scene = Scene(threads=self._threads, device=self._device)
        self._followed: Optional[Followed] = None
        self._lock = threading.RLock()  # signal handlers may query during a query
        self._process = os.getpid()


    def _follow(self) -> Followed:
        if self._process != os.getpid():  # after fork, the child has none of the scene's threads
            self._begin()
        with self._lock:
            now, old = hash(self.mesh), self._followed
            if old is not None and now == old.hash:
                return old
            vertices = np.array(self.mesh.vertices, np.float64).reshape(-1, 3)
            faces = np.array(self.mesh.faces, np.int64).reshape(-1, 3)
            new = followed(now, vertices, faces, self._scale_to_box, old)
            # A signal handler may have queried meanwhile. Until the scene has the mesh, its state
            # is unknown: if an exception ends this, the next query starts from scratch.
            old, self._followed = self._followed, None
            hand_over(self._scene, new, old)
            self._followed = new
            return new


    def _batch(self, mesh: Followed, ray_origins: ArrayLike, ray_directions: ArrayLike) -> _Batch:
        origins = _arrays.doubles(ray_origins, "ray_origins")
        directions = _arrays.doubles(ray_directions, "ray_directions")
        if origins.size == 0 and directions.size == 0:
            origins = directions = np.zeros((0, 3))
        if origins.shape != directions.shape or origins.ndim != 2 or origins.shape[1] != 3:
            raise ValueError(
                f"ray_origins {origins.shape}, ray_directions {directions.shape}: "
                "two arrays of one shape (n, 3) are expected"
            )
        middle = (mesh.center - mesh.origin) * mesh.scale
        reach = _FAR * mesh.size * mesh.scale
        frame = _core.Frame(mesh.origin.tolist(), middle.tolist(), mesh.scale, reach, _SHORT, _LONG)
        rays = np.empty((len(origins), 8), np.float32)
        good = np.empty(len(origins), np.bool_)
        if _core.pack_rays_in_frame(self._context(), origins, directions, frame, rays, good):
            return _Batch(origins, directions, rays, None)
        # Only these rays start nearer, so that no ray's answer depends on the rest of the batch.
        odd = np.flatnonzero(~good)
        with np.errstate(all="ignore"):
            starts = (origins[odd] - mesh.origin) * mesh.scale
            # Divide by the largest component first, because squares can overflow or underflow.
            units = directions[odd] / np.abs(directions[odd]).max(axis=1, initial=0.0)[:, None]
            units /= np.linalg.norm(units, axis=1)[:, None]
            # The distance to the point closest to the middle, minus the reach: the ray starts
            # there.
            ahead = np.einsum("ij,ij->i", middle - starts, units) - reach
            starts += np.maximum(ahead, 0.0)[:, None] * units
            usable = np.isfinite(starts).all(axis=1) & np.isfinite(units).all(axis=1)
            usable &= np.abs(starts).max(axis=1, initial=0.0) < np.finfo(np.float32).max
            rays[odd, :3], rays[odd, 4:7] = starts, units
        rays[odd, 3], rays[odd, 7] = 0.0, np.inf
        directions = directions.copy()
        directions[odd] = units
        if usable.all():
            return _Batch(origins, directions, rays, None)
        good[odd[usable]] = True
        asked = np.flatnonzero(good)
        return _Batch(origins, directions, rays[asked], asked)

    def _context(self) -> _core.Context:
        return self._scene._core.context()

    def _rows(
        self,
        mesh: Followed,
        batch: _Batch,
        hits: Hits,
        ends: Optional[Ints] = None,
        max_hits: Optional[int] = None,
    ) -> tuple[Ints, Ints, Floats]:
        """Faces, rays and locations, in float64. `ends`: the end of each ray's hits; None: one hit
        per ray."""
        return _core.found_rows(
            self._context(),
            mesh.vertices,
            mesh.faces,
            batch.origins,
            batch.directions,
            batch.asked,
            ends,
            hits.array.view(np.float32).reshape(-1, 6),
            mesh.unit,
            _SAME_PLACE * mesh.size,
            _MOST_HITS if max_hits is None else max_hits,
        )

    def _first(self, mesh: Followed, batch: _Batch) -> tuple[Ints, Ints, Floats]:
        return self._rows(mesh, batch, self._scene.closest_hit(batch.rays))

    def _all(
        self, mesh: Followed, batch: _Batch, max_hits: Optional[int]
    ) -> tuple[Ints, Ints, Floats]:
        rows = self._scene.all_hits(batch.rays)
        return self._rows(mesh, batch, rows.hits, rows.offsets, max_hits)


    def intersects_location(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        **kwargs: Any,
    ) -> tuple[Floats, Ints, Ints]:
        """Where rays hit the mesh.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays of real numbers
        multiple_hits : bool
            All hits of a ray, or the first.
        **kwargs
            For `intersects_id`.

        Returns
        -------
        locations : (m, 3) float64
        index_ray : (m,) int64
        index_tri : (m,) int64
            Indices into ``mesh.faces``.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins,
            ray_directions,
            multiple_hits=multiple_hits,
            return_locations=True,
            **kwargs,
        )
        return locations, index_ray, index_tri

    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = ...,
        max_hits: Optional[SupportsIndex] = ...,
        *,
        return_locations: Literal[True],
    ) -> tuple[Ints, Ints, Floats]: ...

    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool,
        max_hits: Optional[SupportsIndex],
        return_locations: Literal[True],
    ) -> tuple[Ints, Ints, Floats]: ...

    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = ...,
        max_hits: Optional[SupportsIndex] = ...,
        return_locations: Literal[False] = ...,
    ) -> tuple[Ints, Ints]: ...

    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = ...,
        max_hits: Optional[SupportsIndex] = ...,
        return_locations: bool = ...,
    ) -> Union[tuple[Ints, Ints], tuple[Ints, Ints, Floats]]: ...

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: Optional[SupportsIndex] = None,
        return_locations: bool = False,
    ) -> Union[tuple[Ints, Ints], tuple[Ints, Ints, Floats]]:
        """Which faces rays hit.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays of real numbers
        multiple_hits : bool
            All hits of a ray, or the first.
        max_hits : int, optional
            The largest number of hits per ray, which are the nearest ones; all by default.
        return_locations : bool
            Return a third array.

        Returns
        -------
        index_tri : (m,) int64
            Indices into ``mesh.faces``.
        index_ray : (m,) int64
        locations : (m, 3) float64
            Only with `return_locations`.
        """
        most = _most(max_hits)
        mesh = self._follow()
        batch = self._batch(mesh, ray_origins, ray_directions)
        if multiple_hits:
            found = self._all(mesh, batch, most)
        else:
            found = self._first(mesh, batch)
        return found if return_locations else found[:2]

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> Ints:
        """The first face that each ray hits.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays of real numbers

        Returns
        -------
        (n,) int64
            Indices into ``mesh.faces``; -1 for a miss.
        """
        batch = self._batch(self._follow(), ray_origins, ray_directions)
        hits = self._scene.closest_hit(batch.rays)
        # A miss is the largest uint32, which is -1 as int32; there are fewer than 2^31 faces.
        found = hits.prim_id.view(np.int32).astype(np.int64)
        return self._for_all(batch, found, -1)

    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.bool_]:
        """Whether each ray hits the mesh.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays of real numbers

        Returns
        -------
        (n,) bool
        """
        batch = self._batch(self._follow(), ray_origins, ray_directions)
        found = self._scene.any_hit(batch.rays)
        return self._for_all(batch, found, False)

    @staticmethod
    def _for_all(batch: _Batch, found: NDArray[Any], otherwise: Any) -> NDArray[Any]:
        if batch.asked is None:
            return found
        result = np.full(len(batch.origins), otherwise, found.dtype)
        result[batch.asked] = found
        return result

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points lie inside the mesh, by the number of hits in both directions of a line.

        Parameters
        ----------
        points : (n, 3) array of real numbers
            For points on the surface, the result is unspecified.

        Returns
        -------
        (n,) bool
        """
        places = _points(points)
        # The attributes of an engine that trimesh uses; the mesh's own box is NaN if any vertex is.
        box = SimpleNamespace(bounds=self._follow().bounds)
        asked = SimpleNamespace(mesh=box, intersects_location=self.intersects_location)
        contained: NDArray[np.bool_] = contains_points(asked, places)
        return contained

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in _NOT_COPIED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._begin()

    def __copy__(self: _Own) -> _Own:
        copied = type(self).__new__(type(self))
        copied.__setstate__(self.__getstate__())
        return copied

    def __deepcopy__(self: _Own, memo: dict[int, Any]) -> _Own:
        return self.__copy__()  # as in trimesh's other back ends, the mesh is not copied


class ProximityQuery:
    """The interface of `trimesh.proximity.ProximityQuery`, implemented by raysheaf.

    Faces with a vertex that is not finite are never found.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        The mesh. It may change: the next query notices, and if the faces are the same it updates
        only the vertices.
    threads : int
        Number of threads of queries; 0 uses all cores.
    device : "cpu" or "cuda"
        Where queries run; arrays are numpy's on both.
    """

    def __init__(self, mesh: Any, *, threads: SupportsIndex = 0, device: Device = "cpu") -> None:
        self._mesh = mesh
        self._engine = RayMeshIntersector(mesh, threads=threads, device=device)

    def on_surface(self, points: ArrayLike) -> tuple[Floats, Floats, Ints]:
        """The closest point on the mesh for each point.

        If two faces are equally near, the result is the one that faces the point more.

        Parameters
        ----------
        points : (n, 3) array of real numbers

        Returns
        -------
        closest : (n, 3) float64
        distance : (n,) float64
        triangle_id : (n,) int64
            Indices into ``mesh.faces``. A mesh without faces has NaN, NaN and -1.
        """
        followed = self._engine._follow()
        return self._nearest(followed, _points(points))[:3]

    def vertex(self, points: ArrayLike) -> tuple[Floats, Ints]:
        """The distance to the nearest vertex for each point, and its index, by the mesh's k-d tree.

        A mesh without vertices has NaN and -1.
        """
        if not len(self._mesh.vertices):
            count = len(_points(points))
            return np.full(count, np.nan), np.full(count, -1)
        distance, index = self._mesh.kdtree.query(points)
        return distance, index

    def signed_distance(self, points: ArrayLike) -> Floats:
        """The distance to the mesh, positive inside.

        If the closest point lies in a face, its normal tells the side; on an edge or a corner the
        parity of crossings does. Points within trimesh's ``tol.merge`` have a positive distance.

        Parameters
        ----------
        points : (n, 3) array of real numbers

        Returns
        -------
        (n,) float64
            NaN for a mesh without faces.
        """
        followed = self._engine._follow()
        places = _points(points)
        _, distance, _, side = self._nearest(followed, places)
        inside = side < 0
        doubtful = np.flatnonzero((side == 0) & (distance > tol.merge))
        if len(doubtful):
            asked = self._in_scene(followed, places[doubtful])
            inside[doubtful] = self._engine._scene.contains(asked, inside="evenodd")
        return np.where(inside | ~(distance > tol.merge), distance, -distance)

    @staticmethod
    def _in_scene(followed: Followed, points: Floats) -> Floats:
        with np.errstate(all="ignore"):
            moved: Floats = (points - followed.origin) * followed.scale
        return moved

    def _nearest(
        self, followed: Followed, points: Floats
    ) -> tuple[Floats, Floats, Ints, NDArray[np.int8]]:
        """Closest points, distances, faces, and sides of those that lie in a face."""
        asked = self._in_scene(followed, points)
        if followed.met is followed.faces:
            candidates = self._engine._scene.nearest(asked, 2).prim_id
        else:  # without the faces that nothing may meet, which the engine's scene has as points
            alive = np.flatnonzero(np.isfinite(followed.vertices)[followed.faces].all(axis=(1, 2)))
            scene = Scene(threads=self._engine._threads, device=self._engine._device)
            scene.add(followed.moved, followed.faces[alive])
            found = scene.nearest(asked, 2)
            candidates = np.full(found.shape, INVALID_ID, np.uint32)
            candidates[found.found] = alive[found.prim_id[found.found]]
        out, distance = np.empty((len(points), 3)), np.empty(len(points))
        face, side = np.empty(len(points), np.int64), np.empty(len(points), np.int8)
        _core.nearest_faces(
            self._engine._context(),
            followed.vertices,
            followed.faces,
            points,
            np.ascontiguousarray(candidates),
            tol.merge * min(1.0, followed.size) ** 2,  # of squares; trimesh's at any size
            out,
            distance,
            face,
            side,
        )
        return out, distance, face, side
