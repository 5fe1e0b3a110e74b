"""Points all over a mesh with normals: at its vertices, triangles, or the texels of a texture."""

from __future__ import annotations

from typing import NamedTuple, Optional, Sequence, SupportsIndex, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values
from ._asked import _normal_map
from ._look import per_vertex
from ._patches import Doubles, Ints, world_corners
from ._scene import Scene


class Places(NamedTuple):
    """Points on a surface and unit normals there, in the world; NaN for texels off the surface."""

    points: Doubles
    """(..., 3)"""
    normals: Doubles
    """(..., 3), on the front."""


def _instance(
    scene: Scene, mesh: SupportsIndex, instance: Optional[SupportsIndex]
) -> tuple[int, int]:
    number = _arrays.integer(mesh, "mesh")
    placed = scene.instances(number)
    if instance is None:
        if not placed:
            raise ValueError(f"mesh: {number} has no instance; a mesh that is placed is expected")
        return number, placed[0]
    wanted = _arrays.integer(instance, "instance")
    if wanted not in placed:
        raise ValueError(f"instance: {wanted} is given, which does not place mesh {number}")
    return number, wanted


def _crosses(corners: Doubles) -> Doubles:
    """Normals as long as twice the areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _units(vectors: Doubles) -> Doubles:
    """NaN for what has no direction."""
    with np.errstate(all="ignore"):
        return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _vertex_normals(scene: Scene, mesh: int, instance: int) -> Doubles:
    """Those that the mesh was given, or means over the triangles by their areas; of any length."""
    given = scene.surface(mesh).normals
    if given is not None:
        matrix = _normal_map(scene.transform(instance))
        return np.asarray((given[:, None, :] * matrix).sum(-1))
    crosses = _crosses(world_corners(scene, mesh, instance))
    triangles = scene.triangles(mesh)
    normals = np.zeros((scene.vertex_count(mesh), 3))
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], crosses)
    return normals


def at_vertices(
    scene: Scene, mesh: SupportsIndex, *, instance: Optional[SupportsIndex] = None
) -> Places:
    """The vertices of a mesh, (n, 3): results are colours of vertices.

    Normals are those of `Scene.add`, or means over the triangles by their areas; NaN for a vertex
    without triangles. `instance` is the one that counts, the first by default.

    >>> import raysheaf
    >>> from raysheaf import radiation
    >>> scene = raysheaf.Scene()
    >>> mesh = scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> radiation.sky_view(scene, *radiation.at_vertices(scene, mesh))
    array([1., 1., 1.])
    """
    number, place = _instance(scene, mesh, instance)
    matrix = scene.transform(place).astype(np.float64)
    vertices = scene.vertices(number).astype(np.float64)
    with np.errstate(all="ignore"):
        points = (vertices[:, None, :] * matrix[:, :3]).sum(-1) + matrix[:, 3]
    return Places(points, _units(_vertex_normals(scene, number, place)))


def at_triangles(
    scene: Scene, mesh: SupportsIndex, *, instance: Optional[SupportsIndex] = None
) -> Places:
    """The centres of a mesh's triangles, (m, 3), with the normals of the triangles; NaN for those
    without area. `instance` is that of `at_vertices`."""
    corners = world_corners(scene, *_instance(scene, mesh, instance))
    return Places(corners.mean(1), _units(_crosses(corners)))


def at_texels(
    scene: Scene,
    mesh: SupportsIndex,
    size: Union[SupportsIndex, Sequence[SupportsIndex]] = 512,
    *,
    uv: Optional[ArrayLike] = None,
    padding: float = 2.0,
    instance: Optional[SupportsIndex] = None,
) -> Places:
    """Where the texels of a texture are on a mesh, (height, width, 3): results are images.

    A texel's place is where its centre is. Texels whose centres are no more than `padding` texels
    from the nearest triangle have the place of the nearest point of it, so that images
    show no seams when they are filtered; all others are NaN.

    Parameters
    ----------
    size : int, or two
        Width and height in texels.
    uv : (n, 2) array, optional
        Texture coordinates of the vertices, in which the first row of images is at v = 0. By
        default the mesh's second set, as glTF has it for light maps, or the first where it has
        one only.
    padding : float
        Texels.
    instance : int, optional
        That of `at_vertices`.

    >>> import numpy as np, raysheaf
    >>> from raysheaf import radiation
    >>> scene = raysheaf.Scene()
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> mesh = scene.add(square, [[0, 1, 2], [0, 2, 3]], uv=square[:, :2])
    >>> points, normals = radiation.at_texels(scene, mesh, 4)
    >>> points[0, :, 0]
    array([0.125, 0.375, 0.625, 0.875])
    >>> radiation.sky_view(scene, points, normals).shape
    (4, 4)
    """
    number, place = _instance(scene, mesh, instance)
    sizes = np.broadcast_to(_arrays.as_numpy(size, "size"), 2)
    width, height = (_arrays.integer(one, "size", 16384, least=1) for one in sizes.tolist())
    surface = scene.surface(number)
    given = surface.second_uv if surface.second_uv is not None else surface.uv
    if uv is not None:
        given = per_vertex(uv, "uv", 2, scene.vertex_count(number))
    if given is None:
        raise ValueError(f"mesh: {number} has no texture coordinates; uv is expected")
    triangles = scene.triangles(number)
    flat = np.zeros((len(given), 3), np.float32)
    flat[:, :2] = given * np.array([width, height], np.float32)
    plane = Scene(threads=scene.threads)
    plane.add(flat, triangles)
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    reach = _values.number(padding, "padding")
    if not 0 <= reach < np.inf:
        raise ValueError(f"padding: {reach:g} is given; a finite number of texels is expected")
    nearest = plane.closest_point(np.stack([x, y, 0 * x], axis=-1), radius=reach)
    found = nearest.found
    prim = nearest.prim_id[found].astype(np.int64)
    u, v = nearest.u[found], nearest.v[found]
    matrix = scene.transform(place).astype(np.float64)
    mixed = _mixed(scene.vertices(number).astype(np.float64), triangles, prim, u, v)
    points, normals = np.full((2, height, width, 3), np.nan)
    points[found] = (mixed[:, None, :] * matrix[:, :3]).sum(-1) + matrix[:, 3]
    if surface.normals is not None:
        normals[found] = _mixed(_vertex_normals(scene, number, place), triangles, prim, u, v)
    else:
        normals[found] = _crosses(world_corners(scene, number, place))[prim]
    return Places(points, _units(normals))


def _mixed(
    values: Doubles, triangles: NDArray[np.uint32], prim: Ints, u: Doubles, v: Doubles
) -> Doubles:
    a, b, c = (values[triangles[prim, k]] for k in range(3))
    return np.asarray(a * (1 - u - v)[:, None] + b * u[:, None] + c * v[:, None])
