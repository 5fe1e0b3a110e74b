"""A mesh that changes while trimesh's ray interface follows it, with interruptions in between."""

from __future__ import annotations

import signal
import time

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

from raysheaf.trimesh import RayMeshIntersector  # noqa: E402


def test_handlers_of_signals_may_ask(mesh):
    if not hasattr(signal, "setitimer"):
        pytest.skip("the system has no timers")
    ray, found = ([[3, 0, 9]], [[0, 0, -1]]), []
    begin = time.monotonic()
    before = signal.signal(
        signal.SIGALRM, lambda *_: found.append(mesh.ray.intersects_any(*ray).item())
    )
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
        while len(found) < 20 and time.monotonic() - begin < 60:
            mesh.vertices += [0, 0, 1e-3]
            assert mesh.ray.intersects_any(*ray).all()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(found) >= 20 and all(found)


@pytest.mark.parametrize("change", ["add", "update", "replace"])
def test_an_interrupted_change_is_completed_later(mesh, change):
    rng = np.random.default_rng(0)
    origins = rng.normal(size=(500, 3)) * 8
    rays = origins, rng.uniform(-2, 2, (500, 3)) - origins
    scene, kept, faces = mesh.ray._scene, mesh.vertices.copy(), mesh.faces.copy()
    if change != "add":
        mesh.ray.intersects_any(*rays)
    made = getattr(scene, change)

    def interrupted(*arguments):
        made(*arguments)
        raise KeyboardInterrupt

    mesh.vertices += 0.5
    if change == "replace":
        mesh.update_faces(np.arange(len(faces)) % 2 == 0)
    setattr(scene, change, interrupted)
    with pytest.raises(KeyboardInterrupt):
        mesh.ray.intersects_any(*rays)
    delattr(scene, change)
    for vertices in (kept, kept - 0.5):
        mesh.vertices, mesh.faces = vertices, faces
        found = mesh.ray.intersects_location(*rays)
        fresh = RayMeshIntersector(mesh).intersects_location(*rays)
        assert len(found[0]) > 300
        assert all(np.array_equal(ours, other) for ours, other in zip(found, fresh))
    assert len(scene.meshes) == 1
