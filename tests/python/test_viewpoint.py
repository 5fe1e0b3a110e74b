"""The viewpoint of an image, its light if the scene has none, and its background."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

import raysheaf


MODEL = """v 0 0 0
v 2 0 0
v 0 1 0
v 0 0 3
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""


def write_glb_seen_from(path, distance):
    """A triangle, and a camera at this distance."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.float32).tobytes()
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, distance]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": [-1, -1, 0],
                "max": [1, 1, 0],
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)}],
        "buffers": [{"byteLength": len(corners)}],
    }
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(corners)
    path.write_bytes(
        struct.pack("<III", 0x46546C67, 2, total)
        + struct.pack("<II", len(text), 0x4E4F534A)
        + text
        + struct.pack("<II", len(corners), 0x004E4942)
        + corners
    )


def spanned(picture):
    """The larger of the fractions of width and height that the scene covers."""
    rows, columns = np.nonzero(picture.inst_id != raysheaf.INVALID_ID)
    height, width = picture.inst_id.shape
    return max(np.ptp(rows) / height, np.ptp(columns) / width)


def test_models_fill_the_picture(tmp_path):
    (tmp_path / "a.obj").write_text(MODEL)
    for width, height in ((60, 40), (40, 90)):
        for more in ({}, {"view": "left"}, {"up": "-z", "orthographic": True}, {"fov": 20}):
            picture = raysheaf.render(tmp_path / "a.obj", width=width, height=height, **more)
            assert 0.8 < spanned(picture) < 1
    film = raysheaf.Animation(tmp_path / "a.obj")
    first = raysheaf.render(film, width=40, height=30)
    top = raysheaf.render(film, width=40, height=30, view="top")
    assert top != first == raysheaf.render(film, width=40, height=30)
    assert first == raysheaf.render(tmp_path / "a.obj", width=40, height=30)
    assert top == raysheaf.render(tmp_path / "a.obj", width=40, height=30, view="top")


def test_a_camera_that_shows_the_scene_small_is_not_the_default(tmp_path):
    (tmp_path / "a.obj").write_text(MODEL)
    scene = raysheaf.load(tmp_path / "a.obj")
    size = {"width": 60, "height": 40}
    far = raysheaf.render(scene, camera=raysheaf.pinhole((0, 0, 60), (0, 0, 0), **size), **size)
    assert spanned(far) < 0.2
    assert spanned(raysheaf.render(scene, **size)) > 0.8
    write_glb_seen_from(tmp_path / "far.glb", 60)
    write_glb_seen_from(tmp_path / "near.glb", 3)
    for seen in (tmp_path / "far.glb", raysheaf.Animation(tmp_path / "far.glb")):
        assert spanned(raysheaf.render(seen, **size)) > 0.8
        assert spanned(raysheaf.render(seen, camera=0, **size)) < 0.2
    near = raysheaf.render(tmp_path / "near.glb", **size)
    assert near == raysheaf.render(tmp_path / "near.glb", camera=0, **size)


def test_viewpoints_are_those_of_the_command_line(tmp_path):
    (tmp_path / "a.obj").write_text(MODEL)
    picture = raysheaf.render(
        tmp_path / "a.obj",
        width=48,
        height=32,
        camera_position=(4, 3, 6),
        look_at=[0.5, 0.5, 1],
        fov=50,
        zoom=1.5,
        up="z",
        background="#204060",
    )
    words = "--size 48x32 --camera-position 4,3,6 --look-at 0.5,0.5,1 --fov 50 --zoom 1.5 --up z"
    subprocess.run(
        [sys.executable, "-m", "raysheaf", "render", "a.obj", *words.split(), "-q"]
        + ["--background", "#204060", "--primary", "trace", "-o", "a.png"],
        cwd=tmp_path,
        check=True,
    )
    assert np.array_equal(pixels_of(tmp_path / "a.png"), picture.image)
    assert picture.image[0, 0].tolist() == [0x20, 0x40, 0x60]


def pixels_of(path):
    """Decodes an 8-bit PNG with three channels and any filters."""
    data, at, packed = path.read_bytes(), 8, b""
    width, height = struct.unpack(">II", data[16:24])
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    image = np.zeros((height + 1, 3 * width + 3), int)
    for y in range(height):
        for x in range(3, 3 * width + 3):
            left, up, corner = image[y + 1, x - 3], image[y, x], image[y, x - 3]
            guess = left + up - corner
            paeth = min((left, up, corner), key=lambda v: abs(guess - v))
            filters = (0, left, up, (left + up) // 2, paeth)
            image[y + 1, x] = (raw[y, x - 2] + filters[raw[y, 0]]) % 256
    return image[1:, 3:].reshape(height, width, 3)


def test_backgrounds_show_through(tmp_path):
    (tmp_path / "a.obj").write_text(MODEL)
    clear = raysheaf.render(tmp_path / "a.obj", width=40, height=30, background="transparent")
    assert clear.image.shape == (30, 40, 4)
    alpha = clear.image[..., 3]
    assert alpha.min() == 0 and alpha.max() == 255 and len(np.unique(alpha)) > 2
    white = raysheaf.render(tmp_path / "a.obj", width=40, height=30, background="white")
    assert (white.image[alpha == 0] == 255).all()
    assert (white.image[alpha == 255] == clear.image[alpha == 255][:, :3]).all()


def test_a_ground_catches_the_shadow(tmp_path):
    (tmp_path / "a.obj").write_text(MODEL)
    size = {"width": 60, "height": 45, "background": "transparent", "up": "z"}
    plain = raysheaf.render(tmp_path / "a.obj", **size)
    caught = raysheaf.render(tmp_path / "a.obj", ground=True, **size)
    alpha, shaded = plain.image[..., 3], caught.image[..., 3]
    assert (caught.image[alpha == 255] == plain.image[alpha == 255]).all()
    assert (shaded >= alpha).all() and ((shaded > 0) & (alpha == 0)).sum() > 50
    assert np.array_equal(caught.inst_id, plain.inst_id) and caught.exposure == plain.exposure
    subprocess.run(
        [sys.executable, "-m", "raysheaf", "render", "a.obj", "--size", "60x45", "--up", "z"]
        + ["--ground", "--background", "white", "--primary", "trace", "-q", "-o", "a.png"],
        cwd=tmp_path,
        check=True,
    )
    white = raysheaf.render(tmp_path / "a.obj", ground=True, **{**size, "background": "white"})
    assert np.array_equal(pixels_of(tmp_path / "a.png"), white.image)
    film = raysheaf.Animation(tmp_path / "a.obj")
    assert raysheaf.render(film, ground=True, **size) == caught
    assert raysheaf.render(film, **size) == plain
    dot = raysheaf.Scene()
    dot.add([[1, 2, 3]] * 3, [[0, 1, 2]])
    with pytest.raises(raysheaf.InvalidError, match="ground: the scene has no extent"):
        raysheaf.render(dot, width=8, height=8, ground=True)


@pytest.mark.parametrize(
    "wrong, place",
    [
        ({"view": "under"}, "view"),
        ({"up": "w"}, "up"),
        ({"zoom": 0}, "zoom"),
        ({"zoom": float("nan")}, "zoom"),
        ({"fov": 180}, "fov"),
        ({"fov": -1}, "fov"),
        ({"fov": 40, "orthographic": True}, "fov"),
        ({"look_at": (0, 0, 0)}, "look_at"),
        ({"camera_position": (1, 2)}, "camera_position"),
        ({"camera_position": (1, 2, float("inf"))}, "camera_position"),
        ({"camera_position": (1, 2, 3), "look_at": (1, 2, 3)}, "look_at"),
        ({"camera_position": (1, 9, 1), "look_at": (1, 2, 1)}, "up"),
        ({"view": "top", "camera_position": (9, 9, 9)}, "view"),
        ({"view": "top", "camera": 0}, "view"),
        ({"background": "mauve"}, "background"),
    ],
)
def test_nonsense_about_the_viewpoint_is_refused(wrong, place):
    with pytest.raises(ValueError) as caught:
        raysheaf.render("builtin:cornell", width=8, height=8, **wrong)
    assert str(caught.value).startswith(place)
