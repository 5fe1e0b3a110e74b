"""PyTorch's tensors as arguments, and results as tensors. Skipped without PyTorch."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from conftest import make_setting

import raysheaf

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # PyTorch warns if it was built with another numpy
    torch = pytest.importorskip("torch")

SETTING = make_setting(9)


def tensor(array, dtype=None):
    return torch.tensor(array.tolist(), dtype=dtype or torch.float32)


FORMS = {
    "float32": tensor,
    "float64": lambda a: tensor(a, torch.float64),
    "columns": lambda a: tensor(a.T.copy()).T,
    "every second row": lambda a: tensor(np.repeat(a, 2, axis=0))[::2],
    "part of wider rows": lambda a: tensor(np.concatenate([a, a], 1))[:, 3:],
    "detached": lambda a: tensor(a).requires_grad_().detach(),
}


@pytest.fixture(scope="module")
def expected():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene.closest_hit(SETTING.origins, SETTING.directions).array


@pytest.mark.parametrize("form", FORMS)
def test_tensors_are_arrays(expected, form):
    made = FORMS[form]
    scene = raysheaf.Scene()
    triangles = tensor(SETTING.triangles.astype(np.int64), torch.int64)
    mesh = scene.add(made(SETTING.vertices * 2), triangles)
    scene.update(mesh, made(SETTING.vertices))
    hits = scene.closest_hit(made(SETTING.origins), made(SETTING.directions))
    assert np.array_equal(hits.array, expected)


def test_rays_are_read_in_place(expected):
    scene = raysheaf.Scene()
    scene.add(tensor(SETTING.vertices), SETTING.triangles)
    rays = torch.zeros((len(SETTING.origins), 8))
    rays[:, :3], rays[:, 4:7], rays[:, 7] = (
        tensor(SETTING.origins),
        tensor(SETTING.directions),
        np.inf,
    )
    assert np.array_equal(scene.closest_hit(rays).array, expected)


def test_results_become_tensors():
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    hits = scene.closest_hit(SETTING.origins, SETTING.directions)
    t = torch.from_dlpack(np.ascontiguousarray(hits.t))
    assert t.dtype == torch.float32
    assert t.tolist() == hits.t.tolist()
    found = scene.all_hits(tensor(SETTING.origins), tensor(SETTING.directions))
    assert torch.from_dlpack(found.offsets).tolist() == found.offsets.tolist()


@pytest.mark.parametrize(
    "wrong",
    [
        lambda a: tensor(a).requires_grad_(),
        lambda a: tensor(a).to(torch.bfloat16),
        lambda a: tensor(a).to_sparse(),
        lambda a: tensor(a, torch.complex64),
        lambda a: tensor(a)[:, :2],
        lambda a: torch.empty((3, 3), device="meta"),
    ],
    ids=["with gradient", "bfloat16", "sparse", "complex", "shape", "without data"],
)
def test_unreadable_tensors_are_named(wrong):
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    with pytest.raises((TypeError, ValueError), match="^directions"):
        scene.closest_hit(SETTING.origins, wrong(SETTING.directions))
