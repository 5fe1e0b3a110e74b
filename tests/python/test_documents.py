"""Examples in docstrings and in docs/python.md do what they show."""

from __future__ import annotations

import doctest
import importlib
import os
import pkgutil
from pathlib import Path

import pytest

import raysheaf

ROOT = Path(__file__).parents[2]
MODULES = [m.name for m in pkgutil.iter_modules(raysheaf.__path__) if m.name not in ("__main__", "_core")]
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


@pytest.mark.parametrize("name", ["", *MODULES])
def test_docstrings(name):
    if name == "trimesh":
        pytest.importorskip("trimesh")
    module = importlib.import_module(f"raysheaf.{name}" if name else "raysheaf")
    assert doctest.testmod(module, optionflags=FLAGS).failed == 0


def test_the_page(tmp_path, monkeypatch):
    pytest.importorskip("trimesh")
    monkeypatch.chdir(tmp_path)
    done = doctest.testfile(str(ROOT / "docs/python.md"), module_relative=False, optionflags=FLAGS)
    assert done.attempted > 20 and done.failed == 0


def test_everything_public_is_described():
    for name in raysheaf.__all__:
        thing = getattr(raysheaf, name)
        if not callable(thing):
            continue
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                assert value.__doc__ or member in ("shape", "size"), f"{name}.{member}"


def test_types(tmp_path):
    api = pytest.importorskip("mypy.api")
    package = os.path.dirname(raysheaf.__file__)
    report, errors, code = api.run(
        ["--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(tmp_path), package]
    )
    assert code == 0, report + errors
