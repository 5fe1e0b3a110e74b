"""Runs trimesh's own ray tests with raysheaf as its ray engine: run_trimesh_tests.py TRIMESH.

TRIMESH is a checkout of trimesh with its tests and models. Both of trimesh's engines are replaced,
so that every ray query of these tests uses raysheaf. The exit code is pytest's.
"""

import sys
from pathlib import Path

import pytest
import trimesh.ray
from trimesh.ray import ray_pyembree, ray_triangle

import raysheaf.trimesh


class Engine(raysheaf.trimesh.RayMeshIntersector):
    """Counts its queries, so that a run that did not use it is detected."""

    queries = 0

    def _follow(self):
        Engine.queries += 1
        return super()._follow()


def main(folder: Path) -> int:
    ray_triangle.RayMeshIntersector = Engine
    if trimesh.ray.has_embree:
        ray_pyembree.RayMeshIntersector = Engine
    tests = [folder / "tests" / name for name in ("test_ray.py", "test_ray_upstream.py")]
    code = pytest.main(
        [
            "-q",
            "-p",
            "no:cacheprovider",
            f"--rootdir={folder}",
            *[str(t) for t in tests if t.exists()],
        ]
    )
    print(f"{Engine.queries} queries by raysheaf")
    return int(code) or (Engine.queries == 0)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
