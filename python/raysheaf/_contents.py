"""Copies and pickles of scenes, and how they look: the base class of `Scene`."""

from __future__ import annotations

import copy
from typing import Any, Optional, SupportsIndex, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core, _values
from ._cameras import Camera
from ._look import Light, Material, Surface

_Own = TypeVar("_Own", bound="Contents")
_NO_ENVIRONMENT = {
    "name": "",
    "width": 0,
    "height": 0,
    "radiance": np.zeros((0, 3), np.float32),
    "intensity": 1.0,
    "rotation": 0.0,
}


_SHARED = ("_surfaces", "_textures", "_images", "warnings")  # lists of things that never change
_EDITED = ("materials", "lights", "cameras")
_OWN = {"_core", "_threads", "_environment", *_SHARED, *_EDITED}


def _or_none(array: Optional[NDArray[Any]], *shape: int) -> NDArray[Any]:
    return np.zeros((0, *shape), np.float32) if array is None else array


class Contents:
    """The part of `Scene` that is copied, pickled and shown."""

    _core: _core.Scene

    materials: list[Material]
    """The materials of meshes; `add` appends to them. Change them as you like."""
    lights: list[Light]
    """The lights of the file; `render` lights a scene that has none."""
    cameras: list[Camera]
    """The cameras of the file; `render` finds them by name or number."""
    warnings: list[str]
    """A sentence for each thing in the file that was left out."""

    def _begin(self, threads: int) -> None:
        self._threads = threads
        self._surfaces: dict[int, Surface] = {}
        self._textures: list[dict[str, Any]] = []
        self._images: list[dict[str, Any]] = []
        self._environment: dict[str, Any] = _NO_ENVIRONMENT
        self.materials = []
        self.lights = []
        self.cameras = []
        self.warnings = []

    def vertices(self, mesh: SupportsIndex, time: float = 0) -> NDArray[np.float32]:
        """A copy of the mesh's vertices, (n, 3), in its own space; at a time from 0 to 1 if they
        move (`update`)."""
        when = _values.number(time, "time")
        return np.asarray(_core.positions_at(self._core, _arrays.integer(mesh, "mesh"), when))

    def triangles(self, mesh: SupportsIndex) -> NDArray[np.uint32]:
        """A copy of the mesh's triangles, (m, 3): indices into `vertices`."""
        vertices, triangles = _core.mesh_arrays(self._core, _arrays.integer(mesh, "mesh"))
        if triangles is None:
            return np.arange(vertices.shape[1], dtype=np.uint32).reshape(-1, 3)
        return np.asarray(triangles)

    def surface(self, mesh: SupportsIndex) -> Surface:
        """The normals, texture coordinates and materials of the mesh."""
        number = _arrays.integer(mesh, "mesh")
        self._core.vertex_count(number)  # raises for another number
        return self._surfaces.get(number, Surface())

    def copy(self: _Own) -> _Own:
        """A scene of its own with the same meshes, instances, ids, masks, worlds and look.

        `copy.copy` does the same, and so does `copy.deepcopy`, which also copies what a subclass
        has added.

        >>> import raysheaf
        >>> scene = raysheaf.Scene()
        >>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
        >>> other = scene.copy()
        >>> other.remove(mesh)
        >>> mesh in scene, mesh in other
        (True, False)
        """
        other = type(self).__new__(type(self))
        vars(other).update(vars(self))
        other._core = _core.copy_scene(self._core)
        for name in _SHARED:
            setattr(other, name, copy.copy(getattr(self, name)))
        for name in _EDITED:
            setattr(other, name, copy.deepcopy(getattr(self, name)))
        return other

    def __copy__(self: _Own) -> _Own:
        return self.copy()

    def __deepcopy__(self: _Own, memo: dict[int, Any]) -> _Own:
        other = memo[id(self)] = self.copy()
        for name in vars(self).keys() - _OWN:
            setattr(other, name, copy.deepcopy(getattr(self, name), memo))
        return other

    def __getstate__(self) -> dict[str, Any]:
        core = self._core
        meshes = [(mesh, *_core.mesh_arrays(core, mesh)) for mesh in core.meshes()]
        instances = [
            (number, mesh, core.transforms(number), core.mask(number), core.world(number))
            for mesh in core.meshes()
            for number in core.instances(mesh)
        ]
        return {
            "cuda": core.is_on_cuda(),
            "meshes": meshes,
            "instances": sorted(instances, key=lambda one: one[0]),
            "next_ids": _core.next_ids(core),
            "rest": {name: value for name, value in vars(self).items() if name != "_core"},
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state["rest"])
        core = self._core = _core.Scene(self._threads, state["cuda"])
        everything = all_worlds = 0xFFFFFFFF
        for mesh, vertices, triangles in state["meshes"]:
            _core.continue_ids(core, mesh, 0)
            times = vertices if vertices.ndim == 3 else vertices[None]
            identity = np.eye(3, 4, dtype=np.float32)
            core.add(times[0], triangles, False, identity, everything, all_worlds)
            if len(times) > 1:
                core.update(mesh, times.reshape(-1, 3), len(times))
        for number, mesh, given, mask, world in state["instances"]:
            _core.continue_ids(core, _core.next_ids(core)[0], number)
            matrices = given.reshape(-1, 3, 4)
            core.instance(mesh, matrices[0], mask, world)
            core.set_transforms(np.array([number], np.uint32), matrices, len(matrices))
        _core.continue_ids(core, *state["next_ids"])

    def _add_material(self, material: Any, triangles: int) -> Optional[NDArray[np.uint32]]:
        """The indices that stand for what `add` was given."""
        if material is None:
            return None
        if isinstance(material, Material):
            self.materials.append(material)
            return np.array([len(self.materials) - 1], np.uint32)
        array = np.atleast_1d(_arrays.as_numpy(material, "material"))
        if array.dtype.kind not in "iu" or array.ndim != 1:
            raise TypeError(
                f"material: {material!r} is given; a Material, or indices into the scene's materials, "
                "are expected"
            )
        if array.size and not (0 <= array.min() and array.max() < len(self.materials)):
            raise ValueError(
                f"material: an index is out of range: the scene has {len(self.materials)} materials"
            )
        return array.astype(np.uint32)

    def _described(self) -> tuple[dict[str, Any], NDArray[np.uint32], NDArray[np.uint32]]:
        """As the renderer takes scenes; and its meshes' and instances' ids here."""
        core = self._core
        meshes: list[dict[str, Any]] = []
        instances: list[dict[str, Any]] = []
        mesh_ids: list[int] = []
        instance_ids: list[int] = []
        materials = [material._described() for material in self.materials]
        plain = len(materials)
        for mesh in core.meshes():
            placed = [i for i in core.instances(mesh) if core.mask(i) != 0]
            (vertices, *_), triangles = _core.mesh_arrays(core, mesh)
            if triangles is None:
                triangles = np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3)
            if not placed or not len(triangles):
                continue
            surface = self._surfaces.get(mesh, Surface())
            of = surface.materials
            meshes.append(
                {
                    "name": surface.name,
                    "positions": np.where(np.isfinite(vertices), vertices, np.float32(0)),
                    "normals": _or_none(surface.normals, 3),
                    "uvs": _or_none(surface.uv, 2),
                    "second_uvs": _or_none(surface.second_uv, 2),
                    "colors": _or_none(surface.colors, 3),
                    "alphas": _or_none(surface.alphas),
                    "triangles": triangles,
                    "materials": np.array([plain], np.uint32) if of is None else of,
                }
            )
            for number in placed:
                matrix = tuple(core.transforms(number)[0].ravel().tolist())
                instances.append({"name": "", "mesh": len(mesh_ids), "to_world": matrix})
                instance_ids.append(number)
            mesh_ids.append(mesh)
        described = {
            "name": "",
            "meshes": meshes,
            "instances": instances,
            "materials": [*materials, Material()._described()],
            "textures": self._textures,
            "images": self._images,
            "lights": [light._described() for light in self.lights],
            "cameras": [camera._described() for camera in self.cameras],
            "environment": self._environment,
            "warnings": [],
        }
        return described, _named(mesh_ids), _named(instance_ids)


def _named(ids: list[int]) -> NDArray[np.uint32]:
    """With an entry behind the last for what is none."""
    return np.array([*ids, 0xFFFFFFFF], np.uint32)
