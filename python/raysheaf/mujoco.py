"""Scenes of MuJoCo models: `ModelScene` has the geoms of an MjModel and follows its MjData.

>>> import mujoco
>>> from raysheaf.mujoco import ModelScene
>>> model = mujoco.MjModel.from_xml_string('''
... <mujoco><worldbody>
...   <geom type="plane" size="0 0 1"/>
...   <body name="lift" pos="0 0 2"><joint type="slide"/><geom type="box" size="1 1 .5"/></body>
... </worldbody></mujoco>''')
>>> data = mujoco.MjData(model)
>>> scene = ModelScene(model)
>>> scene.multi_ray([0, 0, 9], [[0, 0, -1], [2, 0, -2], [0, 0, 1]])
(array([ 1,  0, -1], dtype=int32), array([ 6.5,  4.5, -1. ]))
>>> data.qpos[0] = 1
>>> mujoco.mj_kinematics(model, data)
>>> scene.follow(data)                        # once a step
>>> float(scene.closest_hit([0, 0, 9], [0, 0, -1]).t)
5.5
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, SupportsIndex, Union

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values
from ._device import Device
from ._hits import INVALID_ID, Hits
from ._poses import Doubles
from ._queries import Sides, Worlds
from ._scene import Scene
from .sensors import DepthCamera

__all__ = ["ModelScene"]

Mesh = tuple[Doubles, NDArray[Any]]  # vertices and triangles

_GEOM = mujoco.mjtGeom
_MOST_SQUEEZE = 1000.0  # by which a unit mesh is scaled along one axis more than along another
_HORIZON = 10.0 ** np.arange(6)  # where planes without end have vertices
_MOST_KINDS = 32  # of geoms, each with a bit of the mask


def _quads(index: NDArray[Any]) -> NDArray[Any]:
    """The triangles of a grid of vertices, counter-clockwise where columns run to the right and
    rows up. Each diagonal is from a row and a column to the next ones, as MuJoCo has it."""
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return np.asarray(faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)])


def _sheet(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Mesh:
    """A grid over the lines x and y with the heights z of shape (y, x), facing up."""
    planes = np.broadcast_arrays(*np.meshgrid(x, y), z)
    vertices = np.stack(planes, axis=-1).reshape(-1, 3).astype(np.float64)
    return vertices, _quads(np.arange(len(vertices)).reshape(planes[0].shape))


def _block(x: ArrayLike, y: ArrayLike, z: ArrayLike, floor: float) -> Mesh:
    """The solid between a sheet and a floor."""
    vertices, top = _sheet(x, y, z)
    index = np.arange(len(vertices)).reshape(np.size(y), np.size(x))
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    below = vertices[rim] * [1, 1, 0] + [0, 0, floor]
    base = len(vertices) + np.arange(len(rim))
    walls = _quads(np.stack([np.append(base, base[0]), np.append(rim, rim[0])]))
    bottom = np.stack([np.full(len(rim) - 2, base[0]), base[2:], base[1:-1]], axis=1)
    return np.concatenate([vertices, below]), np.concatenate([top, walls, bottom])


def _turned(radius: Doubles, z: Doubles, segments: int) -> Mesh:
    """The surface that points of a radius and a height make as they turn about the z axis."""
    angle = 2 * np.pi / segments * np.arange(segments)
    circle = np.stack([np.cos(angle), np.sin(angle), np.ones(segments)], axis=-1)
    vertices = np.stack([radius, radius, z], axis=-1)[:, None] * circle
    index = segments * np.arange(len(radius))[:, None] + np.arange(segments + 1) % segments
    index = np.where(radius[:, None] == 0, index[:, :1], index)
    return vertices.reshape(-1, 3), _quads(index)


def _stretched_sphere(half: float, segments: int) -> Mesh:
    """A sphere of radius 1, whose halves are moved along z by -half and half."""
    angle = 2 * np.pi / segments * np.arange(segments // 4 + 1)
    radius, z = np.cos(angle).round(15), np.sin(angle) + half
    return _turned(np.concatenate([radius[::-1], radius]), np.concatenate([-z[::-1], z]), segments)


def _line(half: float) -> Doubles:
    """Where a plane has vertices along an axis; 0: it has no end."""
    return np.array([-half, half]) if half > 0 else np.append(-_HORIZON[::-1], _HORIZON)


@dataclass(frozen=True)
class _Shape:
    """A mesh that geoms share, and the scale at which one of them has it."""

    kind: int
    numbers: tuple[float, ...] = ()  # what distinguishes meshes of a kind
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)
    error: float = 0.0

    @staticmethod
    def of(model: Any, geom: int, segments: int) -> _Shape:
        kind, size = int(model.geom_type[geom]), tuple(model.geom_size[geom].tolist())
        flat = 1 - np.cos(np.pi / segments)  # of a chord of a circle
        round_ = np.sin(np.pi / segments) ** 2  # of a facet of a sphere
        if kind in (_GEOM.mjGEOM_MESH, _GEOM.mjGEOM_SDF, _GEOM.mjGEOM_HFIELD):
            return _Shape(kind, (int(model.geom_dataid[geom]),))
        if kind == _GEOM.mjGEOM_CAPSULE:
            return _Shape(kind, (size[1] / size[0],), size[:1] * 3, size[0] * round_)
        if kind == _GEOM.mjGEOM_PLANE and min(size[:2]) <= 0:
            return _Shape(kind, size[:2])
        error = 0.0
        if kind == _GEOM.mjGEOM_PLANE:
            size = (*size[:2], max(size[:2]))
        elif kind == _GEOM.mjGEOM_CYLINDER:
            size, error = (size[0], size[0], size[1]), size[0] * flat
        elif kind != _GEOM.mjGEOM_BOX:
            size = size[:1] * 3 if kind == _GEOM.mjGEOM_SPHERE else size
            kind, error = int(_GEOM.mjGEOM_SPHERE), max(size) * round_
        if max(size) > _MOST_SQUEEZE * min(size):  # rays could not enter such an instance
            return _Shape(kind, size, error=error)
        return _Shape(kind, (1.0, 1.0, 1.0), size, error)

    def mesh(self, model: Any, segments: int) -> Mesh:
        if self.kind == _GEOM.mjGEOM_HFIELD:
            return _height_field(model, int(self.numbers[0]))
        if self.kind in (_GEOM.mjGEOM_MESH, _GEOM.mjGEOM_SDF):
            return _asset(model, int(self.numbers[0]))
        if self.kind == _GEOM.mjGEOM_CAPSULE:
            return _stretched_sphere(self.numbers[0], segments)
        if self.kind == _GEOM.mjGEOM_PLANE:
            return _sheet(_line(self.numbers[0]), _line(self.numbers[1]), 0)
        if self.kind == _GEOM.mjGEOM_BOX:
            vertices, triangles = _block([-1, 1], [-1, 1], 1, -1)
        elif self.kind == _GEOM.mjGEOM_CYLINDER:
            profile = np.array([[0.0, 1, 1, 0], [-1, -1, 1, 1]])
            vertices, triangles = _turned(profile[0], profile[1], segments)
        else:
            vertices, triangles = _stretched_sphere(0, segments)
        return vertices * self.numbers, triangles


def _height_field(model: Any, number: int) -> Mesh:
    x, y, high, base = model.hfield_size[number].tolist()
    rows, columns = int(model.hfield_nrow[number]), int(model.hfield_ncol[number])
    first = model.hfield_adr[number]
    heights = model.hfield_data[first : first + rows * columns].reshape(rows, columns)
    lines = np.linspace(-x, x, columns), np.linspace(-y, y, rows)
    return _block(*lines, high * heights.astype(np.float64), -base)


def _asset(model: Any, number: int) -> Mesh:
    vertices, faces = (
        values[first[number] : first[number] + count[number]]
        for values, first, count in (
            (model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum),
            (model.mesh_face, model.mesh_faceadr, model.mesh_facenum),
        )
    )
    return vertices, faces


def _placed(data: Any, what: str) -> Doubles:
    """(..., n, 4, 4), where the n geoms, sites or cameras are."""
    if isinstance(data, (list, tuple)):
        return np.stack([_placed(one, what) for one in data])
    at = np.asarray(getattr(data, f"{what}_xpos"), np.float64)
    matrices = np.zeros((*at.shape[:-1], 4, 4))
    matrices[..., :3, :3] = np.reshape(getattr(data, f"{what}_xmat"), (*at.shape, 3))
    matrices[..., :3, 3] = at
    matrices[..., 3, 3] = 1
    return matrices


class ModelScene(Scene):
    """A `Scene` of the geoms of a MuJoCo model, an instance for each.

    It begins in the model's reference configuration, ``qpos0``, and `follow` moves it. Sensors,
    queries, copies and further meshes are those of any `Scene`.

    As MuJoCo's rays do, it leaves out geoms and materials of alpha 0, sites, tendons, flexes and
    skins. Boxes, planes, meshes and height fields, which have walls and a bottom, have the surfaces
    that MuJoCo's rays meet, rounded to float32. Spheres, ellipsoids, capsules and cylinders are
    polyhedra inside of them, with corners on the surface; see `geom_error`. A plane without end has
    100 000 units to each side, and a signed distance field is its mesh.

    Geoms share meshes: all boxes one, all spheres and ellipsoids one, all cylinders one, capsules
    of one proportion one, and geoms of a mesh asset its mesh.

    Parameters
    ----------
    model : mujoco.MjModel
        Its sizes, groups and colours are read once.
    worlds : int, optional
        So many worlds have moving geoms of their own, while static ones are in all worlds; see
        `Scene.instances`.
    segments : int
        The corners around a round geom, a multiple of 4.
    threads, device
        As `Scene` has them.

    Raises TypeError for what is not an MjModel, and ValueError for a number out of range.
    """

    model: Any
    """The MjModel."""
    instance_ids: NDArray[np.uint32]
    """(geoms,) or (worlds, geoms), the instance of each geom; `INVALID_ID` for one that is left
    out. A static geom has one instance in all worlds."""
    geoms: NDArray[np.int32]
    """(instances,), the geom of each instance by its id. As the `labels` of a scan they make
    `Scan.label` the geom, and ``model.geom_bodyid[scene.geoms]`` makes it the body."""
    geom_error: Doubles
    """(geoms,), how far the polyhedron of a geom may be from its surface. With n segments it is
    r sin(pi / n)**2 for spheres and capsules of radius r, and ellipsoids whose longest half axis is
    r; r (1 - cos(pi / n)) for cylinders; 0 for the others."""

    def __init__(
        self,
        model: Any,
        *,
        worlds: Optional[SupportsIndex] = None,
        segments: SupportsIndex = 64,
        threads: SupportsIndex = 0,
        device: Device = "cpu",
    ) -> None:
        if not isinstance(model, mujoco.MjModel):
            raise TypeError(f"model: {type(model).__name__} is given; a mujoco.MjModel is expected")
        corners = _arrays.integer(segments, "segments", 4096, least=8)
        if corners % 4:
            raise ValueError(f"segments: {corners} is given; a multiple of 4 is expected")
        copies: tuple[int, ...] = ()
        if worlds is not None:
            copies = (_arrays.integer(worlds, "worlds", least=1),)
        super().__init__(threads=threads, device=device)
        self.model = model
        static = model.body_weldid[model.geom_bodyid] == 0
        colours = np.append(model.geom_rgba, model.mat_rgba).reshape(-1, 4)
        material = model.geom_matid
        shown = np.where(material < 0, np.arange(model.ngeom), model.ngeom + material)
        seen = colours[shown, 3] != 0
        self._static, self._moving = np.flatnonzero(seen & static), np.flatnonzero(seen & ~static)
        # Geoms that differ in none of these have one bit of the mask together; see `ray_mask`.
        planes = model.geom_type == _GEOM.mjGEOM_PLANE
        groups = np.clip(model.geom_group, 0, mujoco.mjNGROUP - 1)
        told = np.stack([groups, static, planes, np.full(model.ngeom, -1)], axis=1)
        self._kinds, kind = np.unique(told, axis=0, return_inverse=True)
        self._kind: NDArray[Any] = kind.reshape(-1)

        shapes = [_Shape.of(model, geom, corners) for geom in range(model.ngeom)]
        self._scales = np.array([shape.scale for shape in shapes]).reshape(-1, 1, 3)
        self.geom_error = np.array([shape.error for shape in shapes])
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        places = self.matrices(data)
        self._still = places[self._static]
        self.instance_ids = np.full((*copies, model.ngeom), INVALID_ID, np.uint32)
        meshes: dict[Any, int] = {}
        geoms: list[int] = []
        for geom in np.flatnonzero(seen).tolist():
            shape = shapes[geom]
            key = shape.kind, shape.numbers
            if key not in meshes:
                vertices, triangles = shape.mesh(model, corners)
                meshes[key] = self.add(vertices, triangles, place=False)
            each: tuple[int, ...] = () if static[geom] else copies
            geoms += [geom] * max(each, default=1)
            self.instance_ids[..., geom] = self.instances(
                meshes[key],
                np.broadcast_to(places[geom], (*(each or (1,)), 3, 4)),
                worlds=np.arange(each[0]) if each else None,
                mask=self._mask_of(geom),
            )
        self.geoms = np.array(geoms, np.int32)

    # Moving.

    def matrices(self, data: Any) -> Doubles:
        """(..., geoms, 3, 4), the transforms of the instances of all geoms.

        `data` is an MjData, a list of them, or an object whose ``geom_xpos`` and ``geom_xmat`` have
        shapes (..., geoms, 3) and (..., geoms, 3, 3), as batches of MJX and MuJoCo Warp have.
        """
        matrices = _placed(data, "geom")[..., :3, :]
        if matrices.shape[-3] != self.model.ngeom:
            raise ValueError(
                f"data: {matrices.shape[-3]} geoms are given; {self.model.ngeom} are expected"
            )
        matrices[..., :3] *= self._scales
        return matrices

    def follow(self, *moments: Any) -> None:
        """Move all geoms to where they are in an MjData, in one call.

        MuJoCo computes these places in mj_kinematics, which mj_forward calls, and mj_step at its
        beginning.

        Parameters
        ----------
        *moments : MjData, sequence of MjData, or array
            As `matrices` takes them: with `worlds`, an MjData for each. Or what `matrices` has
            returned. Several moments, at equal distances of time, are a movement, which queries
            with `times` and scans with `moving` see; all others see the first. See
            `Scene.set_transforms`.

        Raises ValueError for another number of geoms or worlds, and `InvalidError` for places that
        are not finite.

        >>> import mujoco
        >>> from raysheaf.mujoco import ModelScene
        >>> model = mujoco.MjModel.from_xml_string('''<mujoco><worldbody>
        ...   <body><freejoint/><geom type="box" size="1 1 1"/></body></worldbody></mujoco>''')
        >>> data, scene, fall = mujoco.MjData(model), ModelScene(model), []
        >>> for _ in range(101):
        ...     mujoco.mj_step(model, data)
        ...     fall.append(scene.matrices(data))
        >>> scene.follow(*fall)
        >>> scene.closest_hit([[0, 0, 3]] * 2, [0, 0, -1], times=[0, 1]).t.round(3)
        array([2.   , 2.198], dtype=float32)
        """
        given = [one if isinstance(one, np.ndarray) else self.matrices(one) for one in moments]
        expected = (*self.instance_ids.shape, 3, 4)
        for one in given:
            if one.shape != expected:
                raise ValueError(
                    f"moments: transforms of shape {one.shape} are given; {expected} is expected"
                )
        if not given:
            raise TypeError("moments: none are given; one or more are expected")
        frames, ids = np.stack(given, axis=-3), self.instance_ids
        if len(self._moving):
            self.set_transforms(ids[..., self._moving], frames[..., self._moving, :, :, :])
        # Static geoms move only if the model is edited. They are the same in all worlds.
        still = frames.reshape(-1, *frames.shape[-4:])[0, self._static, 0]
        if not np.array_equal(still, self._still):
            self.set_transforms(ids.reshape(-1, self.model.ngeom)[0, self._static], still)
            self._still = still

    # Rays as MuJoCo's.

    def _mask_of(self, geom: int) -> int:
        return 1 << int(self._kind[geom])

    def _set_apart(self, body: int) -> None:
        """Gives the geoms of a body bits of their own, if they have none."""
        mine = np.flatnonzero(self.model.geom_bodyid == body)
        old, place = np.unique(self._kind[mine], return_inverse=True)
        if (self._kinds[old, 3] == body).all():
            return
        if len(self._kinds) + len(old) > _MOST_KINDS:
            raise ValueError(
                f"bodyexclude: {body} is given, but the bodies that were excluded before use all "
                f"{_MOST_KINDS} bits of the mask"
            )
        kinds = self._kinds[old] * [1, 1, 1, 0] + [0, 0, 0, body]
        self._kind = self._kind.copy()  # a copy of the scene may share it
        self._kind[mine] = len(self._kinds) + place.reshape(-1)
        self._kinds = np.concatenate([self._kinds, kinds])
        for geom in np.intersect1d(mine, np.union1d(self._static, self._moving)):
            for instance in np.unique(self.instance_ids[..., geom]):
                self.set_mask(instance, self._mask_of(geom))

    def ray_mask(
        self,
        geomgroup: Optional[ArrayLike] = None,
        flg_static: bool = True,
        bodyexclude: SupportsIndex = -1,
    ) -> int:
        """The `mask` with which queries and scans see the geoms that MuJoCo's rays would see.

        Parameters
        ----------
        geomgroup : (6,) array, optional
            Whether each group is seen; all by default.
        flg_static : bool
            Whether static geoms are seen: those of bodies that are welded to the world.
        bodyexclude : int
            A body whose geoms are not seen, mostly that of the sensor; -1: none. The first use of a
            body changes the masks of its instances, so that the mask has a bit for them.

        Raises ValueError for a body or groups that do not exist, and for more excluded bodies than
        the 32 bits of masks distinguish; at least eight are possible.
        """
        groups = np.ones(mujoco.mjNGROUP, np.uint8) if geomgroup is None else geomgroup
        shown = _arrays.as_numpy(groups, "geomgroup")
        if shown.shape != (mujoco.mjNGROUP,):
            raise ValueError(
                f"geomgroup: an array of shape {shown.shape} is given; one of shape "
                f"({mujoco.mjNGROUP},) is expected"
            )
        body = _arrays.integer(bodyexclude, "bodyexclude", self.model.nbody - 1, least=-1)
        if body >= 0:
            self._set_apart(body)
        group, static, _, apart = self._kinds.T
        keep = (shown[group] != 0) & (bool(flg_static) | (static == 0))
        return self._bits(keep & ((apart < 0) | (apart != body)))

    def _bits(self, kinds: NDArray[np.bool_]) -> int:
        return sum(1 << int(kind) for kind in np.flatnonzero(kinds))

    def geom_of(self, hits: Hits) -> NDArray[np.int32]:
        """The geoms of hits, in their shape; -1 for misses and for instances of other meshes."""
        known = np.append(self.geoms, np.int32(-1))
        return np.asarray(known[np.minimum(hits.inst_id, len(self.geoms))])

    def multi_ray(
        self,
        pnt: ArrayLike,
        vec: ArrayLike,
        geomgroup: Optional[ArrayLike] = None,
        flg_static: bool = True,
        bodyexclude: SupportsIndex = -1,
        cutoff: float = np.inf,
        *,
        worlds: Optional[Worlds] = None,
    ) -> tuple[NDArray[np.int32], Doubles]:
        """The rays of mj_multiRay, on all threads: the geom that each ray meets, and how far.

        Planes are met from above only, all other geoms from both sides.

        Parameters
        ----------
        pnt, vec : (..., 3) arrays
            Origins and directions, which broadcast: one origin, or one for each ray. Distances are
            in lengths of the direction. A direction of zero meets nothing.
        geomgroup, flg_static, bodyexclude
            As `ray_mask` has them.
        cutoff : float
            Nothing farther is met, in units of the world. MuJoCo ignores only geoms whose bounding
            spheres are farther, so that its ranges may be longer.
        worlds : int, or array of integers, optional
            The world of each ray, see `Scene.closest_hit`.

        Returns
        -------
        geomid : (...) int32
            -1 where nothing is met.
        dist : (...) float64
            The same.
        """
        mask = self.ray_mask(geomgroup, flg_static, bodyexclude)
        expected = "one of shape (..., 3)"
        origins = _arrays.with_last_axis(pnt, "pnt", 3, expected)
        ways = _arrays.with_last_axis(vec, "vec", 3, expected)
        far = _values.number(cutoff, "cutoff")
        with np.errstate(all="ignore"):
            most = far / np.linalg.norm(ways, axis=-1) if far < np.inf else np.inf
        hits = self.closest_hit(origins, ways, t_max=most, mask=mask, worlds=worlds, invalid="miss")
        geom, dist = self.geom_of(hits), hits.t.astype(np.float64)
        is_plane = self.model.geom_type == _GEOM.mjGEOM_PLANE
        below = np.asarray(np.append(is_plane, False)[geom])
        if below.any():
            below[below] = ~hits[below].front
        if below.any():  # these rays go on through planes
            shape = hits.shape
            starts, ends, limits = (
                np.broadcast_to(one, (*shape, *tail))[below]
                for one, tail in ((origins, (3,)), (ways, (3,)), (most, ()))
            )
            homes = worlds
            if worlds is not None:
                homes = _arrays.leading(worlds, "worlds", shape).reshape(shape)[below]

            def ask(bits: int, sides: Sides) -> Hits:
                return self.closest_hit(
                    starts, ends, t_max=limits, mask=bits, sides=sides, worlds=homes, invalid="miss"
                )

            planes = self._bits(self._kinds[:, 2] != 0)
            solid, above = ask(mask & ~planes, "both"), ask(mask & planes, "front")
            dist[below] = np.minimum(solid.t, above.t)
            geom[below] = np.where(solid.t <= above.t, self.geom_of(solid), self.geom_of(above))
        return geom, np.where(geom < 0, -1.0, dist)

    # Sensors.

    def site_pose(self, data: Any, site: Union[SupportsIndex, str]) -> Doubles:
        """(..., 4, 4), the pose of a site, by its id or name: where a sensor of the model is.

        `data` is an MjData, a list of them or a batch, as `matrices` takes it. Raises KeyError for
        a name that the model does not have.
        """
        return _placed(data, "site")[..., self.model.site(site).id, :, :]

    def camera_pose(self, data: Any, camera: Union[SupportsIndex, str]) -> Doubles:
        """(..., 4, 4), the pose of a camera in OpenCV's frame, as a `DepthCamera` takes it."""
        return _placed(data, "cam")[..., self.model.cam(camera).id, :, :] * [1, -1, -1, 1]

    def depth_camera(
        self, camera: Union[SupportsIndex, str], size: tuple[int, int], **options: Any
    ) -> DepthCamera:
        """A `DepthCamera` with the ``fovy`` of a camera of the model.

        `size` has the width and the height of its images in pixels; `options` are those of
        `DepthCamera`.
        """
        wide, high = size
        focal = high / 2 / np.tan(np.radians(self.model.cam(camera).fovy.item()) / 2)
        matrix = [[focal, 0, (wide - 1) / 2], [0, focal, (high - 1) / 2], [0, 0, 1]]
        return DepthCamera(matrix, size, **options)
