"""trimesh's ray interface, implemented by raysheaf."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

from raysheaf.trimesh import RayMeshIntersector  # noqa: E402


def rays_about(mesh, count=500, seed=0):
    rng = np.random.default_rng(seed)
    center, size = mesh.bounds.mean(axis=0), mesh.scale
    origins = center + rng.normal(size=(count, 3)) * size
    targets = center + rng.uniform(-0.4, 0.4, (count, 3)) * size
    return origins, targets - origins


def test_the_whole_interface(mesh):
    from trimesh.ray import ray_triangle

    for name in vars(ray_triangle.RayMeshIntersector):
        if not name.startswith("_"):
            assert callable(getattr(mesh.ray, name))


def test_hits_lie_on_their_faces_and_on_their_rays(mesh):
    origins, directions = rays_about(mesh)
    locations, index_ray, index_tri = mesh.ray.intersects_location(origins, directions)
    assert len(locations) > 300 and locations.dtype == np.float64
    normals = mesh.face_normals[index_tri]
    off_plane = np.einsum("ij,ij->i", locations - mesh.triangles[index_tri][:, 0], normals)
    assert np.abs(off_plane).max() < 1e-9
    along = locations - origins[index_ray]
    assert np.linalg.norm(np.cross(along, directions[index_ray]), axis=1).max() < 1e-8
    assert (np.einsum("ij,ij->i", along, directions[index_ray]) > 0).all()
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[index_tri], locations)
    assert weights.min() > -1e-4
    # Hits are sorted by ray, then from near to far; a ray leaves a closed mesh as often as it
    # enters.
    assert (np.diff(index_ray) >= 0).all()
    distance = np.linalg.norm(along, axis=1)
    assert (np.diff(distance)[np.diff(index_ray) == 0] > 0).all()
    assert (np.bincount(index_ray) % 2 == 0).all()


def test_queries_agree_with_each_other(mesh):
    origins, directions = rays_about(mesh)
    index_tri, index_ray = mesh.ray.intersects_id(origins, directions)
    first = mesh.ray.intersects_first(origins, directions)
    assert first.dtype == np.int64 and first.min() == -1
    assert np.array_equal(mesh.ray.intersects_any(origins, directions), first >= 0)
    assert np.array_equal(np.flatnonzero(first >= 0), np.unique(index_ray))
    tri, ray, locations = mesh.ray.intersects_id(
        origins, directions, multiple_hits=False, return_locations=True
    )
    assert np.array_equal(first[ray], tri) and len(locations) == len(ray)
    nearest = np.unique(index_ray, return_index=True)[1]
    assert np.array_equal(index_tri[nearest], tri)
    for most in (0, 1, 2, 3):
        tri, ray = mesh.ray.intersects_id(origins, directions, max_hits=most)
        counts = np.minimum(np.bincount(index_ray, minlength=len(origins)), most)
        assert np.array_equal(np.bincount(ray, minlength=len(origins)), counts)


def test_hits_are_those_of_trimesh():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    origins, directions = rays_about(mesh, count=200)
    theirs = pytest.importorskip("rtree") and trimesh.ray.ray_triangle.RayMeshIntersector(mesh)
    ours = RayMeshIntersector(mesh)
    expected = theirs.intersects_location(origins, directions)
    found = ours.intersects_location(origins, directions)
    order = np.lexsort((np.linalg.norm(expected[0] - origins[expected[1]], axis=1), expected[1]))
    assert np.array_equal(found[1], expected[1][order])
    np.testing.assert_allclose(found[0], expected[0][order], atol=1e-9)
    assert np.array_equal(found[2], expected[2][order])


def test_moves_are_noticed(mesh):
    intersector = mesh.ray
    ray = [[3, 0, 9]], [[0, 0, -1]]

    def height():
        return intersector.intersects_location(*ray, multiple_hits=False)[0][0, 2]

    assert np.isclose(height(), 1, atol=0.05)
    scene, id_before = intersector._scene, intersector._scene.meshes
    mesh.apply_translation([0, 0, 2])
    assert np.isclose(height(), 3, atol=0.05)
    mesh.vertices[:, 2] += 1  # in place
    assert np.isclose(height(), 4, atol=0.05)
    mesh.vertices = mesh.vertices * [1, 1, 0.5]
    assert np.isclose(height(), 2, atol=0.05)
    mesh.update_faces(mesh.triangles_center[:, 2] < 1.5)
    assert height() < 1.5
    assert intersector._scene is scene and scene.meshes == id_before


@pytest.mark.parametrize("scale", [1e-12, 1e-3, 1, 1e6, 1e12])
@pytest.mark.parametrize("offset", [0, 1e4])
def test_any_size_and_place(scale, offset):
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.vertices += offset
    mesh.apply_scale(scale)
    mesh.ray = RayMeshIntersector(mesh)
    origins, directions = rays_about(mesh, count=300)
    locations, index_ray, _ = mesh.ray.intersects_location(origins, directions)
    assert (np.bincount(index_ray, minlength=300) == 2).mean() > 0.3
    radius = np.linalg.norm(locations - mesh.bounds.mean(axis=0), axis=1) / scale
    assert (np.abs(radius - 0.995) < 0.01).all()


def test_an_answer_does_not_depend_on_the_rest_of_the_batch():
    rng = np.random.default_rng(0)
    mesh = trimesh.creation.box()
    ours = RayMeshIntersector(mesh)
    # Rays from a lattice to the corners hit edges and corners of faces.
    origins = rng.integers(-3, 4, (2000, 3)) * 0.5
    origins = origins[(np.abs(origins) > 0.5).any(axis=1)]
    directions = mesh.vertices[rng.integers(0, 8, len(origins))] - origins
    far, along = [[50.0, 60, 70]], [[1.0, 0, 0]]
    alone = ours.intersects_first(origins, directions)
    among = ours.intersects_first(np.vstack([origins, far]), np.vstack([directions, along]))
    assert (alone >= 0).all()
    assert np.array_equal(alone, among[:-1])
    assert ours.intersects_any([[20.0, 30, 40]], [[-19.5, -29.5, -39.5]]).all()


@pytest.mark.parametrize("distance", [1e2, 1e5, 1e8, 1e12])
def test_rays_from_far_away(distance):
    mesh = trimesh.creation.box()
    mesh.ray = RayMeshIntersector(mesh)
    locations, _, _ = mesh.ray.intersects_location([[0.1, 0.2, distance]], [[0, 0, -3]])
    np.testing.assert_allclose(
        locations, [[0.1, 0.2, 0.5], [0.1, 0.2, -0.5]], atol=1e-3 * distance / 1e12 + 1e-9
    )


def test_many_rays_are_answered_as_few_are(mesh):
    origins, directions = rays_about(mesh, 40_000)
    # The second half is processed in other blocks, and all of its rays can be queried at once.
    origins[7] = np.nan
    ask = mesh.ray.intersects_id
    for options in ({}, {"max_hits": 1}, {"max_hits": 3}, {"multiple_hits": False}):
        tri, ray, places = ask(origins, directions, return_locations=True, **options)
        pieces = []
        for begin in range(0, len(origins), 16_000):
            some = slice(begin, begin + 16_000)
            of = ask(origins[some], directions[some], return_locations=True, **options)
            pieces.append((of[0], of[1] + begin, of[2]))
        # A batch with an invalid ray is converted with unit directions, so the last digits differ.
        expected = [np.concatenate(column) for column in zip(*pieces)]
        assert np.array_equal(tri, expected[0]) and np.array_equal(ray, expected[1])
        assert np.allclose(places, expected[2], rtol=0, atol=1e-12)
    assert mesh.ray.intersects_id(origins, directions, max_hits=0)[0].size == 0


@pytest.mark.parametrize("length", [1e-300, 1e-160, 1e-20, 1e20, 1e200])
def test_directions_of_any_length(mesh, length):
    origins, directions = rays_about(mesh, 200)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    places, ray, tri = mesh.ray.intersects_location(origins, directions)
    found = mesh.ray.intersects_location(origins, directions * length)
    assert len(ray) > 100
    assert np.array_equal(found[1], ray) and np.array_equal(found[2], tri)
    assert np.allclose(found[0], places, rtol=0, atol=1e-9)


def test_rays_that_are_none_hit_nothing(mesh):
    origins, directions = rays_about(mesh, count=50)
    expected = mesh.ray.intersects_first(origins, directions)
    origins[3], directions[5], directions[7], directions[9] = np.nan, 0, np.inf, np.nan
    found = mesh.ray.intersects_first(origins, directions)
    wrong = [3, 5, 7, 9]
    assert (found[wrong] == -1).all()
    assert not mesh.ray.intersects_any(origins, directions)[wrong].any()
    assert np.array_equal(np.delete(found, wrong), np.delete(expected, wrong))
    for multiple in (True, False):
        _, index_ray, _ = mesh.ray.intersects_location(origins, directions, multiple)
        assert (
            not np.isin(wrong, index_ray).any()
            and index_ray.max() == np.flatnonzero(found >= 0)[-1]
        )


def test_no_rays_and_no_faces(mesh):
    for rays in (([], []), (np.zeros((0, 3)), np.zeros((0, 3)))):
        assert mesh.ray.intersects_first(*rays).shape == (0,)
        assert mesh.ray.intersects_location(*rays)[0].shape == (0, 3)
    empty = trimesh.Trimesh()
    empty.ray = RayMeshIntersector(empty)
    assert not empty.ray.intersects_any([[0, 0, 0]], [[0, 0, 1]]).any()
    assert empty.ray.intersects_location([[0, 0, 0]], [[0, 0, 1]])[0].shape == (0, 3)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("scaled", [True, False])
def test_faces_that_are_not_finite_are_never_hit(mesh, wrong, scaled):
    origins, directions = rays_about(mesh)
    ray = RayMeshIntersector(mesh, scaled)
    expected = ray.intersects_id(origins, directions)
    lost = expected[0][0]
    kept = mesh.vertices.copy()
    mesh.vertices[mesh.faces[lost, 1], 2] = wrong
    gone = np.flatnonzero((mesh.faces == mesh.faces[lost, 1]).any(axis=1))
    assert 0 < np.isin(expected[0], gone).sum() < len(expected[0]) / 2
    found = ray.intersects_id(origins, directions)
    fresh = RayMeshIntersector(mesh, scaled).intersects_id(origins, directions)
    left = ~np.isin(expected[0], gone)
    for column in range(2):
        assert np.array_equal(found[column], expected[column][left])
        assert np.array_equal(fresh[column], found[column])
    mesh.vertices = kept
    assert np.array_equal(ray.intersects_id(origins, directions)[0], expected[0])
    mesh.vertices[:] = wrong
    assert not ray.intersects_any(origins, directions).any()


@pytest.mark.parametrize("far", [np.nan, np.inf, 1e12, 1e60])
def test_vertices_of_no_face_do_not_count(far):
    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices = np.concatenate([[[far, 0, 0]], ball.vertices])
    mesh = trimesh.Trimesh(vertices, ball.faces + 1, process=False)
    origins, directions = rays_about(ball)
    ours, expected = RayMeshIntersector(mesh), RayMeshIntersector(ball)
    for _ in range(2):
        found = ours.intersects_location(origins, directions)
        for column, other in zip(found, expected.intersects_location(origins, directions)):
            assert np.array_equal(column, other)
        mesh.vertices[1:] *= 1.5
        ball.vertices *= 1.5


@pytest.mark.parametrize("gap", [2.0, 0.8, 0.01, 1e-4])
def test_layers_near_to_each_other(gap):
    """Faces that share no corner are hit one by one, however near they are."""
    kept = 300
    layers = np.zeros((300, 3, 3))
    layers[:, 1, 0] = layers[:, 2, 1] = 0.6
    size = np.linalg.norm([0.6, 0.6])
    layers[:, :, 2] = (np.arange(300) * gap * 1e-6 * size)[:, None]
    mesh = trimesh.Trimesh(layers.reshape(-1, 3), np.arange(900).reshape(-1, 3), process=False)
    ray = RayMeshIntersector(mesh)
    origins = np.array([[0.1, 0.2, -1], [0.1, 0.2, np.nan], [9, 9, -1], [0.2, 0.1, -1]])
    directions = np.tile([0, 0, 2.0], (4, 1))
    for use in ([0], [0, 2, 3], [0, 1, 2, 3]):
        places, index_ray, index_tri = ray.intersects_location(origins[use], directions[use])
        assert np.bincount(index_ray, minlength=len(use)).tolist() == [
            kept * (row in (0, 3)) for row in use
        ]
        assert (np.diff(places[index_ray == 0, 2]) > 0.9e-6 * gap * size).all()
        assert index_tri[0] == 0
        for most in (0, 1, 40, 1000):
            some = ray.intersects_id(origins[use], directions[use], max_hits=most)
            first = np.concatenate([np.flatnonzero(index_ray == k)[:most] for k in range(len(use))])
            assert np.array_equal(some[0], index_tri[first])
            assert np.array_equal(some[1], index_ray[first])


@pytest.mark.parametrize("merged", [True, False])
def test_faces_that_share_a_corner_are_one_place(merged):
    """A wedge: its two faces meet in an edge, with or without vertices in common."""
    width = 1e-3  # at a distance x from the edge the faces are x * width apart
    corners = [[0, 0, 0], [0, 1, 0], [1, 0, width / 2], [1, 0, -width / 2]]
    wedge = trimesh.Trimesh(corners, [[0, 1, 2], [0, 1, 3]], process=False)
    if not merged:
        wedge.unmerge_vertices()
    origins = np.array([[x, 0.1, 1] for x in (0, 1e-4, 1e-2)])
    index_tri, index_ray = RayMeshIntersector(wedge).intersects_id(origins, [[0, 0, -1]] * 3)
    assert np.bincount(index_ray).tolist() == [1, 1, 2]
    assert index_tri[-2:].tolist() == [0, 1]


def test_a_vertex_of_many_faces_is_one_place(mesh):
    ball = trimesh.creation.icosphere(subdivisions=2)
    places, index_ray, _ = RayMeshIntersector(ball).intersects_location(
        ball.vertices * 2, -ball.vertices
    )
    assert np.array_equal(index_ray, np.repeat(np.arange(len(ball.vertices)), 2))
    assert np.allclose(places[::2], ball.vertices) and np.allclose(places[1::2], -ball.vertices)


def test_wrong_indices_are_named():
    for index in (7, -1):
        mesh = trimesh.Trimesh(np.eye(3) * np.nan, [[0, 1, index]], process=False)
        with pytest.raises(ValueError, match=f"triangles.*{index}"):
            RayMeshIntersector(mesh).intersects_any([[0, 0, 0]], [[0, 0, 1]])


def test_only_meshes():
    for wrong in (5, None, trimesh.points.PointCloud([[0, 0, 0]]), trimesh.Scene()):
        name = type(wrong).__name__
        with pytest.raises(TypeError, match=f"^geometry: {name} is given; a trimesh.Trimesh is"):
            RayMeshIntersector(wrong)


def test_primitives(monkeypatch):
    # trimesh creates a primitive's engine before the primitive has data.
    monkeypatch.setattr(trimesh.ray.ray_triangle, "RayMeshIntersector", RayMeshIntersector)
    box = trimesh.primitives.Box()
    assert isinstance(box.ray, RayMeshIntersector)
    assert box.ray.intersects_any([[0, 0, -3], [0, 3, -3]], [[0, 0, 1]] * 2).tolist() == [True, False]


def test_wrong_shapes(mesh):
    with pytest.raises(ValueError, match=r"ray_origins \(2, 3\), ray_directions \(1, 3\)"):
        mesh.ray.intersects_any(np.zeros((2, 3)), np.ones((1, 3)))
    with pytest.raises(ValueError, match=r"ray_origins \(3,\)"):
        mesh.ray.intersects_any([0, 0, 0], [0, 0, 1])


@pytest.mark.parametrize(
    "message, origins, options",
    [
        ("^ray_origins: .*dtype <U1 is given; one of .* real numbers", [["a", "b", "c"]], {}),
        ("^ray_origins: .*complex128 is given", [[1j, 0, 0]], {}),
        ("^ray_origins: .*object is given", [[{}, 0, 0]], {}),
        ("^ray_origins: .*masked", np.ma.array([[0.0, 0, 0]], mask=True), {}),
        ("^max_hits: 1.5 is given; an integer", [[0, 0, 9]], {"max_hits": 1.5}),
        ("^max_hits: 'a' is given", [[0, 0, 9]], {"max_hits": "a", "multiple_hits": False}),
    ],
)
def test_wrong_arguments_are_named(mesh, message, origins, options):
    with pytest.raises(TypeError, match=message):
        mesh.ray.intersects_id(origins, [[0, 0, 1]], **options)


def test_any_number_of_hits(mesh):
    ray = [[3, 0, 9]], [[0, 0, -1]]
    for most, count in ((2**63, 2), (2**200, 2), (np.uint8(1), 1), (-1, 0), (-(2**80), 0)):
        assert len(mesh.ray.intersects_id(*ray, max_hits=most)[0]) == count
    objects = np.array(ray[0], object)
    assert mesh.ray.intersects_any(objects, ray[1]).all()


def test_contains_points(mesh):
    rng = np.random.default_rng(0)
    points = rng.uniform(-4.5, 4.5, (2000, 3))
    ring = np.hypot(points[:, 0], points[:, 1]) - 3
    depth = 1 - np.hypot(ring, points[:, 2])  # inside the tube
    sure = np.abs(depth) > 0.05
    assert np.array_equal(mesh.contains(points)[sure], (depth > 0)[sure])


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_contains_points_with_faces_that_are_not_finite(wrong):
    ball = trimesh.creation.icosphere()
    corners = [[5, 5, 5], [6, 5, wrong], [5, 6, 5]]
    faces = np.vstack([ball.faces, [np.arange(3) + len(ball.vertices)]])
    mesh = trimesh.Trimesh(np.vstack([ball.vertices, corners]), faces, process=False)
    mesh.ray = RayMeshIntersector(mesh)
    assert mesh.contains([[0, 0, 0], [0.3, 0.2, 0.1], [0, 0, 2]]).tolist() == [True, True, False]


def test_contains_points_without_points(mesh):
    empty = trimesh.Trimesh()
    empty.ray = RayMeshIntersector(empty)
    assert empty.contains(np.zeros((2, 3))).tolist() == [False, False]
    for points in ([], np.zeros((0, 3))):
        assert mesh.contains(points).shape == empty.contains(points).shape == (0,)


@pytest.mark.parametrize(
    "kind, message, points",
    [
        (ValueError, r"^points \(3,\): an array of shape \(n, 3\)", [0, 0, 0]),
        (ValueError, r"^points \(1, 2\): ", [[0, 0]]),
        (TypeError, "^points: .* is given; one of shape .* real numbers", [["a", "b", "c"]]),
        (TypeError, "^points: .*masked", np.ma.array([[0.0, 0, 0]], mask=True)),
    ],
)
def test_wrong_points_are_named(mesh, kind, message, points):
    with pytest.raises(kind, match=message):
        mesh.contains(points)


def test_copies_and_pickles(mesh):
    ray = [[3, 0, 9]], [[0, 0, -1]]
    for other in (
        copy.copy(mesh.ray),
        copy.deepcopy(mesh.ray),
        pickle.loads(pickle.dumps(mesh.ray)),
    ):
        assert np.array_equal(other.intersects_first(*ray), mesh.ray.intersects_first(*ray))


class Counting(RayMeshIntersector):
    def __init__(self, mesh):
        super().__init__(mesh, scale_to_box=False, threads=1)
        self.asked = 0

    def intersects_any(self, *rays):
        self.asked += 1
        return super().intersects_any(*rays)


def test_copies_of_an_engine_are_of_its_class(mesh):
    mesh.ray = Counting(mesh)
    ray = [[3, 0, 9]], [[0, 0, -1]]
    mesh.ray.intersects_any(*ray)
    for other in (
        copy.copy(mesh.ray),
        copy.deepcopy(mesh.ray),
        pickle.loads(pickle.dumps(mesh.ray)),
        pickle.loads(pickle.dumps(mesh)).ray,
    ):
        assert type(other) is Counting and other.asked == 1 and not other._scale_to_box
        assert other.intersects_any(*ray).all() and other._scene.threads == 1
        assert other._scene is not mesh.ray._scene


def test_copies_of_a_mesh_have_an_engine_of_trimesh(mesh):
    assert type(mesh.copy().ray) is type(trimesh.creation.box().ray)
    pickled = pickle.loads(pickle.dumps(mesh))
    assert type(pickled.ray) is RayMeshIntersector and pickled.ray.mesh is pickled


def test_trimeshs_own_tests():
    folder = os.environ.get("RAYSHEAF_TRIMESH_TESTS")
    if not folder:
        pytest.skip("RAYSHEAF_TRIMESH_TESTS names no checkout of trimesh")
    runner = Path(__file__).with_name("run_trimesh_tests.py")
    done = subprocess.run([sys.executable, str(runner), folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
