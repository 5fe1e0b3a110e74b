"""Scenes of MuJoCo models answer as MuJoCo's own rays do."""

from __future__ import annotations

import copy
from types import SimpleNamespace

import numpy as np
import pytest

import raysheaf
from raysheaf.sensors import SpinningLidar

mujoco = pytest.importorskip("mujoco")
from raysheaf.mujoco import ModelScene  # noqa: E402  (it needs mujoco)

SEGMENTS = 32


def of(xml, assets=""):
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{assets}</asset><worldbody>{xml}</worldbody></mujoco>"
    )


def at(model, qpos=None):
    data = mujoco.MjData(model)
    if qpos is not None:
        data.qpos[:] = qpos
    placed(model, data)
    return data


def placed(model, data):
    """Computes where things are, without collisions."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)


def numbers(values):
    return " ".join(str(float(one)) for one in values)


def place(generator, spread=3.0):
    turn = generator.normal(size=4)
    turn /= np.linalg.norm(turn)
    return f'pos="{numbers(generator.uniform(-spread, spread, 3))}" quat="{numbers(turn)}"'


def random_model(seed, shrunk=False):
    """Geoms of all kinds, some on moving bodies, in several groups. Those of the shrunken model are
    inside of the polyhedra of the others."""
    generator = np.random.default_rng(seed)
    radial = np.cos(np.pi / SEGMENTS) if shrunk else 1.0
    both = radial**2
    factors = {
        "sphere": [both],
        "ellipsoid": [both] * 3,
        "capsule": [both, 1],
        "cylinder": [radial, 1],
        "box": [1] * 3,
    }
    xml = '<geom type="plane" size="0 0 1" pos="0 0 -4"/>'
    xml += f'<geom type="plane" size="2 1 1" {place(generator)}/>'
    xml += f'<geom type="plane" size="0 .5 1" {place(generator)}/>'
    xml += f'<geom type="hfield" hfield="land" {place(generator)}/>'
    xml += f'<geom type="mesh" mesh="rock" {place(generator)}/>'
    for k in range(30):
        kind = list(factors)[k % len(factors)]
        size = generator.uniform(0.1, 0.6, 3)[: len(factors[kind])]
        geom = f'<geom type="{kind}" size="{numbers(size * factors[kind])}" group="{k % 6}"'
        if k % 2:
            xml += f"<body {place(generator)}><freejoint/>{geom}/></body>"
        else:
            xml += f"{geom} {place(generator)}/>"
    heights = generator.uniform(0, 1, 5 * 7)
    points = generator.normal(size=(40, 3))
    assets = (
        f'<hfield name="land" nrow="5" ncol="7" size="1 .7 .5 .2" elevation="{numbers(heights)}"/>'
    )
    assets += f'<mesh name="rock" vertex="{numbers(points.ravel())}"/>'
    return of(xml, assets)


def by_mujoco(model, data, pnt, vec, groups=None, static=True, body=-1, normal=None):
    count = len(vec)
    ids, far = np.zeros(count, np.int32), np.zeros(count)
    rest = (np.ascontiguousarray(vec, float).ravel(), groups, static, body, ids, far)
    try:
        mujoco.mj_multiRay(model, data, np.asarray(pnt, float), *rest, normal, count, 1e10)
    except TypeError:  # before MuJoCo 3.4
        mujoco.mj_multiRay(model, data, np.asarray(pnt, float), *rest, count, 1e10)
    return ids, far


def rays_from(generator, count=2000, away=9.0):
    """An origin outside of all geoms, and rays past them."""
    pnt = generator.normal(size=3)
    pnt *= away / np.linalg.norm(pnt)
    return pnt, (generator.uniform(-4, 4, (count, 3)) - pnt) * generator.uniform(0.5, 2, (count, 1))


def ends(far):
    return np.where(far < 0, np.inf, far)


FAR = 1e4  # planes without end have no more than ten times this


@pytest.mark.parametrize("seed", range(8))
def test_ranges_are_between_those_of_the_surface_and_of_its_polyhedron(seed):
    generator = np.random.default_rng(100 + seed)
    whole, inner = random_model(seed), random_model(seed, shrunk=True)
    scene = ModelScene(whole, segments=SEGMENTS)
    data, smaller = at(whole), at(inner)
    for step in range(3):
        pnt, vec = rays_from(generator)
        ids, far = by_mujoco(whole, data, pnt, vec)
        inner_ids, inner_far = by_mujoco(inner, smaller, pnt, vec)
        geom, dist = scene.multi_ray(pnt, vec, cutoff=FAR)
        lengths = np.linalg.norm(vec, axis=1)
        assert (dist * lengths <= 1.00001 * FAR).all() and ((dist < 0) == (geom < 0)).all()
        within = (far * lengths < FAR) & (inner_far * lengths < FAR)
        least, most = 0.999999 * ends(far) - 2e-6, 1.000001 * ends(inner_far) + 2e-6
        inside = (least <= ends(dist)) & (ends(dist) <= most)
        # A ray through the very edge of a geom may pass it on either side.
        assert np.count_nonzero(within & ~inside) <= 1
        assert np.count_nonzero(within & (ids == inner_ids) & (geom != ids)) <= 1
        assert within.mean() > 0.95 and len(np.unique(geom)) > 12
        data.qpos[:] += generator.normal(scale=0.3, size=whole.nq)
        smaller.qpos[:] = data.qpos
        placed(whole, data), placed(inner, smaller)
        scene.follow(data)


def test_the_stated_error_of_round_geoms_is_the_most_that_they_have():
    kinds = {"sphere": ".7", "ellipsoid": ".3 .7 .2", "capsule": ".7 .3", "cylinder": ".7 .4"}
    for kind, size in kinds.items():
        scene = ModelScene(of(f'<geom type="{kind}" size="{size}"/>'), segments=SEGMENTS)
        error = scene.geom_error[0]
        assert 0.7 * np.sin(np.pi / SEGMENTS) ** 2 > 0.99 * error > 0.4 * 0.7 * 0.0096
        generator = np.random.default_rng(1)
        out = generator.normal(size=(20_000, 3))
        model, data = scene.model, at(scene.model)
        _, far = by_mujoco(model, data, [0, 0, 0], out)
        _, found = scene.multi_ray([0, 0, 0], out)
        gap = (far - found) * np.linalg.norm(out, axis=1)
        assert gap.min() > -1e-6 and gap.max() > 0.8 * error
        if kind == "sphere":  # the ways out are perpendicular to the surface
            assert gap.max() <= error + 1e-6


@pytest.mark.parametrize("rows, columns", [(9, 9), (6, 11), (2, 2)])
def test_height_fields_have_the_triangles_of_mujoco(rows, columns):
    generator = np.random.default_rng(rows)
    heights = generator.uniform(0, 1, rows * columns)
    asset = (
        f'<hfield name="land" nrow="{rows}" ncol="{columns}" size="2 1.5 .8 .1" '
        f'elevation="{numbers(heights)}"/>'
    )
    model = of('<geom type="hfield" hfield="land" pos="1 2 3" euler="10 20 30"/>', asset)
    scene, data = ModelScene(model), at(model)
    turn, shift = data.geom_xmat[0].reshape(3, 3), data.geom_xpos[0]
    pnt = shift + turn @ [0.1, 0.2, 6]
    spots = generator.uniform([-2.2, -1.7, 0], [2.2, 1.7, 0.8], (4000, 3))
    vec = shift + spots @ turn.T - pnt
    ids, far = by_mujoco(model, data, pnt, vec)
    geom, dist = scene.multi_ray(pnt, vec)
    same = geom == ids
    assert same.mean() > 0.998 and 0.6 < (ids == 0).mean() < 0.99
    assert np.abs(dist - far)[same].max() < 2e-6
    solid = scene.hit_counts(np.broadcast_to(pnt, vec.shape), vec)
    assert (solid % 2 == 0).mean() > 0.999  # closed: rays that come in go out


def test_masks_are_those_of_mujoco():
    generator = np.random.default_rng(3)
    model = random_model(3)
    scene, data = ModelScene(model), at(model)
    pnt, vec = rays_from(generator)
    first = int(model.geom_bodyid[-1])
    for groups in (None, [1, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 1]):
        for static in (True, False):
            for body in (-1, 0, first, first - 1):
                chosen = None if groups is None else np.array(groups, np.uint8)
                ids, far = by_mujoco(model, data, pnt, vec, chosen, static, body)
                geom, dist = scene.multi_ray(pnt, vec, groups, static, body)
                assert (geom == ids).mean() > 0.99
                close = (geom == ids) & (far * np.linalg.norm(vec, axis=1) < FAR)
                assert np.median(np.abs(dist - far)[close]) < 1e-2
    everything = scene.closest_hit(pnt, vec)
    assert (scene.geom_of(everything) == scene.multi_ray(pnt, vec)[0]).mean() > 0.9
    assert scene.geom_of(everything[0]).shape == ()


def test_a_mask_has_bits_for_a_few_bodies():
    xml = "".join(
        f'<body pos="{3 * k} 0 0"><freejoint/><geom type="box" size="1 1 1"/></body>'
        for k in range(40)
    )
    scene = ModelScene(of(xml))
    other = copy.copy(scene)
    origins = np.array([[3.0 * k, 0, 9] for k in range(40)])
    for body in range(1, 32):
        geom, _ = scene.multi_ray(origins, [0, 0, -1], bodyexclude=body)
        expected = np.arange(40)
        expected[body - 1] = -1
        assert geom.tolist() == expected.tolist()
    with pytest.raises(ValueError, match="bodyexclude: 33 is given"):
        scene.ray_mask(bodyexclude=33)
    assert (scene.multi_ray(origins, [0, 0, -1])[0] == np.arange(40)).all()
    geom, _ = other.multi_ray(origins, [0, 0, -1], bodyexclude=40)
    assert geom.tolist() == [*range(39), -1]


def test_planes_have_one_side_and_all_else_two():
    xml = """<geom type="plane" size="0 0 1" pos="0 0 1"/><geom type="plane" size="2 2 1"
        euler="180 0 0"/><geom type="sphere" size=".5" pos="0 0 3"/>"""
    model = of(xml)
    scene, data = ModelScene(model), at(model)
    vec = np.array([[0.1, 0.2, 1], [0.1, 0.2, -1], [5, 0, 1], [5, 0, -1]])
    for pnt in ([0, 0, -2], [0, 0, 0.5], [0, 0, 2], [0, 0, 3], [0, 0, 5]):
        ids, far = by_mujoco(model, data, pnt, vec)
        geom, dist = scene.multi_ray(pnt, vec)
        assert geom.tolist() == ids.tolist()
        np.testing.assert_allclose(dist, far, atol=2e-3)
        for one, way in enumerate(vec):
            alone = scene.multi_ray(pnt, way)
            assert alone[0].shape == () and alone[0] == geom[one] and alone[1] == dist[one]


def test_what_has_no_colour_is_not_there():
    xml = """<geom type="sphere" size=".5" rgba="1 1 1 0"/><geom type="box" size="1 1 1"
        material="glass" pos="5 0 0"/><geom type="box" size="1 1 1" pos="9 0 0"/>"""
    scene = ModelScene(of(xml, '<material name="glass" rgba="1 1 1 0"/>'))
    assert scene.instance_ids.tolist() == [raysheaf.INVALID_ID] * 2 + [0]
    assert scene.geoms.tolist() == [2]
    geom, dist = scene.multi_ray([-9, 0, 0], [[1, 0, 0], [0, 0, 0], [np.nan, 0, 0]])
    assert geom.tolist() == [2, -1, -1] and dist.tolist() == [17, -1, -1]


def test_geoms_share_meshes_and_move_in_one_call(monkeypatch):
    generator = np.random.default_rng(1)
    xml = '<geom type="plane" size="9 9 1"/>'
    for k in range(1000):
        size = numbers(generator.uniform(0.01, 1, 3))
        xml += f'<body {place(generator)}><freejoint/><geom type="box" size="{size}"/></body>'
    xml += '<geom type="box" size="100 100 .01" pos="0 0 -5"/>'
    model = of(xml)
    scene = ModelScene(model)
    assert len(scene.meshes) == 3 and scene.triangle_count() == 2 + 12 * 1001
    calls = []
    move = raysheaf.Scene.set_transforms
    monkeypatch.setattr(
        raysheaf.Scene, "set_transforms", lambda *given: (calls.append(1), move(*given))
    )
    data = at(model, generator.normal(size=model.nq))
    scene.follow(data)
    assert len(calls) == 1
    pnt, vec = rays_from(generator)
    ids, far = by_mujoco(model, data, pnt, vec)
    geom, dist = scene.multi_ray(pnt, vec)
    assert (geom == ids).mean() > 0.999
    np.testing.assert_allclose(dist[geom == ids], far[geom == ids], rtol=1e-5, atol=1e-6)


def test_static_geoms_may_be_edited():
    model = of(
        '<body name="block"><geom type="box" size="1 1 1"/></body><geom size="1" pos="9 0 0"/>'
    )
    scene = ModelScene(model)
    model.body("block").pos[:] = 0, 0, 3
    scene.follow(at(model))
    assert scene.multi_ray([0, 0, 9], [0, 0, -1])[1] == 5


def test_worlds_are_as_many_scenes():
    generator = np.random.default_rng(5)
    model = random_model(5)
    states = [
        at(model, at(model).qpos + generator.normal(scale=0.5, size=model.nq)) for _ in range(7)
    ]
    many, one = ModelScene(model, worlds=7), ModelScene(model)
    assert many.instance_ids.shape == (7, model.ngeom)
    assert len(many.geoms) == len(np.unique(many.instance_ids)) < 7 * model.ngeom
    pnt, vec = rays_from(generator, 7 * 300)
    vec = vec.reshape(7, 300, 3)
    batch = SimpleNamespace(
        geom_xpos=np.stack([state.geom_xpos for state in states]),
        geom_xmat=np.stack([state.geom_xmat.reshape(-1, 3, 3) for state in states]),
    )
    for given in (states, batch, many.matrices(tuple(states))):
        many.follow([states[0]] * 7)
        many.follow(given)
        for body in (-1, int(model.geom_bodyid[-1])):
            geom, dist = many.multi_ray(pnt, vec, bodyexclude=body, worlds=range(7))
            for k, state in enumerate(states):
                one.follow(state)
                mine = one.multi_ray(pnt, vec[k], bodyexclude=body)
                assert (geom[k] == mine[0]).all() and (dist[k] == mine[1]).all()


def test_several_moments_are_a_movement():
    model = of('<body><freejoint/><geom type="box" size="1 1 1"/></body>')
    scene = ModelScene(model)
    scene.follow(*(at(model, [x, 0, 0, 1, 0, 0, 0]) for x in (0, 1, 4)))
    hits = scene.closest_hit([[-9, 0, 0]] * 4, [1, 0, 0], times=[0, 0.25, 0.5, 1])
    assert hits.t.tolist() == [8, 8.5, 9, 12]
    assert scene.multi_ray([-9, 0, 0], [1, 0, 0])[1] == 8


def test_sensors_see_geoms_from_sites_and_cameras():
    model = of("""<geom type="box" size="1 9 9" pos="8 0 0"/>
        <body name="robot" pos="1 0 0"><freejoint/><geom type="box" size=".2 .2 .2"/>
        <site name="top" pos="0 0 .5" euler="0 0 90"/>
        <camera name="eye" pos=".5 0 0" xyaxes="0 -1 0 0 0 1" fovy="60"/></body>""")
    scene, data = ModelScene(model), at(model)
    data.qpos[:3] += [1, 0, 0]
    placed(model, data)
    scene.follow(data)
    pose = scene.site_pose(data, "top")
    assert pose.shape == (4, 4) and pose[:3, 3].tolist() == [2, 0, 0.5]
    lidar = SpinningLidar(elevation=[0, -80], steps=360)
    scan = lidar.scan(scene, pose, labels=scene.geoms, mask=scene.ray_mask())
    assert scan.label[270, 0] == 0 and abs(scan.range[270, 0] - 5) < 1e-5  # to the right is x
    assert scan.label[0].tolist() == [-1, 1]
    alone = lidar.scan(
        scene, pose, labels=scene.geoms, mask=scene.ray_mask(bodyexclude=model.body("robot").id)
    )
    assert alone.label[0].tolist() == [-1, -1]
    camera = scene.depth_camera("eye", (64, 48), far=90.0)
    image = camera.scan(scene, scene.camera_pose(data, "eye"), labels=scene.geoms)
    np.testing.assert_allclose(image.depth, 4.5, rtol=1e-6)
    assert (image.label == 0).all()
    high = image.position[..., 2]
    np.testing.assert_allclose(
        high[0] - high[-1], 2 * 4.5 * np.tan(np.radians(30)) * 47 / 48, rtol=1e-5
    )
    assert (high[0] > high[-1]).all() and (image.position[0, 0, 1] > image.position[0, -1, 1])
    poses = scene.site_pose([data, at(model)], 0)
    assert poses.shape == (2, 4, 4) and poses[:, 0, 3].tolist() == [2, 1]


def test_other_meshes_may_be_added_and_scenes_copied():
    scene = ModelScene(of('<geom type="box" size="1 1 1"/>'))
    scene.add([[-9, -9, 5], [9, -9, 5], [0, 9, 5]])
    assert scene.geom_of(scene.closest_hit([0, 0, 9], [0, 0, -1])) == -1
    other = copy.deepcopy(scene)
    assert type(other) is ModelScene and other.multi_ray([0, 0, 3], [0, 0, -1])[1] == 2


def test_messages():
    model = of('<body><freejoint/><geom type="box" size="1 1 1"/></body>')
    scene = ModelScene(model)
    for wrong, text in [
        (lambda: ModelScene("a.xml"), "model: str is given; a mujoco.MjModel is expected"),
        (lambda: ModelScene(model, segments=30), "segments: 30 is given; a multiple of 4"),
        (lambda: ModelScene(model, worlds=0), "worlds: 0 is given"),
        (lambda: scene.follow(), "moments: none are given"),
        (lambda: scene.follow([at(model)] * 2), r"moments: transforms of shape \(2, 1, 3, 4\)"),
        (
            lambda: scene.follow(at(of('<geom size="1"/><geom size="2"/>'))),
            "data: 2 geoms are given",
        ),
        (lambda: scene.ray_mask([1, 0]), "geomgroup: an array of shape \\(2,\\) is given"),
        (lambda: scene.ray_mask(bodyexclude=2), "bodyexclude: 2 is given"),
        (lambda: scene.multi_ray([0, 0], [0, 0, 1]), "pnt: an array of shape"),
        (lambda: scene.multi_ray([0, 0, 0], [0, 0, 1], cutoff="a"), "cutoff: 'a' is given"),
        (lambda: scene.site_pose(at(model), "nowhere"), "nowhere"),
    ]:
        with pytest.raises((TypeError, ValueError, KeyError), match=text):
            wrong()
