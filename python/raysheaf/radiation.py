"""Light and heat as numbers: view factors, sky views, hours of sun, irradiance, occlusion.

Each function casts many rays into a `Scene` and returns arrays of float64. Surfaces are opaque.
Points lie on a surface or above it; normals need not be unit vectors and say to which side a point
looks. Points and normals that are NaN, as those of misses and of texels without a surface, have
the answer NaN.

Results are the same bits for any number of threads and any `memory`: samples are Sobol' points,
scrambled eight times, and the spread of the eight answers is the standard error. Long runs keep to
`memory` bytes besides their results, and call ``progress(done, total)``, in rays, after each batch.

>>> import numpy as np, raysheaf
>>> from raysheaf import radiation
>>> scene = raysheaf.Scene()
>>> floor = scene.add([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], [[0, 1, 2], [0, 2, 3]])
>>> ceiling = scene.add([[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]], [[0, 1, 2], [0, 2, 3]])
>>> radiation.view_factors(scene, [floor, ceiling]).factors.round(6)
array([[0.      , 0.199825],
       [0.199825, 0.      ]])
>>> points, normals = radiation.at_vertices(scene, floor)
>>> radiation.sky_view(scene, points, normals, samples=4096).round(2)
array([0.86, 0.86, 0.86, 0.86])
"""

from __future__ import annotations

import math
from typing import Any, Literal, Optional, Sequence, SupportsIndex, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _open, _values, _view_factors
from ._bake import Places, at_texels, at_triangles, at_vertices
from ._batches import MEMORY, Batches, Progress
from ._cameras import Number
from ._open import Points, Reflectance
from ._patches import Doubles, Patch
from ._scene import Scene
from ._sky import Sky, overcast_sky, perez_sky, sky_patches, sun_positions, uniform_sky
from ._sobol import REPLICATES, log2_at_least
from ._view_factors import ViewFactors

__all__ = [
    "Patch",
    "Places",
    "Sky",
    "ViewFactors",
    "ambient_occlusion",
    "at_texels",
    "at_triangles",
    "at_vertices",
    "irradiance",
    "overcast_sky",
    "perez_sky",
    "sky_patches",
    "sky_view",
    "sun_hours",
    "sun_positions",
    "thickness",
    "uniform_sky",
    "view_factors",
    "visibility",
]

WithError = tuple[Doubles, Doubles]


def view_factors(
    scene: Scene,
    patches: Sequence[Union[Patch, SupportsIndex]],
    *,
    samples: SupportsIndex = 2**14,
    to: Optional[Sequence[Union[Patch, SupportsIndex]]] = None,
    exact: Optional[bool] = None,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> ViewFactors:
    """The view factors between patches: of the diffuse radiation that leaves the front of one, the
    share that arrives at the front of another. All triangles of the scene are in the way; the backs
    of patches are black.

    Two patches of few triangles, each of which lies in front of the other, have the integral along
    their edges (E. M. Sparrow, J. Heat Transfer 85 (1963), eq. 8), to about eight digits. For two
    plane patches, the parts in front of each other count. Where nothing is found to be between
    them, this is the factor; elsewhere it is multiplied by the share of lines of sight that are
    free, weighted by the kernel, if the patches are apart. All other factors are counted by
    cosine-distributed rays, from both patches.

    Factors are reciprocal: the area times the factor is the same both ways. If no rays leave a
    patch's surroundings, which are then closed, its row sums to 1: sampled factors are moved by
    least squares, each by as much as it may err.

    Parameters
    ----------
    scene : Scene
        It stands still, as at time 0.
    patches : sequence of ints and `Patch`
        The id of a mesh stands for all its triangles in all its instances.
    samples : int
        Rays of a patch, and lines of sight of a patch to all others together; rounded up to a power
        of two.
    to : sequence of ints and `Patch`, optional
        The columns, if they are not the patches: the rows of a part of the matrix. Rows of a part
        are not closed.
    exact : bool, optional
        False: all factors are counted by rays. By default so are those of more than 16 384 pairs,
        if there are fewer than 8 samples for each column: rays then take less time than integrals.
    memory : float
        Bytes besides the n x m results.
    progress : function of two ints, optional
        Called after each batch, with the number of rays that are done and of all.

    Returns
    -------
    ViewFactors
        `factors` and `errors`, (n, m), without unit. Standard errors fall with the number of
        samples, by about samples^-0.7, and do not count the closing of rows, which reduces errors.

    Raises
    ------
    ValueError
        For a mesh that does not exist, a patch without area, patches with a triangle in common.

    Examples
    --------
    >>> import raysheaf
    >>> from raysheaf.radiation import Patch, view_factors
    >>> scene = raysheaf.Scene()
    >>> wall = scene.add([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> floor = scene.add([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> round(float(view_factors(scene, [wall, floor])[0, 1]), 9)
    0.200043776
    >>> halves = [Patch(wall, triangles=[0]), Patch(wall, triangles=[1])]
    >>> view_factors(scene, halves, to=[floor]).factors.round(4)
    array([[0.1324],
           [0.2677]])
    """
    return _view_factors.view_factors(
        scene,
        patches,
        samples=samples,
        to=to,
        exact=exact,
        memory=_values.number(memory, "memory"),
        progress=progress,
    )


def _log2(samples: Any) -> int:
    return log2_at_least(_arrays.integer(samples, "samples", 2**30, least=1))


@overload
def ambient_occlusion(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    radius: Number = ...,
    samples: SupportsIndex = ...,
    errors: Literal[False] = ...,
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> Doubles: ...


@overload
def ambient_occlusion(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    radius: Number = ...,
    samples: SupportsIndex = ...,
    errors: Literal[True],
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> WithError: ...


def ambient_occlusion(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    radius: Number = math.inf,
    samples: SupportsIndex = 256,
    errors: bool = False,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> Union[Doubles, WithError]:
    """The free share of the hemisphere over each point, weighted by the cosine to the normal: 1 is
    open, 0 is closed. Hayden Landis, "Production-ready global illumination" (SIGGRAPH 2002 course).

    Parameters
    ----------
    points, normals : (..., 3)
        They broadcast. Points on a surface are lifted by as much as rounding may hide them.
    radius : float
        What is farther away does not count, in the scene's unit of length.
    samples : int
        Rays of a point, rounded up to a power of two, at least 8.
    errors : bool
        True returns (shares, standard errors).
    memory, progress
        Those of `view_factors`.

    Returns
    -------
    (...) array, or two of them
        From 0 to 1, without unit.

    >>> import numpy as np, raysheaf
    >>> from raysheaf.radiation import ambient_occlusion
    >>> scene = raysheaf.Scene()
    >>> square = np.array([[0, -9, -9], [0, 9, -9], [0, 9, 9], [0, -9, 9]])
    >>> wall = scene.add(square, [[0, 1, 2], [0, 2, 3]])
    >>> points = [[0.4, 0, 0], [2, 0, 0]]
    >>> ambient_occlusion(scene, points, [0, 1, 0], radius=1, samples=2**14).round(3)
    array([0.748, 1.   ])
    """
    return _free(scene, points, normals, radius, samples, errors, memory, progress)


def _free(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    radius: Number,
    samples: SupportsIndex,
    errors: bool,
    memory: Number,
    progress: Optional[Progress],
) -> Union[Doubles, WithError]:
    reach = _values.number(radius, "radius")
    if not reach > 0:
        raise ValueError(f"radius: {reach:g} is given; a number above 0 is expected")
    log2 = _log2(samples)
    where = Points(scene, points, normals)
    work = Batches(memory, progress, len(where) * REPLICATES << log2)
    found = _open.free_shares(scene, where, log2, reach, work)
    shares, spread = (where.shaped(one) for one in found)
    return (shares, spread) if errors else shares


@overload
def sky_view(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    samples: SupportsIndex = ...,
    errors: Literal[False] = ...,
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> Doubles: ...


@overload
def sky_view(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    samples: SupportsIndex = ...,
    errors: Literal[True],
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> WithError: ...


def sky_view(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    samples: SupportsIndex = 1024,
    errors: bool = False,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> Union[Doubles, WithError]:
    """The sky view factor of each point: the share of the hemisphere around its normal, weighted by
    the cosine to the normal, in which there is no geometry (G. T. Johnson, I. D. Watson, "The
    determination of view-factors in urban canyons", J. Climate and Applied Meteorology 23 (1984)).

    The ground counts as far as it is in the scene. Parameters and results are those of
    `ambient_occlusion` without a radius.

    >>> import numpy as np, raysheaf
    >>> from raysheaf.radiation import sky_view
    >>> scene = raysheaf.Scene()
    >>> square = np.array([[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]])
    >>> wall = scene.add(square * [1, 1, 9e3], [[0, 1, 2], [0, 2, 3]])
    >>> sky_view(scene, [[1, 0, 0]], [0, 1, 0], samples=2**14).round(2)      # (1 + cos 45) / 2
    array([0.85])
    """
    return _free(scene, points, normals, math.inf, samples, errors, memory, progress)


def _weighted(directions: Any, weights: Any) -> tuple[Doubles, Doubles, tuple[int, ...]]:
    """Unit directions (d, 3), weights (k, d), and the shape of k."""
    if isinstance(directions, Sky):
        if weights is not None:
            raise TypeError("weights: a Sky has its own; None is expected")
        directions, weights = directions.directions, directions.weights
    ways = _arrays.with_last_axis(directions, "directions", 3, "one of shape (d, 3)")
    if ways.ndim != 2:
        raise ValueError(f"directions: an array of shape {ways.shape} is given; (d, 3) is expected")
    ways = ways.astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        ways = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
    if not np.isfinite(ways).all():
        number = int(np.argmin(np.isfinite(ways).all(-1)))
        raise ValueError(f"directions[{number}]: it is 0 or not finite; a direction is expected")
    factors = _arrays.floats(1.0 if weights is None else weights, "weights", "an array")
    if factors.ndim == 0:
        factors = np.broadcast_to(factors, len(ways))
    if factors.shape[-1] != len(ways) or not np.isfinite(factors).all():
        raise ValueError(
            f"weights: an array of shape {factors.shape} is given; finite numbers of shape (..., "
            f"{len(ways)}) are expected"
        )
    return ways, factors.reshape(-1, len(ways)).astype(np.float64), factors.shape[:-1]


def sun_hours(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    directions: ArrayLike,
    weights: Optional[ArrayLike] = None,
    *,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> Doubles:
    """For how long each point sees the sun: the sum of the weights of those directions that are
    above the point's plane and in which nothing is hit.

    Parameters
    ----------
    points, normals : (..., 3)
        Those of `ambient_occlusion`.
    directions : (d, 3)
        Towards the sun, of any length, as of `sun_positions`; leave out those below the horizon
        where the scene has no ground.
    weights : (..., d), optional
        What each direction stands for, in hours or another unit; 1 by default. Rows of weights, one
        a month for example, share their rays.
    memory, progress
        Those of `view_factors`.

    Returns
    -------
    (...) array
        Of the shape of the points, then of the rows of weights, in the unit of the weights. It has
        no sampling error: it is as fine as the steps of time.

    >>> import numpy as np, raysheaf
    >>> from raysheaf.radiation import sun_hours
    >>> scene = raysheaf.Scene()
    >>> square = np.array([[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]])
    >>> wall = scene.add(square * [1, 1, 9e3], [[0, 1, 2], [0, 2, 3]])
    >>> turn = np.radians(np.arange(0.5, 180))              # from east to west, above the equator
    >>> suns = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1)
    >>> sun_hours(scene, [[-1, 0, 0], [1, 0, 0]], [0, 1, 0], suns, 12 / 180)
    array([9., 9.])
    """
    ways, factors, rows = _weighted(directions, weights)
    if isinstance(directions, Sky):
        raise TypeError("directions: a Sky is given; the directions of suns are expected")
    where = Points(scene, points, normals)
    work = Batches(memory, progress, len(where) * len(ways))
    return where.shaped(_open.sums_of_visible(scene, where, ways, factors, False, work), rows)


@overload
def irradiance(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    directions: Union[Sky, ArrayLike],
    weights: Optional[ArrayLike] = ...,
    *,
    bounces: SupportsIndex = ...,
    reflectance: Reflectance = ...,
    samples: SupportsIndex = ...,
    errors: Literal[False] = ...,
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> Doubles: ...


@overload
def irradiance(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    directions: Union[Sky, ArrayLike],
    weights: Optional[ArrayLike] = ...,
    *,
    bounces: SupportsIndex = ...,
    reflectance: Reflectance = ...,
    samples: SupportsIndex = ...,
    errors: Literal[True],
    memory: Number = ...,
    progress: Optional[Progress] = ...,
) -> WithError: ...


def irradiance(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    directions: Union[Sky, ArrayLike],
    weights: Optional[ArrayLike] = None,
    *,
    bounces: SupportsIndex = 0,
    reflectance: Reflectance = 0.5,
    samples: SupportsIndex = 256,
    errors: bool = False,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> Union[Doubles, WithError]:
    """The irradiance of each point under a sky: the sum over its directions of weight times cosine
    to the normal, where nothing is in the way.

    Parameters
    ----------
    points, normals : (..., 3)
        Those of `ambient_occlusion`.
    directions : Sky, or (d, 3) array
        `uniform_sky`, `overcast_sky`, `perez_sky`, or a sky of your own by directions and weights.
    weights : (..., d), with an array of directions
        The irradiance of a plane that faces each direction: radiance times solid angle, or the
        normal irradiance of a sun. Rows of weights share their rays.
    bounces : int
        Reflections of diffuse surfaces that count; 0 to 63. More than 0 need one row of weights
        that are not negative.
    reflectance : float, or dict
        The share that surfaces reflect, on both sides: of all, or by the ids of meshes, and 0 of
        those that are not named.
    samples : int
        Paths of a point, for bounces only; rounded up to a power of two, at least 8.
    errors : bool
        True returns (irradiances, standard errors of the reflected part).
    memory, progress
        Those of `view_factors`.

    Returns
    -------
    (...) array, or two of them
        Of the shape of the points, then of the rows of weights, in the unit of the weights: W / m2,
        lux, or Wh / m2. The sky is as fine as its directions: 2305 patches err by about 0.2 % of
        the horizontal irradiance on open tilted planes.

    >>> import numpy as np, raysheaf
    >>> from raysheaf.radiation import irradiance, overcast_sky
    >>> scene = raysheaf.Scene()
    >>> square = np.array([[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]])
    >>> wall = scene.add(square * [1, 1, 9e3], [[0, 1, 2], [0, 2, 3]])
    >>> irradiance(scene, [[1, 0, 0], [99, 0, 0]], [0, 1, 0], overcast_sky()).round(2)
    array([2.16, 2.44])
    """
    ways, factors, rows = _weighted(directions, weights)
    if not isinstance(directions, Sky) and weights is None:
        raise TypeError("weights: None is given besides directions; an array is expected")
    count = _arrays.integer(bounces, "bounces", 63)
    if count and (rows or (factors < 0).any()):
        raise ValueError("weights: bounces need one row of them, none of which is negative")
    where = Points(scene, points, normals)
    log2 = _log2(samples)
    paths = len(where) * REPLICATES << log2 if count else 0
    work = Batches(memory, progress, len(where) * len(ways) + paths)
    found = _open.sums_of_visible(scene, where, ways, factors, True, work)
    spread = np.zeros_like(found)
    if count:
        light = _open.Bounces(scene, reflectance, ways, factors[0])
        reflected, error = light.irradiance(where, log2, count, work)
        found, spread = found + reflected[:, None], error[:, None]
    total = where.shaped(found, rows)
    return (total, where.shaped(spread, rows)) if errors else total


def thickness(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    angle: Number = 0.0,
    samples: SupportsIndex = 64,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> Doubles:
    """How thick the solid below each point of its surface is: the distance along the normal,
    inwards, to the next surface.

    With an angle, it is the mean distance of rays in a cone around that direction, as the diameter
    function of L. Shapira, A. Shamir, D. Cohen-Or, "Consistent mesh partitioning and
    skeletonisation using the shape diameter function", Visual Computer 24 (2008), without its
    filter.

    Parameters
    ----------
    points, normals : (..., 3)
        Those of `ambient_occlusion`; normals point out of the solid.
    angle : float
        Degrees between the axis of the cone and its sides, 0 to 90.
    samples : int
        Rays of a cone, rounded up to a power of two, at least 8.
    memory, progress
        Those of `view_factors`.

    Returns
    -------
    (...) array
        In the scene's unit of length; inf where no ray hits anything.

    >>> import raysheaf
    >>> from raysheaf.radiation import thickness
    >>> scene = raysheaf.Scene()
    >>> bottom = scene.add([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 2, 1]])
    >>> top = scene.add([[0, 0, 2], [4, 0, 2], [0, 4, 2]], [[0, 1, 2]])
    >>> thickness(scene, [[1, 1, 2]], [0, 0, 1]).round(3)
    array([2.])
    """
    cone = _values.number(angle, "angle")
    if not 0 <= cone <= 90:
        raise ValueError(f"angle: {cone:g} is given; degrees from 0 to 90 are expected")
    log2 = _log2(samples) if cone else 0
    where = Points(scene, points, normals, side=-1.0)
    work = Batches(memory, progress, len(where) * (REPLICATES << log2 if cone else 1))
    return where.shaped(_open.mean_lengths(scene, where, log2, math.radians(cone), work))


def visibility(
    scene: Scene,
    points: ArrayLike,
    others: ArrayLike,
    *,
    memory: Number = MEMORY,
    progress: Optional[Progress] = None,
) -> NDArray[np.bool_]:
    """Which points see each other: whether nothing is on the line between them.

    Parameters
    ----------
    points, others : (..., 3)
        They broadcast: ``points[:, None]`` and ``others[None]`` are all pairs. Surfaces
        on which the points lie, within the rounding of float32, do not count.
    memory, progress
        Those of `view_factors`.

    Returns
    -------
    (...) array of bool

    >>> import raysheaf
    >>> from raysheaf.radiation import visibility
    >>> scene = raysheaf.Scene()
    >>> wall = scene.add([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> visibility(scene, [[-1, 0, 0], [0, 0, 0]], [[[1, 0, 0]], [[1, 9, 0]]])
    array([[False,  True],
           [ True,  True]])
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: {type(scene).__name__} is given; a Scene is expected")
    shape, start, stop = _open.flat_pairs(points, others)
    found = np.empty(math.prod(shape), np.bool_)
    work = Batches(memory, progress, len(found))
    for begin, end in work.ranges(len(found)):
        ends = (_open.rows_of(one, begin, end) for one in (start, stop))
        found[begin:end] = _open.visible(scene, *ends)
    return found.reshape(shape)
