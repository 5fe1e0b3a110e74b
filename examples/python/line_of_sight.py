"""Line of sight over terrain: the points that can be seen from a mast on a hill.

One ray from a little above every point of the terrain to the top of the mast, from t = 0 to 1:
`any_hit` says which of them the land blocks.
"""

import numpy as np
from pictures import arguments, face_normals, grid

import raysheaf


def hills(seed=8, octaves=5):
    """A smooth terrain: sines in random directions, each octave half as high (metres)."""
    rng = np.random.default_rng(seed)
    waves = [(2.0**k, rng.uniform(0, 2 * np.pi, 2)) for k in range(octaves) for _ in range(4)]

    def height(x, y):
        total = np.zeros_like(x)
        for frequency, (turn, phase) in waves:
            along = np.cos(turn) * x + np.sin(turn) * y
            total += np.sin(along * frequency / 1100 + phase) / frequency**1.4
        return 80 * total

    return height


def seen_from(scene, points, mast, above=2.0):
    """Which points are seen from the top of the mast, by someone `above` the ground (metres)."""
    eyes = points + [0, 0, above]
    return ~scene.any_hit(eyes, mast - eyes, t_max=1)


def main(output="line_of_sight.png", size=400, height=None):
    line = np.linspace(-5000, 5000, size)
    vertices, triangles = grid(line, line, height or hills())
    scene = raysheaf.Scene()
    scene.add(vertices, triangles)
    mast = vertices[vertices[:, 2].argmax()] + [0, 0, 30]
    visible = seen_from(scene, vertices, mast).reshape(size, size)

    normals = face_normals(vertices, triangles)
    light = np.clip(normals @ np.array([-0.5, 0.5, 0.707]), 0, 1)
    shade = np.zeros((size, size))
    n = size - 1
    shade[:n, :n] = light[: n * n].reshape(n, n)
    image = shade[..., None] * np.where(visible[..., None], [0.75, 1.0, 0.6], [0.55, 0.45, 0.6])
    at = np.argwhere(np.hypot(*np.meshgrid(line - mast[0], line - mast[1])) < 80)
    image[at[:, 0], at[:, 1]] = [1, 0.2, 0.1]
    raysheaf.write_png(output, image[::-1])
    return visible


if __name__ == "__main__":
    given = arguments(__doc__, "line_of_sight.png", 400)
    main(given.output, given.size)
