"""The examples write their images, and their results are right where these are known."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_render import decoded

FOLDER = Path(__file__).parents[2] / "examples" / "python"
NAMES = sorted(p.stem for p in FOLDER.glob("*.py") if p.stem != "pictures")


@pytest.fixture(autouse=True)
def _importable(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))


@pytest.mark.parametrize("name", NAMES)
def test_makes_its_picture(name, tmp_path):
    command = [sys.executable, str(FOLDER / f"{name}.py"), "-o", "out.png", "--size", "60"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    picture = (tmp_path / "out.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) > 300


@pytest.mark.parametrize("name", NAMES)
def test_the_gallery_shows_what_they_make(name, tmp_path):
    command = [sys.executable, str(FOLDER / f"{name}.py"), "-o", "out.png"]
    command += ["--size", "480"] if name == "ambient_occlusion" else []
    subprocess.run(command, check=True, cwd=tmp_path)
    kept = FOLDER.parents[1] / "docs/images" / f"example-{name.replace('_', '-')}.png"
    shown, made = (decoded(p.read_bytes()).astype(int) for p in (kept, tmp_path / "out.png"))
    assert shown.shape == made.shape and np.abs(shown - made).mean() < 1


def test_the_lidar_measures_walls_where_they_are():
    import lidar_sweep

    points = lidar_sweep.sweep(lidar_sweep.Street(cars=0), columns=40, beams=16)
    seen = points[np.isfinite(points[..., 0])]
    on_ground = np.abs(seen[:, 2]) < 1e-4
    on_wall = (np.abs(seen[:, 1] - 18) < 1e-3) | (np.abs(seen[:, 1] + 17.7) < 1e-3)
    assert (on_ground | on_wall).all() and on_wall.sum() > 20 and on_ground.sum() > 20


def test_the_lidar_sees_what_moves_where_it_is_then():
    import lidar_sweep

    street = lidar_sweep.Street(cars=1)
    begin, *_, end = street.scene.transforms(street.cars[0])
    moved = end[:, 3] - begin[:, 3]
    assert 2.5 < np.linalg.norm(moved) < 3.1  # 30 m/s for 0.1 s, along a circle
    columns = 90
    points = lidar_sweep.sweep(street, columns, beams=24)
    for column in range(0, columns, 7):
        still = lidar_sweep.Street(cars=1)
        angle = -30 / 6 * lidar_sweep.TURN * column / columns
        still.scene.set_transform(
            still.cars[0],
            lidar_sweep.moved(6 * np.cos(angle), 6 * np.sin(angle), angle + np.pi / 2),
        )
        there = lidar_sweep.sweep(still, columns, beams=24)
        np.testing.assert_allclose(points[column], there[column], atol=2e-3)


def test_a_camera_and_a_lidar_measure_one_room(tmp_path):
    import depth_and_lidar
    import raysheaf

    image, scan = depth_and_lidar.main(tmp_path / "both.png", 60)
    assert image.shape == (45, 60) and image.hit.mean() > 0.9 and scan.hit.mean() > 0.9
    optical, above = depth_and_lidar.poses(raysheaf.load("builtin:office").cameras[0])
    np.testing.assert_allclose(above[:3, 3] - optical[:3, 3], [0, 0.5, 0], atol=1e-6)
    np.testing.assert_allclose(above[:3, :3].T @ above[:3, :3], np.eye(3), atol=1e-6)
    assert np.abs(image.position - optical[:3, 3]).max() < 20


def test_line_of_sight_over_a_plain_and_behind_a_ridge(tmp_path):
    import line_of_sight

    flat = line_of_sight.main(tmp_path / "flat.png", 21, lambda x, y: 0 * x)
    assert flat.all()
    ridge = line_of_sight.main(
        tmp_path / "ridge.png", 41, lambda x, y: 300.0 * (x == -5000) + 200.0 * (x == 0)
    )
    assert ridge[:, 1:20].all() and not ridge[:, 25:].any()


def test_view_factors_of_parallel_squares_and_of_a_closed_room():
    import view_factors

    down = np.array([[0.0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]), np.array(
        [[0, 2, 1], [0, 3, 2]]
    )
    up = down[0] - [0, 0, 1], down[1][:, ::-1]
    factors = view_factors.view_factors([up, down], rays=100_000)
    np.testing.assert_allclose(factors, [[0, 0.19982], [0.19982, 0]], atol=1e-5)  # Hottel
    room = view_factors.room()
    factors = view_factors.view_factors(room, rays=40_000)
    np.testing.assert_allclose(factors.sum(axis=1), 1, atol=1e-9)
    areas = np.array([20, 20, 12.5, 12.5, 10, 10, 2 * 2 * 1.2 + 2 * 0.1 * 3.2])
    exchanged = areas[:, None] * factors
    np.testing.assert_allclose(exchanged, exchanged.T, atol=1e-3)  # reciprocity


def test_the_sun_and_its_hours():
    import shadow_study

    noon = shadow_study.suns(latitude=48.0, day=172, hours=12.0)
    assert np.isclose(np.degrees(np.arcsin(noon[2])), 90 - 48 + 23.45, atol=0.05)
    assert np.allclose(np.linalg.norm(shadow_study.suns(30, 10, np.arange(24)), axis=1), 1)
    morning = shadow_study.suns(48.0, 80, 8.0)
    assert morning[0] > 0  # in the east
    spots = np.array([[0.0, -500, 0.1], [0.0, 30, 0.1]])
    tower = shadow_study.box([-20, -20, 0], [20, 20, 200])
    south, north = shadow_study.hours_of_sun([tower], spots)
    assert 11.5 < south < 12.5 and north < south - 3  # an equinox
