"""View factors, sky views, hours of sun, irradiance: closed formulas, laws, and equal bits."""

from __future__ import annotations

import datetime
import sys

import numpy as np
import pytest

import raysheaf
from raysheaf import radiation
from raysheaf._contour import exchange_areas, outline
from raysheaf._sobol import REPLICATES, point_sets
from raysheaf.radiation import Patch, view_factors


def rectangle(at, u, v, n=1):
    """n x n cells; the front is where u x v points."""
    at, u, v = (np.array(x, float) for x in (at, u, v))
    s, t = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n, indexing="ij")
    points = (at + s[..., None] * u + t[..., None] * v).reshape(-1, 3)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    first = np.stack([corner, corner + n + 1, corner + n + 2], -1)
    second = np.stack([corner, corner + n + 2, corner + 1], -1)
    return points, np.concatenate([first, second])


def sphere(radius, center=(0, 0, 0), rows=48):
    turn, fall = np.meshgrid(
        np.linspace(0, 2 * np.pi, 2 * rows + 1), np.linspace(0, np.pi, rows + 1)
    )
    points = np.stack(
        [np.sin(fall) * np.cos(turn), np.cos(fall), np.sin(fall) * np.sin(turn)], -1
    ).reshape(-1, 3)
    n = 2 * rows + 1
    corner = (np.arange(rows)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + n + 1], -1),
            np.stack([corner, corner + n + 1, corner + n], -1),
        ]
    )
    return points * radius + np.array(center), faces


def box(low, high, inwards=False):
    (a, b, c), (d, e, f) = low, high
    x, y, z = (d - a, 0, 0), (0, e - b, 0), (0, 0, f - c)
    sides = [(low, z, y), (low, x, z), (low, y, x), (high, y, z), (high, z, x), (high, x, y)]
    made = []
    for at, u, v in sides:
        sign = 1 if at is low else -1
        made.append(rectangle(at, np.multiply(sign, u), np.multiply(sign, v)))
    return [(p, t[:, ::-1]) for p, t in made] if inwards else made


def scene_of(shapes, **options):
    scene = raysheaf.Scene(**options)
    return scene, [scene.add(p.astype(np.float32), t) for p, t in shapes]


def opposed(a, b, c):
    """J. R. Howell's catalogue, C-11."""
    x, y = a / c, b / c
    r, s = np.sqrt(1 + x * x), np.sqrt(1 + y * y)
    return (
        np.log(np.sqrt((r * s) ** 2 / (1 + x * x + y * y)))
        + x * s * np.arctan(x / s)
        + y * r * np.arctan(y / r)
        - x * np.arctan(x)
        - y * np.arctan(y)
    ) * (2 / (np.pi * x * y))


def corner(h, w):
    """C-14, from a floor of depth w to a wall of height h."""
    a, b, c = 1 + w * w, 1 + h * h, 1 + w * w + h * h
    d = h * h + w * w
    return (
        w * np.arctan(1 / w)
        + h * np.arctan(1 / h)
        - np.sqrt(d) * np.arctan(1 / np.sqrt(d))
        + np.log(a * b / c * (w * w * c / (a * d)) ** (w * w) * (h * h * c / (b * d)) ** (h * h))
        / 4
    ) / (np.pi * w)


FLOOR = rectangle((0, 0, 0), (0, 0, 1), (1, 0, 0))
CEILING = rectangle((0, 1, 0), (1, 0, 0), (0, 0, 1))


# The points.


def test_each_scrambled_set_is_a_net():
    sets = point_sets(8, 4)
    assert sets.shape == (REPLICATES, 256, 4)
    for points in sets:
        for dimension in range(4):
            assert len(np.unique(points[:, dimension] >> 24)) == 256
        for rows in range(9):  # each elementary interval of the first two dimensions has a point
            cell = (points[:, 0].astype(np.int64) >> (32 - rows)) << (8 - rows)
            cell += points[:, 1].astype(np.int64) >> (24 + rows)
            assert len(np.unique(cell)) == 256
    assert len(np.unique(sets[:, 0], axis=0)) == REPLICATES


# View factors.


@pytest.mark.parametrize("cells", [1, 3])
def test_rectangles_without_anything_between_have_the_catalogues_factors(cells):
    for a, b, c in ((1, 1, 1), (2, 0.5, 0.25), (1, 4, 8)):
        shapes = [
            rectangle((0, 0, 0), (0, 0, b), (a, 0, 0), cells),
            rectangle((0, c, 0), (a, 0, 0), (0, 0, b)),
        ]
        found = view_factors(*scene_of(shapes), samples=8)
        np.testing.assert_allclose(found[0, 1], opposed(a, b, c), atol=1e-9)
        assert found.errors.max() == 0
    for h, w in ((1, 1), (0.5, 2), (4, 0.25)):
        shapes = [
            rectangle((0, 0, 0), (0, 0, 1), (w, 0, 0), cells),
            rectangle((0, 0, 0), (0, h, 0), (0, 0, 1)),
        ]
        found = view_factors(*scene_of(shapes), samples=8)
        np.testing.assert_allclose(found[0, 1], corner(h, w), atol=1e-9)


def test_only_the_parts_in_front_of_each_other_count():
    """A wall that goes on below the floor has the factor of its upper part."""
    below = rectangle((0, -0.7, 0), (0, 1.7, 0), (0, 0, 1))
    found = view_factors(*scene_of([FLOOR, below]))
    np.testing.assert_allclose(found[0, 1], corner(1, 1), atol=1e-7)
    behind = rectangle((0, -1, 0), (1, 0, 0), (0, 0, 1))  # looks away, and lies behind the floor
    assert view_factors(*scene_of([FLOOR, behind])).factors.max() == 0


def test_edges_of_neighbours_cancel():
    points, triangles = rectangle((0, 0, 0), (2, 0, 0), (0, 1, 0), 5)
    edges = outline(points[triangles])
    assert len(edges) == 20
    np.testing.assert_allclose((edges[:, 1] - edges[:, 0]).sum(0), 0, atol=1e-15)


def test_integrals_along_edges_agree_with_rays_anywhere():
    random = np.random.default_rng(3)
    for _ in range(12):
        shapes = [random.normal(size=(3, 3)) + [[k * 1.5, 0, 0]] for k in range(2)]
        scene = raysheaf.Scene()
        meshes = [scene.add(one, [[0, 1, 2]]) for one in shapes]
        one = view_factors(scene, meshes)
        other = view_factors(scene, meshes, exact=False, samples=2**15)
        assert (np.abs(one.factors - other.factors) <= 6 * other.errors + 1e-12).all()
        assert one.errors.max() == 0


def test_a_scale_and_a_place_do_not_change_factors():
    for scale, move in ((1e-3, 0.0), (1e4, 0.0), (1.0, 64.0)):
        shapes = [(p * scale + move, t) for p, t in (FLOOR, CEILING)]
        found = view_factors(*scene_of(shapes))
        np.testing.assert_allclose(found[0, 1], opposed(1, 1, 1), rtol=1e-5)
        np.testing.assert_allclose(found.areas, scale**2, rtol=1e-5)


def test_what_is_between_hides():
    half = rectangle((0, 0.5, 0), (0, 0, 1), (0.5, 0, 0))
    scene, meshes = scene_of([FLOOR, CEILING, half])
    found = view_factors(scene, meshes[:2], samples=2**16)
    assert abs(found[0, 1] - opposed(1, 1, 1) / 2) < min(5 * found.errors[0, 1], 5e-4)
    assert 0 < found.errors[0, 1] < 1e-3
    turned = view_factors(scene, meshes[1::-1], samples=2**16)
    assert abs(turned[0, 1] - opposed(1, 1, 1) / 2) < min(5 * turned.errors[0, 1], 5e-4)
    all_of_it = rectangle((-1, 0.5, -1), (0, 0, 3), (3, 0, 0))
    scene, meshes = scene_of([FLOOR, CEILING, all_of_it])
    assert view_factors(scene, meshes[:2])[0, 1] == 0


def test_patches_do_not_hide_themselves(monkeypatch):
    """Lines of sight between two squares that nothing hides are free, wherever the squares are."""
    monkeypatch.setattr("raysheaf._facing._clear", lambda planes, triangles, wanted: wanted & False)
    random = np.random.default_rng(6)
    for k in range(16):
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0] if k % 4 else np.eye(3)
        turn *= np.sign(np.linalg.det(turn)) * 10 ** random.uniform(-3, 4)
        move = random.normal(size=3) * (0, 1, 30)[k % 3] * abs(turn).max()
        scene, meshes = scene_of([(p @ turn.T + move, t) for p, t in (FLOOR, CEILING)])
        for order in (meshes, meshes[::-1]):
            found = view_factors(scene, order, samples=2**11)
            np.testing.assert_allclose(found[0, 1], opposed(1, 1, 1), rtol=1e-4)
            assert found.errors[0, 1] > 0


def test_facets_behind_a_board():
    """Two squares of 6 x 6 facets with a chess board of 8 x 8 between them, which hides half."""
    floor, ceiling = (
        rectangle((0, 0, 0), (0, 0, 1), (1, 0, 0), 6),
        rectangle((0, 1, 0), (1, 0, 0), (0, 0, 1), 6),
    )
    points, triangles = rectangle((0, 0.5, 0), (0, 0, 1), (1, 0, 0), 8)
    cell = np.arange(64)
    black = np.flatnonzero((cell // 8 + cell % 8) % 2)
    scene, meshes = scene_of(
        [floor, ceiling, (points, triangles[np.concatenate([black, black + 64])])]
    )
    patches = [Patch(mesh, [k, k + 36]) for mesh in meshes[:2] for k in range(36)]
    found = view_factors(scene, patches, samples=2**12)
    total = (found.areas[:36, None] * found.factors[:36, 36:]).sum()
    assert abs(total - opposed(1, 1, 1) / 2) < 5e-4
    assert (found.errors[:36, :36] == 0).all()


def test_a_sphere_sees_a_disc_and_the_other_way_round():
    angle = np.linspace(0, 2 * np.pi, 181)
    rim = 0.9 * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], -1)
    disc = np.concatenate([[[0, 0, 0]], rim]), np.array([[0, k + 1, k] for k in range(1, 181)])
    scene, meshes = scene_of([sphere(0.5, (0, 1.2, 0)), disc])
    found = view_factors(scene, meshes, samples=2**16)
    exact = 0.5 * (1 - 1 / np.sqrt(1 + (0.9 / 1.2) ** 2))  # C-127
    assert abs(found[0, 1] - exact) < 1e-3
    exchange = found.areas[:, None] * found.factors
    np.testing.assert_allclose(exchange, exchange.T, rtol=1e-12)


def test_closed_rooms_are_closed_and_reciprocal():
    random = np.random.default_rng(1)
    for _ in range(3):
        low = random.uniform(0.1, 0.4, 3)
        shapes = box((0, 0, 0), (1, 1, 1), inwards=True)
        shapes += box(low, low + random.uniform(0.1, 0.5, 3))
        found = view_factors(*scene_of(shapes), samples=2**12)
        assert found.closed.all()
        np.testing.assert_allclose(found.factors.sum(1), 1, atol=1e-9)
        exchange = found.areas[:, None] * found.factors
        np.testing.assert_allclose(exchange, exchange.T, atol=1e-15)
        assert (found.factors >= 0).all()
        assert (found.factors[6:, 6:] == 0).all()  # a box does not see itself


def test_a_sphere_in_a_sphere():
    inner, outer = sphere(0.5), sphere(1.0)
    found = view_factors(*scene_of([inner, (outer[0], outer[1][:, ::-1])]), samples=2**14)
    np.testing.assert_allclose(found.factors, [[0, 1], [0.25, 0.75]], atol=2e-4)


def test_an_open_box_is_not_closed():
    found = view_factors(*scene_of(box((0, 0, 0), (1, 1, 1), inwards=True)[:5]))
    assert not found.closed.any()
    assert found.errors.max() == 0 and abs(found.factors.sum(1) - 1).max() > 0.1


def test_rows_are_those_of_the_matrix():
    scene, meshes = scene_of([FLOOR, CEILING, *box((0.3, 0.3, 0.3), (0.6, 0.6, 0.6))])
    whole = view_factors(scene, meshes, samples=2**12)
    part = view_factors(scene, meshes[:1], to=meshes[1:], samples=2**12)
    assert part.shape == (1, 7) and len(part) == 1
    np.testing.assert_allclose(part.factors[0], whole.factors[0, 1:], atol=5e-3)
    same = part.errors[0] == 0
    assert same.any() and (part.factors[0, same] == whole.factors[0, 1:][same]).all()


def test_parts_sum_to_the_whole():
    scene, meshes = scene_of([rectangle((0, 0, 0), (0, 0, 1), (1, 0, 0), 4), CEILING])
    parts = [Patch(meshes[0], np.arange(32)[np.arange(32) % 3 == k]) for k in range(3)]
    found = view_factors(scene, parts, to=[meshes[1]])
    np.testing.assert_allclose((found.areas @ found.factors)[0], opposed(1, 1, 1), atol=1e-9)


def test_instances_and_mirrors():
    scene = raysheaf.Scene()
    mesh = scene.add(*FLOOR, place=False)
    scene.instance(mesh)
    mirrored = np.diag([1.0, -1.0, 1.0, 1.0])  # keeps fronts: its front looks down
    mirrored[1, 3] = 1
    other = scene.instance(mesh, mirrored)
    both = [Patch(mesh, instances=[0]), Patch(mesh, instances=[other])]
    np.testing.assert_allclose(view_factors(scene, both)[0, 1], opposed(1, 1, 1), atol=1e-9)
    assert view_factors(scene, [mesh], samples=2**14)[0, 0] == pytest.approx(
        opposed(1, 1, 1), abs=2e-3
    )


def test_errors_are_those_that_are_made():
    """Nearly all of many sampled factors lie within a few standard errors of the exact ones."""
    random = np.random.default_rng(5)
    ratios = []
    for _ in range(30):
        c = random.uniform(0.2, 2)
        shapes = [FLOOR, (CEILING[0] + [0, c - 1, 0], CEILING[1])]
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        found = view_factors(
            *scene_of([(p @ turn.T, t) for p, t in shapes]), samples=2**10, exact=False
        )
        ratios.append((found[0, 1] - opposed(1, 1, c)) / found.errors[0, 1])
    ratios = np.array(ratios)
    assert np.abs(ratios).max() < 5 and 0.3 < np.sqrt((ratios**2).mean()) < 2.2
    assert abs(ratios.mean()) < 0.7


def test_the_bits_are_those_of_any_threads_and_memory():
    shapes = [FLOOR, CEILING, *box((0.3, 0.3, 0.3), (0.6, 0.6, 0.6)), sphere(0.1, (2, 0, 0), 9)]
    points, normals = np.random.default_rng(2).uniform(-1, 2, (2, 50, 3))
    sky = radiation.perez_sky(500, 100, (1, 1, 0), albedo=0.2, subdivision=1)

    def answers(threads, memory):
        scene, meshes = scene_of(shapes, threads=threads)
        more = {"memory": memory}
        found = view_factors(scene, meshes, samples=2**12, **more)
        yield from (found.factors, found.errors)
        yield from radiation.sky_view(scene, points, normals, samples=2**13, errors=True, **more)
        yield radiation.ambient_occlusion(scene, points, normals, radius=0.5, **more)
        yield radiation.thickness(scene, points, normals, angle=40, samples=2**13, **more)
        yield radiation.sun_hours(scene, points, normals, normals, **more)
        yield radiation.visibility(scene, points[:, None], points, **more)
        yield from radiation.irradiance(
            scene, points, normals, sky, bounces=3, errors=True, samples=2**13, **more
        )

    expected = list(answers(1, 1e9))
    for threads, memory in ((1, 1), (2, 3e6), (5, 1e8)):
        for one, other in zip(expected, answers(threads, memory)):
            np.testing.assert_array_equal(one, other)


def test_progress_counts_all_rays():
    scene, meshes = scene_of([FLOOR, CEILING, sphere(0.2, (0.5, 0.5, 0.5), 9)])
    points, normals = radiation.at_vertices(scene, meshes[2])
    steps: list[tuple[int, int]] = []

    def check(call):
        steps.clear()
        call(lambda done, total: steps.append((done, total)))
        done, totals = zip(*steps)
        assert len(set(totals)) == 1 and done[-1] == totals[0] and sorted(done) == list(done)

    check(lambda p: view_factors(scene, meshes, samples=2**14, memory=1, progress=p))
    check(lambda p: radiation.sky_view(scene, points, normals, memory=1, progress=p))
    check(
        lambda p: radiation.irradiance(
            scene, points, normals, radiation.uniform_sky(), bounces=1, memory=1, progress=p
        )
    )


# Points.


def long_wall(height, x=0.0):
    return rectangle((x, 0, -3000), (0, height, 0), (0, 0, 6000))


GROUND = rectangle((-3000, 0, -3000), (0, 0, 6000), (6000, 0, 0))


def test_the_sky_next_to_a_wall():
    scene, _ = scene_of([GROUND, long_wall(1.5)])
    at = np.array([0.3, 1, 4])
    points = np.stack([at, 0 * at, 0 * at], -1)
    exact = (1 + np.cos(np.arctan(1.5 / at))) / 2
    found, error = radiation.sky_view(scene, points, [0, 1, 0], samples=2**14, errors=True)
    np.testing.assert_allclose(found, exact, atol=1e-3)
    assert (error < 1e-3).all() and (np.abs(found - exact) < 6 * error).all()
    steep = np.arctan2(1.5, at)
    circle = radiation.ambient_occlusion(scene, points, [0, 1, 0], radius=2e3, samples=2**14)
    np.testing.assert_allclose(circle, (1 + np.cos(steep)) / 2, atol=1e-3)
    assert (radiation.ambient_occlusion(scene, points, [0, 1, 0], radius=0.25) == 1).all()


def test_points_on_surfaces_do_not_hide_themselves():
    random = np.random.default_rng(8)
    for scale in (1e-3, 1.0, 1e4):
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0] * scale
        points, triangles = rectangle((-1, 0, -1), (0, 0, 2), (2, 0, 0), 6)
        scene, meshes = scene_of([(points @ turn.T + 7 * scale, triangles)])
        for places in (radiation.at_vertices, radiation.at_triangles):
            assert (radiation.sky_view(scene, *places(scene, meshes[0])) == 1).all()


def test_misses_and_texels_without_surface_are_nan():
    scene, _ = scene_of([GROUND])
    hits = scene.closest_hit([[0, 1, 0], [0, 1, 0]], [[0, -1, 0], [0, 1, 0]])
    for call in (radiation.sky_view, radiation.thickness):
        found = call(scene, hits.position, hits.normal)
        assert np.isfinite(found).tolist() == [True, False] or found[0] == np.inf
        assert np.isnan(found[1])


def test_hours_of_sun_and_rows_of_weights():
    scene, _ = scene_of([GROUND, long_wall(1.0)])
    turn = np.radians(np.arange(0.25, 180, 0.5))
    suns = np.stack([np.cos(turn), np.sin(turn), 0 * turn], -1)
    at = [[1, 0, 0], [-1, 0, 0]]
    hours = radiation.sun_hours(scene, at, [0, 1, 0], suns, 12 / 360)
    np.testing.assert_allclose(hours, [9, 9])
    halves = np.stack([turn < np.pi / 2, turn > np.pi / 2]) * 12 / 360
    np.testing.assert_allclose(
        radiation.sun_hours(scene, at, [0, 1, 0], suns, halves), [[6, 3], [3, 6]]
    )
    assert radiation.sun_hours(scene, [1, 0.1, 0], [1, 0, 0], [[0, 0, 1], [1, 1, 0]]) == 1


def test_thickness():
    scene, meshes = scene_of([sphere(1.5, rows=64)])
    points, normals = radiation.at_triangles(scene, meshes[0])
    some = np.isfinite(normals).all(-1)
    np.testing.assert_allclose(radiation.thickness(scene, points, normals)[some], 3, atol=2e-2)
    cone = radiation.thickness(
        scene, points[some][:50], normals[some][:50], angle=60, samples=2**12
    )
    np.testing.assert_allclose(cone, 3 * 0.75, rtol=2e-2)  # the mean cosine of a cone of 60 degrees
    assert radiation.thickness(scene, [9, 0, 0], [-1, 0, 0]) == np.inf


def test_visibility_of_pairs():
    scene, meshes = scene_of([*box((0, 0, 0), (1, 1, 1))])
    points = np.random.default_rng(4).uniform(-1, 2, (40, 3))
    found = radiation.visibility(scene, points[:, None], points)
    between = scene.any_hit(points[:, None], points - points[:, None] + [1e-30, 0, 0], t_max=1)
    np.testing.assert_array_equal(found, ~between | np.eye(40, dtype=bool))
    on_faces = np.array([[0.5, 1, 0.5], [0.2, 1, 0.7], [0.5, 0, 0.5], [1, 1, 1]])
    assert radiation.visibility(scene, on_faces, [0.5, 3, 0.5]).tolist() == [
        True,
        True,
        False,
        True,
    ]


# Skies.


@pytest.mark.parametrize("up", ["y", "z", (1, 2, 3)])
@pytest.mark.parametrize("parts", [1, 2, 5])
def test_patches_cover_the_sky(parts, up):
    directions, angles = radiation.sky_patches(parts, up=up)
    assert len(directions) == 144 * parts * parts + 1
    axis = {"y": (0, 1, 0), "z": (0, 0, 1)}.get(up, up)
    sines = directions @ axis / np.linalg.norm(axis)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    np.testing.assert_allclose(angles.sum(), 2 * np.pi)
    np.testing.assert_allclose((angles * sines).sum(), np.pi, rtol=2e-4)


@pytest.mark.parametrize("albedo", [0.0, 0.3])
def test_skies_on_tilted_planes(albedo):
    scene = raysheaf.Scene()
    b = np.radians([0, 30, 90, 150])
    normals = np.stack([np.sin(b), np.cos(b), 0 * b], -1)
    ground = albedo * (1 - np.cos(b)) / 2
    uniform = radiation.irradiance(
        scene, [0, 0, 0], normals, radiation.uniform_sky(2, albedo=albedo)
    )
    np.testing.assert_allclose(uniform, 2 * np.pi * ((1 + np.cos(b)) / 2 + ground), rtol=3e-3)
    found = radiation.irradiance(scene, [0, 0, 0], normals, radiation.overcast_sky(albedo=albedo))
    tilted = (1 + np.cos(b)) / 2
    tilted += 4 / (7 * np.pi) * (np.sin(b) - b * np.cos(b) - np.pi * np.sin(b / 2) ** 2)
    np.testing.assert_allclose(found, 7 * np.pi / 9 * (tilted + ground), rtol=3e-3)


def test_perez_has_the_measured_irradiances():
    scene = raysheaf.Scene()
    up, sun = np.array([0, 1, 0]), np.array([0.6, 0.8, 0])
    for direct, diffuse in ((0, 120), (300, 200), (800, 90), (950, 60), (5, 0)):
        sky = radiation.perez_sky(direct, diffuse, sun, albedo=0.25)
        found = radiation.irradiance(scene, [0, 0, 0], [up, -up], sky)
        total = diffuse + 0.8 * direct
        np.testing.assert_allclose(found, [total, 0.25 * total], rtol=1e-3)
        assert (sky.weights >= 0).all()
    clear = radiation.perez_sky(900, 80, sun, subdivision=1)
    _, angles = radiation.sky_patches(1)
    radiance = clear.weights[:145] / angles
    assert (clear.directions[radiance.argmax()] * sun).sum() > np.cos(np.radians(12))
    covered = radiation.perez_sky(0, 80, sun, subdivision=1).weights[:145] / angles
    assert radiance.max() / radiance.min() > 5 > covered.max() / covered.min()


def test_perez_sums_over_the_moments_of_a_year():
    suns = np.array([[1, 1, 0], [0, 1, 0], [0, -1, 0.1]], float)
    many = radiation.perez_sky([100, 500, 9], [50, 80, 0], suns, hours=[1, 2, 1], subdivision=1)
    single = [
        radiation.perez_sky(a, b, s, hours=h, subdivision=1)
        for a, b, s, h in zip([100, 500, 9], [50, 80, 0], suns, [1, 2, 1])
    ]
    np.testing.assert_allclose(many.weights[:145], sum(s.weights[:145] for s in single))
    np.testing.assert_allclose(many.weights[145:], [100, 1000, 0])


def test_bounces_in_a_sphere_with_a_hole():
    """Points of a sphere see each part of it by its area: E = pi L f (1 + r (1 - f) + ...)."""
    points, triangles = sphere(1.0, rows=64)
    rim = 18 * np.pi / 64
    hole = points[triangles][:, :, 1].min(1) > np.cos(rim) - 1e-6
    scene, meshes = scene_of([(points, triangles[~hole][:, ::-1])])
    f, r = (1 - np.cos(rim)) / 2, 0.6
    at, normals = np.array([[0, -0.999, 0], [0.9, -0.43, 0]]), np.array(
        [[0, 1, 0], [-0.9, 0.43, 0]]
    )
    sky = radiation.uniform_sky(albedo=1, subdivision=16)
    for bounces in (0, 1, 2, 12):
        found, error = radiation.irradiance(
            scene, at, normals, sky, bounces=bounces, reflectance=r, samples=2**14, errors=True
        )
        exact = np.pi * f * sum((r * (1 - f)) ** k for k in range(bounces + 1))
        np.testing.assert_allclose(found, exact, rtol=2.5e-2)
        assert (error < 0.04).all() and (error > 0).all() == bool(bounces)
    none = radiation.irradiance(scene, at, normals, sky, bounces=3, reflectance={})
    np.testing.assert_allclose(none, radiation.irradiance(scene, at, normals, sky))


def test_positions_of_the_sun():
    pytest.importorskip("pvlib")
    noon = datetime.datetime(2024, 6, 20, 12, tzinfo=datetime.timezone.utc)
    times = [noon - datetime.timedelta(hours=6), noon, noon + datetime.timedelta(hours=6)]
    morning, high, evening = radiation.sun_positions(times, 23.44, 0)
    assert high[1] > 0.999 and morning[0] > 0.9 and evening[0] < -0.9
    np.testing.assert_allclose(
        radiation.sun_positions(times, 40, 0, up="z")[:, [0, 2]],
        radiation.sun_positions(times, 40, 0)[:, [0, 1]],
    )
    with pytest.raises(ValueError, match="times: they have no time zone"):
        radiation.sun_positions([datetime.datetime(2024, 6, 20)], 40, 0)


def test_pvlib_is_needed_for_positions_of_the_sun_only(monkeypatch):
    monkeypatch.setitem(sys.modules, "pvlib.solarposition", None)
    with pytest.raises(ImportError, match="sun_positions needs pvlib, which is not installed"):
        radiation.sun_positions([], 0, 0)


# Baking.


def test_vertices_have_normals_and_places_in_the_world():
    scene = raysheaf.Scene()
    matrix = np.array([[0, -2, 0, 1], [2, 0, 0, 0], [0, 0, 2, 0.0]])
    points, triangles = sphere(1.0)
    mesh = scene.add(points, triangles, transform=matrix)
    at, normals = radiation.at_vertices(scene, mesh)
    np.testing.assert_allclose(at, points @ matrix[:, :3].T + matrix[:, 3], atol=1e-6)
    expected = points @ matrix[:, :3].T / 2
    np.testing.assert_allclose(normals[97:-97], expected[97:-97], atol=5e-2)
    given = raysheaf.Scene()
    mesh = given.add(points, triangles, transform=matrix, normals=points)
    np.testing.assert_allclose(radiation.at_vertices(given, mesh).normals, expected, atol=1e-5)


def test_texels_lie_on_the_surface_and_seams_are_padded():
    shape = rectangle((0, 0, 0), (0, 0, 2), (2, 0, 0), 4)
    uv = shape[0][:, [0, 2]] / 4 + 0.25  # the middle quarter of the texture
    scene = raysheaf.Scene()
    mesh = scene.add(*shape, uv=uv)
    points, normals = radiation.at_texels(scene, mesh, (32, 16), padding=0)
    there = np.isfinite(points).all(-1)
    assert there.sum() == 16 * 8 and there[4:12, 8:24].all()
    x, y = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(16) + 0.5) / 16)
    np.testing.assert_allclose(points[there][:, 0], 4 * x[there] - 1, atol=1e-5)
    np.testing.assert_allclose(points[there][:, 2], 4 * y[there] - 1, atol=1e-5)
    np.testing.assert_allclose(normals[there], [[0, 1, 0]] * there.sum())
    padded, _ = radiation.at_texels(scene, mesh, (32, 16), padding=2)
    wide = np.isfinite(padded).all(-1)
    assert wide[3:13, 7:25].all() and not wide[:, :5].any() and not wide[0].any()
    assert (padded[8, 6, :] == [0, 0, points[8, 10, 2]]).all()
    image = radiation.sky_view(scene, padded, normals)
    assert image.shape == (16, 32) and (image[there] == 1).all() and np.isnan(image[0]).all()
    whole = radiation.at_texels(scene, mesh, 8, uv=shape[0][:, [0, 2]] / 2)
    assert np.isfinite(whole.points).all()


# Wrong arguments.


def test_wrong_arguments_are_named():
    scene, meshes = scene_of([FLOOR, CEILING])
    point, up = [0, 1, 0], [0, 1, 0]
    for error, words, call in (
        (TypeError, "patches: 3 is given", lambda: view_factors(scene, 3)),
        (ValueError, r"patches\[1\]: the scene has no mesh 9", lambda: view_factors(scene, [0, 9])),
        (ValueError, "given twice", lambda: view_factors(scene, [0, 0])),
        (
            ValueError,
            "triangle 0 of instance 0 is in patches",
            lambda: view_factors(scene, [0, Patch(0, [0])]),
        ),
        (ValueError, r"patches\[0\].triangles: 7 is", lambda: view_factors(scene, [Patch(0, [7])])),
        (ValueError, "has no area", lambda: view_factors(scene, [Patch(0, [])])),
        (ValueError, "samples: 0 is given", lambda: view_factors(scene, meshes, samples=0)),
        (ValueError, "memory: 0 is given", lambda: view_factors(scene, meshes, memory=0)),
        (TypeError, "progress: 3", lambda: view_factors(scene, meshes, progress=3)),
        (TypeError, "scene: int is given", lambda: radiation.sky_view(1, point, up)),
        (ValueError, "normals: a normal is 0", lambda: radiation.sky_view(scene, point, [0, 0, 0])),
        (
            ValueError,
            "shapes that broadcast",
            lambda: radiation.sky_view(scene, [point] * 2, [up] * 3),
        ),
        (ValueError, "radius: 0", lambda: radiation.ambient_occlusion(scene, point, up, radius=0)),
        (
            ValueError,
            r"directions\[1\]",
            lambda: radiation.sun_hours(scene, point, up, [up, [0, 0, 0]]),
        ),
        (
            ValueError,
            "weights: an array of shape",
            lambda: radiation.sun_hours(scene, point, up, [up], [1, 2]),
        ),
        (TypeError, "weights: None", lambda: radiation.irradiance(scene, point, up, [up])),
        (
            TypeError,
            "weights: a Sky",
            lambda: radiation.irradiance(scene, point, up, radiation.uniform_sky(), [1]),
        ),
        (
            ValueError,
            "bounces need one row",
            lambda: radiation.irradiance(scene, point, up, [up], [[1]], bounces=1),
        ),
        (
            ValueError,
            "reflectance: 2",
            lambda: radiation.irradiance(scene, point, up, [up], 1, bounces=1, reflectance=2),
        ),
        (
            ValueError,
            r"reflectance\[5\]",
            lambda: radiation.irradiance(
                scene, point, up, [up], 1, bounces=1, reflectance={5: 0.5}
            ),
        ),
        (ValueError, "angle: 99", lambda: radiation.thickness(scene, point, up, angle=99)),
        (ValueError, "subdivision: 0", lambda: radiation.sky_patches(0)),
        (ValueError, "albedo: 2", lambda: radiation.uniform_sky(albedo=2)),
        (ValueError, "diffuse_horizontal", lambda: radiation.perez_sky(1, -1, up)),
        (ValueError, "north: it runs along up", lambda: radiation.sky_patches(north="y")),
        (ValueError, "mesh: 0 has no texture coordinates", lambda: radiation.at_texels(scene, 0)),
        (ValueError, "instance: 1 is given", lambda: radiation.at_vertices(scene, 0, instance=1)),
        (raysheaf.NotFoundError, "9", lambda: radiation.at_triangles(scene, 9)),
    ):
        with pytest.raises(error, match=words):
            call()


def test_edges_that_touch_have_exact_integrals():
    """Squares with an edge in common at any angle: the sums over halves of one are the whole."""
    for angle in np.radians([20, 90, 170]):
        other = rectangle((0, 0, 0), (np.cos(angle), np.sin(angle), 0), (0, 0, 1))
        edges = [outline(p[t]) for p, t in (FLOOR, other)]
        fine = outline(rectangle((0, 0, 0), (0, 0, 1), (1, 0, 0), 8)[0][FLOOR[1] * 0])
        assert len(fine) == 0
        counts = tuple(np.array([len(one)]) for one in edges)
        whole = exchange_areas((edges[0], edges[1]), counts, np.ones(1))[0]
        halves = 0.0
        for k in range(2):
            half = rectangle((0, 0, k / 2), (0, 0, 0.5), (1, 0, 0))
            part = outline(half[0][half[1]])
            halves += exchange_areas((part, edges[1]), (np.array([4]), counts[1]), np.ones(1))[0]
        np.testing.assert_allclose(halves, whole, rtol=1e-10)
