"""The judge: rays and points against triangles in integers and fractions, without rounding.

It shares nothing with raysheaf except the definitions: edges and corners belong to a triangle, a ray in
the plane of a triangle misses it, and a triangle without area has no hits but has distances.
"""

from fractions import Fraction
from itertools import product

AXES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def whole(vectors):
    """The vectors of floats as integers, and the power of two by which all were multiplied."""
    ratios = [[float(x).as_integer_ratio() for x in vector] for vector in vectors]
    scale = max((d for vector in ratios for _, d in vector), default=1)
    return [tuple(n * (scale // d) for n, d in vector) for vector in ratios], scale


class Ray:
    """A ray with the triangles relative to its origin, in integers."""

    def __init__(self, vertices, origin, direction):
        (self.origin, *self.vertices), self.scale = whole([origin, *vertices])
        (self.direction,), self.direction_scale = whole([direction])

    def crossing(self, face):
        """(t, side, whether on an edge) where the line meets the triangle; side: 1 from the front, -1 from the back."""
        a, b, c = (sub(self.vertices[i], self.origin) for i in face)
        normal = cross(sub(b, a), sub(c, a))
        slope = dot(normal, self.direction)
        if slope == 0:
            return None
        d = self.direction
        volumes = (dot(d, cross(b, c)), dot(d, cross(c, a)), dot(d, cross(a, b)))
        if min(volumes) < 0 < max(volumes):
            return None
        t = Fraction(dot(normal, a), slope) * Fraction(self.direction_scale, self.scale)
        return t, (1 if slope < 0 else -1), 0 in volumes


def hits(vertices, faces, origin, direction, t_min=0, t_max=float("inf"), sides="both", skip=None):
    """All hits as (t, triangle, side), from near to far; of equal t, the lower triangle is first."""
    ray = Ray(vertices, origin, direction)
    low, high = Fraction(t_min), None if t_max == float("inf") else Fraction(float(t_max))
    found = []
    for number, face in enumerate(faces):
        hit = ray.crossing(face)
        if hit is None or number == skip or (sides == "front") * hit[1] < 0 or (sides == "back") * hit[1] > 0:
            continue
        if hit[0] >= low and (high is None or hit[0] <= high):
            found.append((hit[0], number, hit[1]))
    return sorted(found)


def squared_distance(p, corners):
    a, b, c = corners
    ab, ac, ap = sub(b, a), sub(c, a), sub(p, a)
    normal = cross(ab, ac)
    area = dot(normal, normal)
    if area:
        u, v = dot(cross(ap, ac), normal), dot(cross(ab, ap), normal)
        if u >= 0 and v >= 0 and u + v <= area:
            return Fraction(dot(ap, normal) ** 2, area)
    return min(to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a))


def to_segment(p, a, b):
    ab, ap = sub(b, a), sub(p, a)
    along, length = dot(ap, ab), dot(ab, ab)
    if length == 0 or along <= 0:
        return Fraction(dot(ap, ap))
    if along >= length:
        return Fraction(dot(sub(p, b), sub(p, b)))
    return dot(ap, ap) - Fraction(along * along, length)


def squared_distances(vertices, faces, point):
    """The squared distance of each triangle, as a fraction."""
    (p, *corners), scale = whole([point, *vertices])
    return [squared_distance(p, [corners[i] for i in face]) / scale**2 for face in faces]


def is_closed(vertices, faces):
    """Whether each edge, by its coordinates, is used as often one way as the other."""
    balance = {}
    for a, b, c in ([tuple(vertices[i]) for i in face] for face in faces):
        for start, end in ((a, b), (b, c), (c, a)):
            key, sign = ((start, end), 1) if start < end else ((end, start), -1)
            balance[key] = balance.get(key, 0) + sign
    return not any(balance.values())


def passed(vertices, faces, point, direction):
    """The signs with which a ray leaves through triangles; None if it meets an edge or starts on one."""
    ray, signs = Ray(vertices, point, direction), []
    for face in faces:
        hit = ray.crossing(face)
        if hit is None or hit[0] < 0:
            continue
        if hit[2] or hit[0] == 0:
            return None
        signs.append(-hit[1])
    return signs


def inside(vertices, faces, point, rule="nonzero"):
    """Closed: the winding number along a ray that meets no edge. Otherwise six rays along the axes vote."""
    if is_closed(vertices, faces):
        tries = ((x + 0.5, y + 0.25, z + 0.125) for x, y, z in product(range(-7, 8), repeat=3))
        rays = [next(s for s in (passed(vertices, faces, point, d) for d in tries) if s is not None)]
    else:
        rays = [passed(vertices, faces, point, d) for d in AXES]
        assert None not in rays, "a case with an open mesh must have points in general position"
    numbers = [len(signs) % 2 if rule == "evenodd" else sum(signs) for signs in rays]
    return abs(Fraction(sum(numbers), len(rays))) > Fraction(1, 2)
