"""Runs trimesh's own tests of rays and of proximity with raysheaf: run_trimesh_tests.py TRIMESH.

TRIMESH is a checkout of trimesh (its tests and models). Both of trimesh's ray engines and its
proximity queries are replaced, so that every query of these tests is ours. Exit code as pytest's.
"""

import sys
from pathlib import Path

import pytest
import trimesh.proximity
import trimesh.ray
from trimesh.ray import ray_pyembree, ray_triangle

import raysheaf.trimesh


class Engine(raysheaf.trimesh.RayMeshIntersector):
    """Counts its queries, so that a run that did not use it is detected."""

    queries = 0

    def _follow(self):
        Engine.queries += 1
        return super()._follow()


class Proximity(raysheaf.trimesh.ProximityQuery):
    """The same for points."""

    queries = 0

    def _nearest(self, *arguments):
        Proximity.queries += 1
        return super()._nearest(*arguments)


def main(folder: Path) -> int:
    trimesh.proximity.ProximityQuery = Proximity
    trimesh.proximity.closest_point = lambda mesh, points: Proximity(mesh).on_surface(points)
    trimesh.proximity.signed_distance = lambda mesh, points: Proximity(mesh).signed_distance(points)
    ray_triangle.RayMeshIntersector = Engine
    if trimesh.ray.has_embree:
        ray_pyembree.RayMeshIntersector = Engine
    tests = [folder / "tests" / name for name in ("test_ray.py", "test_ray_upstream.py", "test_proximity.py")]
    code = pytest.main(
        [
            "-q",
            "-p",
            "no:cacheprovider",
            f"--rootdir={folder}",
            *[str(t) for t in tests if t.exists()],
        ]
    )
    print(f"{Engine.queries} queries of rays and {Proximity.queries} of points by raysheaf")
    return int(code) or (Engine.queries == 0 or Proximity.queries == 0)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
