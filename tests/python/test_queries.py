"""Compares answers with a Python brute force, and bit for bit with the library's."""

from __future__ import annotations

import math
import threading
import time

import numpy as np
import pytest
from conftest import Setting, brute_force, interrupted_after, make_setting

import raysheaf


def scene_of(setting: Setting, **options) -> raysheaf.Scene:
    scene = raysheaf.Scene(**options)
    scene.add(setting.vertices, setting.triangles)
    return scene


def test_hits_are_those_of_a_brute_force(setting):
    scene = scene_of(setting)
    truth = brute_force(setting.vertices[setting.triangles], setting.origins, setting.directions)
    sure = ~truth.doubtful.any(axis=1)
    assert sure.mean() > 0.3
    hits = scene.closest_hit(setting.origins, setting.directions)
    t = np.where(truth.hit, truth.t, np.inf)
    nearest = t.argmin(axis=1)
    expected = np.isfinite(t.min(axis=1))
    assert np.array_equal(hits.hit[sure], expected[sure])
    assert 0.1 < expected[sure].mean() < 0.99
    both = np.flatnonzero(sure & expected)
    np.testing.assert_allclose(hits.t[both], t[both, nearest[both]], rtol=1e-4, atol=1e-5)
    apart = np.partition(t[both], 1, axis=1)
    clear = both[apart[:, 1] - apart[:, 0] > 1e-4]
    assert np.array_equal(hits.prim_id[clear], nearest[clear])
    np.testing.assert_allclose(hits.u[clear], truth.u[clear, nearest[clear]], atol=1e-3)
    np.testing.assert_allclose(hits.v[clear], truth.v[clear, nearest[clear]], atol=1e-3)


def test_all_hits_are_those_of_a_brute_force(setting):
    scene = scene_of(setting)
    truth = brute_force(setting.vertices[setting.triangles], setting.origins, setting.directions)
    rows = scene.all_hits(setting.origins, setting.directions)
    checked = 0
    for ray in np.flatnonzero(~truth.doubtful.any(axis=1)):
        assert sorted(rows[ray].prim_id) == list(np.flatnonzero(truth.hit[ray]))
        assert (np.diff(rows[ray].t) >= 0).all()
        checked += len(rows[ray])
    assert checked > 50


def test_hits_lie_in_the_interval(setting):
    scene = scene_of(setting)
    t_min, t_max = 0.05, np.linspace(0.1, 1, len(setting.origins))
    truth = brute_force(
        setting.vertices[setting.triangles],
        setting.origins,
        setting.directions,
        t_min,
        t_max[:, None],
    )
    sure = ~truth.doubtful.any(axis=1)
    hit = scene.any_hit(setting.origins, setting.directions, t_min=t_min, t_max=t_max)
    assert np.array_equal(hit[sure], truth.hit.any(axis=1)[sure])
    counts = scene.hit_counts(setting.origins, setting.directions, t_min=t_min, t_max=t_max)
    assert np.array_equal(counts[sure], truth.hit.sum(axis=1)[sure])


@pytest.mark.parametrize("threads", [1, 2])
def test_methods_agree_bit_for_bit(setting, threads):
    scene = scene_of(setting, threads=threads)
    assert scene.threads == threads
    rays = setting.origins, setting.directions
    hits = scene.closest_hit(*rays)
    brute = scene.closest_hit(*rays, method="brute")
    assert hits.array.tobytes() == brute.array.tobytes()
    assert np.array_equal(scene.any_hit(*rays), hits.hit)
    assert np.array_equal(scene.any_hit(*rays, method="brute"), hits.hit)
    rows, brute_rows = scene.all_hits(*rays), scene.all_hits(*rays, method="brute")
    assert rows.hits.array.tobytes() == brute_rows.hits.array.tobytes()
    assert np.array_equal(rows.offsets, brute_rows.offsets)
    assert np.array_equal(scene.hit_counts(*rays), rows.counts)
    first = rows.hits[rows.offsets[:-1][rows.counts > 0]]
    assert first.array.tobytes() == hits[hits.hit].array.tobytes()


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("method", ["dual", "brute"])
def test_invalid_rays_may_be_misses(setting, method, packed):
    """They are misses in every query, and the other rays get the same answers without them."""
    scene = scene_of(setting)
    count = len(setting.origins)
    rays = np.zeros((count, 8), np.float32)
    rays[:, :3], rays[:, 4:7], rays[:, 7] = setting.origins, setting.directions, 9
    wrong = np.arange(count) % 9
    right = rays[wrong == 0]
    rays[wrong == 1, 1], rays[wrong == 2, 6], rays[wrong == 3, 4:7] = np.nan, np.inf, 0
    rays[wrong == 4, 7], rays[wrong == 5, 3], rays[wrong == 6, 3] = np.nan, -1, 10
    rays[wrong == 7, 7], rays[wrong == 8, 3] = -np.inf, np.nan
    given = rays.copy()
    asked = (rays,) if packed else (rays[:, :3], rays[:, 4:7])
    ends = {} if packed else {"t_min": rays[:, 3], "t_max": rays[:, 7]}
    hits = scene.closest_hit(*asked, **ends, method=method, invalid="miss")
    assert np.array_equal(hits[wrong == 0].array, scene.closest_hit(right, method=method).array)
    assert not hits[wrong > 0].hit.any() and np.isnan(hits[wrong > 0].position).all()
    counts = scene.hit_counts(*asked, **ends, method=method, invalid="miss")
    assert np.array_equal(scene.any_hit(*asked, **ends, method=method, invalid="miss"), counts > 0)
    assert np.array_equal(counts > 0, hits.hit)
    rows = scene.all_hits(*asked, **ends, method=method, invalid="miss")
    assert np.array_equal(rows.counts, counts)
    assert np.array_equal(rays, given, equal_nan=True)
    with pytest.raises(raysheaf.InvalidError):
        scene.closest_hit(*asked, **ends, method=method)
    with pytest.raises(ValueError, match="^invalid: 'hit' is given"):
        scene.any_hit(*asked, **ends, invalid="hit")
    assert not scene.closest_hit([0, 0, 0], [0, 0, 0], invalid="miss").hit


def test_degenerate_triangles_are_never_hit():
    scene = raysheaf.Scene()
    scene.add([[0, 0, 1], [1, 1, 1], [2, 2, 1]], [[0, 1, 2], [0, 0, 1], [2, 2, 2]])
    assert not scene.any_hit([[0.5, 0.5, 0], [0, 0, 0]], [0, 0, 1]).any()


def test_a_closed_mesh_has_no_cracks():
    n = 24
    u, v = np.meshgrid(np.arange(n) / n * 2 * np.pi, np.arange(1, n) / n * np.pi)
    ring = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], -1).reshape(-1, 3)
    vertices = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    at = lambda i, j: i * n + j % n
    quads = [
        (at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1))
        for i in range(n - 2)
        for j in range(n)
    ]
    triangles = [t for a, b, c, d in quads for t in ((a, c, b), (b, c, d))]
    top, bottom = len(ring), len(ring) + 1
    triangles += [(top, at(0, j), at(0, j + 1)) for j in range(n)]
    triangles += [(bottom, at(n - 2, j + 1), at(n - 2, j)) for j in range(n)]
    scene = raysheaf.Scene()
    scene.add(vertices, triangles)
    directions = np.concatenate([vertices, vertices[np.array(triangles)].mean(axis=1)])
    corners = vertices[np.array(triangles)]
    directions = np.concatenate([directions, (corners[:, 0] + corners[:, 1]) / 2])  # edges
    assert scene.any_hit([0, 0, 0], directions).all()


def test_instances_and_masks():
    scene = raysheaf.Scene()
    square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    mesh = scene.add(square, [[0, 1, 2], [2, 1, 3]], place=False)
    near = scene.instance(mesh, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2]], mask=1)
    far = scene.instance(mesh, np.diag([1.0, 1, -1, 1]) + _lift(5), mask=2)
    ray = ([0.25, 0.25, 0], [0, 0, 1])
    assert scene.closest_hit(*ray).inst_id == near
    seen = scene.closest_hit(*ray, mask=2)
    assert (seen.inst_id, seen.geom_id, seen.t) == (far, mesh, 5)
    assert not scene.closest_hit(*ray, mask=4).hit
    scene.set_mask(near, 6)
    assert scene.closest_hit(*ray, mask=2).t == 2
    scene.set_transform(near, None)
    assert scene.closest_hit(*ray).t == 0
    scene.remove_instance(near)
    assert scene.closest_hit(*ray).inst_id == far
    assert scene.instances(mesh) == [far] and scene.mesh_of(far) == mesh
    np.testing.assert_array_equal(scene.transform(far), (np.diag([1.0, 1, -1, 1]) + _lift(5))[:3])
    assert scene.mask(far) == 2


def _lift(z: float) -> np.ndarray:
    matrix = np.zeros((4, 4))
    matrix[2, 3] = z
    return matrix


def test_statistics_say_what_was_done():
    setting = make_setting(5)
    scene = scene_of(setting)
    told: dict = {}
    scene.closest_hit(setting.origins, setting.directions, statistics=told)
    assert told["rays"] == len(setting.origins)
    assert told["triangles"] == len(setting.triangles)
    assert told["triangle_tests"] > 0
    assert told["total_ms"] >= told["trace_ms"] > 0
    assert all(isinstance(sentence, str) for sentence in told["plan"]) and told["plan"]
    scene.any_hit(setting.origins, setting.directions, method="brute", statistics=told)
    assert told["triangle_tests"] == len(setting.origins) * len(setting.triangles)


def test_a_million_rays_against_a_hundred_thousand_triangles():
    n = 230  # a height field z = f(x, y) of 2 * 229^2 triangles
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], -1).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + n], -1),
            np.stack([corner + n, corner + 1, corner + n + 1], -1),
        ]
    )
    assert len(triangles) > 100_000
    scene = raysheaf.Scene()
    scene.add(vertices, triangles)
    rng = np.random.default_rng(0)
    origins = np.concatenate(
        [rng.uniform(0.001, 0.999, (1_000_000, 2)), np.full((1_000_000, 1), 2.0)], 1
    )
    hits = scene.closest_hit(origins, [0, 0, -1])
    assert hits.hit.all()
    height = 0.1 * np.sin(9 * origins[:, 0]) * np.cos(7 * origins[:, 1])
    assert np.abs(2 - hits.t - height).max() < 1e-4


@pytest.mark.parametrize("kind", ["closest_hit", "any_hit", "all_hits", "hit_counts"])
def test_ctrl_c_is_heard(kind):
    setting = make_setting(4, triangles=20_000, rays=20_000)
    scene = scene_of(setting)
    far = np.tile(setting.origins, (50, 1)) + 100  # behind all triangles: no hit ends a ray
    with interrupted_after(0.2):
        getattr(scene, kind)(far, [1, 0, 0], method="brute")
    assert scene.closest_hit(setting.origins, setting.directions).hit.any()


def test_ctrl_c_interrupts_a_waiting_change():
    setting = make_setting(4, triangles=20_000, rays=20_000)
    scene = scene_of(setting)
    far = setting.origins + 100
    begin = time.monotonic()
    scene.any_hit(far, [1, 0, 0], method="brute")
    times = math.ceil(1.5 / (time.monotonic() - begin))
    batch = np.tile(far, (times, 1))
    other = threading.Thread(target=lambda: scene.any_hit(batch, [1, 0, 0], method="brute"))
    other.start()
    time.sleep(0.5)
    with interrupted_after(0.2):
        scene.update(0, setting.vertices)
    assert other.is_alive()
    other.join()
    scene.update(0, setting.vertices)
    assert scene.closest_hit(setting.origins, setting.directions).hit.any()
