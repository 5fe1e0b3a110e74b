"""Tests an installed wheel. Run it with a Python that has the wheel and numpy; it prints one line.

It compares a batch of rays with brute force, and runs the command line and a traced image. OpenGL
must work or be refused in one sentence, and so must a window without a display. No library that the
wheel includes may be loaded from the system instead. Its argument, if any, is the emulator that runs
this Python, by which it then starts the command line.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import raysheaf
from raysheaf.bench import rays_at, wavy_ball


def loaded():
    """The shared libraries of this process, if the system lists them."""
    maps = Path("/proc/self/maps")
    lines = maps.read_text(encoding="utf-8").splitlines() if maps.exists() else []
    return {Path(line.split(None, 5)[5]) for line in lines if ".so" in line and "/" in line}


def stem(path):
    """"libtbb" for libtbb.so.12 and for libtbb-1a2b3c4d.so.12.8."""
    return path.name.split(".so")[0].split("-")[0]


def main():
    package = Path(raysheaf.__file__).parent
    scene = raysheaf.Scene()
    scene.add(*wavy_ball(2000))
    rays = rays_at(5000)
    hits = scene.closest_hit(*rays)
    assert 0.3 < hits.hit.mean() < 1
    assert np.array_equal(hits.array, scene.closest_hit(*rays, method="brute").array)

    carried = package.parent / "raysheaf.libs"
    names = {stem(path) for path in carried.iterdir()}
    assert {"libtbb", "libhwy"} <= names, names
    strangers = [p for p in loaded() if stem(p) in names and p.parent != carried]
    assert not strangers, strangers

    picture = raysheaf.render("builtin:cornell", width=64, height=48)
    assert picture.image.std() > 10
    try:
        raysheaf.render("builtin:cornell", width=64, height=48, primary="raster")
        graphics = "OpenGL works"
    except raysheaf.Error as error:
        assert error.code == "no_graphics", error
        graphics = f"no OpenGL ({error.sentence})"

    programs = [sys.executable, "-m", "raysheaf"]
    if len(sys.argv) > 1:
        programs = [sys.argv[1], str(package / "bin" / "raysheaf")]
    with tempfile.TemporaryDirectory() as folder:
        command = [*programs, "render", "builtin:cornell", "--size", "32x32"]
        command += ["--primary", "trace", "--quiet", "-o", "c.png"]
        subprocess.run(command, cwd=folder, check=True)
        assert Path(folder, "c.png").read_bytes().startswith(b"\x89PNG")

    command = [*programs, "view", "builtin:cornell"]
    nowhere = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    view = subprocess.run(command, env=nowhere, capture_output=True, text=True, check=False)
    assert view.returncode not in (0, -6, -11) and view.stderr.count("\n") == 1, view
    print(f"raysheaf {raysheaf.__version__} works from {package}; {graphics}")


if __name__ == "__main__":
    main()
