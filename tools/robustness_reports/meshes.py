"""Small meshes for the cases, as (vertices, faces) in float32."""

import numpy as np


def mesh(vertices, faces):
    return np.array(vertices, np.float32).reshape(-1, 3), np.array(faces, np.int64).reshape(-1, 3)


def triangle(*corners):
    return mesh(corners, [(0, 1, 2)])


def joined(*meshes):
    """One mesh of several, which share no vertex."""
    starts = np.cumsum([0, *(len(v) for v, _ in meshes)])
    return mesh(np.concatenate([v for v, _ in meshes]),
                np.concatenate([f + s for (_, f), s in zip(meshes, starts)]))


def moved(given, scale=1, shift=(0, 0, 0)):
    return mesh(given[0] * np.float32(scale) + np.array(shift, np.float32), given[1])


def turned_over(given):
    return mesh(given[0], given[1][:, ::-1])


def square(half=1.0, z=0.0):
    """Two triangles, with the diagonal from one corner to the opposite one; the front is above."""
    h = half
    return mesh([(-h, -h, z), (h, -h, z), (h, h, z), (-h, h, z)], [(0, 1, 2), (0, 2, 3)])


def box(low=(-1, -1, -1), high=(1, 1, 1)):
    vertices = [[(low, high)[c >> axis & 1][axis] for axis in range(3)] for c in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return mesh(vertices, [f for a, b, c, d in sides for f in ((a, b, c), (a, c, d))])


def cut_box(parts=2, half=1.0):
    """A box around the origin whose sides are grids of parts x parts squares; no vertex is shared by sides."""
    sides = []
    for axis in range(3):
        for sign in (-1, 1):
            side = grid(parts, lambda x, y: parts, -parts / 2)
            flat = side[0] * np.float32(2 * half / parts)
            flat[:, 2] = half
            flat = flat if sign > 0 else flat * np.array([-1, 1, -1], np.float32)
            sides.append(mesh(np.roll(flat, axis + 1, axis=1), side[1]))
    return joined(*sides)


def tetrahedron():
    return mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 3, 2), (0, 1, 3), (1, 2, 3)])


def fan(count=6, height=1.0):
    """Triangles around the z axis that share the apex (0, 0, height)."""
    rim = [(np.cos(a), np.sin(a), 0) for a in 2 * np.pi * np.arange(count) / count]
    return mesh([(0, 0, height), *rim], [(0, 1 + i, 1 + (i + 1) % count) for i in range(count)])


def sphere(around=12, rings=6, radius=1.0):
    """A closed sphere of rings between two poles."""
    vertices = [(0, 0, radius)]
    for i in range(1, rings):
        height, r = radius * np.cos(np.pi * i / rings), radius * np.sin(np.pi * i / rings)
        vertices += [(r * np.cos(a), r * np.sin(a), height) for a in 2 * np.pi * np.arange(around) / around]
    vertices.append((0, 0, -radius))
    last, faces = len(vertices) - 1, []
    for j in range(around):
        k = (j + 1) % around
        faces += [(0, 1 + j, 1 + k), (last, last - around + k, last - around + j)]
        for i in range(rings - 2):
            a, b = 1 + i * around + j, 1 + i * around + k
            faces += [(a, a + around, b), (b, a + around, b + around)]
    return mesh(vertices, faces)


def cylinder(around=12, radius=1.0, half=1.0):
    """A closed cylinder along the z axis."""
    ring = [(radius * np.cos(a), radius * np.sin(a)) for a in 2 * np.pi * np.arange(around) / around]
    vertices = [(x, y, z) for z in (-half, half) for x, y in ring] + [(0, 0, -half), (0, 0, half)]
    faces = []
    for j in range(around):
        k = (j + 1) % around
        faces += [(j, k, j + around), (k, k + around, j + around), (2 * around, k, j),
                  (2 * around + 1, j + around, k + around)]
    return mesh(vertices, faces)


def grid(parts, height, start=0.0):
    """A terrain of parts x parts squares of side 1, whose first corner is (start, start)."""
    vertices = [(start + x, start + y, height(x, y)) for y in range(parts + 1) for x in range(parts + 1)]
    faces = []
    for y in range(parts):
        for x in range(parts):
            a = y * (parts + 1) + x
            faces += [(a, a + 1, a + parts + 2), (a, a + parts + 2, a + parts + 1)]
    return mesh(vertices, faces)


def terrain(parts=6):
    return grid(parts, lambda x, y: (3 * x * x + 5 * y + x * y) % 7 / 4)


def voxels(cells):
    """The surface of unit cubes at integer places, as a voxel program writes it."""
    cells, corners, faces = set(cells), {}, []
    unit = box((0, 0, 0), (1, 1, 1))
    for cell in sorted(cells):
        for face in unit[1]:
            points = [tuple(int(x) for x in unit[0][i]) for i in face]
            normal = [0, 0, 0]
            for axis in range(3):
                if len({p[axis] for p in points}) == 1:
                    normal[axis] = 1 if points[0][axis] else -1
            if tuple(c + n for c, n in zip(cell, normal)) not in cells:
                faces.append([corners.setdefault(tuple(c + x for c, x in zip(cell, p)), len(corners))
                              for p in points])
    return mesh(list(corners), faces)
