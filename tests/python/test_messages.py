"""Errors name the invalid argument and its element."""

from __future__ import annotations

import numpy as np
import pytest

import raysheaf


@pytest.fixture(scope="module")
def scene():
    scene = raysheaf.Scene()
    scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
    return scene


FIVE, GRID, UP = np.zeros((5, 3)), np.zeros((2, 5, 3)), [0, 0, 1]
ZERO = "the direction is zero in float32"
WRONG_RAYS = [
    # An argument that applies to all rays has no index; one for several rays has the index in its
    # array.
    (f"directions: {ZERO}", FIVE, [0, 0, 0], {}),
    (f"directions[0]: {ZERO}", FIVE, [[0, 0, 0]], {}),
    (f"directions[1]: {ZERO}", GRID, [UP, [0, 0, 0], UP, UP, UP], {}),
    (f"directions[1, 0]: {ZERO}", GRID, [[UP], [[0, 0, 0]]], {}),
    (
        "origins[1]: the origin is not finite in float32",
        [[0, 0, 0], [0, np.nan, 0]],
        np.ones((4, 2, 3)),
        {},
    ),
    ("t_min[2]: t_min is negative", GRID, UP, {"t_min": [1, 1, -1, 1, 1]}),
    ("t_min: t_min is negative", GRID, UP, {"t_min": -1}),
    ("t_max[1, 0]: t_max is not a number", GRID, UP, {"t_max": [[1], [np.nan]]}),
    # For an empty interval, the error names the end that was given or that varies over the rays.
    ("t_max: t_max is smaller than t_min", FIVE, UP, {"t_max": -1}),
    ("t_max[3]: t_max is smaller than t_min", FIVE, UP, {"t_max": [1, 1, 1, -1, 1]}),
    ("t_max[3]: t_max is smaller than t_min", FIVE, UP, {"t_min": 2, "t_max": [3, 3, 3, 1, 3]}),
    ("t_min: t_min is larger than t_max", FIVE, UP, {"t_min": 2, "t_max": 1}),
    ("t_min[1]: t_min is larger than t_max", FIVE, UP, {"t_min": [0, 2, 0, 0, 0], "t_max": 1}),
]


@pytest.mark.parametrize("message, origins, directions, interval", WRONG_RAYS)
def test_the_element_of_the_argument_is_named(scene, message, origins, directions, interval):
    with pytest.raises(raysheaf.InvalidError) as caught:
        scene.any_hit(origins, directions, **interval)
    assert str(caught.value) == message


def test_packed_rays_have_their_own_names(scene):
    rays = np.tile(np.float32([0, 0, 0, 0, 0, 0, 1, 9]), (2, 2, 1))
    rays[1, 0, 7] = -1
    with pytest.raises(ValueError, match=r"^rays\[1, 0\]\.t_min: t_min is larger than t_max$"):
        scene.any_hit(rays)


@pytest.mark.parametrize("kind", ["closest_hit", "any_hit", "hit_counts", "all_hits"])
def test_more_rays_than_a_query_answers(scene, kind):
    ask, many = getattr(scene, kind), np.broadcast_to(np.float32(1), (2**31,))
    wide = np.broadcast_to(np.float32(1), (10**5, 1, 3))
    for rays in (
        {"origins": [0, 0, 0], "directions": UP, "t_max": many},
        {"origins": wide, "directions": wide.reshape(1, -1, 3)},
        {"origins": np.broadcast_to(np.float32(1), (2**31, 8))},
    ):
        with pytest.raises(raysheaf.UnsupportedError, match=r"^rays: \d+ rays are more than 2\^31"):
            ask(**rays)


def test_not_enough_memory_for_results(scene, monkeypatch):
    def none(count):
        raise MemoryError("std::bad_alloc")

    monkeypatch.setattr(raysheaf._core, "empty_hits", none)
    with pytest.raises(raysheaf.OutOfMemoryError, match="there is no room for 5000 hits"):
        scene.closest_hit(np.zeros((5000, 3)), UP)


@pytest.mark.skipif(np.lib.NumpyVersion(np.__version__) < "2.0.0", reason="32 axes at most there")
def test_more_axes_than_numpy_supports(scene):
    def ones(axes, *tail):
        return np.ones((1,) * axes + tail)

    assert scene.any_hit(ones(31, 3), UP).ndim == 31
    for rays in (
        {"origins": ones(63, 3), "directions": UP},
        {"origins": [0, 0, 0], "directions": UP, "t_max": ones(32)},
        {"origins": ones(40, 8)},
    ):
        with pytest.raises(ValueError, match=r"^rays: a batch of \d+ axes is given; 31 at most"):
            scene.any_hit(**rays)


class Protocol:
    """A third-party array whose methods fail."""

    def __init__(self, failing, error, device=1):
        self._failing, self._error, self._device = failing, error, device

    def __dlpack_device__(self):
        if self._failing == "device":
            raise self._error
        return self._device, 0

    def __dlpack__(self, **options):
        raise self._error

    def __array__(self, dtype=None, copy=None):
        if self._failing == "array":
            raise self._error
        return np.zeros(3)


class NoArray:
    def __dlpack_device__(self):
        return 1, 0

    def __dlpack__(self, **options):
        raise ValueError("no memory to share")


@pytest.mark.parametrize("error", [ValueError("broken"), KeyError("broken"), OSError("broken")])
def test_errors_of_protocols_name_the_argument(scene, error):
    for failing in ("device", "array"):
        with pytest.raises(TypeError, match="^directions: cannot be read as an array: .*broken"):
            scene.any_hit(UP, Protocol(failing, error))
    scene.any_hit(Protocol("dlpack", error), UP)  # numpy has another way
    with pytest.raises(TypeError, match="^origins: cannot be read as an array: no memory to share"):
        scene.any_hit(NoArray(), UP)
    with pytest.raises(MemoryError):
        scene.any_hit(UP, Protocol("array", MemoryError()))


def test_masks_are_not_overlooked(scene):
    origins = np.ma.array(np.zeros((4, 3)), mask=False)
    assert scene.any_hit(origins, UP).shape == (4,)
    origins[2, 1] = np.ma.masked
    sentence = (
        r"shape \(4, 3\) and dtype float64 is given, of which 1 elements are masked; .*filled"
    )
    with pytest.raises(TypeError, match="^origins: an array of " + sentence):
        scene.any_hit(origins, UP)
    with pytest.raises(TypeError, match="^vertices: an array of " + sentence):
        scene.add(origins, [[0, 1, 2]])
    assert scene.any_hit(origins.filled(0), UP).shape == (4,)
    with pytest.raises(TypeError, match="^out: an array with a mask is given"):
        scene.hit_counts(UP, UP, out=np.ma.array(np.uint32(0), mask=True))


def test_invalid_words(scene):
    for wrong in (np.zeros(3), ["brute"], None, 1):
        with pytest.raises(TypeError, match='^method: .* is given; "dual" or "brute" is expected'):
            scene.any_hit(UP, UP, method=wrong)
        with pytest.raises(TypeError, match="^device: "):
            raysheaf.Scene(device=wrong)
        with pytest.raises(TypeError, match="^primary: "):
            raysheaf.render("builtin:cornell", primary=wrong)


def test_whether_a_scene_has_a_mesh(scene):
    assert 0 in scene and np.uint8(0) in scene
    for other in (1, -1, 2**32, 2**80, "x", None, 0.0, [0], np.zeros(2)):
        assert other not in scene
