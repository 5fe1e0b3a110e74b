"""Point queries: equal to numpy's brute force, whatever arrays they come in."""

import pickle

import numpy as np
import pytest

import raysheaf

CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
SIDES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
FACES = np.array([[s[0], s[i], s[i + 1]] for s in SIDES for i in (1, 2)])


@pytest.fixture
def cube():
    scene = raysheaf.Scene(threads=2)
    scene.add(CUBE, FACES)
    return scene


def distance_to_cube(points):
    outside = np.linalg.norm(np.maximum(np.abs(points) - 1, 0), axis=-1)
    inside = np.min(1 - np.abs(points), axis=-1)
    return np.where(inside > 0, -inside, outside)


def test_a_cube(cube):
    points = np.random.default_rng(0).uniform(-2, 2, (5000, 3))
    expected = distance_to_cube(points)
    found = cube.closest_point(points)
    np.testing.assert_allclose(found.distance, np.abs(expected), atol=1e-14)
    np.testing.assert_allclose(
        np.linalg.norm(points - found.point, axis=-1), found.distance, atol=1e-14
    )
    corners = CUBE[FACES[found.prim_id]]
    weights = np.stack([1 - found.u - found.v, found.u, found.v], axis=-1)
    np.testing.assert_allclose((weights[..., None] * corners).sum(axis=1), found.point, atol=1e-14)
    assert (found.geom_id == 0).all() and (found.inst_id == 0).all()
    inside = expected < 0
    assert (found.side[inside] == -1).all()
    np.testing.assert_array_equal(cube.contains(points), inside)
    np.testing.assert_array_equal(cube.contains(points, inside="evenodd"), inside)
    np.testing.assert_allclose(cube.signed_distance(points), expected, atol=1e-14)
    np.testing.assert_array_equal(cube.occupancy(points), inside.astype(np.float32))


def test_brute_force_gives_the_same_bits(cube):
    points = np.random.default_rng(1).uniform(-2, 2, (300, 3))
    for moved in range(3):
        cube.update(0, CUBE + 0.1 * np.random.default_rng(moved).normal(size=CUBE.shape))
        for query in (
            lambda **how: cube.closest_point(points, **how).array,
            lambda **how: cube.nearest(points, 5, 1.5, **how).array,
            lambda **how: cube.signed_distance(points, **how),
            lambda **how: cube.contains(points, **how),
        ):
            assert query().tobytes() == query(method="brute").tobytes()


def test_nearest_are_sorted_and_within_the_radius(cube):
    found = cube.nearest([[0, 0, 3.0], [9, 9, 9]], 12, radius=[4.5, 1])
    assert found.shape == (2, 12)
    assert (np.diff(found.distance[0][found.found[0]]) >= 0).all()
    assert found.distance[0, 0] == 2 and found.found[0].sum() >= 10
    assert not found.found[1].any() and np.isnan(found.point[1]).all()
    assert cube.nearest([0, 0, 3], 1).prim_id[0] == cube.closest_point([0, 0, 3]).prim_id


def test_shapes_and_dtypes(cube):
    points = np.random.default_rng(2).uniform(-2, 2, (4, 5, 3))
    expected = cube.signed_distance(points)
    assert expected.shape == (4, 5) and expected.dtype == np.float64
    for same in (
        points[::-1][::-1],
        np.asfortranarray(points),
        np.stack([points[..., 0], points[..., 1], points[..., 2]])[:, :, :].transpose(1, 2, 0),
        points.astype(">f8"),
        points.tolist(),
    ):
        np.testing.assert_array_equal(cube.signed_distance(same), expected)
    floats = points.astype(np.float32)
    np.testing.assert_array_equal(
        cube.signed_distance(floats), cube.signed_distance(floats.astype(float))
    )
    assert cube.closest_point([0, 0, 0]).shape == ()
    assert cube.contains([0, 0, 0]) and cube.contains([0, 0, 0]).shape == ()
    assert cube.closest_point([]).shape == (0,)
    assert cube.closest_point(np.zeros((2, 0, 3))).shape == (2, 0)
    many = cube.closest_point([0, 0, 3], radius=np.array([[1], [2], [3]]))
    assert many.shape == (3, 1) and many.found.ravel().tolist() == [False, True, True]


def test_masks_and_instances(cube):
    cube.instance(0, [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]], mask=2)
    found = cube.closest_point([4.5, 0, 0], mask=2)
    assert found.inst_id == 1 and found.distance == 0.5
    assert not cube.closest_point([0, 0, 0], mask=4, statistics=(told := {})).found is True
    assert cube.contains([[5, 0, 0]]).all()
    assert told["rays"] == 1


def test_closest_points_are_arrays(cube):
    found = cube.closest_point([[0, 0, 3], [0, 0, 5]], radius=3)
    assert repr(found) == "<raysheaf.ClosestPoints of shape (2,): 1 of 2 found>"
    assert len(found) == found.size == 2
    assert [one.found.item() for one in found] == [True, False]
    np.testing.assert_array_equal(found["distance"], found.distance)
    assert found[0].distance == 2
    again = pickle.loads(pickle.dumps(found))
    assert again.array.tobytes() == found.array.tobytes()
    assert np.asarray(found).dtype == raysheaf.CLOSEST_DTYPE
    assert raysheaf.CLOSEST_DTYPE.itemsize == 64
    with pytest.raises(TypeError, match="CLOSEST_DTYPE"):
        raysheaf.ClosestPoints(np.zeros(3))
    with pytest.raises(TypeError, match="no items"):
        iter(cube.closest_point([0, 0, 0]))


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (lambda s: s.closest_point([[0, 0, 0], [0, np.nan, 0]]), r"points\[1\]: the point is not fin"),
        (lambda s: s.contains(np.full((2, 2, 3), 1e19)), r"points\[0, 0\]: the point is farther out"),
        (lambda s: s.closest_point([0, 0, np.inf]), "points: the point is not finite"),
        (lambda s: s.closest_point([[0, 0, 0]] * 3, radius=[1, 2, -1]), r"radius\[2\]: the radius is n"),
        (lambda s: s.nearest([0, 0, 0], 2, np.nan), "radius: the radius is not a number"),
        (lambda s: s.closest_point([[0, 0]]), r"points: an array of shape \(1, 2\)"),
        (lambda s: s.closest_point(np.zeros((4, 3)), radius=[1, 2]), "broadcast"),
        (lambda s: s.nearest([0, 0, 0], 0), "k: 0 is given; an integer from 1 to 65536"),
        (lambda s: s.nearest([0, 0, 0], 65537), "k: 65537 is given; an integer from 1 to 65536"),
        (lambda s: s.signed_distance([0, 0, 0], inside="odd"), "inside: 'odd' is given"),
    ],
)
def test_what_is_wrong_is_named(cube, wrong, sentence):
    with pytest.raises(ValueError, match=sentence):
        wrong(cube)


def test_wrong_types_are_refused(cube):
    with pytest.raises(TypeError, match="points"):
        cube.closest_point("abc")
    with pytest.raises(TypeError, match="k: 1.5"):
        cube.nearest([0, 0, 0], 1.5)


def test_doubles_are_not_rounded(cube):
    distance = cube.signed_distance([[0, 0, 1 + 1e-12], [0, 0, 1 - 1e-12]])
    np.testing.assert_allclose(distance, [1e-12, -1e-12], rtol=1e-3)


def test_open_surfaces_vote(cube):
    cube.replace(0, CUBE, FACES[:-2])  # without one side
    points = np.random.default_rng(3).uniform(-2, 2, (1000, 3))
    np.testing.assert_array_equal(cube.contains(points), (np.abs(points) < 1).all(axis=-1))


def test_triangles_without_area_count():
    scene = raysheaf.Scene()
    scene.add([[0, 0, 0], [2, 0, 0], [1, 0, 0], [5, 5, 5]], [[0, 1, 2], [3, 3, 3]])
    assert scene.closest_point([1.5, 2, 0]).distance == 2
    assert scene.closest_point([5, 5, 8]).prim_id == 1


def test_an_empty_scene():
    scene = raysheaf.Scene()
    assert scene.signed_distance([0, 0, 0]) == np.inf
    assert not scene.contains([0, 0, 0])
