"""Memory for results from the caller: it is written in place, or refused with a reason."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

SETTING = make_setting(7)
RAYS = SETTING.origins, SETTING.directions
COUNT = len(SETTING.origins)
KINDS = [
    ("any_hit", "bool"),
    ("any_hit", "uint8"),
    ("hit_counts", "uint32"),
    ("hit_counts", "int32"),
]


@pytest.fixture(scope="module")
def scene():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene


def test_room_for_results_is_used(scene):
    out = raysheaf.Hits.empty(COUNT)
    hits = scene.closest_hit(*RAYS, out=out)
    assert hits is out and np.array_equal(out.array, scene.closest_hit(*RAYS).array)
    with pytest.raises(ValueError, match=r"out: .*shape \(3,\)"):
        scene.closest_hit(*RAYS, out=raysheaf.Hits.empty(3))
    with pytest.raises(ValueError, match="not in C order"):
        strided = raysheaf.Hits.empty(2 * COUNT)[::2]
        scene.closest_hit(*RAYS, out=strided)
    with pytest.raises(ValueError, match="out: read-only Hits"):
        out = raysheaf.Hits(locked(out.array))
        scene.closest_hit(*RAYS, out=out)
    with pytest.raises(TypeError, match="out: ndarray"):
        scene.closest_hit(*RAYS, out=np.zeros(3))


def locked(array):
    array.flags.writeable = False
    return array


@pytest.mark.parametrize("method", ["dual", "brute"])
@pytest.mark.parametrize("kind, dtype", KINDS)
def test_numbers_go_into_room(scene, kind, dtype, method):
    ask = getattr(scene, kind)
    answer = ask(*RAYS, method=method)
    assert answer.any() and not answer.all()
    memory = np.full(COUNT + 2, 7, dtype)
    out = memory[1:-1]
    assert ask(*RAYS, method=method, out=out) is out
    assert np.array_equal(out, answer) and memory[[0, -1]].tolist() == [memory[0]] * 2
    grid = np.empty((3, COUNT // 3), dtype)
    assert ask(*(a.reshape(3, -1, 3) for a in RAYS), method=method, out=grid) is grid
    assert np.array_equal(grid.ravel(), answer)
    one = np.empty((), dtype)
    ask(RAYS[0][5], RAYS[1][5], method=method, out=one)
    assert one == answer[5]
    assert ask(np.zeros((0, 3)), [0, 0, 1], out=np.empty(0, dtype)).shape == (0,)


@pytest.mark.parametrize("kind, dtype", KINDS)
def test_unsuitable_memory_for_results(scene, kind, dtype):
    ask = getattr(scene, kind)
    wanted = rf"a writable one of shape \({COUNT},\) and dtype \w+ or \w+ in C order is expected"
    raw = np.zeros(4 * COUNT + 1, np.uint8)[1:]
    wrong = {
        rf"out: an array of shape \(3,\) and dtype {dtype} is given; {wanted}": np.empty(3, dtype),
        f"dtype float32 is given; {wanted}": np.empty(COUNT, np.float32),
        f"dtype {dtype}, not in C order, is given; {wanted}": np.empty(2 * COUNT, dtype)[::2],
        f"out: a read-only array of .* is given; {wanted}": locked(np.empty(COUNT, dtype)),
    }
    if np.dtype(dtype).itemsize > 1:
        wrong["dtype >.4 is given"] = np.empty(COUNT, np.dtype(dtype).newbyteorder(">"))
        wrong["not aligned, is given"] = raw.view(dtype)
    for sentence, out in wrong.items():
        with pytest.raises(ValueError, match=sentence):
            ask(*RAYS, out=out)
    for out in ([0] * COUNT, raysheaf.Hits.empty(COUNT), 3):
        with pytest.raises(TypeError, match="out: .* is given; an array of numpy or on a CUDA"):
            ask(*RAYS, out=out)
