"""Queries raysheaf and embreex (Embree's Python binding) with the same rays; exact fractions
decide.

The exit code is 1 if raysheaf is wrong. ./check does not install embreex: `pip install embreex`.
"""

import argparse
import sys
from fractions import Fraction

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

import raysheaf


def exact_t(corners, origin, direction):
    """The parameter at which the ray meets the closed triangle, or None."""
    a, b, c = ([Fraction(float(x)) for x in p] for p in corners)
    o, d = ([Fraction(float(x)) for x in p] for p in (origin, direction))

    def minus(p, q):
        return [x - y for x, y in zip(p, q)]

    def dot(p, q):
        return sum(x * y for x, y in zip(p, q))

    def cross(p, q):
        return [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]

    e, f, k = minus(b, a), minus(c, a), minus(a, o)
    n, m = cross(e, f), cross(k, d)
    det = dot(n, d)
    if det == 0:
        return None
    t, u, v = dot(n, k) / det, dot(m, f) / det, -dot(m, e) / det
    return t if u >= 0 and v >= 0 and u + v <= 1 and t >= 0 else None


def soups(random, triangles):
    """Triangles with integer coordinates, with any coordinates, and with shared corners."""
    yield random.integers(-8, 9, (triangles, 3, 3)).astype(np.float32)
    yield random.uniform(-1, 1, (triangles, 3, 3)).astype(np.float32)
    side = int(np.sqrt(triangles / 2)) + 1
    x, y = np.meshgrid(np.arange(side + 1), np.arange(side + 1))
    heights = random.integers(0, 4, x.shape)
    points = np.stack([x - side // 2, y - side // 2, heights], -1).astype(np.float32)
    p, q, r, s = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    yield np.concatenate(
        [np.stack(t, 2).reshape(-1, 3, 3) for t in ((p, q, r), (p, r, s))]
    )


def targets(random, corners, rays):
    """Corners, midpoints of edges, points of interiors, and points near them."""
    chosen = corners[random.integers(0, len(corners), rays)]
    weights = random.choice([0, 0.25, 0.5, 0.75, 1], (rays, 3))
    weights[weights.sum(1) == 0] = 1
    weights /= weights.sum(1)[:, None]
    return np.einsum("ij,ijk->ik", weights, chosen).astype(np.float32)


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=20)
    options.add_argument("--rays", type=int, default=20_000)
    options.add_argument("--triangles", type=int, default=300)
    chosen = options.parse_args()
    asked = different = ties = embree_wrong = raysheaf_wrong = 0
    for seed in range(chosen.rounds):
        random = np.random.default_rng(seed)
        for corners in soups(random, chosen.triangles):
            end = targets(random, corners, chosen.rays)
            start = (end + random.integers(-9, 10, end.shape)).astype(np.float32)
            direction = (end - start).astype(np.float32)
            direction[(direction == 0).all(1)] = [0, 0, 1]
            scene = raysheaf.Scene()
            scene.add(corners)
            ours = scene.closest_hit(start, direction)
            peer = rtcore_scene.EmbreeScene()
            TriangleMesh(peer, corners)
            theirs = peer.run(start, direction, query="INTERSECT")
            first = np.where(ours.hit, ours.prim_id.astype(np.int64), -1)
            asked += len(first)
            for i in np.flatnonzero(first != theirs):
                different += 1
                ray = start[i], direction[i]
                here = exact_t(corners[first[i]], *ray) if first[i] >= 0 else None
                there = exact_t(corners[theirs[i]], *ray) if theirs[i] >= 0 else None
                if here is not None and here == there:
                    ties += 1
                elif here is None and first[i] >= 0:
                    raysheaf_wrong += 1
                elif there is not None and (here is None or there < here):
                    # The exact parameters differ but round to the same float: then the triangle's
                    # number decides.
                    near = here is not None and np.float32(here) == np.float32(there)
                    ties, raysheaf_wrong = ties + near, raysheaf_wrong + (not near)
                else:
                    embree_wrong += 1
    print(
        f"{asked} rays: {different} first triangles differ; {ties} at one distance, "
        f"{embree_wrong} where Embree is wrong, {raysheaf_wrong} where raysheaf is"
    )
    return raysheaf_wrong != 0


if __name__ == "__main__":
    sys.exit(main())
