"""View factors: the fraction of the radiation from one surface that arrives at another.

F[i, j] describes radiation in rooms and ovens and between satellites' panels.
"""

import numpy as np
from pictures import arguments, box, colours

import raysheaf
from raysheaf import radiation


def view_factors(surfaces, rays=20_000):
    """The matrix of closed or open `surfaces`, each (vertices, triangles), from their fronts."""
    scene = raysheaf.Scene()
    meshes = [scene.add(vertices, triangles) for vertices, triangles in surfaces]
    return radiation.view_factors(scene, meshes, samples=rays).factors


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
