"""Random triangles and rays, and a brute force reference: Möller and Trumbore (1997), in float64."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator

import numpy as np
import pytest

import raysheaf

# Programs that tests start must import the same module.
os.environ["PYTHONPATH"] = str(Path(raysheaf.__file__).absolute().parents[1])


@contextlib.contextmanager
def interrupted_after(seconds: float) -> Iterator[None]:
    """Sends Ctrl-C after a delay; the code inside must stop then, although it would take minutes."""
    if not hasattr(signal, "setitimer"):
        pytest.skip("the system has no timers")

    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    begin = time.monotonic()
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds)
        with pytest.raises(KeyboardInterrupt):
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - begin < 30


@dataclass
class Setting:
    """A soup of triangles, rays through it, and its scene."""

    vertices: np.ndarray  # (3 m, 3)
    triangles: np.ndarray  # (m, 3)
    origins: np.ndarray  # (n, 3)
    directions: np.ndarray


def make_setting(seed: int, triangles: int = 200, rays: int = 300) -> Setting:
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-1, 1, (triangles, 1, 3))
    corners = centers + rng.uniform(-0.4, 0.4, (triangles, 3, 3))
    origins = rng.uniform(-2, 2, (rays, 3))
    directions = rng.normal(size=(rays, 3)) * rng.uniform(0.1, 10, (rays, 1))
    order = rng.permutation(3 * triangles)  # corners of a triangle are not adjacent in memory
    vertices = np.empty((3 * triangles, 3))
    vertices[order] = corners.reshape(-1, 3)
    return Setting(
        vertices.astype(np.float32),
        order.reshape(-1, 3).astype(np.uint32),
        origins.astype(np.float32),
        directions.astype(np.float32),
    )


@pytest.fixture(params=[1, 2, 3])
def setting(request: pytest.FixtureRequest) -> Setting:
    return make_setting(request.param)


@dataclass
class BruteForce:
    """Every ray with every triangle: arrays of shape (n, m)."""

    t: np.ndarray
    u: np.ndarray
    v: np.ndarray
    hit: np.ndarray
    doubtful: np.ndarray  # too near to an edge or to the interval's end to decide


def brute_force(corners, origins, directions, t_min=0.0, t_max=np.inf) -> BruteForce:
    a, b, c = np.moveaxis(np.asarray(corners, np.float64), 1, 0)
    o, d = np.asarray(origins, np.float64)[:, None], np.asarray(directions, np.float64)[:, None]
    p = np.cross(d, c - a)
    with np.errstate(all="ignore"):
        determinant = np.sum((b - a) * p, -1)
        s = o - a
        u = np.sum(s * p, -1) / determinant
        q = np.cross(s, b - a)
        v = np.sum(d * q, -1) / determinant
        t = np.sum((c - a) * q, -1) / determinant
    margin = np.minimum(np.minimum(u, v), 1 - u - v)
    t_margin = np.minimum(t - t_min, t_max - t)
    hit = (margin >= 0) & (t_margin >= 0)
    doubtful = (np.abs(margin) < 1e-3) & (t_margin > -1e-3)
    doubtful |= (np.abs(t_margin) < 1e-3) & (margin > -1e-3)
    doubtful |= ~np.isfinite(margin)
    return BruteForce(t, u, v, hit, doubtful)


@pytest.fixture
def mesh():
    """A torus whose ray queries use raysheaf."""
    trimesh = pytest.importorskip("trimesh")
    from raysheaf.trimesh import RayMeshIntersector

    torus = trimesh.creation.torus(major_radius=3, minor_radius=1)
    torus.ray = RayMeshIntersector(torus)
    return torus
