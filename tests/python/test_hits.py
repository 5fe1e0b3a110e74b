"""Results of queries can be indexed, iterated and pickled like numpy arrays."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import raysheaf


@pytest.fixture(scope="module")
def scene():
    scene = raysheaf.Scene()
    scene.add([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
    return scene


@pytest.fixture
def hits(scene):
    return scene.closest_hit([[0.25, 0.5, 0], [9, 9, 0], [0.5, 0.25, 0]], [0, 0, 1])


def test_names_are_fields(hits):
    for name in raysheaf.HIT_DTYPE.names:
        assert hits[name].dtype == raysheaf.HIT_DTYPE[name]
        assert np.array_equal(hits[name], getattr(hits, name))
        assert np.shares_memory(hits[name], hits.array)
    assert hits[["t", "u"]].dtype.names == ("t", "u")
    assert hits[0]["t"] == 1
    with pytest.raises(ValueError, match="nothing"):
        hits["nothing"]


def test_indices_are_those_of_arrays(hits):
    for index in (0, -1, np.int64(2), slice(1, None), [2, 0], [], hits.hit, ..., None, (0, None)):
        found = hits[index]
        assert isinstance(found, raysheaf.Hits)
        assert found.array.tobytes() == np.asarray(hits.array[index]).tobytes()
        assert found.shape == hits.array[index].shape
    for wrong in (3, (0, 0), [5], np.ones(7, bool)):
        with pytest.raises(IndexError):
            hits[wrong]
    for wrong in (1.5, {}, ("t", 0), b"t", 1j, [0.0]):
        with pytest.raises(TypeError, match="index: .* is given; integers, slices"):
            hits[wrong]


def test_items(scene, hits):
    assert [float(hit.t) for hit in hits] == [1, np.inf, 1]
    assert [row.shape for row in hits[None]] == [(3,)]
    one = scene.closest_hit([0.25, 0.5, 0], [0, 0, 1])
    with pytest.raises(TypeError, match="a single ray has no items"):
        iter(one)
    with pytest.raises(TypeError):
        len(one)


@pytest.mark.parametrize("wrong", [[1, 2], None, 3, np.void(b"x" * 24)])
def test_objects_that_are_not_arrays(wrong):
    with pytest.raises(TypeError, match="array: .* is given; an array of dtype HIT_DTYPE"):
        raysheaf.Hits(wrong)


def test_one_record_is_one_hit(hits):
    assert raysheaf.Hits(hits.array[0]).shape == () and raysheaf.Hits(hits.array[0]).hit


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_pickling(scene, hits, protocol):
    rows = scene.all_hits([[[0.25, 0.5, 0], [9, 9, 0]]], [0, 0, 1])
    for value in (hits, hits[0], rows):
        again = pickle.loads(pickle.dumps(value, protocol))
        assert type(again) is type(value) and again.shape == value.shape
        for name in ("array", "offsets"):
            assert np.array_equal(getattr(again, name, None), getattr(value, name, None))
    assert pickle.loads(pickle.dumps(rows, protocol))[0, 0].array == rows[0, 0].array


def test_copies(scene, hits):
    assert copy.copy(hits).array is hits.array
    assert not np.shares_memory(copy.deepcopy(hits).array, hits.array)
    rows = copy.deepcopy(scene.all_hits([[0.25, 0.5, 0]], [0, 0, 1]))
    assert rows[0].t.tolist() == [1]
