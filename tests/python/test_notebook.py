"""The notebook runs from top to bottom and shows images: as plain code, and in Jupyter."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

PATH = Path(__file__).parents[2] / "examples/python/frames.ipynb"


def shown_by(source, names):
    """The value of a cell's last expression, which the notebook displays."""
    *statements, last = ast.parse(source).body
    exec(compile(ast.Module(statements, []), str(PATH), "exec"), names)
    if isinstance(last, ast.Expr):
        return eval(compile(ast.Expression(last.value), str(PATH), "eval"), names)
    exec(compile(ast.Module([last], []), str(PATH), "exec"), names)
    return None


def test_its_code(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    cells = json.loads(PATH.read_text(encoding="utf-8"))["cells"]
    names: dict = {}
    values = [shown_by("".join(c["source"]), names) for c in cells if c["cell_type"] == "code"]
    pictures = [value._repr_png_() for value in values if hasattr(value, "_repr_png_")]
    assert len(pictures) == 3
    assert all(p.startswith(b"\x89PNG") and len(p) > 5000 for p in pictures)
    assert names["picture"].image.std() > 10
    assert "total_ms" in values[-1] and capsys.readouterr().out


def test_it_contains_no_outputs():
    for cell in json.loads(PATH.read_text(encoding="utf-8"))["cells"]:
        assert not cell.get("outputs") and cell.get("execution_count") is None


def test_in_jupyter(tmp_path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(PATH, as_version=4)
    done = nbclient.NotebookClient(
        notebook,
        timeout=120,
        kernel_name="python3",
        resources={"metadata": {"path": str(tmp_path)}},
    ).execute()
    images = [
        output
        for cell in done.cells
        for output in cell.get("outputs", [])
        if "image/png" in output.get("data", {})
    ]
    assert len(images) == 3
