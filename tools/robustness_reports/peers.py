"""The answers of trimesh, of Embree through embreex, and of Open3D, from their wheels.

Each peer runs in a process of its own, which is replaced if it dies or takes more than a minute.
"""

import importlib
import importlib.metadata
import multiprocessing
import sys

import numpy as np

from . import answers, reports

PEERS = {"trimesh": "trimesh", "embreex": "embreex", "Open3D": "open3d"}
TIME_LIMIT_S = 60
NOTHING = ("side", "normal")  # what no peer answers by itself


def versions():
    return {name: importlib.metadata.version(package) for name, package in PEERS.items()}


def along(places, query, of):
    """The t of places on rays."""
    origins, directions = (x.astype(np.float64)[of] for x in (query.origins, query.directions))
    return ((places - origins) * directions).sum(axis=-1) / (directions**2).sum(axis=-1)


def trimesh_rays(report, engine):
    import trimesh
    from trimesh.ray import ray_pyembree, ray_triangle

    query = report.query
    mesh = trimesh.Trimesh(*report.world, process=False)
    ray = {"trimesh": ray_triangle, "embreex": ray_pyembree}[engine].RayMeshIntersector(mesh)
    asked = (query.origins.astype(np.float64), query.directions.astype(np.float64))
    rays = range(len(query.origins))
    if query.kind == "any" and query.t_max == answers.INF:
        return ray.intersects_any(*asked).tolist()
    if query.kind == "triangle":
        return ray.intersects_first(*asked).tolist()
    places, ray_of, _ = ray.intersects_location(*asked, multiple_hits=query.kind != "closest")
    t = along(places.reshape(-1, 3), query, ray_of)
    rows = [sorted(t[(ray_of == i) & (t <= query.t_max)].tolist()) for i in rays]
    return {"closest": lambda: [row[0] if row else answers.INF for row in rows],
            "refused": lambda: [row[0] if row else answers.INF for row in rows],
            "any": lambda: [bool(row) for row in rows],
            "all": lambda: [tuple(row) for row in rows]}.get(query.kind, lambda: [len(row) for row in rows])()


def trimesh_points(report, engine):
    import trimesh
    from trimesh.ray import ray_pyembree, ray_triangle

    mesh = trimesh.Trimesh(*report.world, process=False)
    mesh.ray = {"trimesh": ray_triangle, "embreex": ray_pyembree}[engine].RayMeshIntersector(mesh)
    places = report.query.origins.astype(np.float64)
    if report.query.kind == "inside":
        return mesh.ray.contains_points(places).tolist()
    if report.query.kind == "signed":
        return (-trimesh.proximity.signed_distance(mesh, places)).tolist()
    return trimesh.proximity.closest_point(mesh, places)[1].tolist() if engine == "trimesh" else None


def open3d_answers(report):
    import open3d

    query, (vertices, faces) = report.query, report.world
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(vertices.astype(np.float32)),
                        open3d.core.Tensor(faces.astype(np.uint32)))
    if query.directions is None:
        ask = {"distance": scene.compute_distance, "signed": scene.compute_signed_distance,
               "inside": scene.compute_occupancy}[query.kind]
        found = ask(open3d.core.Tensor(query.origins)).numpy()
        return (found > 0).tolist() if query.kind == "inside" else found.tolist()
    rays = open3d.core.Tensor(np.hstack([query.origins, query.directions]))
    if query.kind == "any":
        return scene.test_occlusions(rays, tfar=query.t_max).numpy().tolist()
    if query.kind == "count":
        return scene.count_intersections(rays).numpy().tolist()
    if query.kind in ("places", "all"):
        found = scene.list_intersections(rays)
        t, ray = found["t_hit"].numpy(), found["ray_ids"].numpy()
        rows = [sorted(t[(ray == i) & (t <= query.t_max)].tolist()) for i in range(len(query.origins))]
        return [tuple(row) for row in rows] if query.kind == "all" else [len(set(row)) for row in rows]
    found = scene.cast_rays(rays)
    if query.kind == "triangle":
        return found["primitive_ids"].numpy().astype(np.int32).tolist()
    return found["t_hit"].numpy().tolist()


def asks_too_much(query):
    """Whether the peers have no such question: an interval's begin, a triangle to skip, sides, another rule."""
    return (query.kind in NOTHING or query.t_min > 0 or query.skip is not None or query.sides != "both"
            or query.rule != "nonzero")


def answer(peer, number):
    report = reports.all_reports()[number]
    try:
        if peer == "Open3D":
            return open3d_answers(report)
        return (trimesh_points if report.query.directions is None else trimesh_rays)(report, peer)
    except Exception as error:  # whatever it raises is its answer
        return f"{type(error).__name__}"


def with_limit(peer, all_reports):
    context = multiprocessing.get_context("spawn")
    pool, found = None, []
    for number, report in enumerate(all_reports):
        if asks_too_much(report.query) or (report.query.t_max != answers.INF and report.query.kind == "closest"):
            found.append(None)
            continue
        pool = pool or context.Pool(1)
        try:
            found.append(pool.apply_async(answer, (peer, number)).get(TIME_LIMIT_S))
        except multiprocessing.TimeoutError:
            found.append("no answer within a minute, or the process died")
            pool.terminate()
            pool = None
        print(f"{peer}: {report.project} {report.number}", file=sys.stderr)
    if pool:
        pool.terminate()
    return found


def verdicts():
    """For each report and peer: how many of its answers are right, or its single answer, or None.

    Raises ImportError if a peer cannot be imported: that is no answer of its own.
    """
    for package in (*PEERS.values(), "rtree"):
        importlib.import_module(package)
    all_reports = reports.all_reports()
    right = [answers.judged(report) for report in all_reports]
    found = {}
    for peer in PEERS:
        for report, truth, given in zip(all_reports, right, with_limit(peer, all_reports)):
            found.setdefault(report.key, {})[peer] = verdict(report, truth, given)
    return {"versions": versions(), "reports": found}


def verdict(report, truth, given):
    if given is None or isinstance(given, str):
        return given
    good = sum(answers.nearly(report, g, t) for g, t in zip(given, truth))
    if good == len(truth):
        return True
    return f"{good} of {len(truth)}" if len(truth) > 1 else shown(given[0])


def shown(value):
    """An answer in few characters."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (tuple, list)):
        return ", ".join(map(shown, value)) or "nothing"
    if isinstance(value, str):
        return value
    if value == answers.INF:
        return "miss"
    return f"{float(value):.6g}".replace("-", "−").replace("e+0", "e").replace("e−0", "e−")
