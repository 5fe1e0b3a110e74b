"""The method in two dimensions, small enough to look at: a room with two lamps, a floor, and meshes of
segments. Rays are made, sorted, bundled and culled as the renderer does it with its spheres, cones and
triangles. What pictures.py draws.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

BRANCHING = 4

Point = tuple[float, float]


@dataclass
class Mesh:
    """A round outline of segments, and the circle around it that culling tests first."""

    center: Point
    radius: float
    corners: list[Point]

    def segments(self) -> list[tuple[Point, Point]]:
        return list(zip(self.corners, self.corners[1:] + self.corners[:1]))


@dataclass
class Ray:
    origin: Point
    direction: Point
    length: float


@dataclass
class Node:
    """A circle around the origins and a cone around the directions: the paper's bound."""

    rays: list[int]
    center: Point
    radius: float
    axis: float  # an angle
    half: float
    children: list["Node"] = field(default_factory=list)


def polygon(x: float, y: float, radius: float, sides: int, turn: float) -> Mesh:
    at = [turn + 2 * math.pi * i / sides for i in range(sides)]
    return Mesh((x, y), radius, [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in at])


MESHES = [
    polygon(300, 165, 34, 11, 0.2),
    polygon(420, 105, 30, 9, 0.5),
    polygon(560, 190, 42, 13, 0.1),
    polygon(130, 180, 38, 12, 0.7),
    polygon(640, 70, 26, 8, 0.3),
]
LAMPS = [(215.0, 22.0), (500.0, 22.0)]
FLOOR, PIXELS = 288.0, 32


def shadow_rays() -> list[Ray]:
    """Rays from each lamp to the points of the floor that the pixels see, pixel by pixel."""
    rays = []
    for pixel in range(PIXELS):
        x = 25 + 640 * (pixel + 0.5) / PIXELS
        for lamp in LAMPS:
            length = math.dist(lamp, (x, FLOOR))
            rays.append(Ray(lamp, ((x - lamp[0]) / length, (FLOOR - lamp[1]) / length), length))
    return rays


def key(ray: Ray) -> tuple[int, int]:
    """The lamp, then the direction in 64 steps, as in the keys of shadow rays."""
    angle = math.atan2(ray.direction[1], ray.direction[0])
    return LAMPS.index(ray.origin), int(angle / math.pi * 64)


def bound(rays: list[Ray], chosen: list[int]) -> tuple[Point, float, float, float]:
    xs = [rays[i].origin[0] for i in chosen]
    ys = [rays[i].origin[1] for i in chosen]
    center = ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2)
    radius = max(math.dist(center, rays[i].origin) for i in chosen)
    angles = [math.atan2(rays[i].direction[1], rays[i].direction[0]) for i in chosen]
    axis = (min(angles) + max(angles)) / 2
    return center, radius, axis, (max(angles) - min(angles)) / 2


def levels(rays: list[Ray], order: list[int]) -> list[list[Node]]:
    """The leaves, then each level above, until a level has one node."""
    groups = [order[i : i + BRANCHING] for i in range(0, len(order), BRANCHING)]
    level = [Node(g, *bound(rays, g)) for g in groups]
    all_levels = [level]
    while len(level) > 1:
        parents = []
        for i in range(0, len(level), BRANCHING):
            children = level[i : i + BRANCHING]
            chosen = [r for child in children for r in child.rays]
            parents.append(Node(chosen, *bound(rays, chosen), children))
        all_levels.append(parents)
        level = parents
    return all_levels


def meets(node: Node, center: Point, radius: float) -> bool:
    """Does { o + t d : o in the circle, d in the cone, t >= 0 } come within `radius` of the point?"""
    x, y = center[0] - node.center[0], center[1] - node.center[1]
    distance, reach = math.hypot(x, y), node.radius + radius
    if distance <= reach:
        return True
    off = abs(math.remainder(math.atan2(y, x) - node.axis, 2 * math.pi)) - node.half
    return off <= 0 or (off < math.pi / 2 and distance * math.sin(off) <= reach)


def circle_of(segment: tuple[Point, Point]) -> tuple[Point, float]:
    (ax, ay), (bx, by) = segment
    return ((ax + bx) / 2, (ay + by) / 2), math.dist(*segment) / 2


def first_hit(ray: Ray) -> float:
    """The distance to the first segment that the ray hits, or its whole length."""
    best = ray.length
    for mesh in MESHES:
        for (ax, ay), (bx, by) in mesh.segments():
            ex, ey = bx - ax, by - ay
            det = ray.direction[0] * ey - ray.direction[1] * ex
            if det == 0:
                continue
            wx, wy = ax - ray.origin[0], ay - ray.origin[1]
            t = (wx * ey - wy * ex) / det
            s = (wx * ray.direction[1] - wy * ray.direction[0]) / det
            if t > 0 and 0 <= s <= 1:
                best = min(best, t)
    return best
