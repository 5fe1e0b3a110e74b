"""Arrays in a device's memory: refused arguments, the data that the extension gets, and, on a
machine
with a CUDA device, equality with the CPU's answers.
"""

from __future__ import annotations

import ctypes
import sys
import types

import numpy as np
import pytest
from conftest import interrupted_after, make_setting

import raysheaf
from raysheaf import _core, _device

SETTING = make_setting(11)
ALL = 0xFFFFFFFF


def packed_rays() -> np.ndarray:
    origins, directions = SETTING.origins, SETTING.directions
    rays = np.zeros((len(origins), 8), np.float32)
    rays[:, 0:3], rays[:, 4:7], rays[:, 7] = origins, directions, np.inf
    return rays


class Fake:
    """Claims to be on a device; its memory is never read."""

    def __init__(self, shape, typestr="<f4", **more):
        self.__cuda_array_interface__ = {
            "data": (4096, False),
            "shape": shape,
            "typestr": typestr,
            "version": 3,
            **more,
        }


class WithGradient:
    """Like PyTorch's tensors that require gradients."""

    @property
    def __cuda_array_interface__(self):
        raise RuntimeError("Can't get __cuda_array_interface__ on Variable that requires grad.")


def scene_of_the_cpu() -> raysheaf.Scene:
    scene = raysheaf.Scene()
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene


def test_devices_have_names():
    assert raysheaf.Scene().device == "cpu"
    with pytest.raises(ValueError, match='device: \'gpu\' is given; "cpu" or "cuda"'):
        raysheaf.Scene(device="gpu")
    with pytest.raises(ValueError, match="device: 'gpu' is given"):
        raysheaf.render("builtin:cornell", width=8, height=8, device="gpu")


def test_a_device_that_is_not_there():
    try:
        raysheaf.Scene(device="cuda")
    except raysheaf.UnsupportedError as error:
        assert "CUDA" in str(error)
        with pytest.raises(raysheaf.UnsupportedError):
            raysheaf.render("builtin:cornell", width=8, height=8, device="cuda")
    else:
        pytest.skip("there is a CUDA device")


@pytest.mark.parametrize(
    "given, sentence",
    [
        (
            Fake((5, 8)),
            "rays: an array of shape \\(5, 8\\) and dtype float32 on a CUDA device is given to a scene of the CPU",
        ),
        (
            Fake((5, 8), "<f8"),
            "dtype float64 .* is given; on a device one of shape \\(..., 8\\) and dtype float32",
        ),
        (Fake((5, 7)), "shape \\(5, 7\\) .* one of shape \\(..., 8\\)"),
        (Fake(()), "one of shape \\(..., 8\\)"),
        (Fake((5, 8), strides=(64, 4)), "not in C order"),
        (WithGradient(), "rays: cannot be read as an array: Can't get"),
    ],
)
def test_rays_that_cannot_be_read(given, sentence):
    with pytest.raises((TypeError, ValueError), match=sentence):
        scene_of_the_cpu().closest_hit(given)


def test_only_whole_rays_lie_on_devices():
    with pytest.raises(TypeError, match="origins: .* is given besides directions"):
        scene_of_the_cpu().any_hit(Fake((5, 3)), [0, 0, 1])
    with pytest.raises(TypeError, match="directions: .* in the memory of the CPU is expected"):
        scene_of_the_cpu().any_hit([0, 0, 0], Fake((5, 3)))
    with pytest.raises(TypeError, match="vertices: .* in the memory of the CPU is expected"):
        raysheaf.Scene().add(Fake((3, 3)), [[0, 1, 2]])


@pytest.mark.parametrize(
    "given, radius, sentence",
    [
        (Fake((5, 3)), None, "points: .* is given to a scene of the CPU"),
        (Fake((5, 3), "<i4"), None, "shape \\(..., 3\\) and dtype float32 or float64 is expected"),
        (Fake((5, 4)), None, "shape \\(5, 4\\) .* one of shape \\(..., 3\\)"),
        (Fake((5, 3), strides=(24, 4)), None, "not in C order"),
        (Fake((5, 3)), np.ones(5), "radius: an array of shape \\(5,\\) .* one number is expected"),
        (Fake((5, 3)), Fake((5,)), "radius: .* in the memory of the CPU is expected"),
        ([[0, 0, 0]], Fake((1,)), "radius: .* in the memory of the CPU is expected"),
    ],
)
def test_points_that_cannot_be_read(given, radius, sentence):
    with pytest.raises((TypeError, ValueError), match=sentence):
        scene_of_the_cpu().closest_point(given, radius=radius)


def test_room_for_the_answers_to_points():
    scene, points = scene_of_the_cpu(), np.zeros((2, 3))
    for ask in (scene.closest_point, scene.signed_distance, scene.contains):
        with pytest.raises(TypeError, match="out: .* is given to a scene of the CPU"):
            ask(points, out=Fake((2, 8), "<f8"))
        with pytest.raises(TypeError, match="out: ndarray is given; an array on a CUDA device"):
            ask(points, out=np.zeros(2))
    with pytest.raises(TypeError, match="out: occupancy makes a new array"):
        scene.occupancy(points, out=Fake((2,), "|b1"))


def test_room_for_results():
    scene, rays = scene_of_the_cpu(), packed_rays()
    with pytest.raises(TypeError, match="out: .* is given to a scene of the CPU"):
        scene.any_hit(rays, out=Fake((len(rays),), "|b1"))
    with pytest.raises(
        TypeError, match="out: list is given; an array of numpy or on a CUDA device"
    ):
        scene.hit_counts(rays, out=[0] * len(rays))
    good = _device.device_array(Fake((2, 3, 6)), "out")
    assert _device.room_there(good, (2, 3, 6), ("float32",)) is good
    for wrong in (
        Fake((2, 3, 6), "<f8"),
        Fake((6, 6)),
        Fake((2, 3, 6), data=(4096, True)),
    ):
        array = _device.device_array(wrong, "out")
        with pytest.raises(ValueError, match="out: .* a writable one of shape \\(2, 3, 6\\)"):
            _device.room_there(array, (2, 3, 6), ("float32",))


def test_descriptions_of_arrays():
    array = _device.device_array(Fake((4, 2, 8), stream=2, strides=(64, 32, 4)), "rays")
    assert (array.shape, array.dtype, array.stream) == ((4, 2, 8), "float32", 2)
    assert _device.device_array(Fake((0, 8), data=(None, False)), "rays").pointer == 0
    assert _device.device_array(Fake((1, 8), strides=(4, 4)), "rays") is not None
    for other in (None, 3.0, [1, 2], np.zeros(3)):
        assert _device.device_array(other, "rays") is None


def test_streams_that_arrays_name():
    def stream(**more):
        return _device.device_array(Fake((5, 8), **more), "rays").stream

    assert (stream(stream=1), stream(stream=2), stream(stream=4711)) == (1, 2, 4711)
    assert stream(stream=None) == 0  # no stream to wait for
    assert stream() == 0  # as before version 3 of the interface
    assert stream(stream=0) == 1  # not allowed; treated as the default stream


def test_streams_of_tensors(monkeypatch):
    class Tensor(Fake):
        device = "cuda:3"

    current = {"cuda:3": 4711}
    torch = types.ModuleType("torch")
    torch.Tensor = Tensor
    torch.cuda = types.SimpleNamespace(
        current_stream=lambda device: types.SimpleNamespace(cuda_stream=current[device])
    )
    monkeypatch.setitem(sys.modules, "torch", torch)
    tensor = Tensor((5, 8), version=2)
    assert _device.device_array(tensor, "rays").stream == 4711
    current["cuda:3"] = 0  # PyTorch's value for the legacy default stream
    assert _device.device_array(tensor, "rays").stream == 1
    assert _device.device_array(Tensor((5, 8), stream=5), "rays").stream == 5
    assert _device.device_array(Fake((5, 8)), "rays").stream == 0  # not PyTorch's


def place(array: np.ndarray) -> _core.Place:
    """The place of a numpy array: a CPU scene reads memory at the pointer."""
    return _core.Place(array.ctypes.data, len(array), 0)


def test_pointers_reach_the_library():
    scene, rays = scene_of_the_cpu(), packed_rays()
    request = _core.QueryRequest(ALL, False, True, None)
    hits = raysheaf.Hits.empty(len(rays))
    scene._core.closest_hit(place(rays), place(hits.array), request)
    assert hits.array.tobytes() == scene.closest_hit(rays).array.tobytes()
    flags = np.full(len(rays), 7, np.uint8)
    scene._core.any_hit(rays, place(flags), request)
    assert (flags.view(np.bool_) == scene.any_hit(rays)).all()
    counts = np.zeros(len(rays), np.uint32)
    scene._core.hit_counts(place(rays), counts, request)
    assert (counts == scene.hit_counts(rays)).all() and counts.any()
    offsets, *_ = scene._core.all_hits(place(rays), request)
    assert offsets[-1] == counts.sum()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_pointers_to_points_reach_the_library(dtype):
    scene, points = scene_of_the_cpu(), np.ascontiguousarray(SETTING.origins, dtype)
    request = _core.QueryRequest(ALL, False, True, None)
    there = _core.PointArrays(place(points), dtype == np.float64, 2.5)
    found = np.zeros((len(points), 64), np.uint8)
    scene._core.nearest(there, 1, place(found), request)
    expected = scene.closest_point(points, radius=2.5)
    assert found.tobytes() == expected.array.tobytes() and expected.found.any()
    distances = np.zeros(len(points))
    scene._core.signed_distance(there, False, place(distances), request)
    assert distances.tobytes() == scene.signed_distance(points, radius=2.5).tobytes()
    flags = np.full(len(points), 7, np.uint8)
    scene._core.inside(there, True, place(flags), request)
    assert (flags.view(np.bool_) == scene.contains(points, inside="evenodd")).all()


def test_pointers_are_followed_on_the_thread_that_asks():
    """The query must run on the calling thread: on another one, a handle of the thread's default
    stream
    would mean another stream. Ctrl-C interrupts a waiting thread, which ends its query; a working
    one
    reports it when the query is finished.
    """
    setting, scene = make_setting(12, 400), raysheaf.Scene(threads=1)
    scene.add(setting.vertices, setting.triangles)
    many = np.tile(packed_rays(), (400, 1))
    assert len(many) >= 100_000  # with numpy arrays, so many rays would use another thread
    hits = raysheaf.Hits.empty(len(many))
    hits.array["t"] = -1
    with interrupted_after(0.01):
        scene._core.closest_hit(place(many), place(hits.array), _core.QueryRequest(ALL, True, True, None))
    assert (hits.t >= 0).all()


class OnCuda:
    """A numpy array, copied to the device by CUDA's own library."""

    _cuda = None

    @classmethod
    def library(cls):
        if cls._cuda is None:
            for name in ("libcudart.so", "libcudart.so.13", "libcudart.so.12"):
                try:
                    cls._cuda = ctypes.CDLL(name)
                    break
                except OSError:
                    continue
        return cls._cuda

    def __init__(self, array):
        self._like = np.ascontiguousarray(array)
        self._at = ctypes.c_void_p()
        cuda = self.library()
        assert cuda.cudaMalloc(ctypes.byref(self._at), ctypes.c_size_t(self._like.nbytes)) == 0
        size = ctypes.c_size_t(self._like.nbytes)
        assert cuda.cudaMemcpy(self._at, ctypes.c_void_p(self._like.ctypes.data), size, 1) == 0

    @property
    def __cuda_array_interface__(self):
        return {
            "data": (self._at.value, False),
            "shape": self._like.shape,
            "typestr": self._like.dtype.str,
            "version": 3,
            "stream": 1,
        }

    def back(self) -> np.ndarray:
        copy = np.empty_like(self._like)
        size = ctypes.c_size_t(copy.nbytes)
        assert self.library().cudaMemcpy(ctypes.c_void_p(copy.ctypes.data), self._at, size, 2) == 0
        return copy

    def __del__(self):
        self.library().cudaFree(self._at)


@pytest.fixture
def on_cuda():
    try:
        scene = raysheaf.Scene(device="cuda")
    except raysheaf.UnsupportedError as error:
        pytest.skip(str(error))
    if OnCuda.library() is None:
        pytest.skip("there is no libcudart")
    scene.add(SETTING.vertices, SETTING.triangles)
    return scene


def test_answers_are_those_of_the_cpu(on_cuda):
    here, rays = scene_of_the_cpu(), packed_rays()
    there = OnCuda(rays)
    expected = here.closest_hit(rays)
    assert on_cuda.closest_hit(rays).array.tobytes() == expected.array.tobytes()
    assert on_cuda.closest_hit(there).array.tobytes() == expected.array.tobytes()
    room = OnCuda(np.zeros((len(rays), 6), np.float32))
    assert on_cuda.closest_hit(there, out=room) is room
    assert room.back().tobytes() == expected.array.tobytes()
    flags = OnCuda(np.zeros(len(rays), np.bool_))
    on_cuda.any_hit(rays, out=flags)
    assert (flags.back() == here.any_hit(rays)).all()
    counts = OnCuda(np.zeros(len(rays), np.uint32))
    on_cuda.hit_counts(there, out=counts)
    assert (counts.back() == here.hit_counts(rays)).all()
    points = np.ascontiguousarray(rays[:, :3])
    for ask in (
        lambda scene: scene.nearest(points, 3).array,
        lambda scene: scene.signed_distance(points),
        lambda scene: scene.contains(points, inside="evenodd"),
    ):
        assert ask(on_cuda).tobytes() == ask(here).tobytes()
    points_there = OnCuda(points)
    assert on_cuda.closest_point(points_there).array.tobytes() == here.closest_point(points).array.tobytes()
    room = OnCuda(np.zeros((len(points), 3, 8)))
    assert on_cuda.nearest(points_there, 3, 2.5, out=room) is room
    assert room.back().tobytes() == here.nearest(points, 3, 2.5).array.tobytes()
    distances = OnCuda(np.zeros(len(points)))
    on_cuda.signed_distance(OnCuda(points.astype(np.float64)), out=distances)
    assert distances.back().tobytes() == here.signed_distance(points).tobytes()
    flags = OnCuda(np.zeros(len(points), np.bool_))
    on_cuda.contains(points_there, inside="evenodd", out=flags)
    assert (flags.back() == here.contains(points, inside="evenodd")).all()
    rows = on_cuda.all_hits(there)
    assert rows.hits.array.tobytes() == here.all_hits(rays).hits.array.tobytes()


def test_pictures_are_those_of_the_cpu(on_cuda):
    for scene in ("builtin:cornell", "builtin:office"):
        here = raysheaf.render(scene, width=64, height=48)
        there = raysheaf.render(scene, width=64, height=48, device="cuda")
        assert there.beauty.tobytes() == here.beauty.tobytes()
