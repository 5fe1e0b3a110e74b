"""Hits of one ray that lie at one place, of which one counts."""

from __future__ import annotations

import numpy as np

from ._mesh_space import Floats, Ints

Found = tuple[Ints, Ints, Floats]  # faces, rays and places; sorted by ray, then from near to far


def apart(found: Found, origins: Floats, directions: Floats, same_place: float) -> Found:
    """Without those hits that are no farther than `same_place` behind the last one that is kept."""
    faces, rays, places = found
    ways = directions[rays]
    with np.errstate(all="ignore"):
        along = np.einsum("ij,ij->i", places - origins[rays], ways) / np.linalg.norm(ways, axis=1)
        near = np.zeros(len(rays), np.bool_)  # to the hit before, of the same ray
        near[1:] = (rays[1:] == rays[:-1]) & ~(np.diff(along) > same_place)
        kept = ~near
        # Mostly no hit of a chain is far from its first one.
        begins = np.flatnonzero(kept)
        ends = np.append(begins[1:], len(rays))
        chain = np.cumsum(kept) - 1
        long = np.unique(chain[along - along[begins[chain]] > same_place])
    for begin, end in zip(begins[long].tolist(), ends[long].tolist()):
        while begin < end:
            kept[begin] = True
            begin += int(np.searchsorted(along[begin:end], along[begin] + same_place, "right"))
    return faces[kept], rays[kept], places[kept]


def nearest(found: Found, most: int) -> Found:
    """At most so many hits a ray."""
    faces, rays, places = found
    index = np.arange(len(rays))
    begins = np.ones(len(rays), np.bool_)
    begins[1:] = rays[1:] != rays[:-1]
    kept = index - np.maximum.accumulate(np.where(begins, index, 0)) < most
    return faces[kept], rays[kept], places[kept]
