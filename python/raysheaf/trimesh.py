"""Ray queries for trimesh: ``mesh.ray = raysheaf.trimesh.RayMeshIntersector(mesh)``.

>>> import trimesh
>>> from raysheaf.trimesh import RayMeshIntersector
>>> mesh = trimesh.creation.box()
>>> mesh.ray = RayMeshIntersector(mesh)
>>> locations, index_ray, index_tri = mesh.ray.intersects_location([[0.1, 0.2, -2]], [[0, 0, 1]])
>>> locations
array([[ 0.1,  0.2, -0.5],
       [ 0.1,  0.2,  0.5]])
>>> mesh.apply_translation([0, 0, 9])
<trimesh.Trimesh(vertices.shape=(8, 3), faces.shape=(12, 3))>
>>> mesh.ray.intersects_any([[0.1, 0.2, -2]], [[0, 0, 1]], max_distance=5)
array([False])
"""

from __future__ import annotations

import math
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh.ray.ray_util import contains_points

from ._scene import Scene

# Hits of one ray that are nearer to each other than this part of the mesh's size are one: a ray
# through an edge meets both triangles at it. trimesh's other back end steps on by the same length.
_SAME_PLACE = 1e-6
# Rays that begin farther away than this many times the mesh's size begin nearer, so that float32 keeps
# its digits for the mesh.
_FAR = 4.0
# Where a ray meets a triangle at a flatter angle, the corner's weights say more than its plane.
_FLAT = 1e-4


class RayMeshIntersector:
    """What `trimesh.ray.ray_pyembree.RayMeshIntersector` does, by raysheaf.

    Parameters
    ----------
    geometry : trimesh.Trimesh
        The mesh. It may change: the next query notices, and takes over moved vertices as an update
        if the faces are the same.
    scale_to_box : bool
        Query about the mesh's middle and at a size of about 1, so that float32 is as good as it can
        be wherever the mesh lies. False: as it is.
    threads : int
        How many threads queries use; 0 takes all cores.

    Rays whose origin or direction is not finite, or whose direction is zero, hit nothing.
    Directions need not be unit vectors. Hits lie at and before the origin, never behind it. Both
    sides of faces are met. A ray through an edge or a vertex shared by faces hits one of them there;
    rows of results are sorted by ray, then from near to far.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, *, threads: int = 0) -> None:
        self.mesh = geometry
        self._scale_to_box = bool(scale_to_box)
        self._threads = threads
        self._forget()

    def _forget(self) -> None:
        self._scene = Scene(threads=self._threads)
        self._id: Optional[int] = None  # the mesh in the scene
        self._hash: Optional[int] = None  # what the mesh was then
        self._faces: NDArray[np.int64] = np.zeros((0, 3), np.int64)
        self._corners: NDArray[np.float64] = np.zeros((0, 3))
        self._center: NDArray[np.float64] = np.zeros(3)
        self._scale = 1.0
        self._size = 0.0

    # The scene follows the mesh.

    @property
    def scene(self) -> Scene:
        """The scene behind it, for queries of its own: in its own units, see `to_scene`."""
        self._follow()
        return self._scene

    def to_scene(self, points: ArrayLike) -> NDArray[np.float64]:
        """Points of the mesh's space in that of `scene`."""
        self._follow()
        return (np.asarray(points, np.float64) - self._center) * self._scale

    def _follow(self) -> None:
        now = hash(self.mesh)
        if self._id is not None and now == self._hash:
            return
        vertices = np.asarray(self.mesh.vertices, np.float64).reshape(-1, 3)
        faces = np.asarray(self.mesh.faces).reshape(-1, 3)
        self._measure(vertices)
        moved = (vertices - self._center) * self._scale
        if self._id is None:
            self._id = self._scene.add(moved, faces)
        elif len(vertices) == len(self._corners) and np.array_equal(faces, self._faces):
            self._scene.update(self._id, moved)
        else:
            self._scene.replace(self._id, moved, faces)
        if self._faces is not faces:
            self._faces = np.array(faces, np.int64)
        self._corners = vertices.copy()
        self._hash = now

    def _measure(self, vertices: NDArray[np.float64]) -> None:
        """Middle, size and scale; the scale is a power of two, which rounds nothing."""
        if len(vertices) == 0:
            return
        least, most = vertices.min(axis=0), vertices.max(axis=0)
        self._size = float(np.linalg.norm(most - least))
        if not self._scale_to_box:
            return
        self._center = (least + most) / 2
        usable = math.isfinite(self._size) and self._size > 0
        self._scale = 2.0 ** -math.frexp(self._size)[1] if usable else 1.0

    # Rays.

    def _rays(
        self, origins: ArrayLike, directions: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        starts = np.asarray(origins, np.float64)
        ways = np.asarray(directions, np.float64)
        if starts.shape != ways.shape or starts.ndim != 2 or starts.shape[1] != 3:
            if not (starts.size == 0 and ways.size == 0):
                raise ValueError(
                    f"ray_origins {starts.shape}, ray_directions {ways.shape}: "
                    "two arrays of the same shape (n, 3) are expected"
                )
            return np.zeros((0, 3)), np.zeros((0, 3))
        return starts, ways

    def _query_rays(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Origins and unit directions in the scene's space, and which of them are rays at all."""
        with np.errstate(all="ignore"):
            lengths = np.sqrt(np.einsum("ij,ij->i", directions, directions))
            units = directions / lengths[:, None]
            starts = (origins - self._center) * self._scale
            along = np.einsum("ij,ij->i", starts, units)
            # A far ray begins where it comes near: no hit lies before that.
            reach = _FAR * max(self._size * self._scale, np.finfo(np.float64).tiny)
            skipped = np.where(-along > reach, -along - reach, 0.0)
            far = np.flatnonzero(skipped)
            if len(far):
                starts[far] += skipped[far, None] * units[far]
            right = np.isfinite(starts.sum(axis=1)) & np.isfinite(units.sum(axis=1))
            right &= np.abs(starts).max(axis=1, initial=0.0) < 1e30
        if not right.all():
            starts[~right] = 0.0
            units[~right] = (0.0, 0.0, 1.0)
        return starts, units, right

    def _t_max(
        self, right: NDArray[np.bool_], max_distance: Optional[ArrayLike] = None
    ) -> NDArray[np.float64]:
        return np.where(right, np.inf, 0.0)

    # trimesh's interface.

    def intersects_location(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        **kwargs: Any,
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        raise NotImplementedError
