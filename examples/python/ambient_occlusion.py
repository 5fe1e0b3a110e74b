"""Ambient occlusion of a mesh, baked to its vertices: the part of the sky that each sees."""

import numpy as np
from pictures import arguments, camera_rays, grid, srgb

import raysheaf
from raysheaf import radiation
from raysheaf.bench import wavy_ball


def main(output="ambient_occlusion.png", size=320):
    scene = raysheaf.Scene()
    ball, ball_triangles = wavy_ball(60 * size, phase=1.0)
    ball = ball + [0, 0, 1.0]
    line = np.linspace(-4, 4, size // 3)
    floor, floor_triangles = grid(line, line, lambda x, y: 0 * x)
    meshes = [(ball, ball_triangles), (floor, floor_triangles)]
    for vertices, triangles in meshes:
        scene.add(vertices, triangles)
    sky = [
        radiation.ambient_occlusion(
            scene, *radiation.at_vertices(scene, mesh), radius=3, samples=128
        )
        for mesh in scene.meshes
    ]

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
