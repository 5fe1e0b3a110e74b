"""Scenes that change between queries, and while threads use them."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

TRIANGLE = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.float32)
UP = [0, 0, 0], [0, 0, 1]


def lifted(z: float) -> np.ndarray:
    return TRIANGLE + np.float32([0, 0, z])


def test_a_moving_mesh_equals_a_new_one():
    setting = make_setting(11)
    scene = raysheaf.Scene()
    mesh = scene.add(setting.vertices, setting.triangles)
    rng = np.random.default_rng(0)
    vertices = setting.vertices.copy()
    for _ in range(6):
        vertices += rng.normal(scale=0.05, size=vertices.shape).astype(np.float32)
        scene.update(mesh, vertices)
        fresh = raysheaf.Scene()
        fresh.add(vertices, setting.triangles)
        rays = setting.origins, setting.directions
        moved = scene.closest_hit(*rays)
        assert moved.array.tobytes() == fresh.closest_hit(*rays).array.tobytes()
        assert moved.array.tobytes() == scene.closest_hit(*rays, method="brute").array.tobytes()
        assert np.array_equal(scene.hit_counts(*rays), fresh.hit_counts(*rays))


def test_queries_commit_what_has_changed():
    scene = raysheaf.Scene()
    mesh = scene.add(lifted(1), [[0, 1, 2]])
    assert not scene.committed
    assert scene.closest_hit(*UP).t == 1
    assert scene.committed
    for change, t in [
        (lambda: scene.update(mesh, lifted(2)), 2),
        (lambda: scene.replace(mesh, lifted(3), [[0, 1, 2], [0, 1, 2]]), 3),
        (lambda: scene.set_transform(0, np.diag([1, 1, 2, 1])), 6),
        (lambda: scene.instance(mesh), 3),
        (lambda: scene.remove_instance(1), 6),
        (lambda: scene.set_mask(0, 0), np.inf),
        (lambda: scene.set_mask(0, 1), 6),
        (lambda: scene.remove(mesh), np.inf),
    ]:
        change()
        assert scene.closest_hit(*UP).t == t
    scene.add(lifted(9))
    scene.commit()
    assert scene.committed and scene.closest_hit(*UP).geom_id == 1


def test_contents_of_a_scene():
    scene = raysheaf.Scene(threads=1)
    first = scene.add(lifted(1), [[0, 1, 2]])
    second = scene.add(np.concatenate([lifted(2), lifted(3)]))
    scene.instance(second, [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]])
    assert scene.meshes == [first, second] == [0, 1]
    assert first in scene and 7 not in scene
    assert scene.instances(second) == [1, 2]
    assert scene.vertex_count(second) == 6
    assert scene.triangle_count(second) == 2 and scene.triangle_count() == 5
    np.testing.assert_array_equal(scene.bounds, [[-1, -1, 1], [6, 1, 3]])
    assert scene.memory_bytes > 0
    assert repr(scene) == (
        "<raysheaf.Scene: 2 meshes, 3 instances, 5 triangles, from (-1, -1, 1) to (6, 1, 3)>"
    )
    assert repr(raysheaf.Scene()) == "<raysheaf.Scene: 0 meshes, 0 instances, 0 triangles>"
    assert repr(scene.closest_hit(*UP)) == "<raysheaf.Hits of shape (): 1 of 1 hit>"
    assert repr(scene.all_hits([UP[0]], UP[1])) == "<raysheaf.HitRows of shape (1,): 3 hits>"


def test_missing_meshes_and_instances():
    scene = raysheaf.Scene()
    mesh = scene.add(TRIANGLE)
    scene.remove(mesh)
    for call in [
        lambda: scene.update(mesh, TRIANGLE),
        lambda: scene.replace(mesh, TRIANGLE),
        lambda: scene.remove(mesh),
        lambda: scene.instance(mesh),
        lambda: scene.instances(mesh),
        lambda: scene.triangle_count(mesh),
    ]:
        with pytest.raises(raysheaf.NotFoundError, match=r"meshes\[0\]: this mesh was removed"):
            call()
    with pytest.raises(LookupError, match=r"instances\[3\]: there is no such instance"):
        scene.set_transform(3, None)
    with pytest.raises(TypeError, match="mesh: 'a' is given"):
        scene.remove("a")
    with pytest.raises(ValueError, match="threads: 2000 is given"):
        raysheaf.Scene(threads=2000)


def test_a_refused_change_changes_nothing():
    scene = raysheaf.Scene()
    mesh = scene.add(lifted(1), [[0, 1, 2]])
    scene.commit()
    for wrong in (np.zeros((4, 3)), np.full((3, 3), np.nan)):
        with pytest.raises(raysheaf.InvalidError, match=r"meshes\[0\]\.positions"):
            scene.update(mesh, wrong)
    with pytest.raises(ValueError, match=r"vertices: .*\(3,\)"):
        scene.update(mesh, [1, 2, 3])
    assert scene.committed and scene.closest_hit(*UP).t == 1


def test_a_transform_beyond_the_limit_is_refused_until_corrected():
    scene = raysheaf.Scene()
    scene.add(lifted(1), transform=np.diag([1, 1, 1e19, 1]))
    for _ in range(2):
        with pytest.raises(raysheaf.InvalidError, match=r"instances\[0\].transform"):
            scene.any_hit(*UP)
    assert repr(scene).endswith(
        "1 triangles; instances[0].transform: the transform puts a vertex of "
        "meshes[0] farther out than 1e18>"
    )
    scene.set_transform(0, None)
    assert scene.any_hit(*UP)


# Threads.


def test_threads_ask_while_another_changes():
    setting = make_setting(13, triangles=2000, rays=3000)
    scene = raysheaf.Scene()
    mesh = scene.add(setting.vertices, setting.triangles)
    shifts = [0.0, 0.25, -0.5]
    rays = setting.origins, setting.directions
    answers = set()
    for shift in shifts:
        scene.update(mesh, setting.vertices + np.float32(shift))
        answers.add(scene.closest_hit(*rays).array.tobytes())
    assert len(answers) == len(shifts)
    failures, asked, done = [], [0, 0, 0], threading.Event()

    def ask(k):
        try:
            while not done.is_set() or asked[k] == 0:
                hits = scene.closest_hit(*rays)
                if hits.array.tobytes() not in answers:
                    failures.append("an answer of no state of the scene")
                asked[k] += 1
        except Exception as error:  # noqa: BLE001
            failures.append(repr(error))

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(len(asked))]
    for thread in threads:
        thread.start()
    for frame in range(60):
        scene.update(mesh, setting.vertices + np.float32(shifts[frame % 3]))
    done.set()
    for thread in threads:
        thread.join(timeout=60)
        assert not thread.is_alive()
    assert failures == [] and min(asked) > 0


def test_threads_that_all_change():
    scene = raysheaf.Scene()
    failures = []

    def work(k):
        try:
            for _ in range(50):
                mesh = scene.add(lifted(k + 1), mask=1 << k)
                assert scene.closest_hit(*UP, mask=1 << k).t == k + 1
                scene.update(mesh, lifted(k + 2))
                assert scene.closest_hit(*UP, mask=1 << k).geom_id == mesh
                scene.remove(mesh)
        except Exception as error:  # noqa: BLE001
            failures.append(repr(error))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
        assert not thread.is_alive()
    assert failures == [] and scene.meshes == []


def test_queries_let_other_threads_run():
    setting = make_setting(17, triangles=4000, rays=4000)
    scene = raysheaf.Scene(threads=1)
    scene.add(setting.vertices, setting.triangles)
    scene.commit()
    beats, done = [], threading.Event()

    def ask():
        scene.closest_hit(setting.origins, setting.directions, method="brute")
        done.set()

    thread = threading.Thread(target=ask)
    begin = time.perf_counter()
    thread.start()
    while not done.wait(timeout=0.001):
        beats.append(time.perf_counter())
    thread.join()
    took = time.perf_counter() - begin
    assert took > 0.05, "too short to tell"
    assert len(beats) > 10


def test_meshes_are_what_has_vertices_and_faces():
    mesh = SimpleNamespace(vertices=[[0, 0, 1], [1, 0, 1], [0, 1, 1]], faces=np.array([[0, 1, 2]]))
    scene = raysheaf.Scene()
    number = scene.add(mesh)
    assert scene.closest_hit([0.2, 0.2, 0], [0, 0, 1]).t == 1
    mesh.vertices[0][0] = 0.1
    scene.replace(number, mesh)
    assert scene.vertices(number)[0, 0] == np.float32(0.1)
    with pytest.raises(ValueError, match=r"^vertices.faces: an array of shape \(1, 2\)"):
        scene.add(SimpleNamespace(vertices=mesh.vertices, faces=np.array([[0, 1]])))


@pytest.mark.parametrize("path", ["a.glb", b"a.glb", Path("a.glb")])
def test_paths_are_for_load(path):
    with pytest.raises(TypeError, match="a.glb.* raysheaf.load reads files"):
        raysheaf.Scene().add(path)
