"""The measuring program: its mesh, and a run at a size that takes no time."""

from __future__ import annotations

import importlib.util
import json

import numpy as np
import pytest

import raysheaf
from raysheaf import bench


def test_the_ball_is_closed():
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
            assert np.ptp(list(row["hits"].values())) <= 2  # of 2000; rounding at silhouettes
        assert row["hits"]["scene"] > 500


def test_it_says_what_is_missing(monkeypatch):
    monkeypatch.setattr(bench.importlib.util, "find_spec", lambda name: None)
    who, notes = bench.contenders(*bench.wavy_ball(100), bench.Where(threads=1))
    assert list(who) == ["scene"] and notes == [
        "trimesh is not installed: raysheaf.Scene runs alone"
    ]


@pytest.mark.parametrize("name", bench.BATCHES)
def test_batches_meet_the_ball(name):
    origins, directions = bench.BATCHES[name](4000)
    assert origins.shape == directions.shape and abs(len(origins) - 4000) < 100
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    scene = raysheaf.Scene()
    scene.add(*bench.wavy_ball(2000))
    assert scene.any_hit(origins, directions).mean() > 0.6


def test_a_device_that_is_not_there(monkeypatch):
    try:
        raysheaf.Scene(device="cuda")
        pytest.skip("there is a CUDA device")
    except raysheaf.UnsupportedError:
        pass
    with pytest.raises(raysheaf.UnsupportedError):
        bench.main(["--device", "cuda", "--rays", "10", "--triangles", "36", "--rounds", "1"])


@pytest.mark.parametrize("wrong", [["--rays", "0"], ["--triangles", "3"], ["--rounds", "0"]])
def test_wrong_sizes(wrong, capsys):
    with pytest.raises(SystemExit) as stopped:
        bench.main(wrong)
    assert stopped.value.code == 2 and "must be at least" in capsys.readouterr().err
