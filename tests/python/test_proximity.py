"""`raysheaf.trimesh.ProximityQuery` compared with trimesh's own."""

import copy

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

from raysheaf.trimesh import ProximityQuery  # noqa: E402


def on_faces(mesh, triangles, points):
    """trimesh's closest points, which have a tolerance of their own, at a size of 1."""
    center = mesh.bounds.mean(axis=0)
    near = trimesh.triangles.closest_point(
        (triangles - center) / mesh.scale, (points - center) / mesh.scale
    )
    return near * mesh.scale + center


def reference(mesh, points):
    """The distance, by every face."""
    best = np.full(len(points), np.inf)
    for corner in np.asarray(mesh.triangles):
        near = on_faces(mesh, np.tile(corner, (len(points), 1, 1)), points)
        best = np.minimum(best, np.linalg.norm(near - points, axis=1))
    return best


MESHES = {
    "sphere": lambda: trimesh.creation.icosphere(subdivisions=2),
    "box far away": lambda: trimesh.creation.box().apply_translation([1e6, -1e6, 1e5]),
    "small": lambda: trimesh.creation.icosphere(subdivisions=1).apply_scale(1e-3),
}


@pytest.mark.parametrize("name", MESHES)
def test_on_surface(name):
    mesh = MESHES[name]()
    size, center = mesh.scale, mesh.bounds.mean(axis=0)
    points = center + np.random.default_rng(0).normal(size=(400, 3)) * size
    closest, distance, face = ProximityQuery(mesh).on_surface(points)
    np.testing.assert_allclose(distance, reference(mesh, points), atol=2e-7 * size)
    np.testing.assert_allclose(np.linalg.norm(points - closest, axis=1), distance, atol=1e-9 * size)
    on_face = on_faces(mesh, np.asarray(mesh.triangles[face]), points)
    np.testing.assert_allclose(on_face, closest, atol=1e-9 * size)


def test_signed_distance():
    mesh = trimesh.creation.icosphere(subdivisions=3)
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (500, 3))
    distance = ProximityQuery(mesh).signed_distance(points)
    inside = np.linalg.norm(points, axis=1) < 0.98
    outside = np.linalg.norm(points, axis=1) > 1
    assert (distance[inside] > 0).all() and (distance[outside] < 0).all()
    np.testing.assert_allclose(np.abs(distance), reference(mesh, points), atol=1e-6)
    assert ProximityQuery(mesh).signed_distance(mesh.vertices[:5]).min() >= 0


def test_vertex():
    mesh = trimesh.creation.box()
    pytest.importorskip("scipy")
    distance, index = ProximityQuery(mesh).vertex([[0.6, 0.6, 0.6]])
    np.testing.assert_allclose(mesh.vertices[index[0]], [0.5, 0.5, 0.5])
    np.testing.assert_allclose(distance, 0.1 * np.sqrt(3))


def test_it_follows_the_mesh():
    mesh = trimesh.creation.box()
    query = ProximityQuery(mesh, threads=1)
    assert query.on_surface([[0, 0, 2]])[1][0] == pytest.approx(1.5)
    mesh.apply_translation([0, 0, 1])
    assert query.on_surface([[0, 0, 2]])[1][0] == pytest.approx(0.5)
    assert query.signed_distance([[0, 0, 1]])[0] == pytest.approx(0.5)
    assert copy.copy(query).on_surface([[0, 0, 2]])[1][0] == pytest.approx(0.5)


def test_faces_that_are_not_finite_are_never_found():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, np.nan]]
    mesh = trimesh.Trimesh(vertices, [[0, 1, 3], [0, 1, 2]], process=False)
    closest, distance, face = ProximityQuery(mesh).on_surface([[0.2, 0.2, 2.0], [-1, 0, 0]])
    assert face.tolist() == [1, 1]
    np.testing.assert_allclose(distance, [2, 1])


def test_few_points_and_wrong_ones():
    query = ProximityQuery(trimesh.creation.box())
    assert [len(a) for a in query.on_surface(np.zeros((0, 3)))] == [0, 0, 0]
    with pytest.raises(ValueError, match="shape"):
        query.on_surface([[1, 2]])
    with pytest.raises(ValueError, match="not finite"):
        query.on_surface([[1, 2, np.nan]])


def test_device():
    mesh = trimesh.creation.box()
    points = [[0.2, 0.2, 2.0], [0.1, 0.0, 0.0]]
    try:
        there = ProximityQuery(mesh, device="cuda")
    except NotImplementedError as error:
        assert "CUDA" in str(error)
        with pytest.raises(ValueError, match="device"):
            ProximityQuery(mesh, device="gpu")
        return
    expected = ProximityQuery(mesh)
    assert (there.signed_distance(points) == expected.signed_distance(points)).all()
    assert (there.on_surface(points)[0] == expected.on_surface(points)[0]).all()


@pytest.mark.parametrize("count", [0, 2])
def test_a_mesh_without_faces(count):
    empty = trimesh.Trimesh(np.zeros((count, 3)), np.zeros((0, 3), int), process=False)
    query, points = ProximityQuery(empty), [[0, 0, 1.0], [2, 0, 0]]
    closest, distance, face = query.on_surface(points)
    assert np.isnan(closest).all() and np.isnan(distance).all() and face.tolist() == [-1, -1]
    assert np.isnan(query.signed_distance(points)).all()
    assert query.signed_distance([]).shape == (0,)
    if count == 0:
        distance, vertex = query.vertex(points)
        assert np.isnan(distance).all() and vertex.tolist() == [-1, -1]
