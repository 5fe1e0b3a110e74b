"""The benchmark program: its mesh, and a run of a small size."""

from __future__ import annotations

import importlib.util
import json

import numpy as np
import pytest

import raysheaf
from raysheaf import bench


def test_the_mesh_is_closed():
    vertices, faces = bench.wavy_ball(1000, phase=0.5)
    assert 800 < len(faces) < 1200 and np.isfinite(vertices).all()
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert len(np.unique(faces)) == len(vertices)


def test_a_small_run(tmp_path, capsys):
    path = tmp_path / "bench.json"
    assert (
        bench.main(["--rays", "2000", "--triangles", "500", "--rounds", "1", "--json", str(path)])
        == 0
    )
    printed = capsys.readouterr().out
    assert "first hit  static" in printed and "all hits   moving" in printed
    has_peer = all(importlib.util.find_spec(name) for name in ("trimesh", "embreex"))
    assert has_peer or "is not installed" in printed
    rows = json.loads(path.read_text())["rows"]
    assert len(rows) == 6
    for row in rows:
        assert min(row["seconds"].values()) > 0
        if row["kind"] != "all":
            # 2 of 2000 may differ, because of rounding at silhouettes.
            assert np.ptp(list(row["hits"].values())) <= 2
        assert row["hits"]["scene"] > 500


def test_missing_packages_are_reported(monkeypatch):
    monkeypatch.setattr(bench.importlib.util, "find_spec", lambda name: None)
    who, notes = bench.contenders(*bench.wavy_ball(100), bench.Where(threads=1))
    assert list(who) == ["scene"] and notes == [
        "trimesh is not installed: only raysheaf.Scene is measured"
    ]


def refused(arguments, capsys) -> str:
    """The error message for these arguments, before anything runs."""
    with pytest.raises(SystemExit) as stopped:
        bench.main(arguments)
    printed = capsys.readouterr()
    assert stopped.value.code == 2 and printed.out == ""
    return printed.err


@pytest.mark.parametrize("name", bench.BATCHES)
def test_batches_hit_the_mesh(name):
    origins, directions = bench.BATCHES[name](4000)
    assert origins.shape == directions.shape and abs(len(origins) - 4000) < 100
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    scene = raysheaf.Scene()
    scene.add(*bench.wavy_ball(2000))
    assert scene.any_hit(origins, directions).mean() > 0.6


def test_a_device_that_is_not_there(capsys):
    try:
        raysheaf.Scene(device="cuda")
        pytest.skip("there is a CUDA device")
    except raysheaf.UnsupportedError:
        pass
    assert "CUDA" in refused(["--device", "cuda"], capsys)


@pytest.mark.parametrize("wrong", [["--rays", "0"], ["--triangles", "3"], ["--rounds", "0"]])
def test_wrong_sizes(wrong, capsys):
    assert "must be at least" in refused(wrong, capsys)


def test_errors_are_reported_before_the_run(tmp_path, capsys):
    assert "threads: 5000 is given" in refused(["--threads", "5000"], capsys)
    nowhere = tmp_path / "no folder" / "bench.json"
    assert "--json: [Errno 2]" in refused(["--json", str(nowhere)], capsys)
    assert "--json: [Errno 21]" in refused(["--json", str(tmp_path)], capsys)


def test_numbers_may_be_written_shorter(capsys):
    assert bench.arguments_of(["--rays", "1e6", "--triangles", "2.5e3"]).rays == 1_000_000
    for wrong in ("1.5", "1e-3", "inf", "nan", "many"):
        assert f"--rays: '{wrong}' is given; a whole number" in refused(["--rays", wrong], capsys)


def test_a_small_run_of_points(tmp_path, capsys):
    path = tmp_path / "points.json"
    arguments = ["--points", "--rays", "2000", "--triangles", "500", "--rounds", "1"]
    assert bench.main([*arguments, "--json", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "closest point    static" in printed and "signed distance  moving" in printed
    rows = json.loads(path.read_text())["rows"]
    assert len(rows) == 4
    for row in rows:
        assert min(row["seconds"].values()) > 0
        distance = row["distance"]
        assert 0.1 < distance["scene"] < 1
        for name in ("open3d", "adapter"):
            assert abs(distance.get(name, distance["scene"]) - distance["scene"]) < 1e-4
