"""Ambient occlusion of a mesh, baked to its vertices: the part of the sky that each of them sees.

Rays start at every vertex over the hemisphere around its normal, denser where light counts more
(cosine-weighted). Each hit that `any_hit` finds nearby hides a part of the sky.
"""

import numpy as np
from pictures import arguments, camera_rays, grid, srgb, unit, vertex_normals

import raysheaf
from raysheaf.bench import wavy_ball


def hemisphere(count):
    """Cosine-distributed directions around +z on a spiral (Vogel 1979), so that they are evenly
    spread."""
    k = np.arange(count) + 0.5
    radius, angle = np.sqrt(k / count), k * np.pi * (3 - np.sqrt(5))
    return np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - radius**2)], axis=-1
    )


def frames(normals):
    """Two tangents for each normal."""
    helper = np.where(np.abs(normals[:, :1]) > 0.7, [[0.0, 1, 0]], [[1.0, 0, 0]])
    first = unit(np.cross(normals, helper))
    return first, np.cross(normals, first)


def open_sky(scene, points, normals, reach, rays=128):
    """The visible part of the sky at each point, 0 to 1."""
    first, second = frames(normals)
    x, y, z = hemisphere(rays).T
    directions = (
        x[:, None] * first[:, None] + y[:, None] * second[:, None] + z[:, None] * normals[:, None]
    )
    origins = (points + 1e-4 * normals)[:, None]
    return 1 - scene.any_hit(origins, directions, t_max=reach).mean(axis=1)


def main(output="ambient_occlusion.png", size=320):
    scene = raysheaf.Scene()
    ball, ball_triangles = wavy_ball(60 * size, phase=1.0)
    ball = ball + [0, 0, 1.0]
    line = np.linspace(-4, 4, size // 3)
    floor, floor_triangles = grid(line, line, lambda x, y: 0 * x)
    sky = []
    meshes = [(ball, ball_triangles), (floor, floor_triangles)]
    for vertices, triangles in meshes:
        scene.add(vertices, triangles)
    for vertices, triangles in meshes:
        sky.append(open_sky(scene, vertices, vertex_normals(vertices, triangles), reach=3))

    eye, directions = camera_rays([4, -5, 3.2], [0, 0, 0.8], size, size * 3 // 4)
    hits = scene.closest_hit(eye, directions)
    image = np.full(hits.shape, 0.05)
    for mesh, (_, triangles) in enumerate(meshes):
        seen = hits.hit & (hits.geom_id == mesh)
        a, b, c = sky[mesh][triangles[hits.prim_id[seen]]].T
        u, v = hits.u[seen], hits.v[seen]
        image[seen] = (1 - u - v) * a + u * b + v * c
    raysheaf.write_png(output, srgb(image))
    return sky


if __name__ == "__main__":
    given = arguments(__doc__, "ambient_occlusion.png", 320)
    main(given.output, given.size)
