"""Scenes that are copied, pickled, loaded, and shown."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

TRIANGLE = np.array([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], np.float32)
PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
WAYS = [
    copy.copy,
    copy.deepcopy,
    lambda scene: scene.copy(),
    *(lambda scene, p=p: pickle.loads(pickle.dumps(scene, p)) for p in PROTOCOLS),
]


def varied_scene() -> raysheaf.Scene:
    """Gaps in the ids, instances with masks and transforms, a soup, surfaces."""
    setting = make_setting(3)
    scene = raysheaf.Scene(threads=1)
    scene.remove(scene.add(TRIANGLE))
    mesh = scene.add(setting.vertices, setting.triangles, mask=3)
    scene.remove_instance(scene.instance(mesh))
    scene.instance(mesh, [[1, 0, 0, 1], [0, -2, 0, 0], [0, 0, 1, 0]], mask=4)
    red = raysheaf.Material(base_color=(0.8, 0.1, 0.1), name="red")
    scene.add(TRIANGLE, normals=TRIANGLE, uv=TRIANGLE[:, :2], material=red)
    scene.remove_instance(scene.instance(mesh))
    scene.lights.append(raysheaf.Light(position=(0, 0, -9), intensity=100))
    return scene


@pytest.mark.parametrize("way", WAYS)
def test_another_answers_alike(way):
    setting = make_setting(4)
    scene = varied_scene()
    other = way(scene)
    assert repr(other) == repr(scene) and other.threads == 1
    for mask in (raysheaf.INVALID_ID, 1, 4):
        rays = setting.origins, setting.directions
        mine, theirs = (s.closest_hit(*rays, mask=mask).array for s in (scene, other))
        assert mine.tobytes() == theirs.tobytes()
    assert other.meshes == scene.meshes and other.materials == scene.materials
    assert np.array_equal(other.surface(2).uv, scene.surface(2).uv)
    size = {"width": 24, "height": 24}
    assert raysheaf.render(other, **size) == raysheaf.render(scene, **size)
    # The ids go on, and nothing is shared.
    assert other.add(TRIANGLE) == scene.add(TRIANGLE)
    assert other.instances(3) == scene.instances(3)
    other.materials[0].roughness = 0.5
    assert scene.materials[0].roughness == 1.0
    other.update(2, TRIANGLE + 1)
    assert np.array_equal(scene.vertices(2), TRIANGLE)


class Named(raysheaf.Scene):
    """Has something of its own."""

    def __init__(self, name):
        super().__init__()
        self.name = name


@pytest.mark.parametrize("way", WAYS)
def test_subclasses(way):
    scene = Named(["a"])
    scene.add(TRIANGLE)
    other = way(scene)
    assert type(other) is Named and other.name == ["a"] and other.triangle_count() == 1


def test_what_refers_to_each_other():
    scene = varied_scene()
    first, second = copy.deepcopy([scene, scene])
    assert first is second and first is not scene


def test_changes_that_wait():
    scene = raysheaf.Scene()
    scene.add(TRIANGLE)
    assert not scene.copy().committed
    scene.add(TRIANGLE, transform=np.diag([1, 1, 1e19, 1]))
    other = scene.copy()
    with pytest.raises(raysheaf.InvalidError, match=r"instances\[1\].transform"):
        other.commit()


@pytest.mark.parametrize("name", ["cornell", "office"])
def test_what_is_loaded_is_shown_as_the_file(name):
    scene = raysheaf.load(f"builtin:{name}")
    size = {"width": 40, "height": 30, "samples": 1}
    picture = raysheaf.render(f"builtin:{name}", **size)
    assert raysheaf.render(scene, **size) == picture
    assert raysheaf.render(scene, camera=scene.cameras[0], **size) == picture
    assert raysheaf.render(pickle.loads(pickle.dumps(scene)), **size) == picture
    seen = scene.closest_hit(scene.cameras[0].rays(40, 30))
    assert (seen.prim_id == picture.prim_id).mean() > 0.999
    assert (seen.inst_id == picture.inst_id).mean() > 0.999


def test_a_file(tmp_path):
    (tmp_path / "a.mtl").write_text("newmtl red\nKd 1 0 0\n")
    (tmp_path / "a.obj").write_text(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n"
        "usemtl red\nf 1/1/1 2/2/1 3/3/1\n"
    )
    scene = raysheaf.load(tmp_path / "a.obj")
    assert scene.triangle_count() == 1 and scene.materials[0].name == "red"
    assert scene.surface(0).normals.tolist() == [[0, 0, 1]] * 3
    assert scene.surface(0).uv.shape == (3, 2)
    size = {"width": 16, "height": 16}
    assert raysheaf.render(scene, **size) == raysheaf.render(tmp_path / "a.obj", **size)
    with pytest.raises(raysheaf.NotFoundError):
        raysheaf.load(tmp_path / "b.obj")
    with pytest.raises(raysheaf.NotFoundError, match="nothing"):
        raysheaf.load("builtin:nothing")
    with pytest.raises(TypeError, match="^path: 3 is given"):
        raysheaf.load(3)
    with pytest.raises(ValueError, match="^time: NaN"):
        raysheaf.load(tmp_path / "a.obj", time=float("nan"))


def test_scenes_are_shown_as_they_are_now():
    scene = raysheaf.Scene()
    hidden = scene.add(TRIANGLE + 5, mask=0)
    mesh = scene.add(TRIANGLE)
    scene.remove(hidden)
    rays = raysheaf.pinhole((0, 0, 5), (0, 0, 0), width=32, height=32)
    picture = raysheaf.render(scene, camera=rays)
    hits = scene.closest_hit(rays)
    for name in ("prim_id", "geom_id", "inst_id"):
        assert np.array_equal(getattr(picture, name), hits[name])
    assert (picture.geom_id == mesh).any() and picture.image.shape == (32, 32, 3)
    np.testing.assert_allclose(picture.position[hits.hit][:, 2], 1, atol=1e-5)
    scene.set_transform(scene.instances(mesh)[0], np.diag([0.1, 0.1, 0.1, 1]))
    assert (raysheaf.render(scene, camera=rays).geom_id == mesh).sum() < hits.hit.sum() / 4
    assert np.array_equal(np.asarray(picture), picture.image)
    with pytest.raises(raysheaf.InvalidError):
        raysheaf.render(raysheaf.Scene())
    with pytest.raises(ValueError, match="^time: a Scene is at one time"):
        raysheaf.render(scene, time=0)


def test_lights():
    scene = raysheaf.Scene()
    scene.add(TRIANGLE, material=raysheaf.Material(base_color=(1, 1, 1)))
    ask = {"camera": raysheaf.pinhole((0, 0, 5), (0, 0, 0), width=16, height=16), "exposure": 1}
    dim = raysheaf.render(scene, lights=[raysheaf.Light(position=(0, 0, 3), intensity=1)], **ask)
    two = raysheaf.render(
        scene, lights=[raysheaf.Light(position=(0, 0, 3), intensity=(2, 2, 2))], **ask
    )
    np.testing.assert_allclose(two.beauty[8, 8], 2 * dim.beauty[8, 8], rtol=0.1)
    with pytest.raises(TypeError, match="^lights: 3 is given"):
        raysheaf.render(scene, lights=[3], **ask)
    with pytest.raises(ValueError, match="^lights: an Animation"):
        raysheaf.render(raysheaf.Animation("builtin:cornell"), lights=[])
    with pytest.raises(ValueError, match="^direction"):
        raysheaf.render(scene, lights=[raysheaf.Light("directional", direction=(0, 0, 0))], **ask)
    with pytest.raises(ValueError, match="^type: 'sun'"):
        raysheaf.render(scene, lights=[raysheaf.Light("sun")], **ask)


def test_what_meshes_carry_is_looked_over():
    scene = raysheaf.Scene()
    for name, wrong, words in [
        ("normals", np.zeros((2, 3)), "3 vertices"),
        ("uv", np.zeros((3, 3)), r"shape \(3, 2\)"),
        ("material", [0], "0 materials"),
        ("material", "red", "red"),
    ]:
        with pytest.raises((TypeError, ValueError), match=f"^{name}: .*{words}"):
            scene.add(TRIANGLE, **{name: wrong})
    assert scene.meshes == []
    mesh = scene.add(TRIANGLE, normals=TRIANGLE)
    scene.update(mesh, TRIANGLE, normals=-TRIANGLE)
    assert np.array_equal(scene.surface(mesh).normals, -TRIANGLE)
    scene.update(mesh, TRIANGLE)
    assert scene.surface(mesh).normals is None
    scene.replace(mesh, TRIANGLE, material=raysheaf.Material())
    scene.replace(mesh, np.concatenate([TRIANGLE, TRIANGLE]))
    assert scene.surface(mesh).materials.tolist() == [0]
    with pytest.raises(raysheaf.NotFoundError):
        scene.surface(7)
