"""Threads, signals and the end of the process during queries."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import interrupted_after

import raysheaf

TRIANGLE = np.array([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], np.float32)


def stack(layers: int) -> np.ndarray:
    """Parallel triangles above each other."""
    z = np.linspace(1, 2, layers, dtype=np.float32)
    corners = np.zeros((layers, 3, 3), np.float32)
    corners[..., :2] = [[-5, -5], [5, -5], [0, 5]]
    corners[..., 2] = z[:, None]
    return corners.reshape(-1, 3)


def told_by(program: str) -> tuple[int, str]:
    """Runs a program; returns its exit code and standard error."""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("count", [100, 5_000, 300_000])
@pytest.mark.parametrize("query", ["any_hit", "closest_hit", "all_hits"])
def test_a_process_ends_while_a_daemon_asks(query: str, count: int):
    program = f"""
import threading, time, numpy as np, raysheaf
scene = raysheaf.Scene()
mesh = scene.add(np.random.rand(3000, 3, 3))
origins, directions = np.zeros(({count}, 3)), np.random.rand({count}, 3)
vertices = np.random.rand(9000, 3)

def ask(updates):
    while True:
        if updates:
            scene.update(mesh, vertices)
        scene.{query}(origins, directions)

for updates in (False, True):
    threading.Thread(target=ask, args=(updates,), daemon=True).start()
time.sleep(0.2)
"""
    assert told_by(program) == (0, "")


def test_a_process_that_ends_in_an_exception_prints_only_that():
    code, said = told_by(
        "import raysheaf\n"
        "def fail():\n"
        "    scene = raysheaf.Scene()\n"
        "    scene.add([[0, 0, 1]], [[0, 0, 1]])\n"
        "fail()\n"
    )
    assert code == 1 and said.splitlines()[-1].startswith("raysheaf.InvalidError: "), said


def test_a_signal_handler_may_use_the_scene_that_its_thread_waits_for():
    if not hasattr(signal, "setitimer"):
        pytest.skip("the system has no timers")
    scene = raysheaf.Scene(threads=1)
    mesh = scene.add(stack(20_000))
    scene.commit()
    origins = np.zeros((4_000, 3), np.float32)
    begun = threading.Event()

    def ask():
        begun.set()
        scene.hit_counts(origins, [0, 0, 1], method="brute")

    other = threading.Thread(target=ask)
    found: list[int] = []

    def handler(*_):
        found.extend(scene.meshes)
        scene.update(mesh, stack(20_000))

    before = signal.signal(signal.SIGALRM, handler)
    try:
        other.start()
        begun.wait()
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        while not found:
            scene.update(mesh, stack(20_000))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        other.join()
    assert found[0] == mesh


@pytest.mark.parametrize("query", ["all_hits", "hit_counts"])
def test_ctrl_c_ends_a_query_of_few_rays_and_many_hits(query: str):
    scene = raysheaf.Scene(threads=1)
    scene.add(stack(200_000))
    with interrupted_after(0.2):
        getattr(scene, query)(np.zeros((6_000, 3)), [0, 0, 1])
    assert scene.any_hit([0, 0, 0], [0, 0, 1])


@pytest.mark.parametrize("what", ["positions", "triangles"])
def test_arrays_that_change_while_they_are_read(what: str):
    count = 30_000
    vertices = np.zeros((count, 3), np.float32)
    triangles = np.zeros((count, 3), np.uint32)
    triangles[0, 0] = count - 1
    scene = raysheaf.Scene()
    mesh = scene.add(vertices, triangles)
    done = False

    def write():
        while not done:
            if what == "positions":
                vertices[-1, 0] = np.nan
                vertices[-1, 0] = 0
            else:
                triangles[-1, 0] = count
                triangles[-1, 0] = 0

    other = threading.Thread(target=write)
    other.start()
    said = set()
    try:
        for _ in range(100):
            try:
                scene.replace(mesh, vertices, triangles)
            except raysheaf.InvalidError as error:
                said.add(str(error))
    finally:
        done = True
        other.join()
    if what == "positions":
        expected = f"meshes[0].positions[{count - 1}]: the vertex is not finite"
    else:
        expected = (
            f"meshes[0].triangles[{count - 1}]: index 0 is {count}, "
            f"but the mesh has {count} vertices"
        )
    assert said <= {expected}


def test_a_child_of_fork_gets_an_error_and_may_make_new_scenes():
    pytest.importorskip("trimesh")
    program = """
import os, signal, threading, warnings, numpy as np, raysheaf, trimesh
from raysheaf.trimesh import RayMeshIntersector
warnings.simplefilter("ignore")  # Python's own of fork where there are threads

def soup():
    scene = raysheaf.Scene(threads=2)
    scene.add(np.random.default_rng(1).random((900, 3, 3)))
    return scene

origins, directions = np.zeros((50_000, 3)), np.random.default_rng(2).random((50_000, 3))
scene, ends = soup(), False
adapter = RayMeshIntersector(trimesh.creation.icosphere())
expected, faces = scene.closest_hit(origins, directions), adapter.intersects_first(origins, directions)

def ask():
    while not ends:
        scene.closest_hit(origins, directions)
        adapter.intersects_first(origins[:100], directions[:100])

asking = threading.Thread(target=ask)
asking.start()
for _ in range(5):
    child = os.fork()
    if child == 0:
        signal.alarm(30)
        code = 1
        try:
            scene.closest_hit(origins[:9], directions[:9])
        except raysheaf.Error as error:
            code = 0 if "forked" in str(error) else 2
        if soup().threads != 1:
            code = 5
        if not np.array_equal(soup().closest_hit(origins, directions).array, expected.array):
            code = 3
        if not np.array_equal(adapter.intersects_first(origins, directions), faces):
            code = 4
        os._exit(code)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert status == 0, status
ends = True
asking.join()
"""
    assert told_by(program) == (0, "")
