"""The answers of exact arithmetic and of raysheaf to a case, one for each ray or point, and whether they agree."""

import math
from fractions import Fraction

import numpy as np

from . import exact

INF = float("inf")
REFUSED = "refused"


def judged(report):
    """The exact answers: distances as fractions (squared, with the sign apart), counts, booleans."""
    query, (vertices, faces) = report.query, report.world
    if query.kind == REFUSED:
        return [REFUSED] * len(query.origins)
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used].tolist(), faces.reshape(-1, 3).tolist()
    if query.directions is None:
        return [point_answer(query, vertices, faces, point) for point in query.origins.tolist()]
    return [ray_answer(query, vertices, faces, exact.hits(
        vertices, faces, origin, direction, query.t_min, query.t_max, query.sides, query.skip))
        for origin, direction in zip(query.origins.tolist(), query.directions.tolist())]


def ray_answer(query, vertices, faces, hits):
    first = hits[0] if hits else None
    if query.kind == "normal":
        a, b, c = (vertices[i] for i in faces[first[1]])
        return exact.cross(exact.sub(b, a), exact.sub(c, a))
    return {"closest": lambda: first[0] if first else INF,
            "any": lambda: first is not None,
            "count": lambda: len(hits),
            "places": lambda: len({hit[0] for hit in hits}),
            "all": lambda: tuple(hit[0] for hit in hits),
            "triangle": lambda: first[1] if first else -1,
            "side": lambda: first[2] if first else 0}[query.kind]()


def point_answer(query, vertices, faces, point):
    if query.kind == "inside":
        return exact.inside(vertices, faces, point, query.rule)
    squared = min(exact.squared_distances(vertices, faces, point))
    within = query.kind == "signed" and squared and exact.inside(vertices, faces, point, query.rule)
    return -square_root(squared) if within else square_root(squared)


def square_root(squared):
    """The root of a fraction, with an error below 2^-150 of it."""
    shift = 400 + max(0, 2 * squared.denominator.bit_length())
    shift += shift % 2
    return Fraction(math.isqrt((squared.numerator << shift) // squared.denominator), 1 << shift // 2)


def answered(report):
    """The answers of raysheaf; for a refused case, the error's text."""
    import raysheaf

    query, (vertices, faces) = report.query, report.mesh
    scene = raysheaf.Scene()
    try:
        mesh = scene.add(vertices if report.before is None else report.before, faces)
        if report.before is not None:
            scene.closest_hit([0, 0, 0], [0, 0, 1])
            scene.update(mesh, vertices)
        if report.placed is not None:
            scene.instance(mesh, np.array(report.placed))
            scene.remove_instance(scene.instances(mesh)[0])
        if query.directions is None:
            return point_answers(scene, query)
        return ray_answers(scene, query, mesh)
    except raysheaf.InvalidError as error:
        return [f"{error.place}: {error.sentence}"] * len(query.origins)


def point_answers(scene, query):
    places = query.origins.astype(np.float64)
    if query.kind == "distance":
        return scene.closest_point(places).distance.tolist()
    ask = scene.signed_distance if query.kind == "signed" else scene.contains
    return ask(places, inside=query.rule).tolist()


def ray_answers(scene, query, mesh):
    given = {"t_min": query.t_min, "t_max": query.t_max, "sides": query.sides}
    if query.skip is not None:
        given["skip"] = query.skip
    asked = (query.origins, query.directions)
    if query.kind == "any":
        return scene.any_hit(*asked, **given).tolist()
    if query.kind == "count":
        return scene.hit_counts(*asked, **given).tolist()
    if query.kind in ("places", "all"):
        rows = scene.all_hits(*asked, **given)
        t = [tuple(rows[i].t.tolist()) for i in range(len(query.origins))]
        return t if query.kind == "all" else [len(set(row)) for row in t]
    hits = scene.closest_hit(*asked, **given)
    if query.kind == "triangle":
        return np.where(hits.hit, hits.prim_id.astype(np.int64), -1).tolist()
    return {"closest": lambda: hits.t, "side": lambda: hits.side,
            "normal": lambda: hits.geometric_normal}[query.kind]().tolist()


def agrees(query, given, right):
    """Whether an answer of raysheaf is as promised: t within 2 ulp, distances within 2^-46, all else exact."""
    if query.kind == REFUSED:
        return isinstance(given, str)
    if isinstance(given, str):
        return False
    if query.kind == "all":
        return len(given) == len(right) and all(map(within_two_ulp, given, right))
    if query.kind == "closest":
        return within_two_ulp(given, right)
    if query.kind in ("distance", "signed"):
        return abs(Fraction(given) - right) <= Fraction(1, 2**46) * max(abs(right), 16)
    if query.kind == "normal":
        return same_direction(given, right)
    return given == right


def within_two_ulp(given, right):
    if INF in (given, right):
        return given == right
    return abs(Fraction(given) - right) <= 2 * Fraction(float(np.spacing(np.float32(given))))


def same_direction(given, right):
    length = math.sqrt(exact.dot(right, right))
    return all(abs(g - r / length) < 1e-6 for g, r in zip(given, right))


def nearly(report, given, right):
    """Whether a peer's answer is right: distances within 1e-4 of them and 1e-6 of the mesh."""
    if given == right or given in report.also:
        return True
    if isinstance(given, str) or isinstance(right, str) or isinstance(given, bool) != isinstance(right, bool):
        return False
    if report.query.kind == "all":
        return len(given) == len(right) and all(nearly_equal(report, g, r) for g, r in zip(given, right))
    if report.query.kind == "normal":
        return same_direction(given, right)
    return report.query.kind in ("closest", "distance", "signed") and nearly_equal(report, given, right)


def nearly_equal(report, given, right):
    if INF in (given, right) or given != given:
        return given == right
    used = report.mesh[0][report.mesh[1]]
    return abs(given - float(right)) <= 1e-4 * abs(float(right)) + 1e-6 * float(np.ptp(used))
