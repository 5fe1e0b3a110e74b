"""raysheaf: ray queries against triangles that move.

`Scene` answers batches of rays against meshes that may change completely between any two
batches, with `closest_hit`, `any_hit`, `all_hits` and `hit_counts`; and batches of points, with
`closest_point`, `nearest`, `signed_distance` and `contains`. `load` reads scenes from files;
`pinhole`, `orthographic` and `lidar` make rays. `render` makes images of scenes, of scene files,
and of an `Animation` at any time. `raysheaf.trimesh` gives these queries to trimesh's
meshes, `raysheaf.sensors` has lidars and depth cameras,
`raysheaf.mujoco` scenes of MuJoCo's models. ``python -m raysheaf`` is the command line,
``python -m raysheaf.bench`` a benchmark.

>>> import raysheaf
>>> scene = raysheaf.Scene()
>>> mesh = scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
>>> hits = scene.closest_hit([0.25, 0.25, 0], [0, 0, 1])
>>> float(hits.t), int(hits.prim_id)
(1.0, 0)
"""

import importlib
from typing import TYPE_CHECKING

from ._cameras import Camera, Rays, lidar, orthographic, pinhole
from ._core import version as __version__
from ._closest import CLOSEST_DTYPE, ClosestPoints
from ._errors import Error, InvalidError, NotFoundError, OutOfMemoryError, UnsupportedError
from ._hits import HIT_DTYPE, INVALID_ID, HitRows, Hits
from ._load import load
from ._look import Light, Material, Surface
from ._queries import ALL_WORLDS
from ._render import Animation, Gbuffer, Picture, png_bytes, render, write_png
from ._scene import Scene

__all__ = [
    "ALL_WORLDS",
    "CLOSEST_DTYPE",
    "HIT_DTYPE",
    "INVALID_ID",
    "Animation",
    "Camera",
    "ClosestPoints",
    "Error",
    "Gbuffer",
    "HitRows",
    "Hits",
    "InvalidError",
    "Light",
    "Material",
    "NotFoundError",
    "OutOfMemoryError",
    "Picture",
    "Rays",
    "Scene",
    "Surface",
    "UnsupportedError",
    "__version__",
    "lidar",
    "load",
    "orthographic",
    "pinhole",
    "png_bytes",
    "render",
    "write_png",
]

# Imported on first use: mujoco and trimesh may be missing, and not all programs use the others.
_LATER = ("bench", "mujoco", "radiation", "sensors", "trimesh")

if TYPE_CHECKING:
    from . import bench as bench, mujoco as mujoco, radiation as radiation
    from . import sensors as sensors, trimesh as trimesh
else:

    def __getattr__(name):
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        try:
            return importlib.import_module(f"{__name__}.{name}")
        except ImportError as error:
            # An AttributeError, so that hasattr() and code that lists all attributes continue.
            why = f"cannot be imported: {error}"
            if isinstance(error, ModuleNotFoundError):
                why = f"needs {(error.name or '').partition('.')[0]}, which is not installed"
            raise AttributeError(f"{__name__}.{name} {why}") from error

    def __dir__():
        return sorted([*__all__, *_LATER])
