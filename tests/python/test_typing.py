"""The types that type checkers find in the package, as its users see them."""

from __future__ import annotations

import doctest
import os
import re
from pathlib import Path

import pytest

import raysheaf

ROOT = Path(__file__).parents[2]

PROGRAM = """
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray
from typing_extensions import assert_type

import raysheaf
from raysheaf import HitRows, Hits, Scene

points: NDArray[np.float64] = np.zeros((3, 3))
scene = Scene(threads=np.int32(1))
mesh = scene.add(points, [[0, 1, 2]], mask=np.uint32(1))
hits = scene.closest_hit(points, [0, 0, 1], mask=np.int64(3), t_max=3.0)
assert_type(hits, Hits)
assert_type(hits[0], Hits)
assert_type(hits["t"], NDArray[Any])
for one in hits:
    assert_type(one, Hits)
rows = scene.all_hits(points, points)
assert_type(rows[np.int64(0)], Hits)
assert_type(rows[0, np.int64(1)], Hits)
scene.update(hits.geom_id[0], points)
scene.set_transform(hits.inst_id[0], None)
assert_type(scene.triangle_count(np.int64(mesh)), int)
assert_type(scene.any_hit(points, points, out=np.empty(3, np.bool_)), NDArray[np.bool_])
Hits.empty((np.int64(3), 2))

picture = raysheaf.render(b"a.glb", camera=np.int64(0), width=np.int64(4), time=np.float32(1))
assert_type(picture == picture, bool)

ray = raysheaf.trimesh.RayMeshIntersector(None)
Ids = NDArray[np.int64]
Two = tuple[Ids, Ids]
Three = tuple[Ids, Ids, NDArray[np.float64]]
flag = bool(mesh)
assert_type(ray.intersects_id(points, points), Two)
assert_type(ray.intersects_id(points, points, max_hits=np.int64(3)), Two)
assert_type(ray.intersects_id(points, points, True, 20, True), Three)
assert_type(ray.intersects_id(points, points, return_locations=True), Three)
assert_type(ray.intersects_id(points, points, return_locations=flag), Union[Two, Three])
raysheaf.bench.main(["--rays", "1e3"])

from raysheaf.sensors import DepthCamera, DepthImage, Raster, Scan, SolidStateLidar

assert_type(SolidStateLidar(Raster(4, 3), noise=0.1).scan(scene, np.eye(4), seed=np.int64(1)), Scan)
assert_type(DepthCamera(np.eye(3), (4, 3)).scan(scene, worlds=range(1)), DepthImage)

from raysheaf import radiation
from raysheaf.radiation import Patch, ViewFactors

Shares = NDArray[np.float64]
assert_type(radiation.view_factors(scene, [mesh, Patch(mesh, [0])]), ViewFactors)
places = radiation.at_texels(scene, mesh, (8, np.int64(4)))
assert_type(radiation.sky_view(scene, *places), Shares)
assert_type(radiation.sky_view(scene, points, points, errors=True), tuple[Shares, Shares])
assert_type(radiation.irradiance(scene, points, points, radiation.uniform_sky(np.float32(2))), Shares)
"""

WRONG = """
import raysheaf

raysheaf.nothing
raysheaf.Scene().remove("a")
raysheaf.Scene().remove(1.5)
"""


@pytest.fixture(scope="module")
def options(tmp_path_factory) -> list[str]:
    """mypy's, with one cache for all tests: it reads numpy once."""
    cache = str(tmp_path_factory.mktemp("mypy"))
    return ["--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", cache]


def errors_of(program: str, options, tmp_path, monkeypatch) -> list[str]:
    api = pytest.importorskip("mypy.api")
    monkeypatch.setenv("MYPYPATH", os.path.dirname(os.path.dirname(raysheaf.__file__)))
    (tmp_path / "program.py").write_text(program)
    report, errors, _ = api.run([*options, str(tmp_path / "program.py")])
    assert not errors
    return [line for line in report.splitlines() if ": error: " in line]


def test_what_is_right(options, tmp_path, monkeypatch):
    pytest.importorskip("trimesh")
    pytest.importorskip("typing_extensions")
    assert errors_of(PROGRAM, options, tmp_path, monkeypatch) == []


def test_what_is_documented(options, tmp_path, monkeypatch):
    """The blocks of docs/python.md as one program."""
    pytest.importorskip("trimesh")
    page = (ROOT / "docs/python.md").read_text()
    blocks = re.findall(r"^(<!-- not run -->\n)?```python\n(.*?)^```", page, re.M | re.S)
    examples = [
        example.source
        for skipped, block in blocks
        if not skipped
        for example in doctest.DocTestParser().get_examples(block)
    ]
    assert len(examples) > 20
    assert errors_of("".join(examples), options, tmp_path, monkeypatch) == []


def test_what_is_wrong(options, tmp_path, monkeypatch):
    errors = errors_of(WRONG, options, tmp_path, monkeypatch)
    assert [int(line.split(":")[1]) for line in errors] == [4, 5, 6], errors


def test_the_package_itself(options):
    api = pytest.importorskip("mypy.api")
    report, errors, code = api.run([*options, os.path.dirname(raysheaf.__file__)])
    assert code == 0, report + errors
