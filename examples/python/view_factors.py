"""View factors: the fraction of the radiation from one surface that arrives at another.

F[i, j] describes radiation in rooms and ovens and between satellites' panels: rays leave surface i
everywhere, cosine-distributed, and `closest_hit` says which surface each hits.
"""

import numpy as np
from ambient_occlusion import frames
from pictures import arguments, box, colours, face_normals

import raysheaf


def view_factors(surfaces, rays=20_000, seed=0):
    """The matrix of closed or open `surfaces`, each (vertices, triangles), seen from their front."""
    scene = raysheaf.Scene()
    for vertices, triangles in surfaces:
        scene.add(vertices, triangles)
    rng = np.random.default_rng(seed)
    factors = np.zeros((len(surfaces), len(surfaces)))
    for i, (vertices, triangles) in enumerate(surfaces):
        corners = np.asarray(vertices, float)[triangles]
        areas = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        face = rng.choice(len(triangles), rays, p=areas / areas.sum())
        u, v = rng.random((2, rays))
        u, v = np.where(u + v > 1, (1 - u, 1 - v), (u, v))  # uniform over the triangle
        a, b, c = np.moveaxis(corners[face], 1, 0)
        normals = face_normals(vertices, triangles)[face]
        origins = a + u[:, None] * (b - a) + v[:, None] * (c - a) + 1e-5 * normals
        radius, angle = np.sqrt(rng.random(rays)), rng.uniform(0, 2 * np.pi, rays)
        first, second = frames(normals)
        x, y, z = radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - radius**2)
        directions = x[:, None] * first + y[:, None] * second + z[:, None] * normals
        hits = scene.closest_hit(origins, directions)
        factors[i] = np.bincount(hits.geom_id[hits.hit], minlength=len(surfaces)) / rays
    return factors


def room():
    """Six walls that face inwards, and a table in the middle: a closed world of seven surfaces."""
    vertices, triangles = box([0, 0, 0], [5, 4, 2.5])
    walls = [(vertices, triangles[2 * k : 2 * k + 2, ::-1]) for k in range(6)]
    return [*walls, box([1.5, 1.2, 0.7], [3.5, 2.4, 0.8])]


def main(output="view_factors.png", size=420):
    factors = view_factors(room(), rays=100 * size)
    cell = max(1, size // len(factors))
    image = np.kron(colours(factors, 0), np.ones((cell, cell, 1)))
    raysheaf.write_png(output, image)
    return factors


if __name__ == "__main__":
    given = arguments(__doc__, "view_factors.png", 420)
    np.set_printoptions(precision=3, suppress=True)
    print(main(given.output, given.size))
