"""Scenes from files."""

from __future__ import annotations

import math
import os
from typing import Any, Optional, SupportsFloat, SupportsIndex, Union

import numpy as np
from numpy.typing import NDArray

from . import _core, _values
from ._cameras import camera_from
from ._device import Device
from ._look import Material, Surface, light_from, material_from
from ._scene import Scene

Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]


def load(
    path: Path,
    *,
    time: Optional[Union[SupportsFloat, SupportsIndex]] = None,
    threads: SupportsIndex = 0,
    device: Device = "cpu",
) -> Scene:
    """A scene of a file: its meshes and instances, and its materials, lights and cameras.

    Parameters
    ----------
    path : str, bytes or path
        A glTF, GLB, OBJ, PLY or STL file; or ``"builtin:office"``, ``"builtin:cornell"``,
        ``"builtin:atrium"``.
    time : float, optional
        Seconds, for files that move; by default the file is at rest.
    threads, device
        As `Scene` has them.

    Returns
    -------
    Scene
        Mesh i of the file has the id i, and so have the instances. `Scene.surface` has the normals
        and texture coordinates of vertices, `Scene.materials`, `Scene.lights` and `Scene.cameras`
        what the file has of these. `render` shows it as it shows the file.

    Raises
    ------
    InvalidError
        For an invalid file.
    NotFoundError
        For a missing file or built-in scene.

    Examples
    --------
    >>> import raysheaf
    >>> scene = raysheaf.load("builtin:cornell")
    >>> scene
    <raysheaf.Scene: ... meshes, ... instances, ... triangles, from (...) to (...)>
    >>> scene.surface(0).normals.shape == scene.vertices(0).shape, scene.materials[0].name
    (True, 'floor')
    >>> raysheaf.render(scene, width=32, height=32)
    <raysheaf.Picture 32x32>
    """
    at = None if time is None else _values.number(time, "time")
    if at is not None and math.isnan(at):
        raise ValueError("time: NaN is given; seconds are expected")
    scene = Scene(threads=threads, device=device)
    file = _core.load(_values.path_in_utf8(path, "path"), at)
    scene.materials = [material_from(one) for one in file["materials"]]
    scene.lights = [light_from(one) for one in file["lights"]]
    scene.cameras = [camera_from(one) for one in file["cameras"]]
    scene.warnings = list(file["warnings"])
    scene._textures, scene._images = file["textures"], file["images"]
    scene._environment = file["environment"]
    without = None  # what stands for no material
    for mesh in file["meshes"]:
        number = scene.add(mesh["positions"], mesh["triangles"], place=False)
        materials = mesh["materials"]
        if not len(materials):
            if without is None:
                without = len(scene.materials)
                scene.materials.append(Material(double_sided=False))
            materials = np.array([without], np.uint32)
        scene._surfaces[number] = Surface(
            name=mesh["name"],
            normals=_given(mesh["normals"]),
            uv=_given(mesh["uvs"]),
            second_uv=_given(mesh["second_uvs"]),
            colors=_given(mesh["colors"]),
            alphas=_given(mesh["alphas"]),
            materials=materials,
        )
    for one in file["instances"]:
        scene.instance(one["mesh"], np.array(one["to_world"], np.float32).reshape(3, 4))
    return scene


def _given(array: NDArray[Any]) -> Optional[NDArray[Any]]:
    return array if len(array) else None
