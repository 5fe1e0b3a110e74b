"""The names that `import raysheaf` provides, and the modules that it imports only on first use."""

from __future__ import annotations

import importlib.util
import subprocess
import sys

import pytest

import raysheaf


def printed_by(program: str) -> list[str]:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_modules_come_when_they_are_asked_for():
    names = "[n in sys.modules for n in ('trimesh', 'mujoco', 'raysheaf.bench')]"
    program = f"import sys, raysheaf; print(*{names}); raysheaf.bench.main; print(*{names})"
    assert printed_by(program) == ["False"] * 3 + ["False", "False", "True"]


@pytest.mark.skipif(importlib.util.find_spec("trimesh") is None, reason="trimesh is not installed")
def test_the_adapter_is_there_by_its_name():
    program = "import raysheaf; print(raysheaf.trimesh.RayMeshIntersector.__name__)"
    assert printed_by(program) == ["RayMeshIntersector"]


def test_a_missing_module_is_no_attribute():
    program = "import sys; sys.modules['trimesh'] = None; import raysheaf, inspect; "
    assert printed_by(program + "print(hasattr(raysheaf, 'trimesh'))") == ["False"]
    assert "bench" in printed_by(program + "print(*dict(inspect.getmembers(raysheaf)))")
    said = printed_by(
        program + "\ntry: raysheaf.trimesh\nexcept AttributeError as error: print(error)"
    )
    assert " ".join(said) == "raysheaf.trimesh needs trimesh, which is not installed"


def test_public_names():
    later = {"bench", "mujoco", "radiation", "sensors", "trimesh"}
    assert {*later, *raysheaf.__all__} <= set(dir(raysheaf))
    with pytest.raises(AttributeError, match="module 'raysheaf' has no attribute 'nothing'"):
        raysheaf.nothing
