"""Arrays of every kind: right answers, or an exception that names the argument."""

from __future__ import annotations

import gc
import pickle
import threading
import tracemalloc
import warnings

import numpy as np
import pytest
from conftest import make_setting

import raysheaf
from raysheaf import _arrays

SETTING = make_setting(7)
FORMS = {
    "float32": lambda a: a,
    "float64": lambda a: a.astype(np.float64),
    "long double": lambda a: a.astype(np.longdouble),
    "Fortran order": np.asfortranarray,
    "every second row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "reversed": lambda a: a[::-1].copy()[::-1],
    "columns of a wider array": lambda a: np.concatenate([a, a], 1)[:, : a.shape[1]],
    "other endian": lambda a: a.astype(a.dtype.newbyteorder()),
    "not aligned": lambda a: _unaligned(a),
    "field of records": lambda a: _field(a),
    "read-only": lambda a: _locked(a),
    "list": lambda a: a.tolist(),
    "memoryview": lambda a: memoryview(np.ascontiguousarray(a)),
    "DLPack": lambda a: OnlyDlpack(np.ascontiguousarray(a)),
    "array interface": lambda a: OnlyInterface(np.ascontiguousarray(a)),
}


def _unaligned(array):
    raw = np.zeros(array.nbytes + 1, np.uint8)[1:]
    view = raw.view(array.dtype).reshape(array.shape)
    view[:] = array
    assert not view.flags.aligned
    return view


def _field(array):
    records = np.zeros(
        len(array), np.dtype([("pad", "u1"), ("at", array.dtype, (array.shape[1],))])
    )
    records["at"] = array
    return records["at"]


def _locked(array):
    copy = array.copy()
    copy.flags.writeable = False
    return copy


class OnlyDlpack:
    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **options):
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._array.__dlpack_device__()


class OnDevice(OnlyDlpack):
    def __dlpack_device__(self):
        return (2, 0)  # kDLCUDA


class OnlyInterface:
    def __init__(self, array):
        self._array = array
        self.__array_interface__ = array.__array_interface__


@pytest.fixture(scope="module")
def scene():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene


@pytest.fixture(scope="module")
def expected(scene):
    return scene.closest_hit(SETTING.origins, SETTING.directions).array


@pytest.mark.parametrize("form", FORMS)
def test_rays_of_any_layout(scene, expected, form):
    hits = scene.closest_hit(FORMS[form](SETTING.origins), FORMS[form](SETTING.directions))
    assert np.array_equal(hits.array, expected)


@pytest.mark.parametrize("form", FORMS)
def test_packed_rays_of_any_layout(scene, expected, form):
    n = len(SETTING.origins)
    packed = np.zeros((n, 8), np.float32)
    packed[:, :3], packed[:, 4:7], packed[:, 7] = SETTING.origins, SETTING.directions, np.inf
    assert np.array_equal(scene.closest_hit(FORMS[form](packed)).array, expected)


@pytest.mark.parametrize("form", FORMS)
def test_meshes_of_any_layout(expected, form):
    scene = raysheaf.Scene()
    triangles = SETTING.triangles.astype(np.int64)
    if form not in ("float64", "long double"):
        triangles = FORMS[form](triangles)
    mesh = scene.add(FORMS[form](SETTING.vertices), triangles)
    assert np.array_equal(scene.closest_hit(SETTING.origins, SETTING.directions).array, expected)
    scene.update(mesh, FORMS[form](SETTING.vertices * 0))
    scene.update(mesh, FORMS[form](SETTING.vertices))
    assert np.array_equal(scene.closest_hit(SETTING.origins, SETTING.directions).array, expected)


def test_unaligned_arrays_are_copied(scene):
    """The CPU may tolerate unaligned access, so the test inspects the converted arrays."""
    triangles, points = _unaligned(SETTING.triangles), _unaligned(np.ones((5, 3)))
    for read, given in (
        (_arrays.triangles(triangles), triangles),
        (_arrays.doubles(points, ""), points),
    ):
        assert read.flags.aligned and read.flags.c_contiguous and np.array_equal(read, given)
    n = len(SETTING.origins)
    out = np.zeros(n * raysheaf.HIT_DTYPE.itemsize + 1, np.uint8)[1:].view(raysheaf.HIT_DTYPE)
    with pytest.raises(ValueError, match=r"^out: writable Hits .* in C order, not aligned, are"):
        scene.closest_hit(SETTING.origins, SETTING.directions, out=raysheaf.Hits(out))


@pytest.mark.parametrize("told", ["raise", "warn"])
def test_values_beyond_float32_raise_no_warning(told):
    tiny, huge, beyond = 1e-60, 1e300, np.longdouble(2) ** 1020 * 64
    corners = np.array([[tiny, 0, 5], [4, tiny, 5], [0, 4, 5]])
    origins = np.array([[1, 1, tiny], [1, tiny, 0]])
    matrix = np.eye(3, 4) + np.fliplr(np.eye(3, 4)) * tiny
    packed = [[1, 1, tiny, tiny, 0, 0, 1, huge]] * 2
    with np.errstate(all=told), warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = raysheaf.Scene()
        mesh = scene.add(corners, [[0, 1, 2]], transform=matrix)
        scene.update(mesh, corners)
        assert scene.any_hit(origins, [tiny, 0, 1], t_min=tiny, t_max=huge).all()
        assert scene.any_hit(origins[:, None], np.array([[tiny, 0, 1]] * 3)).all()
        assert scene.any_hit(packed).all()
        with pytest.raises(raysheaf.InvalidError, match="not finite"):
            scene.update(mesh, corners * huge)
        assert _arrays.doubles(np.array([[beyond, 1, 2]]), "").max() > huge


@pytest.mark.parametrize("dtype", ["u1", "i2", "u2", "i4", "u4", "i8", "u8", ">i4"])
def test_triangles_of_any_integer(dtype):
    scene = raysheaf.Scene()
    scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], np.array([[0, 1, 2]], dtype))
    assert scene.any_hit([0.2, 0.2, 0], [0, 0, 1])


def test_integers_are_real_numbers(scene):
    hits = scene.closest_hit(np.zeros((2, 3), np.int8), np.array([[0, 0, 1], [1, 0, 0]]))
    assert hits.shape == (2,)


def test_large_batches_are_packed_as_small_ones(scene):
    rng = np.random.default_rng(3)
    origins, directions = rng.normal(size=(50_000, 3)), rng.normal(size=(3, 50_000)).T
    t_max = np.arange(50_000)[::-1]
    whole = scene.closest_hit(origins, directions, t_max=t_max).array
    packed = np.zeros((50_000, 8), np.float32)
    packed[:, :3], packed[:, 4:7], packed[:, 7] = origins, directions, t_max
    assert np.array_equal(whole, scene.closest_hit(packed).array)


def test_wrong_rays_far_in_are_named(scene):
    origins, directions = np.zeros((70_000, 3)), np.ones((70_000, 3))
    directions[[40_001, 69_999], 1] = np.nan
    with pytest.raises(ValueError, match=r"directions\[40001\]"):
        scene.closest_hit(origins, directions)
    with pytest.raises(ValueError, match=r"directions\[57, 101\]"):
        scene.any_hit(origins.reshape(100, 700, 3), directions.reshape(100, 700, 3))


@pytest.mark.parametrize(
    ("starts", "ways", "limits"),
    [
        ((1, 50), (7, 1), ()),
        ((50, 1), (1, 7), (50, 7)),
        ((50, 1), (3,), (50, 1)),
        ((5, 10, 1, 1), (3, 4), ()),
        ((5, 1, 10), (1, 4, 1), ()),
        ((1, 0), (3, 1), ()),
        ((), (1, 5, 1), (2, 5, 3)),
    ],
)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_arrays_that_repeat(scene, starts, ways, limits, dtype):
    rng = np.random.default_rng(4)
    origins, directions = (rng.normal(size=(*shape, 3)).astype(dtype) for shape in (starts, ways))
    t_max = rng.uniform(1, 3, limits).astype(dtype)
    shape = np.broadcast_shapes(starts, ways, limits)
    packed = np.zeros((*shape, 8), np.float32)
    packed[..., :3], packed[..., 4:7], packed[..., 7] = origins, directions, t_max
    expected = scene.closest_hit(packed)
    hits = scene.closest_hit(origins, directions, t_max=t_max)
    assert hits.shape == shape and np.array_equal(hits.array, expected.array)
    assert np.array_equal(hits.side, expected.side)
    counts = scene.hit_counts(origins[..., ::-1][..., ::-1], directions, t_max=t_max)
    assert np.array_equal(counts, scene.hit_counts(packed))


def test_arrays_that_repeat_are_read_in_place():
    from raysheaf._rays import batch_of

    points, suns = np.ones((1, 100_000, 3)), np.ones((50, 1, 3), np.float32)
    tracemalloc.start()
    batch_of(points, suns, None, None)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100_000


def test_wrong_rays_of_arrays_that_repeat_are_named(scene):
    directions = np.ones((40, 1, 3))
    directions[17, 0, 1] = np.nan
    with pytest.raises(ValueError, match=r"directions\[17, 0\]"):
        scene.closest_hit(np.zeros((1, 3000, 3)), directions)


def test_packed_rays_are_read_in_place():
    from raysheaf._rays import batch_of

    rays = np.ones((5, 8), np.float32)
    assert np.shares_memory(batch_of(rays, None, None, None).rays, rays)
    grid = rays.reshape(5, 1, 8)
    assert np.shares_memory(batch_of(grid, None, None, None).rays, rays)


def test_soups():
    corners = SETTING.vertices[SETTING.triangles]
    scenes = [raysheaf.Scene() for _ in range(3)]
    scenes[0].add(SETTING.vertices, SETTING.triangles)
    scenes[1].add(corners)
    mesh = scenes[2].add(corners.reshape(-1, 3) * 0)
    scenes[2].update(mesh, corners)
    answers = [s.closest_hit(SETTING.origins, SETTING.directions).array.tobytes() for s in scenes]
    assert answers[0] == answers[1] == answers[2]
    with pytest.raises(raysheaf.InvalidError, match="4 vertices are not a multiple of three"):
        raysheaf.Scene().add(np.zeros((4, 3)))


# Lifetimes.


def test_arrays_may_be_deleted_or_changed_after_a_call(expected):
    scene = raysheaf.Scene()
    vertices, triangles = SETTING.vertices.copy(), SETTING.triangles.copy()
    scene.add(vertices, triangles)
    vertices[:], triangles[:] = np.nan, 2**32 - 1
    del vertices, triangles
    gc.collect()
    assert np.array_equal(scene.closest_hit(SETTING.origins, SETTING.directions).array, expected)


def test_arrays_may_be_deleted_while_a_query_reads_them(scene, expected):
    copies = 300
    rays = np.zeros((copies, len(SETTING.origins), 8), np.float32)  # read in place
    rays[..., :3], rays[..., 4:7], rays[..., 7] = SETTING.origins, SETTING.directions, np.inf
    given, answers = [rays], []
    del rays
    asking = threading.Thread(target=lambda: answers.append(scene.closest_hit(given.pop())))
    asking.start()
    while given:
        pass
    junk = []
    while asking.is_alive():
        gc.collect()
        junk = [np.full(len(SETTING.origins) * 8 * copies, np.nan, np.float32) for _ in range(3)]
    asking.join()
    assert all(np.array_equal(row, expected) for row in answers[0].array) and len(junk) in (0, 3)


def test_results_outlive_the_scene():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    rows = scene.all_hits(SETTING.origins, SETTING.directions)
    t, total = rows.hits.t, float(rows.hits.t.sum())
    del scene, rows
    gc.collect()
    junk = [np.full(1000, 7.0) for _ in range(100)]
    assert float(t.sum()) == total and junk


# Invalid arguments.

RAY = [0.0, 0, 0], [0.0, 0, 1]
WRONG = [
    (TypeError, r"origins: .*shape \(\) and dtype object", dict(origins=None)),
    (TypeError, r"origins: .*dtype <U3", dict(origins="abc")),
    (TypeError, r"origins: .*complex128.*real", dict(origins=np.zeros(3, complex))),
    (TypeError, r"directions: .*bool", dict(directions=[True, False, True])),
    (TypeError, r"directions: cannot be read", dict(directions=[[1, 2, 3], [1, 2]])),
    (TypeError, r"directions: lies on a device", dict(directions=OnDevice(np.zeros(3)))),
    (ValueError, r"origins: .*shape \(4,\).*\(\.\.\., 3\)", dict(origins=[1, 2, 3, 4])),
    (ValueError, r"origins: .*shape \(\)", dict(origins=1.0)),
    (ValueError, r"directions: .*shape \(3, 0\)", dict(directions=np.zeros((3, 0)))),
    (
        ValueError,
        r"origins \(2, 3\), directions \(5, 3\)",
        dict(origins=np.zeros((2, 3)), directions=np.ones((5, 3))),
    ),
    (ValueError, r"t_max \(4,\)", dict(origins=np.zeros((3, 3)), t_max=[1, 2, 3, 4])),
    (TypeError, r"t_min: .*<U1", dict(t_min="0")),
    (ValueError, r"origins: the origin is not finite", dict(origins=[0, np.nan, 0])),
    (
        ValueError,
        r"origins\[1, 0\]: the origin is not finite in float32",
        dict(origins=[[[0, 0, 0]], [[0, 1e200, 0]]]),
    ),
    (
        ValueError,
        r"directions\[2\]: the direction is zero",
        dict(directions=[[1, 0, 0], [0, 1, 0], [0, 0, 0]]),
    ),
    (ValueError, r"t_min: t_min is negative", dict(t_min=-1)),
    (ValueError, r"t_min\[1\]: t_min is larger", dict(t_min=[1, 3], t_max=2)),
    (ValueError, r"t_max: t_max is not a number", dict(t_max=np.nan)),
    (ValueError, r"mask: -1 is given", dict(mask=-1)),
    (ValueError, r"mask: 4294967296 is given", dict(mask=2**32)),
    (TypeError, r"mask: 1.5 is given", dict(mask=1.5)),
    (ValueError, r"method: 'fast' is given", dict(method="fast")),
    (TypeError, r"statistics: list", dict(statistics=[])),
]


@pytest.mark.parametrize("query", ["closest_hit", "any_hit", "all_hits", "hit_counts"])
@pytest.mark.parametrize(
    "kind, message, given", WRONG, ids=lambda x: x if isinstance(x, str) else ""
)
def test_wrong_rays(scene, query, kind, message, given):
    with pytest.raises(kind, match=message):
        getattr(scene, query)(**{"origins": RAY[0], "directions": RAY[1], **given})


def test_wrong_packed_rays(scene):
    rays = np.ones((4, 8))
    rays[2, 5] = np.inf
    with pytest.raises(ValueError, match=r"rays\[2\].direction: the direction is not finite"):
        scene.any_hit(rays)
    with pytest.raises(ValueError, match=r"rays: .*shape \(4, 3\).*\(\.\.\., 8\)"):
        scene.any_hit(np.ones((4, 3)))
    with pytest.raises(TypeError, match="t_min, t_max"):
        scene.any_hit(np.ones((4, 8)), t_max=3)


WRONG_MESHES = [
    (ValueError, r"vertices: .*\(3, 2\).*\(n, 3\)", np.zeros((3, 2)), [[0, 1, 2]]),
    (ValueError, r"vertices: .*\(2, 3, 3\).*\(n, 3\)", np.zeros((2, 3, 3)), [[0, 1, 2]]),
    (TypeError, r"vertices: .*object", [[0, 0, None]], [[0, 0, 0]]),
    (ValueError, r"triangles: .*\(1, 4\)", np.zeros((4, 3)), [[0, 1, 2, 3]]),
    (ValueError, r"triangles: .*\(3,\)", np.zeros((3, 3)), [0, 1, 2]),
    (TypeError, r"triangles: .*float64", np.zeros((3, 3)), [[0.0, 1, 2]]),
    (ValueError, r"triangles: \[0, 2\] of .* is -1", np.zeros((3, 3)), [[0, 1, -1]]),
    (ValueError, r"triangles: \[0, 1\] of .* is 4294967296", np.zeros((3, 3)), [[0, 2**32, 1]]),
    (
        ValueError,
        r"meshes\[0\].triangles\[1\]: index 2 is 3",
        np.zeros((3, 3)),
        [[0, 1, 2], [0, 1, 3]],
    ),
    (
        ValueError,
        r"meshes\[0\].positions\[1\]: .*not finite",
        [[0, 0, 0], [0, np.nan, 0], [1, 1, 1]],
        [[0, 1, 2]],
    ),
    (
        ValueError,
        r"meshes\[0\].positions\[2\]: .*not finite",
        [[0, 0, 0], [0, 0, 0], [1e300, 1, 1]],
        [[0, 1, 2]],
    ),
    (
        ValueError,
        r"meshes\[0\].positions\[0\]: .*farther out",
        [[1e19, 0, 0], [0, 0, 0], [1, 1, 1]],
        [[0, 1, 2]],
    ),
]


@pytest.mark.parametrize("kind, message, vertices, triangles", WRONG_MESHES)
def test_wrong_meshes(kind, message, vertices, triangles):
    scene = raysheaf.Scene()
    with pytest.raises(kind, match=message):
        scene.add(vertices, triangles)
    assert scene.meshes == []


@pytest.mark.parametrize(
    "kind, message, transform",
    [
        (ValueError, r"transform: .*\(3, 3\)", np.eye(3)),
        (ValueError, r"last row .*\[0.0, 0.0, 0.0, 2.0\]", np.diag([1, 1, 1, 2])),
        (ValueError, "not finite", np.full((3, 4), np.inf)),
        (TypeError, "transform: .*complex", np.eye(4) * 1j),
    ],
)
def test_wrong_transforms(kind, message, transform):
    scene = raysheaf.Scene()
    with pytest.raises(kind, match=message):
        scene.add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], transform=transform)
    assert scene.meshes == []


def test_errors_have_a_sentence_and_a_place_and_can_be_pickled(scene):
    with pytest.raises(raysheaf.Error) as caught:
        scene.any_hit([0, 0, 0], [0, 0, 0])
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.code, error.place) == ("invalid_data", "directions")
    assert str(error) == "directions: the direction is zero in float32"
    assert isinstance(error, ValueError)


def test_a_dtype_that_is_not_a_hit():
    with pytest.raises(TypeError, match="HIT_DTYPE"):
        raysheaf.Hits(np.zeros(3))
