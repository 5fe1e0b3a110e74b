"""Many small scenes at once, all of whose instances move before each query: raysheaf in one call, a
loop over a `raysheaf.Scene` for each world, and NVIDIA Warp on the CPU, interleaved in one process.

    pip install raysheaf warp-lang
    python bench/worlds.py --json worlds.json

Times are medians of processor time. Warp has its best way: one mesh, whose instances are in a
`warp.Bvh` grouped by world, which is refitted; a ray goes into the space of each instance whose box
it meets.
"""

from __future__ import annotations

import argparse
import importlib
import json
import platform
import re
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np

import raysheaf
from raysheaf.bench import wavy_ball

ROUNDS = 5
TRIANGLES = 1000
CASES = ((10, 64), (10, 256), (1, 64))  # instances and rays of a world


class Case:
    """Rays, and two steps of motion: positions, and quaternions as x, y, z, w."""

    def __init__(self, worlds: int, each: int, rays: int) -> None:
        random = np.random.default_rng(1)
        self.worlds, self.each, self.rays = worlds, each, rays
        self.vertices, self.faces = wavy_ball(TRIANGLES)
        reach = 4.0 if each > 1 else 0.3
        self.steps = []
        for _ in range(2):
            places = random.uniform(-reach, reach, (worlds, each, 3))
            turns = random.normal(size=(worlds, each, 4))
            turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
            self.steps.append((places.astype(np.float32), turns.astype(np.float32)))
        # Many instances are seen from among them, a single one from its inside.
        start = random.uniform(-6, 6, (worlds, rays, 3)) * (each > 1)
        ways = random.normal(size=(worlds, rays, 3))
        ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
        self.origins, self.directions = start.astype(np.float32), ways.astype(np.float32)

    def matrices(self, step: int) -> Any:
        """Those of a step, (worlds, each, 3, 4)."""
        places, turns = self.steps[step]
        x, y, z, w = np.moveaxis(turns.astype(float), -1, 0)
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        turn = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
        return np.concatenate([turn, places[..., None]], axis=-1).astype(np.float32)


Step = Callable[[int], Any]  # the ranges of all rays after a step of motion


def in_one_call(case: Case) -> Step:
    scene = raysheaf.Scene(threads=1)
    mesh = scene.add(case.vertices, case.faces, place=False)
    matrices = [case.matrices(step) for step in range(2)]
    ids = scene.instances(mesh, matrices[0], worlds=range(case.worlds))

    def step(number: int) -> Any:
        scene.set_transforms(ids, matrices[number])
        return scene.closest_hit(case.origins, case.directions, worlds=range(case.worlds)).t

    return step


def in_a_loop(case: Case) -> Step:
    scenes = []
    matrices = [case.matrices(step) for step in range(2)]
    for matrix in matrices[0]:
        scene = raysheaf.Scene(threads=1)
        mesh = scene.add(case.vertices, case.faces, place=False)
        scenes.append((scene, scene.instances(mesh, matrix)))

    def step(number: int) -> Any:
        ranges = []
        for world, (scene, ids) in enumerate(scenes):
            scene.set_transforms(ids, matrices[number][world])
            ranges.append(scene.closest_hit(case.origins[world], case.directions[world]).t)
        return np.array(ranges)

    return step


def by_warp(case: Case) -> Step:
    wp = importlib.import_module("warp")
    wp.config.quiet = True
    wp.init()

    def array(values: Any, dtype: Any) -> Any:
        return wp.array(values, dtype=dtype, device="cpu")

    def place(poses, middle, half, lows, highs):  # type: ignore[no-untyped-def]
        i = wp.tid()
        turn = wp.quat_to_matrix(wp.transform_get_rotation(poses[i]))
        at = wp.transform_point(poses[i], middle)
        reach = wp.vec3(
            wp.dot(wp.abs(turn[0]), half), wp.dot(wp.abs(turn[1]), half), wp.dot(wp.abs(turn[2]), half)
        )
        lows[i] = at - reach
        highs[i] = at + reach

    def cast(bvh, mesh, poses, origins, ways, each, far):  # type: ignore[no-untyped-def]
        i = wp.tid()
        best = float(1.0e30)
        found = int(0)
        query = wp.bvh_query_ray(bvh, origins[i], ways[i], wp.bvh_get_group_root(bvh, i // each))
        while wp.bvh_query_next(query, found, best):
            back = wp.transform_inverse(poses[found])
            start = wp.transform_point(back, origins[i])
            hit = wp.mesh_query_ray(mesh, start, wp.transform_vector(back, ways[i]), best)
            if hit.result:
                best = wp.min(best, hit.t)
        far[i] = wp.inf
        if best < 1.0e30:
            far[i] = best

    vectors, poses = wp.array(dtype=wp.vec3), wp.array(dtype=wp.transform)
    place.__annotations__ = dict(poses=poses, middle=wp.vec3, half=wp.vec3, lows=vectors, highs=vectors)
    cast.__annotations__ = dict(
        bvh=wp.uint64, mesh=wp.uint64, poses=poses, origins=vectors, ways=vectors, each=int,
        far=wp.array(dtype=float),
    )  # fmt: skip
    placing, casting = wp.kernel(place), wp.kernel(cast)
    vertices = case.vertices.astype(np.float32)
    mesh = wp.Mesh(array(vertices, wp.vec3), array(case.faces.ravel().astype(np.int32), wp.int32))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, half = wp.vec3(*map(float, (low + high) / 2)), wp.vec3(*map(float, (high - low) / 2))
    count = case.worlds * case.each
    stands = [
        array(np.concatenate([places, turns], axis=-1).reshape(count, 7), wp.transform)
        for places, turns in case.steps
    ]
    lows, highs = array(np.zeros((count, 3)), wp.vec3), array(np.zeros((count, 3)), wp.vec3)
    wp.launch(placing, count, [stands[0], middle, half, lows, highs], device="cpu")
    groups = array(np.repeat(np.arange(case.worlds, dtype=np.int32), case.each), wp.int32)
    bvh = wp.Bvh(lows, highs, groups=groups)
    origins = array(case.origins.reshape(-1, 3), wp.vec3)
    ways = array(case.directions.reshape(-1, 3), wp.vec3)
    far = wp.zeros(case.worlds * case.rays, dtype=float, device="cpu")

    def step(number: int) -> Any:
        wp.launch(placing, count, [stands[number], middle, half, lows, highs], device="cpu")
        bvh.refit()
        given = [bvh.id, mesh.id, stands[number], origins, ways, case.rays, far]
        wp.launch(casting, len(far), given, device="cpu")
        return far.numpy().reshape(case.worlds, case.rays)

    return step


PROGRAMS = {"raysheaf": in_one_call, "a scene a world": in_a_loop, "warp": by_warp}


def measured(case: Case) -> list[dict[str, Any]]:
    """Rays a second of each program, and its rays that hit where another of them does not."""
    steps: dict[str, Step] = {}
    for name, make in PROGRAMS.items():
        try:
            steps[name] = make(case)
        except ImportError as error:
            print(f"{error.name} is not installed")
    times: dict[str, list[float]] = {name: [] for name in steps}
    for number in range(ROUNDS + 1):
        ranges = {}
        for name, step in steps.items():
            begin = time.process_time()
            ranges[name] = step(number % 2)
            if number > 0:
                times[name].append(time.process_time() - begin)
    rows = []
    for name, found in ranges.items():
        rate = found.size / float(np.median(times[name]))
        other = np.isfinite(found) != np.isfinite(ranges["raysheaf"])
        rows.append(
            {
                "worlds": case.worlds, "instances": case.each, "rays": case.rays, "program": name,
                "rays_a_second": rate, "other_hits": int(np.count_nonzero(other)),
            }
        )  # fmt: skip
        factor = rows[0]["rays_a_second"] / rate
        print(
            f"{case.worlds} worlds, {case.each:2} instances, {case.rays:3} rays each, {name:16}"
            f"{rate / 1e6:8.3f} million rays a second, {factor:5.2f} times as long; "
            f"{rows[-1]['other_hits']} of {found.size} rays hit otherwise",
            flush=True,
        )
    return rows


def processor() -> str:
    try:
        found = re.search(r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text())
    except OSError:
        found = None
    return found[1].strip() if found else platform.processor()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--worlds", type=int, default=4096, help="how many (default: %(default)s)")
    parser.add_argument("--json", metavar="FILE", help="also write the figures to this file")
    given = parser.parse_args()
    print(f"raysheaf {raysheaf.__version__}, {processor()}, one thread")
    rows = [row for case in CASES for row in measured(Case(given.worlds, *case))]
    if given.json:
        facts = {"processor": processor(), "triangles": TRIANGLES, "rounds": ROUNDS, "rows": rows}
        Path(given.json).write_text(json.dumps(facts, indent=2) + "\n")


if __name__ == "__main__":
    main()
