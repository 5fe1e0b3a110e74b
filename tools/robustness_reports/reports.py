"""The reports, each with a small case of the same kind. `asks` paraphrases the report."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .meshes import (box, cut_box, cylinder, fan, grid, joined, mesh, moved, sphere, square, terrain,
                     tetrahedron, triangle, turned_over, voxels)

INF = float("inf")


@dataclass
class Query:
    """One question about every ray or point of a case.

    Kinds for rays: closest (t), any, count (of triangles), places (different t), all (every t), side,
    normal, triangle; for points: distance, signed, inside; `refused` where no answer exists.
    """

    kind: str
    origins: np.ndarray
    directions: np.ndarray | None = None
    t_min: float = 0.0
    t_max: float = INF
    sides: str = "both"
    skip: int | None = None
    rule: str = "nonzero"


@dataclass
class Report:
    project: str
    number: int
    asks: str
    mesh: tuple[np.ndarray, np.ndarray]
    query: Query
    note: str = ""
    also: tuple[Any, ...] = ()  # answers of peers that are right by their own definition
    before: np.ndarray | None = None  # vertices before the mesh moved to where it is
    placed: Any = None  # a 4x4 matrix of whole numbers
    pull: bool = False

    @property
    def key(self):
        return f"{self.project} {self.number}"

    @property
    def link(self):
        where = "pull" if self.pull else "issues"
        return f"https://github.com/{self.project}/{where}/{self.number}"

    @property
    def world(self):
        """The triangles where the query finds them; a mirrored mesh keeps its front outside."""
        vertices, faces = self.mesh
        if self.placed is not None:
            matrix = np.array(self.placed, np.float32)
            vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
            faces = faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces
        return vertices, faces


def single(values):
    return np.array(values, np.float32).reshape(-1, 3)


def rays(kind, origins, directions, **more):
    origins, directions = np.broadcast_arrays(single(origins), single(directions))
    return Query(kind, origins.copy(), directions.copy(), **more)


def towards(kind, origin, targets, **more):
    """Rays from one origin to many targets; the directions are rounded to float32."""
    return rays(kind, origin, single(targets) - single(origin), **more)


def points(kind, places, **more):
    return Query(kind, single(places), **more)


def lattice(low, high, count):
    line = np.linspace(low, high, count)
    return np.stack(np.meshgrid(line, line, line, indexing="ij"), -1).reshape(-1, 3)


def down(places, height):
    places = np.asarray(places, np.float32).reshape(-1, 2)
    return np.column_stack([places, np.full(len(places), height, np.float32)])


def middles(given):
    """The middles of all edges, rounded."""
    vertices, faces = given
    return np.concatenate([(vertices[faces[:, i]] + vertices[faces[:, i - 1]]) / 2 for i in range(3)])


ROUND, FINE = sphere(), sphere(16, 10)
RIDGE = mesh([(-2, -1, 0), (-2, 1, 0), (-2, 0, 1), (2, -1, 0), (2, 1, 0), (2, 0, 1)],
             [(0, 3, 5), (0, 5, 2), (1, 5, 4), (1, 2, 5), (0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3)])
DIAMOND = mesh([(-1, 0, 0), (0, 1, 0), (1, 0, 0), (0, -1, 0), (0, 0, 0)],
               [(4, 2, 1), (4, 1, 0), (4, 0, 3), (4, 3, 2)])
QUARTERS = np.stack(np.meshgrid(np.arange(0.5, 6, 0.5), np.arange(0.5, 6, 0.5)), -1).reshape(-1, 2)
HOLLOW = joined(box((-2, -2, -2), (2, 2, 2)), turned_over(box()))
OPEN_BOX = (box()[0], box()[1][2:])
BLOCKS = voxels([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 0), (2, 1, 0), (2, 2, 2)])
FAR = 2.0 ** np.arange(0, 40, 4)
ANGLES = 2 * np.pi * np.arange(24) / 24
SHUFFLED = (box()[0], np.where((np.arange(12) % 3 == 0)[:, None], box()[1][:, ::-1], box()[1]))
NEEDLE = triangle((0, 0, 0), (11, 0, 0), (9.75, 0.0625, 0))
COPLANAR = "a ray in the plane of a triangle misses it"
POINTS_ON = "the hit at t = 0 counts"
ROWS = "one row for each triangle"

GROUPS = {
    "Through edges and vertices": [
        Report("mikedh/trimesh", 1766, "a ray at the diagonal of a square hits the square",
               mesh([(-1, -1, 0), (-1, 1, 0), (1, 1, 0), (1, -1, 0)], [(0, 1, 2), (2, 3, 0)]),
               rays("closest", (0, 0, 1), (0, 0, -1))),
        Report("mikedh/trimesh", 2317, "how many triangles a ray through a vertex hits", fan(),
               rays("count", (0, 0, 3), (0, 0, -1)), ROWS, also=(1,)),
        Report("mikedh/trimesh", 1180, "one of many rays from the inside of a closed mesh finds nothing", ROUND,
               rays("any", (0, 0, 0), np.concatenate([ROUND[0], middles(ROUND)]))),
        Report("mikedh/trimesh", 1496, "any hit and first hit agree where rays pass vertices and edges",
               cut_box(), rays("closest", (0, 0, 0), cut_box(half=1.5)[0])),
        Report("mikedh/trimesh", 263, "rays at the edges of a cube hit the cube", box(),
               rays("closest", [(1, y / 4, 5) for y in range(-4, 5)], (0, 0, -1))),
        Report("RenderKit/embree", 181, "a ray at a vertex passes the innermost of nested cylinders",
               joined(*(cylinder(10, r) for r in (1, 1.5, 2, 2.5))),
               towards("closest", (0, 0, 0), cylinder(10, 1)[0])),
        Report("RenderKit/embree", 188, "a ray at an edge crosses the surface once, not twice", box(),
               rays("places", (0.25, 0.25, 5), (0, 0, -1))),
        Report("RenderKit/embree", 381, "no ray from outside hits a closed sphere from its inside", ROUND,
               towards("side", (20, 0, 0), np.concatenate([ROUND[0], middles(ROUND)]) * 0.9375)),
        Report("mitsuba-renderer/mitsuba3", 1149, "rays that meet an edge at a glancing angle pass the surface",
               terrain(), towards("any", (-40, -40, 4), terrain()[0])),
        Report("mrdoob/three.js", 11449, "a ray from the inside of a sphere misses it", FINE,
               towards("any", (0.125, 0.25, 0.375), FINE[0])),
        Report("mrdoob/three.js", 33661, "a ray exactly through an edge or a vertex is lost", fan(7),
               rays("any", [(*p[:2], 4) for p in fan(7)[0][1:] / 2], (0, 0, -1)), pull=True),
        Report("gkjohnson/three-mesh-bvh", 684, "rays along a height meet the lower edge of a wall or not, at random",
               triangle((-1.3836679458618164, -4.480311870574951, 10), (3.9273109436035156, 5.897944450378418, 8),
                        (-1.3836679458618164, -4.480311870574951, 8)),
               rays("any", [(-0.028221702575683627, -2.5058889150619503 - d, 8) for d in (0, 0.001, 0.01)],
                    (-0.16852837373762, 0.9856968028990217, 0))),
        Report("gkjohnson/three-mesh-bvh", 183, "rays pass one column of triangles of a terrain", terrain(),
               rays("closest", down(QUARTERS, 9), (0, 0, -1))),
        Report("gkjohnson/three-mesh-bvh", 112, "one point of a surface is lost with one way to split the tree",
               terrain(), rays("any", down(terrain()[0][:, :2], 9), (0, 0, -1))),
        Report("DCC-Lab/PyTissueOptics", 81, "a ray slips between the edges of two triangles", cut_box(3),
               towards("any", (0.25, 0, 0.125), middles(cut_box(3))), pull=True),
        Report("Oblikovati/Oblikovati", 2146, "a ray at the seam of a square is a miss in float32", square(5),
               rays("closest", (0, 0, 10), (0.30458447, 0.30458447, -0.9024725)),
               "in float32, this direction is a hair off the seam"),
        Report("robandrose/ofxIntersection", 4, "a ray that moves across an edge has a moment without a hit",
               square(), rays("any", [(x / 64, x / 64 + d, 1) for x in (-9, 1, 7) for d in (-2**-20, 0, 2**-20)],
                              (0, 0, -1))),
        Report("cnr-isti-vclab/vcglib", 245, "rays near the edges of a triangle are lost", square(3),
               rays("any", [(x / 7, x / 7, 2) for x in range(-20, 21)], (0, 0, -1))),
        Report("dimforge/parry", 171, "a point next to a roof is inside, because its ray touches the ridge", RIDGE,
               points("inside", [(0, y, 1) for y in (-3, -2, -0.5, 0.5, 2, 3)])),
        Report("dimforge/ncollide", 335, "a ray that touches a ridge reports a back face", RIDGE,
               rays("places", (0, -3, 1), (0, 1, 0)), "both sides of the roof are hit, at one place"),
        Report("libgdx/libgdx", 907, "rays at edges miss", triangle((0, 0, 0), (4, 0, 0), (0, 4, 0)),
               rays("any", [(2, 2, 1), (1, 3, 1), (0, 2, 1), (2, 0, 1)], (0, 0, -1))),
        Report("godotengine/godot", 84108, "rays that start near the corner of a room pass the wall",
               joined(square(4, -1), mesh([(4, -4, -1), (4, 4, -1), (4, 4, 3), (4, -4, 3)], [(0, 1, 2), (0, 2, 3)])),
               rays("any", [(4 - 2.0**-e, y, -1 + 2.0**-e) for e in (3, 9, 20) for y in (-2, 0, 2)], (1, 0, -0.5))),
        Report("libigl/libigl", 2026, "the same hit twice in a ray's list", moved(box(), 0.5),
               rays("places", (1, 0.125, 0.125), (-1, 0, 0))),
        Report("libigl/libigl", 2232, "a tree and brute force differ for a ray at a vertex", DIAMOND,
               rays("closest", (0, 0, -1), (0, 0, 1))),
        Report("RenolY2/mkdd-track-editor", 116, "a ray that starts at an edge of the ground falls through",
               joined(square(2), square(2, -9)), rays("closest", [(0.5, 0.5, 0), (2, 0, 0)], (0, 0, -1)), pull=True),
    ],
    "Parallel to an axis or to a triangle": [
        Report("RenderKit/embree", 298, "a ray in the plane of a triangle hits its edge",
               triangle((0, 0, 0), (1, 0, 0), (0, 1, 0)), rays("closest", (-1, 0.5, 0), (1, 0, 0)), COPLANAR),
        Report("arborx/ArborX", 517, "a ray in the plane of a triangle hits it", square(),
               rays("any", [(-3, 0.25, 0), (-3, -3, 0)], [(1, 0, 0), (1, 1, 0)]), COPLANAR, pull=True),
        Report("g-truc/glm", 578, "a ray parallel to a plane is reported as a hit", square(4),
               rays("any", (0, 0, 1), [(1, 0, 0), (1, 1, 0), (-1, 0.5, 0)])),
        Report("RayTracing/raytracing.github.io", 681, "a ray in a rectangle's plane returns NaN", square(4),
               rays("closest", [(0, 0, 0), (0, 0, 1)], (1, 0, 0)), COPLANAR),
        Report("madmann91/bvh", 9, "rays with a component 0 find nothing", cut_box(),
               rays("closest", (0.25, 0.125, 0), [(1, 0, 0.5), (0, 1, 0.5), (1, 0.5, 0), (0, 0, 1), (0, 1, 0)])),
        Report("madmann91/bvh", 20, "a ray with a component -0 finds nothing",
               mesh([(1, -1, 1), (1, 1, 1), (-1, 1, 1), (1, -1, 2.1), (1, 1, 2.1), (-1, 1, 2.1)],
                    [(0, 1, 2), (3, 4, 5)]), rays("closest", (0.25, 0.25, 0), (0, -0.0, 1))),
        Report("jbikker/tinybvh", 282, "rays along axes with components -0 find nothing", cut_box(),
               rays("closest", (0.25, 0.125, 0.375), [np.where(np.arange(3) == a, s, z) for a in range(3)
                                                      for s in (-1, 1) for z in (0.0, -0.0)]), pull=True),
        Report("madmann91/bvh", 60, "vertical rays at a terrain (slow: nearly all leaves are visited)", terrain(),
               rays("closest", down(QUARTERS + 0.25, 9), (0, 0, -1))),
        Report("madmann91/bvh", 21, "rays along an axis in a mesh along the axes (slow)", cut_box(4),
               rays("count", [(x / 4, y / 4, 3) for x in range(-4, 5) for y in range(-4, 5)], (0, 0, -1)),
               ROWS, also=tuple(range(1, 13))),
        Report("svenstaro/bvh", 107, "a triangle whose box is flat is never hit",
               triangle((-1, -1, 1), (1, -1, 1), (1, 1, 1)), rays("closest", (0.25, 0, 0), (0, 0, 1))),
        Report("svenstaro/bvh", 149, "a ray in the plane of a box's side returns NaN (0 / 0)", tetrahedron(),
               rays("closest", [(-1, 0, 0.25), (0, -1, 0.5), (0.25, 0, -1)], [(1, 0, 0), (0, 1, 0), (0, 0, 1)]),
               COPLANAR + "; it hits the other sides", pull=True),
        Report("mmp/pbrt-v3", 322, "what a box test does with a component 0", box(),
               rays("closest", [(1, 0, -4), (-1, 1, -4), (0, 0, -4)], (0, 0, 1))),
        Report("libgdx/libgdx", 634, "a ray misses a flat bounding box", square(2),
               rays("closest", (0.5, 0.25, 3), (0.25, 0, -1))),
        Report("mrdoob/three.js", 26396, "a flat disc of radius 2.5 is not hit at a distance of 2.83 from its centre",
               moved(fan(32, 0.0), 2.5, (10, 10, 10)), rays("closest", [(8, 8, 100), (9, 9, 100)], (0, 0, -1)),
               "the report's own ray misses the disc; the second ray hits it"),
        Report("brabbitdousha/A-Python-Ray-Mesh-Intersector-in-Slangpy", 1, "ids of hits on a flat mesh are all 0",
               grid(3, lambda x, y: 0), rays("triangle", down([(x + 0.5, y + 0.25) for x in range(3) for y in range(3)],
                                                             4), (0, 0, -1))),
        Report("aevyrie/bevy_mod_raycast", 5, "the bottom of a box that is not rotated is never hit", box(),
               rays("closest", (0.25, -5, 0.5), (0, 1, 0))),
    ],
    "Origins on a surface and intervals": [
        Report("mikedh/trimesh", 331, "a ray from a point of the surface sometimes hits that point", square(),
               rays("closest", [(x / 8, y / 8, 0) for x in range(-7, 8, 3) for y in range(-7, 8, 3)], (0, 0, 1)),
               POINTS_ON),
        Report("isl-org/Open3D", 5430, "shadow rays from a surface hit it in spots", square(),
               rays("closest", [(x / 8, 0.5, 0) for x in range(-7, 8)], (1, 0, 1), t_min=2.0**-10),
               "with `t_min`, none of them does"),
        Report("mrdoob/three.js", 17178, "a ray down from a point of a plane sometimes finds nothing", square(50),
               rays("closest", [(x / 3, x / 7, 0) for x in range(-30, 31, 6)], (0, 0, -1))),
        Report("pyvista/pyvista", 5372, "a hit at the world's origin is not reported", square(),
               rays("closest", (0, 0, 1), (0, 0, -2))),
        Report("libgdx/libgdx", 3122, "a ray that starts at a vertex misses the triangle",
               triangle((60, -30, 1182), (60, 0, 1206), (90, -30, 1174)),
               rays("closest", (60, 0, 1206), (-0.70710677, 0, 0.70710677))),
        Report("MonoGame/MonoGame", 7581, "a ray that starts on a side of a box and leaves it misses",
               box((0, 0, 0), (1, 1, 1)), rays("closest", (0.5, 0.25, 0), (0, 0, -1))),
        Report("cinder/Cinder", 254, "triangles behind the origin are hit", square(),
               rays("any", (0, 0, 1), [(0, 0, 1), (0.25, 0, 1), (0, 0.5, 1)])),
        Report("google-deepmind/mujoco", 3599, "a range sensor ends at its greatest distance", square(4),
               rays("closest", [(0, 0, 2), (1, 0, 3), (2, 0, 5)], (0, 0, -1), t_max=3)),
        Report("gazebosim/gazebo-classic", 503, "a range is measured from the sensor, not from the least range",
               joined(square(4), square(4, 2.5)), rays("closest", (1, 2, 3), (0, 0, -1), t_min=1)),
        Report("google-deepmind/mujoco", 1493, "the distance along a direction that is no unit vector", square(),
               rays("closest", (0.25, 0.5, 3), [(0, 0, -1), (0, 0, -0.5), (0, 0, -4)]),
               "t counts in lengths of the direction"),
        Report("godot-jolt/godot-jolt", 661, "a reflected ray hits the triangle that it leaves", square(),
               rays("closest", (0.5, 0.25, 0), (0, 0, 1), skip=0), "with `skip`"),
        Report("CGAL/cgal", 1821, "the ray from a triangle's centroid returns that triangle", tetrahedron(),
               rays("closest", (0.25, 0.25, 0), (0.125, 0.0625, 1), skip=0), "with `skip`"),
        Report("CGAL/cgal", 1822, "the first hit is not the closest one", joined(square(2), square(2, 0.125)),
               rays("closest", (0.5, 0.25, 2), (0, 0, -1))),
        Report("mitsuba-renderer/mitsuba3", 1871, "the inner of two close walls is skipped",
               joined(square(1, 1), square(1, 1 + 4e-5)), rays("places", (0.25, 0.5, 0), (0, 0, 1)), pull=True),
        Report("tunabrain/tantalum", 3, "a ray passes a floor that touches another surface",
               joined(square(), square(2)), rays("count", (0.5, 0.25, 3), (0, 0, -1)), ROWS, also=(1,)),
        Report("modawan/reone", 341, "a direction of length 0 visits the whole tree", square(),
               rays("refused", (0, 0, 1), (0, 0, 0)), "an error names the ray", pull=True),
        Report("selimanac/defold-daabbcc", 9, "a ray without length aborts the program", square(),
               rays("refused", (0, 0, 0), (0, 0, 0)), "an error names the ray"),
    ],
    "Far, large and small": [
        Report("mikedh/trimesh", 48, "rays towards a triangle miss it from far away",
               triangle((0, 0, 0), (1, 0, 0), (0, 1, 0)),
               rays("closest", [(0.25, 0.25, h) for h in FAR] + [(h + 0.25, 0.25, h) for h in FAR[:5]],
                    [(0, 0, -1)] * len(FAR) + [(-1, 0, -1)] * 5)),
        Report("mikedh/trimesh", 2504, "the same hit up to twenty times in a small or large mesh",
               moved(box(), 2.0**26), rays("places", (2.0**25, 2.0**24, 2.0**28), (0, 0, -1))),
        Report("RenderKit/embree", 387, "rays nearly parallel to a sliver hit it where they miss", NEEDLE,
               rays("any", [(-100, y / 64, 0.875) for y in range(-8, 9)], (1, 0, -0.0087890625))),
        Report("RenderKit/embree", 423, "a segment hits a triangle that is not near it",
               triangle((0.25, 1.375, 0.125), (0.375, 1.4375, 0.1875), (0.28125, 1.375, 0.25)),
               rays("any", [(0.5 + x / 16, 1.5, 0.25) for x in range(8)], (0.015625, 0.03125, 0.0625), t_max=1)),
        Report("RenderKit/embree", 464, "rays from the floor miss a ceiling that is flat", square(4, 3),
               rays("any", [(x / 2, y / 3, 0) for x in range(-7, 8) for y in range(-9, 10, 3)], (0, 0, 1))),
        Report("mitsuba-renderer/mitsuba3", 61, "small discs are lost when the camera is 100 times as far",
               fan(8), rays("closest", [(x / 16, y / 16, 4e5) for x in range(-8, 9, 2) for y in range(-8, 9, 2)],
                            (0, 0, -1))),
        Report("mitsuba-renderer/mitsuba2", 171, "hits lie behind the surface, by more than the shadow's epsilon",
               square(1000), rays("closest", [(0, 0, h) for h in FAR[3:7]], [(0, 0, -1)]),
               "raysheaf: t within 2 units of its last place"),
        Report("sampotter/python-embree", 20, "the hit is imprecise (1e-5)", terrain(),
               towards("closest", (2.125, 3.375, 50), [(x + 0.375, 6 - x + 0.25, 0.5) for x in range(1, 6)]),
               "raysheaf: t within 2 units of its last place"),
        Report("jrouwe/JoltPhysics", 1818, "rays from 12 km away pass cylinders and spheres",
               joined(sphere(12, 6, 0.5), moved(cylinder(12, 0.5), 1, (3, 0, 0))),
               rays("closest", [(x / 8, -12000, 0.125) for x in (-3, 0, 1, 3, 21, 24, 27)], (0, 1, 0))),
        Report("pyvista/pyvista", 918, "a long ray from the inside finds no surface",
               (ROUND[0] * np.float32([1, 1, 0.25]), ROUND[1]), rays("any", (0, 0, 0), (54857, -1.78419e6, -21443.4))),
        Report("pyvista/pyvista", 5587, "rays that start farther away than the mesh is long", box(),
               rays("closest", [(0.25, 0.5, h) for h in (3, 50, 1000, 1e5)], (0, 0, -1))),
        Report("mikedh/trimesh", 1338, "a hit lies off its triangle in a mesh of a millimetre", moved(terrain(), 2**-12),
               towards("closest", moved(terrain(), 2**-12)[0][24] + np.float32([0, 0, 2**-9]),
                       moved(terrain(), 2**-12)[0][::3])),
        Report("jbikker/tinybvh", 283, "a triangle of 0.2 mm is never hit",
               triangle((0, 0, 0), (2e-4, 0, 0), (0, 2e-4, 0)), rays("closest", (2e-4 / 3, 2e-4 / 3, -1), (0, 0, 1)),
               pull=True),
        Report("jrouwe/JoltPhysics", 439, "the ray ends at the box of a terrain", terrain(),
               rays("closest", down([(1.25, 2.5), (3.75, 4.125), (5.5, 0.5)], 50), (0, 0, -1))),
        Report("google-deepmind/mujoco_warp", 943, "distances to a height field differ from those of another engine",
               terrain(), rays("closest", down([(2, 3), (2.25, 3), (1.75, 3), (2.25, 3.25)], 8), (0, 0, -1))),
        Report("google-deepmind/mujoco", 2762, "rays hit the border of a height field that they pass above", terrain(),
               rays("any", [(-3, y, 2) for y in range(7)], (1, 0, 0))),
        Report("newton-physics/newton", 2413, "a ray at the ground plane finds nothing",
               joined(square(2.0**20), moved(box(), 0.5, (0, 0, 1))),
               rays("closest", [(x / 4, 0.125, 3) for x in range(-8, 9)], (0, 0, -1)), pull=True),
        Report("DanielChappuis/reactphysics3d", 236, "a flat mesh is not hit", square(20, -0.5),
               rays("closest", (3, -4, 1.5), [(0, 0, -1), (0.5, 0.25, -1)])),
    ],
    "Degenerate and invalid triangles": [
        Report("libgdx/libgdx", 4901, "a triangle without area is always hit",
               mesh([(100, 200, 300), (400, 500, 600), (400, 500, 600), (0, 0, 0), (0, 0, 0), (0, 0, 0)],
                    [(0, 1, 2), (3, 4, 5)]), rays("any", (10, 20, 30), (0, -1, 0))),
        Report("gkjohnson/three-mesh-bvh", 724, "a degenerate triangle breaks the query",
               joined(triangle((0, 0, 0), (1, 0, 0), (2, 0, 0)), square(2, -1)),
               rays("closest", [(0.5, 0, 1), (0.5, 0.25, 1)], (0, 0, -1)), "a triangle without area has no hits"),
        Report("CGAL/cgal", 107, "an assertion stops the program at a degenerate triangle",
               triangle((0, 0, 0), (1, 1, 1), (2, 2, 2)), rays("any", (1, 1, 5), (0, 0, -1), t_max=9),
               "a triangle without area has no hits"),
        Report("unibas-gravis/scalismo", 262, "the closest point of collinear corners is wrong",
               triangle((0, 0, 0), (1, 0, 0), (3, 0, 0)), points("distance", [(2, 1, 0), (-1, 0, 0), (5, 0, 2)])),
        Report("dimforge/parry", 76, "the distance to two equal corners and a third is 0",
               triangle((2.27699995, -7.9000001, 16.3180008), (-0.569999993, -8.10000038, 16.6070004),
                        (-0.569999993, -8.10000038, 16.6070004)), points("distance", (1.10000002, -7.9000001, 16.5879993))),
        Report("llnl/axom", 1326, "the closest point of a triangle that is a point",
               triangle((1, 2, 3), (1, 2, 3), (1, 2, 3)), points("distance", [(1, 2, 3), (4, 6, 3)]), pull=True),
        Report("mikedh/trimesh", 741, "closest points fail with an error of the R-tree",
               joined(triangle((5, 5, 5), (5, 5, 5), (5, 5, 5)), tetrahedron()),
               points("distance", [(5, 5, 6), (-1, 0, 0), (0.25, 0.25, 0.25)])),
        Report("llnl/devil_ray", 62, "NaN in a mesh makes an endless loop",
               triangle((np.nan, 0, 0), (1, 0, 0), (0, 1, 0)), rays("refused", (0, 0, 1), (0, 0, -1)),
               "an error names the vertex"),
        Report("LTplus-AG/ifc-lite", 3547, "a mesh with NaN hides its neighbours",
               mesh([(np.nan,) * 3, *square()[0]], square()[1] + 1), rays("closest", (0.25, 0.5, 1), (0, 0, -1)),
               "NaN in a vertex that no triangle uses; otherwise an error names it", pull=True),
        Report("mikedh/trimesh", 46, "an error is printed for a ray without a hit",
               mesh([(0, 0, 5), (0, 0, 0), (10, 0, 5), (10, 0, 0), (10, 10, 5), (10, 10, 0), (0, 10, 5), (0, 10, 0)],
                    np.array([(1, 2, 3), (3, 2, 4), (3, 4, 5), (5, 4, 6), (5, 6, 7), (7, 6, 8), (7, 8, 1), (1, 8, 2)]) - 1),
               rays("any", (5, -0.001, 2.5), (0, -1, 0))),
    ],
    "Sides, instances and moving meshes": [
        Report("mrdoob/three.js", 9560, "a mirrored mesh is hit on the wrong side", box(),
               rays("side", (0.25, 0.5, 5), (0, 0, -1)), placed=np.diag([-1, 1, 1, 1])),
        Report("mrdoob/three.js", 10058, "a scene scaled by -1 is hit from the back only", box(),
               rays("side", (0.25, -9, 0.5), (0, 1, 0)), placed=np.diag([2, -3, 1, 1])),
        Report("gkjohnson/three-mesh-bvh", 794, "instances with negative scale have wrong hits", ROUND,
               towards("closest", (9, 8, 7), [(0, 0, 0), (1, 0.5, -1), (-3, 1, 1), (2, 1, 0.25)]),
               placed=[(-2, 0, 0, 1), (0, 3, 0, -1), (0, 0, -1, 2), (0, 0, 0, 1)]),
        Report("mrdoob/three.js", 20550, "the hit on a scaled disc is another one", fan(32, 0.0),
               rays("closest", (0.125, 0.25, 3), (0, 0, -1)), placed=np.diag([2, 2, 1, 1])),
        Report("RenderKit/embree", 60, "normals of instances are in the wrong space", square(),
               rays("normal", (5, 0.25, 0.5), (-1, 0, 0)),
               placed=[(0, 0, 1, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)]),
        Report("jrouwe/JoltPhysics", 1158, "a triangle that is culled hides the ones behind it",
               joined(turned_over(square(1, 2)), square()), rays("closest", (0.5, 0.25, 5), (0, 0, -1), sides="front"),
               pull=True),
        Report("raysan5/raylib", 1688, "two sides of a box are never hit", cut_box(1),
               rays("closest", (0.25, 0.125, 0.375), [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]),
               pull=True),
        Report("gkjohnson/three-mesh-bvh", 330, "a moved mesh is hit where it was", moved(box(), 1, (0, 0, 4)),
               rays("closest", (0.25, 0.5, 9), (0, 0, -1)), before=box()[0]),
        Report("gkjohnson/three-mesh-bvh", 447, "a translated object keeps its old tree", moved(terrain(), 1, (3, 0, -2)),
               rays("closest", down([(1.5, 2.5), (4.25, 3.5), (8.5, 0.5)], 9), (0, 0, -1)), before=terrain()[0]),
        Report("StereoKit/StereoKit", 598, "an animated mesh is hit in its first pose",
               (FINE[0] * np.float32([1, 2, 0.5]), FINE[1]), rays("closest", (0.125, 0.25, 5), (0, 0, -1)),
               before=FINE[0]),
        Report("isaac-sim/IsaacLab", 7523, "the first sensor reading after a reset shows the previous pose",
               moved(square(), 1, (0, 0, -1)), rays("closest", (0.5, 0.25, 2), (0, 0, -1)), before=square()[0], pull=True),
    ],
    "All hits": [
        Report("pyvista/pyvista", 4842, "a ray through an extruded box finds one hit of two",
               box((0, 0, 0), (10, 10, 6)), rays("all", (5, 2, -10), (0, 0, 1), t_max=20)),
        Report("mikedh/trimesh", 303, "a ray through a cylinder finds one place of two",
               moved(cylinder(), 30, (0, 90, 60)), rays("places", (-90, 90, 60), (1, 0, 0))),
        Report("isl-org/Open3D", 5018, "all hits of a ray, not only the first", joined(*(square(2, z) for z in range(5))),
               rays("all", (0.5, 0.25, 9), (0, 0, -1))),
        Report("NVIDIA/warp", 709, "all hits of a ray, with their triangles", ROUND,
               rays("places", [(x / 8, 0.0625, 3) for x in range(-6, 7)], (0, 0, -1))),
        Report("gkjohnson/three-mesh-bvh", 11, "a hit is listed twice, because a leaf is visited twice", terrain(),
               rays("count", down(QUARTERS[::3], 9), (0, 0, -1)), ROWS, also=(1,), pull=True),
    ],
    "Inside, distance and sign": [
        Report("isl-org/Open3D", 5105, "a point outside a cube has a negative distance", box((0, 0, 0), (1, 1, 1)),
               points("signed", [(-1, -1, 0), (-1, -1, -1), (0.5, 0.5, 0.5)])),
        Report("isl-org/Open3D", 5669, "a distance field of a sphere has stripes of the wrong sign", FINE,
               points("inside", lattice(-1.125, 1.125, 7))),
        Report("isl-org/Open3D", 6919, "all points are outside, and all distances positive", turned_over(box()),
               points("signed", [(0, 0, 0), (0.5, 0.25, 0.75), (3, 0, 0)]), "here: a solid that is inside out"),
        Report("mikedh/trimesh", 242, "points in a mesh of voxels are outside", BLOCKS,
               points("inside", lattice(-0.75, 3.25, 9))),
        Report("mikedh/trimesh", 545, "single points outside a watertight mesh are inside", cut_box(3),
               points("inside", lattice(-1.5, 1.5, 7) + 0.0625)),
        Report("mikedh/trimesh", 85, "a point outside is inside, because its ray meets an edge", RIDGE,
               points("inside", [(x, y, 0.5) for x in (-3, 0, 3) for y in (-3, -0.25, 0, 0.25, 3)])),
        Report("mikedh/trimesh", 73, "a distance is 0 for a point in the plane of a side", box((0, 0, 0), (2, 2, 2)),
               points("signed", (3, 2, 2))),
        Report("mikedh/trimesh", 75, "a distance has the wrong sign", voxels([(0, 0, 0), (1, 0, 0), (1, 0, 1)]),
               points("signed", [(0.5, 0.5, 1.25), (0.75, 0.5, 1.5), (1.5, 0.5, 0.5), (1, 0.5, 1.125)])),
        Report("mikedh/trimesh", 181, "contains is random for a small part of a large mesh",
               moved(box(), 2.0**-17, (0.5, 0.5, 0.5)),
               points("inside", 0.5 + 2.0**-20 * lattice(-10, 10, 3))),
        Report("mikedh/trimesh", 1416, "points in two boxes that overlap are outside", joined(box(), moved(box(), 1, (1, 0.5, 0.25))),
               points("inside", [(-0.5, 0, 0), (0.5, 0.125, 0.125), (1.5, 0.75, 0.5), (-0.5, 0.75, 0), (3, 0, 0)])),
        Report("mikedh/trimesh", 2534, "a point in a cavity is inside", HOLLOW,
               points("inside", [(0, 0, 0), (1.5, 0.25, 0.5), (3, 0, 0)])),
        Report("mikedh/trimesh", 1031, "a mesh with a hole has positive and negative distances", OPEN_BOX,
               points("inside", [(0.125, 0.25, 0.375), (3, 0.25, 0.375), (0.125, 0.25, -3)]),
               "six rays along the axes vote on an open mesh"),
        Report("christopherbatty/SDFGen", 4, "whether the sign of an open mesh is reliable", OPEN_BOX,
               points("inside", [(0.5, -0.25, 0.625), (0.5, 2, 0.625), (-3, 0.25, 0)]),
               "six rays along the axes vote on an open mesh"),
        Report("NVIDIA/warp", 1836, "points outside a tetrahedron are inside", tetrahedron(),
               points("inside", [(x, y, z) for x in (-1, 0.25, 2) for y in (-2, 0.125, 1) for z in (-1, 0.25, 2)])),
        Report("NVIDIA/warp", 38, "the sign from the nearest triangle's normal is wrong at vertices", fan(5, 3.0),
               points("distance", [(0, 0, 4), (0.25, 0, 3.5), (1, 1, -1)]), "distances of an open fan"),
        Report("libigl/libigl", 644, "faces that occur twice, with opposite sides, turn the sign",
               joined(box(), square(0.5), turned_over(square(0.5))), points("signed", [(0, 0.125, 0.25), (0, 0, 3)])),
        Report("libigl/libigl", 1204, "a point on the mesh has the distance NaN", box((0, 0, 0), (1, 1, 1)),
               points("signed", [(1e-6, 0.5, 0.5), (-1e-6, 0.5, 0.5), (0, 0.5, 0.5)])),
        Report("libigl/libigl", 2348, "the approximate winding number changes the distance", FINE,
               points("signed", [(0.5, 0.25, 0.125), (0, 0, 0), (2, 1, 0)]), pull=True),
        Report("mikedh/trimesh", 164, "the sign at a sharp edge depends on which of two faces is found",
               mesh([(0, 0, 0), (4, 0, 0.25), (4, 0, -0.25), (2, 3, 0)], [(0, 1, 3), (0, 3, 2), (0, 2, 1), (1, 2, 3)]),
               points("signed", [(-1, -0.5, 0), (-0.5, 0, 0.125), (1, 4, 0)]), pull=True),
        Report("mikedh/trimesh", 310, "the closest point of an obtuse triangle is wrong",
               triangle((0, 0, 0), (4, 0, 0), (-2, 1, 0)),
               points("distance", [(5 * np.cos(a), 5 * np.sin(a), 1) for a in ANGLES]), pull=True),
        Report("facebookresearch/pytorch3d", 1045, "distances are lower than they can be", terrain(),
               points("distance", [(x, 7 - x, 3) for x in range(-2, 9)])),
        Report("facebookresearch/pytorch3d", 897, "points of a surface are nearest to another triangle", terrain(),
               points("distance", terrain()[0][terrain()[1]].mean(axis=1)[::5])),
        Report("janba/GEL", 14, "signs are mixed where triangles face either way", SHUFFLED,
               points("inside", [(0.125, 0.25, 0.375), (-0.5, 0.25, 0.625), (2, 0.25, 0.375)], rule="evenodd"),
               'with `inside="evenodd"`'),
        Report("GavinBarill/fast-winding-number-soups", 2, "winding numbers are useless where triangles face either way",
               SHUFFLED, points("inside", [(-0.125, 0.5, 0.25), (0.5, -3, 0.25)], rule="evenodd"),
               'with `inside="evenodd"`'),
        Report("dimforge/parry", 379, "no point is inside a closed mesh", FINE,
               points("inside", [(0, 0, 0), (0.5, 0.25, 0.125), (0, 0, 0.9375), (1, 1, 0)])),
        Report("mcneel/rhinocommon", 87, "no point is inside a box", box(),
               points("inside", [(0, 0, 0), (0.5, 0.5, 0.5), (2, 0, 0)])),
        Report("fwilliams/point-cloud-utils", 97, "part of a distance field has the wrong sign", HOLLOW,
               points("signed", [(1.5, y / 2, 0.25) for y in range(-5, 6)])),
    ],
}


def all_reports():
    return [report for reports in GROUPS.values() for report in reports]
