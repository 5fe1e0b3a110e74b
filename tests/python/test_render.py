"""Rendered images, and the included command line program."""

from __future__ import annotations

import base64
import concurrent.futures
import copy
import dataclasses
import json
import os
import pickle
import re
import struct
import subprocess
import sys
import warnings
import zlib
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from conftest import interrupted_after

import raysheaf

UTC = timezone.utc


def decoded(png: bytes) -> np.ndarray:
    """Decodes an 8-bit PNG without filters, as `png_bytes` writes it."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, {}
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        kind, data = png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        assert (
            zlib.crc32(kind + data)
            == struct.unpack(">I", png[at + 8 + length : at + 12 + length])[0]
        )
        chunks[kind] = data
        at += 12 + length
    width, height, depth, colour = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    channels = {0: 1, 2: 3, 6: 4}[colour]
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, -1)
    assert depth == 8 and (rows[:, 0] == 0).all() and rows.shape[1] == 1 + width * channels
    return rows[:, 1:].reshape((height, width) + ((channels,) if channels > 1 else ()))


@pytest.mark.parametrize("shape", [(3, 5), (3, 5, 3), (1, 1, 4)])
def test_png_files_hold_what_was_written(tmp_path, shape):
    image = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    raysheaf.write_png(tmp_path / "a.png", image)
    assert np.array_equal(decoded((tmp_path / "a.png").read_bytes()), image)
    assert np.array_equal(decoded(raysheaf.png_bytes(image / 255)), image)


def test_masks_are_images():
    mask = np.random.default_rng(0).random((3, 5)) < 0.5
    assert np.array_equal(decoded(raysheaf.png_bytes(mask)), mask * 255)


def test_pictures_are_equal_where_their_arrays_are():
    first, again = (raysheaf.render("builtin:cornell", width=8, height=8) for _ in range(2))
    assert (first == again) is True and (first != again) is False
    assert first == pickle.loads(pickle.dumps(first)) == copy.deepcopy(first)
    again.beauty[0, 0, 0] += 1
    assert (first == again) is False and (first != again) is True
    assert first != raysheaf.render("builtin:cornell", width=8, height=9)
    assert first != dataclasses.replace(first, exposure=9) and first != 3
    with pytest.raises(TypeError, match="unhashable"):
        hash(first)


def test_gbuffers_are_opengls():
    try:
        plain = raysheaf.render("builtin:cornell", width=64, height=48, primary="raster")
    except raysheaf.Error as error:
        if error.code == "no_graphics":
            pytest.skip("no OpenGL 4.5 here")
        raise
    assert plain.gbuffer is None
    with_targets = {"width": 64, "height": 48, "primary": "raster", "gbuffer": True}
    drawn, again = (raysheaf.render("builtin:cornell", **with_targets) for _ in range(2))
    assert np.array_equal(drawn.beauty, plain.beauty) and drawn != plain and drawn == again
    targets = drawn.gbuffer
    assert all(t.shape == (48, 64, 4) and t.dtype == np.float32 for t in targets)
    seen = targets.position[..., 3] >= 0
    near = np.abs(targets.position[..., :3] - drawn.position).max(axis=-1) < 0.05
    assert near[seen].mean() > 0.9
    assert (targets.diffuse[..., 3] == seen).all()
    with pytest.raises(raysheaf.InvalidError, match="gbuffer"):
        raysheaf.render("builtin:cornell", width=8, height=8, gbuffer=True)


def test_wrong_images():
    assert decoded(raysheaf.png_bytes([[-1.0, 2.0, np.nan]])).tolist() == [[0, 255, 0]]
    with pytest.raises(ValueError, match=r"shape \(2, 2, 5\)"):
        raysheaf.png_bytes(np.zeros((2, 2, 5), np.uint8))
    for shape in ((), (3,), (0, 3), (1, 1, 1, 1)):
        with pytest.raises(ValueError, match=rf"^image: shape {re.escape(str(shape))} is given"):
            raysheaf.png_bytes(np.zeros(shape))
    with pytest.raises(TypeError, match="int64"):
        raysheaf.png_bytes(np.zeros((2, 2), int))


def test_a_built_in_scene():
    picture = raysheaf.render("builtin:cornell", width=40, height=30, bounces=1)
    assert picture.image.shape == (30, 40, 3) and picture.image.std() > 10
    assert picture.beauty.shape == picture.normal.shape == picture.albedo.shape == (30, 40, 3)
    seen = picture.prim_id != raysheaf.INVALID_ID
    assert seen.mean() > 0.9
    np.testing.assert_allclose(np.linalg.norm(picture.normal[seen], axis=1), 1, atol=1e-4)
    assert picture.shadow.shape == (30, 40) and 0 < picture.shadow.mean() < 1
    assert np.array_equal(decoded(picture._repr_png_()), picture.image)
    again = raysheaf.render(
        "builtin:cornell", width=40, height=30, bounces=1, method="brute", threads=1
    )
    assert np.array_equal(again.image, picture.image)


def test_a_file(tmp_path):
    path = tmp_path / "triangle.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    picture = raysheaf.render(path, width=32, height=32)
    assert 0.05 < (picture.geom_id == 0).mean() < 0.95
    picture.save(tmp_path / "out.png")
    assert decoded((tmp_path / "out.png").read_bytes()).shape == (32, 32, 3)


def test_paths_of_every_kind(tmp_path):
    path = tmp_path / "tri\xe4ngle.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name in (path, str(path), os.fsencode(path)):
        assert raysheaf.render(name, width=8, height=8).image.shape == (8, 8, 3)
        assert "ngle.obj" in repr(raysheaf.Animation(name))
    raysheaf.write_png(os.fsencode(tmp_path / "a.png"), [[0.5]])
    assert (tmp_path / "a.png").exists()
    with pytest.raises(ValueError, match="^scene: .*null character"):
        raysheaf.Animation("builtin:cornell\0x")
    with pytest.raises(TypeError, match="^path: 3 is given"):
        raysheaf.write_png(3, [[0.5]])
    with pytest.raises(ValueError, match="^path: .*null character"):
        raysheaf.write_png("a\0.png", [[0.5]])
    with pytest.raises(TypeError, match="^image: cannot be read"):
        raysheaf.write_png(tmp_path / "b.png", [[1, 2], [3]])
    assert not (tmp_path / "b.png").exists()


@pytest.mark.parametrize(
    "kind, message, given",
    [
        (LookupError, "nowhere", dict(scene="builtin:nowhere")),
        (raysheaf.Error, "missing.glb", dict(scene="missing.glb")),
        (LookupError, 'camera: .*"backstage"', dict(camera="backstage")),
        (ValueError, 'there is no method "magic"', dict(method="magic")),
        (ValueError, "width: .*0", dict(width=0)),
        (ValueError, "primary: 'magic' is given", dict(primary="magic")),
        (TypeError, "height: 1.5 is given", dict(height=1.5)),
        (TypeError, "^camera: None is given; a str or an integer", dict(camera=None)),
        (TypeError, "^camera: 1.5 is given", dict(camera=1.5)),
        (LookupError, 'camera: .*"-1"', dict(camera=np.int64(-1))),
        (ValueError, r"^camera: 'a\\udc80' is given, which UTF-8", dict(camera="a\udc80")),
        (TypeError, "^method: None is given; a str", dict(method=None)),
        (TypeError, "^exposure: '1' is given; a real number", dict(exposure="1")),
        (TypeError, "^exposure: 'a' is given", dict(exposure="a")),
        (TypeError, "^aperture: 1j is given", dict(aperture=1j)),
        (TypeError, r"^focus: \[1\] is given", dict(focus=[1])),
        (ValueError, "^focus: 10+ is given; a float", dict(focus=10**400)),
        (TypeError, "^time: 'a' is given; a real number", dict(time="a")),
        (TypeError, r"^time: \[1\] is given", dict(time=[1])),
        (TypeError, "^environment: 3 is given; a str, bytes or os.PathLike", dict(environment=3)),
        (LookupError, "sky.hdr: no such file", dict(environment=b"sky.hdr")),
        (ValueError, r"^environment: 'a\\x00' has a null character", dict(environment="a\0")),
        (ValueError, "^sun: environment is given, too", dict(sun=(0, 1, 0), environment="a.hdr")),
        (ValueError, r"^sun: \(1, 2\) is given; three real numbers", dict(sun=(1, 2))),
        (TypeError, "^sun: 'up' is given; three real numbers", dict(sun="up")),
        (TypeError, "^sun: 'a' is given; a real number", dict(sun=(0, 1, "a"))),
        (ValueError, "^sun: the sun is below the horizon", dict(sun=(0, -1, 0))),
        (ValueError, "^sun: .* with a tzinfo", dict(sun=(48, 11, datetime(2026, 6, 21)))),
        (ValueError, "^sun: 91 and 0 are given", dict(sun=(91, 0, datetime(2026, 6, 21, tzinfo=UTC)))),
        (TypeError, "^scene: None is given; a str, bytes or os.PathLike", dict(scene=None)),
        (ValueError, r"^scene: 'a\\x00b' has a null character", dict(scene="a\0b")),
        (ValueError, r"^scene: '\\udcff.obj' is given, which UTF-8", dict(scene=b"\xff.obj")),
    ],
)
def test_invalid_arguments(kind, message, given):
    with pytest.raises(kind, match=message):
        raysheaf.render(**{"scene": "builtin:cornell", "width": 8, "height": 8, **given})


def test_samples_a_lens_and_an_environment(tmp_path):
    def picture(**options):
        return raysheaf.render("builtin:cornell", width=12, height=12, bounces=0, **options)

    np.testing.assert_array_equal(picture(samples=1).beauty, picture().beauty)  # it is built in
    assert np.any(picture(samples=2).beauty != picture().beauty)
    near, far = (picture(samples=4, aperture=9, focus=depth).beauty for depth in (20, 90))
    assert np.any(near != far)
    sky = tmp_path / "sky.hdr"
    sky.write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n" + bytes([200, 100, 50, 129]))
    assert np.any(picture(samples=2, environment=sky).beauty != picture(samples=2).beauty)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture(environment=sky)
    below = picture()
    below = dataclasses.replace(below, beauty=below.beauty - 1000)
    below.save(tmp_path / "below.exr")
    film = raysheaf.Animation("builtin:cornell")
    for scene in "builtin:cornell", film, film:
        with pytest.warns(UserWarning, match="below.exr is clamped: 144 pixels are negative") as told:
            raysheaf.render(scene, width=4, height=4, environment=tmp_path / "below.exr")
        assert len(told) == 1 and told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        raysheaf.render(film, width=4, height=4)
    sky.write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n")
    with pytest.raises(raysheaf.InvalidError, match="sky.hdr"):
        picture(environment=sky)


def test_tells_what_a_file_lacks(tmp_path):
    path = tmp_path / "triangle.obj"
    path.write_text("mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    film = raysheaf.Animation(path)
    for scene in path, film:
        with pytest.warns(UserWarning, match="missing.mtl") as told:
            raysheaf.render(scene, width=4, height=4)
        assert len(told) == 1 and told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        raysheaf.render(film, width=4, height=4)  # has told it
    names = "".join(f"newmtl m{i}\nmap_Kd missing{i}.png\n" for i in range(12))
    (tmp_path / "missing.mtl").write_text(names)
    used = "".join(f"usemtl m{i}\nf 1/1 2/1 3/1\n" for i in range(12))
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
    path.write_text("mtllib missing.mtl\n" + corners + used)
    with pytest.warns(UserWarning, match="missing0.png") as told:
        raysheaf.render(path, width=4, height=4)
    assert len(told) == 9 and str(told[-1].message).startswith("4 more")


def test_files_have_four_samples_and_a_grey_background(tmp_path):
    path = tmp_path / "triangle.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    size = dict(width=16, height=16)
    picture = raysheaf.render(path, **size)
    assert picture == raysheaf.render(path, samples=4, **size)
    assert picture != raysheaf.render(path, samples=1, **size)
    for other in (picture, raysheaf.render(path, exposure=5, **size)):
        np.testing.assert_array_equal(other.image[0, -1], [226, 226, 226])
    built_in = raysheaf.render("builtin:cornell", **size)
    assert built_in == raysheaf.render("builtin:cornell", samples=1, **size)


def test_the_sun_is_a_direction_or_a_place_and_a_time(tmp_path):
    path = tmp_path / "wall.obj"
    path.write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    size = dict(width=16, height=16, samples=2, view="front")
    front = raysheaf.render(path, sun=(0, 1, 2), **size)
    behind = raysheaf.render(path, sun=(0, 1, -2), **size)
    assert front.beauty[8, 8, 1] > 2 * behind.beauty[8, 8, 1]
    assert np.any(front.image[0, 0] != [226, 226, 226])
    # In the north, the noon sun is in the south, which is in front of the wall.
    noon = datetime(2026, 6, 21, 11, 14, tzinfo=UTC)
    placed = raysheaf.render(path, sun=(48.1, 11.6, noon), **size)
    later = noon.astimezone(timezone(timedelta(hours=2)))
    assert placed == raysheaf.render(path, sun=(48.1, 11.6, later), **size)
    assert placed.beauty[8, 8, 1] > 2 * behind.beauty[8, 8, 1]
    film = raysheaf.Animation(path)
    plain = raysheaf.render(film, **size)
    assert raysheaf.render(film, sun=(0, 1, 2), **size) == front
    assert raysheaf.render(film, **size) == plain


def test_ctrl_c_is_heard():
    with interrupted_after(0.3):
        raysheaf.render("builtin:atrium", width=2048, height=2048, method="brute")
    assert raysheaf.render("builtin:cornell", width=8, height=8).image.shape == (8, 8, 3)


@pytest.mark.skipif(
    not (Path(raysheaf.__file__).parent / "bin" / "raysheaf").exists(),
    reason="built without the command line",
)
def test_the_command_line(tmp_path):
    def run(*arguments):
        command = [sys.executable, "-m", "raysheaf", *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)

    assert raysheaf.__version__ in run("--version").stdout
    done = run("render", "builtin:cornell", "-o", "c.png", "--size", "16x16", "--primary", "trace")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "c.png").read_bytes().startswith(b"\x89PNG")
    failed = run("render", "missing.glb", "-o", "c.png")
    assert failed.returncode != 0 and "missing.glb" in failed.stderr


# Two triangles; the node of the second moves from x = 0 to x = 4 within two seconds.
MOVING = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2]}],
    "nodes": [
        {"mesh": 0},
        {"mesh": 0, "name": "goes"},
        {"camera": 0, "translation": [2, 0, 9]},
    ],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "animations": [
        {
            "name": name,
            "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
            "samplers": [{"input": 1, "output": output}],
        }
        for name, output in (("right", 2), ("left", 3))
    ],
    "accessors": [
        {
            "bufferView": 0,
            "componentType": 5126,
            "count": 3,
            "type": "VEC3",
            "min": [0, 0, 0],
            "max": [1, 1, 0],
        },
        {
            "bufferView": 1,
            "componentType": 5126,
            "count": 2,
            "type": "SCALAR",
            "min": [0],
            "max": [2],
        },
        {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"},
        {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
    ],
    "bufferViews": [
        {"buffer": 0, "byteOffset": at, "byteLength": size}
        for at, size in ((0, 36), (36, 8), (44, 24), (68, 24))
    ],
}


@pytest.fixture
def moving(tmp_path):
    numbers = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 2, 0, 0, 1, 4, 0, 1, 0, 0, 1, -4, 0, 1]
    data = base64.b64encode(np.array(numbers, "<f4").tobytes()).decode()
    uri = f"data:application/octet-stream;base64,{data}"
    path = tmp_path / "moving.gltf"
    path.write_text(json.dumps({**MOVING, "buffers": [{"byteLength": 92, "uri": uri}]}))
    return path


def same(a: raysheaf.Picture, b: raysheaf.Picture) -> bool:
    return np.array_equal(a.image, b.image) and np.array_equal(a.beauty, b.beauty)


def test_animations_are_pictures_at_times(moving):
    size = {"width": 64, "height": 32, "exposure": 1}
    film = raysheaf.Animation(moving)
    assert (film.start, film.end, film.clips) == (0, 2, ["right", "left"])
    assert film.frame_times == []
    assert "0 to 2 s" in repr(film)
    pictures = [raysheaf.render(film, time=t, **size) for t in (0, 1, 2, 1, 99)]
    assert same(pictures[1], pictures[3]) and same(pictures[2], pictures[4])
    assert not same(pictures[0], pictures[1]) and not same(pictures[1], pictures[2])
    for time, picture in zip((0, 1, 2), pictures):
        assert same(picture, raysheaf.render(moving, time=time, **size))
        x = picture.position[picture.inst_id == 1][:, 0]
        assert 2 * time <= x.min() and x.max() <= 2 * time + 1
    film.play("left")
    assert same(raysheaf.render(film, **size), pictures[0])
    assert not same(raysheaf.render(film, time=2, **size), pictures[2])
    film.play(0)
    assert same(raysheaf.render(film, time=2, **size), pictures[2])


def test_numbers_of_cameras_come_before_names_that_are_digits(moving):
    scene = json.loads(moving.read_text())
    camera = scene["cameras"][0]
    scene["cameras"] = [{**camera, "name": "1"}, {**camera, "name": "0"}]
    scene["nodes"][2]["name"] = "1"
    scene["nodes"][2]["translation"] = [0.5, 0, 2]  # shows the scene
    scene["nodes"].append({"camera": 1, "translation": [2, 0, 20], "name": "0"})
    scene["scenes"][0]["nodes"].append(3)
    moving.write_text(json.dumps(scene))
    for shown in (moving, raysheaf.Animation(moving)):
        first, second, named, other = (
            raysheaf.render(shown, camera=camera, width=64, height=32, exposure=1)
            for camera in (0, np.uint8(1), "1", "0")
        )
        assert same(first, named) and same(second, other) and not same(first, second)
        assert same(first, raysheaf.render(shown, width=64, height=32, exposure=1))
    with pytest.raises(LookupError, match='camera: .*"2"; its cameras are 0 "1", 1 "0"'):
        raysheaf.render(moving, camera=2)


def test_animations_are_not_copied(moving):
    film = raysheaf.Animation(moving)
    for call in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="an animation can neither be copied nor pickled"):
            call(film)


def test_animations_refuse_what_is_wrong(moving, tmp_path):
    film = raysheaf.Animation(str(moving))
    with pytest.raises(raysheaf.NotFoundError, match="clip: there is no 'up'; there is right, left"):
        film.play("up")
    with pytest.raises(raysheaf.NotFoundError):
        film.play(2)
    with pytest.raises(ValueError, match="clip"):
        film.play(-1)
    with pytest.raises(ValueError, match="time: NaN"):
        raysheaf.render(film, time=float("nan"))
    with pytest.raises(raysheaf.NotFoundError, match="missing"):
        raysheaf.Animation(tmp_path / "missing.gltf")
    with pytest.raises(ValueError, match="width"):
        raysheaf.render(film, width=0)
    assert raysheaf.render(film, width=8, height=8).image.shape == (8, 8, 3)


def test_an_animation_by_another_light(moving, tmp_path):
    sky = tmp_path / "sky.hdr"
    sky.write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n" + bytes([200, 100, 50, 129]))
    size = {"width": 16, "height": 8, "exposure": 1, "samples": 2}
    film = raysheaf.Animation(moving)
    plain = raysheaf.render(film, time=1, **size)
    lit = raysheaf.render(film, time=1, environment=sky, **size)
    assert not same(plain, lit)
    assert same(lit, raysheaf.render(moving, time=1, environment=sky, **size))
    assert same(plain, raysheaf.render(film, time=1, **size))
    with pytest.raises(raysheaf.Error, match="none.hdr"):
        raysheaf.render(film, time=1, environment=tmp_path / "none.hdr", **size)
    assert same(plain, raysheaf.render(film, time=1, **size))


def test_one_thread_at_a_time_uses_an_animation(moving):
    size = {"width": 32, "height": 16, "exposure": 1}
    times = [0.25 * i for i in range(8)]
    expected = [raysheaf.render(moving, time=t, **size) for t in times]
    film = raysheaf.Animation(moving)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda t: raysheaf.render(film, time=t, **size), times))
    assert all(same(a, b) for a, b in zip(made, expected))


def test_one_side_of_a_size_follows_from_the_camera():
    scene = raysheaf.Scene()
    scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    wide = raysheaf.Camera(np.eye(3, 4), aspect_ratio=2)
    rays = raysheaf.pinhole((0, 0, 4), (0, 0, 0), width=60, height=20)
    for camera, width, shape in (wide, 16, (8, 16)), (rays, 30, (10, 30)), ("", 16, (16, 16)):
        assert raysheaf.render(scene, camera=camera, width=width).shadow.shape == shape
    assert raysheaf.render(scene, camera=rays, height=10).shadow.shape == (10, 30)
    assert raysheaf.render(scene, camera=wide, height=8).shadow.shape == (8, 16)


def test_pictures_are_saved_as_their_names_say(tmp_path):
    picture = raysheaf.render("builtin:cornell", width=16, height=8, background="transparent")
    for name, begin in (
        ("a.png", b"\x89PNG"),
        ("a.PNG", b"\x89PNG"),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.jpeg", b"\xff\xd8\xff"),
        ("a.exr", b"\x76\x2f\x31\x01"),
    ):
        picture.save(tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(begin)
    text = (tmp_path / "a.exr").read_bytes()
    assert all(name in text for name in (b"normal.X", b"albedo.R", b"shadow.V", b"position.Z"))
    lit = raysheaf.render("builtin:cornell", width=8, height=8, environment=tmp_path / "a.exr")
    assert lit.image.shape == (8, 8, 3)
    for name in "a.bmp", "a", "a.png.tga":
        with pytest.raises(ValueError, match="^path: .*a name that ends in .png, .jpg, .jpeg or .exr"):
            picture.save(tmp_path / name)
        assert not (tmp_path / name).exists()
