"""Examples in docstrings and in the pages give the results that they show."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import pkgutil
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

import raysheaf

ROOT = Path(__file__).parents[2]
MODULES = [
    m.name for m in pkgutil.iter_modules(raysheaf.__path__) if m.name not in ("__main__", "_core")
]
OPTIONAL = ("mujoco", "trimesh", "yourdfpy")  # a section that imports one of them needs it
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


@pytest.mark.parametrize("name", ["", *MODULES])
def test_docstrings(name):
    if name in OPTIONAL:
        pytest.importorskip(name)
    module = importlib.import_module(f"raysheaf.{name}" if name else "raysheaf")
    assert doctest.testmod(module, optionflags=FLAGS).failed == 0


PAGES = sorted(p for p in (ROOT / "docs").rglob("*.md") if "\n>>> " in p.read_text("utf-8"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_pages(page, tmp_path, monkeypatch):
    missing = [one for one in OPTIONAL if importlib.util.find_spec(one) is None]
    sections = re.split(r"^(?=## )", page.read_text(encoding="utf-8"), flags=re.M)
    text = "".join(
        part for part in sections if not any(f"import {one}\n" in part for one in missing)
    )
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(text, {}, page.stem, str(page), 0)
    done = doctest.DocTestRunner(optionflags=FLAGS).run(examples)
    assert done.attempted > 0 and done.failed == 0


def test_the_pages_are_there():
    assert {"cookbook", "get-started", "python", "tuning"} <= {page.stem for page in PAGES}


def test_the_drawings_are_what_draws_them(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs/site")
    program = runpy.run_path(str(ROOT / "docs/site/pictures.py"))
    program["draw_all"](tmp_path)
    drawn = sorted(tmp_path.glob("*.svg"))
    assert len(drawn) == 4
    for picture in drawn:
        kept = ROOT / "docs/images" / picture.name
        assert picture.read_bytes() == kept.read_bytes(), f"run docs/site/pictures.py: {kept}"


def test_the_readme():
    blocks = re.findall(
        r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S
    )
    assert blocks
    vertices = np.array([[0.0, 0, 5], [4, 0, 5], [0, 4, 5]])
    points = np.array([[1.0, 1, 0], [9, 9, 0]])
    names = {
        "vertices": vertices,
        "triangles": [[0, 1, 2]],
        "origins": points,
        "directions": [0, 0, 1],
        "moved_vertices": vertices + 1,
        "points": points,
        "lamp": np.array([2.0, 2, 9]),
    }
    for block in blocks:
        exec(block, names)
    assert names["hits"].t.tolist() == [5, np.inf] and names["shadowed"].tolist() == [True, False]


def test_everything_public_is_described():
    for name in raysheaf.__all__:
        thing = getattr(raysheaf, name)
        if not callable(thing):
            continue
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                assert value.__doc__ or member in ("shape", "size"), f"{name}.{member}"
