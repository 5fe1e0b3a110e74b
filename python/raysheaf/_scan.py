"""Scans: beams placed in the world, the echoes of their subrays, and the arrays of a scan."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _clouds, _values
from ._asked import Points
from ._hits import INVALID_ID, Hits
from ._poses import Doubles, Pose, Trajectory, rigid

Floats = NDArray[np.float32]
ByNumber = Union[Mapping[int, Any], ArrayLike]

_LEAST_WEIGHT = 1e-9  # of a subray, so that a mean is defined where nothing is reflected
_FIELDS = "range incidence intensity time beam pose geom_id inst_id prim_id label".split()
_POINT_FIELDS = {"position": "xyz", "normal": ("normal_x", "normal_y", "normal_z")}


@dataclass(frozen=True, eq=False)
class Beams:
    """Beams in the sensor's frame."""

    axes: Doubles  # (b..., 3), NaN for a beam that sees nothing
    origins: Doubles  # broadcasts to (b..., 3)
    times: Doubles  # broadcasts to (b...), with as many axes: seconds from the start of the scan
    subrays: Optional[Doubles] = None  # (b..., s, 3), directions in the cones of the beams

    @property
    def shape(self) -> tuple[int, ...]:
        return self.axes.shape[:-1]

    @cached_property
    def lengths(self) -> Doubles:
        return np.asarray(np.linalg.norm(self.axes, axis=-1))

    @cached_property
    def all_see(self) -> bool:
        return bool(np.isfinite(self.axes).all())


class Placing:
    """Beams in the world: at one pose, at each of several, or along a trajectory."""

    def __init__(self, beams: Beams, matrices: Doubles, poses: tuple[int, ...]) -> None:
        """`matrices` are (p..., 3, 4) for poses of shape (p...), or (p..., t..., 3, 4) where the
        axes t are those of the beams' times."""
        self.beams, self.poses = beams, poses
        if matrices.ndim - 2 == len(poses):
            matrices = matrices.reshape(*poses, *(1,) * len(beams.shape), 3, 4)
        self._matrices = matrices

    @staticmethod
    def of(beams: Beams, pose: Optional[Pose], start: float) -> Placing:
        """Raises ValueError for a pose that is not rigid, or a time outside of the trajectory."""
        if isinstance(pose, Trajectory):
            return Placing(beams, pose.at(start + beams.times), pose.poses.shape[:-3])
        matrices = np.eye(3, 4) if pose is None else rigid(pose, "pose")
        return Placing(beams, matrices, matrices.shape[:-2])

    def aligned(self, turn: Any) -> Placing:
        """The same places with other axes: `turn` maps rotations (..., 3, 3) to such."""
        matrices = self._matrices.copy()
        matrices[..., :3] = turn(matrices[..., :3])
        return Placing(self.beams, matrices, self.poses)

    def turned(self, vectors: NDArray[Any], extra: int = 0, back: bool = False) -> Doubles:
        """Vectors of shape (b..., e..., 3) or (p..., b..., e..., 3), with `extra` axes e, from the
        sensor's frame to the world or back: (p..., b..., e..., 3)."""
        turns = self._matrices[..., :3].reshape(*self._matrices.shape[:-2], *(1,) * extra, 3, 3)
        turns = np.swapaxes(turns, -1, -2) if back else turns
        x, y, z = np.moveaxis(vectors, -1, 0)
        planes = np.empty((3, *np.broadcast_shapes(turns.shape[:-2], x.shape)))
        for i, plane in enumerate(planes):
            np.multiply(turns[..., i, 0], x, out=plane)
            plane += turns[..., i, 1] * y
            plane += turns[..., i, 2] * z
        return np.moveaxis(planes, 0, -1)

    def moved(self, points: NDArray[Any], extra: int = 0) -> Doubles:
        """Points likewise, from the sensor's frame to the world."""
        shifts = self._matrices[..., 3]
        return self.turned(points, extra) + shifts.reshape(
            *shifts.shape[:-1], *(1,) * extra, shifts.shape[-1]
        )

    @cached_property
    def axes(self) -> Doubles:
        """The axes of the beams in the world, (p..., b..., 3)."""
        return self.turned(self.beams.axes)

    def rays(self) -> tuple[Doubles, Doubles]:
        """Origins and directions, which broadcast to (p..., b..., [s,] 3)."""
        beams = self.beams
        origins = self._matrices[..., 3]
        if beams.origins.any():
            origins = self.moved(np.broadcast_to(beams.origins, beams.axes.shape))
        if beams.subrays is None:
            return origins, self.axes
        return origins[..., None, :], self.turned(beams.subrays, extra=1)

    def times_within(self, moving: Sequence[float], start: float) -> Doubles:
        """The times of the rays, from 0 at the first of two seconds to 1 at the last."""
        try:
            first, last = (_values.number(one, "moving") for one in moving)
        except (TypeError, ValueError):
            raise ValueError(f"moving: {moving!r} is given; two numbers are expected") from None
        times = start + self.beams.times
        if not (first <= times.min() and times.max() <= last and first < last):
            raise ValueError(
                f"moving: {first:g} to {last:g} is given; seconds that hold those of the beams, "
                f"{times.min():g} to {times.max():g}, are expected"
            )
        times = np.clip((times - first) / (last - first), 0, 1)
        return times if self.beams.subrays is None else times[..., None]


class Numbered:
    """A value for each number, given as an array by number or as a dict."""

    def __init__(self, given: ByNumber, name: str, dtype: Any) -> None:
        if isinstance(given, Mapping):
            keys, values = list(given.keys()), list(given.values())
            array = np.array(values) if values else np.zeros(0, dtype)
            self._keys = _arrays.ids(keys, name).astype(np.int64)
        else:
            array = _arrays.as_numpy(given, name)
            self._keys = np.arange(len(array) if array.ndim else 0)
        if array.ndim != 1 or array.dtype.kind not in ("iu" if dtype == np.int32 else "iuf"):
            raise TypeError(
                f"{name}: an array of shape {array.shape} and dtype {array.dtype} is given; a number for "
                "each, as {number: value} or an array by number, is expected"
            )
        order = np.argsort(self._keys)
        self._keys, self._values = self._keys[order], array.astype(dtype)[order]

    def of(self, numbers: NDArray[Any], otherwise: float) -> NDArray[Any]:
        """The values of an array of numbers."""
        if not len(self._keys):
            return np.full(numbers.shape, otherwise, self._values.dtype)
        place = np.minimum(np.searchsorted(self._keys, numbers), len(self._keys) - 1)
        known = self._keys[place] == numbers
        return np.where(known, self._values[place], self._values.dtype.type(otherwise))


@dataclass
class Looks:
    """The labels of instances, and the reflectance of labels."""

    labels: Optional[Numbered]
    reflectance: Optional[Numbered]

    @staticmethod
    def of(labels: Optional[ByNumber], reflectance: Optional[ByNumber]) -> Looks:
        if reflectance is not None and labels is None:
            raise TypeError("reflectance: it is given by label, without labels; both are expected")
        return Looks(
            None if labels is None else Numbered(labels, "labels", np.int32),
            None if reflectance is None else Numbered(reflectance, "reflectance", np.float64),
        )

    def label(self, hits: Hits) -> NDArray[np.int32]:
        if self.labels is None:
            raise TypeError("labels: none were given to scan; labels by instance are expected")
        return self.labels.of(hits.inst_id, -1)

    def intensity(self, hits: Hits, cosines: NDArray[Any]) -> Doubles:
        """Cosines times the reflectance; 0 for a miss."""
        found = np.where(hits.hit, cosines, 0.0)
        if self.reflectance is not None:
            found *= self.reflectance.of(self.label(hits), 1)
        return found


def cosines(normals: NDArray[Any], directions: NDArray[Any]) -> Doubles:
    """The cosines between normals and beams against them, times the lengths of the directions."""
    against = -np.einsum("...i,...i->...", normals, directions)
    return np.asarray(np.maximum(against, 0))


@dataclass
class Echoes:
    """The echoes of n beams of s subrays each, of which each beam reports some."""

    subray: NDArray[np.int64]  # (n, r), the subray that carries most of it
    t: Doubles  # (n, r), inf for none
    intensity: Doubles  # (n, r)

    @staticmethod
    def of(t: Doubles, intensity: Doubles, separation: float, returns: Sequence[str]) -> Echoes:
        """Subrays, sorted by t, are in one echo if no two neighbours are farther apart than the
        separation. Its t is their mean, weighted by intensity; its intensity their sum.

        `t`, `intensity`: (n, s); a subray without a hit has t = inf and intensity 0.
        """
        count, most = t.shape
        order = np.argsort(t, axis=1, kind="stable")
        near, power = (np.take_along_axis(one, order, axis=1) for one in (t, intensity))
        hit: NDArray[np.bool_] = np.less(near, np.inf)
        with np.errstate(invalid="ignore"):  # inf - inf
            parts = near[:, 1:] - near[:, :-1] > separation
        number = np.concatenate([np.zeros((count, 1), np.int64), np.cumsum(parts, axis=1)], axis=1)
        place = (number + most * np.arange(count)[:, None]).reshape(-1)

        def summed(values: Doubles) -> Doubles:
            sums = np.bincount(place, values.reshape(-1), count * most)
            return np.asarray(sums, np.float64).reshape(count, most)

        weight = np.where(hit, power + _LEAST_WEIGHT, 0)
        total = summed(weight)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = summed(weight * np.where(hit, near, 0)) / total
        power_sums = summed(power)
        row = np.arange(count)[:, None]
        which = {
            "first": np.zeros(count, np.int64),
            "last": np.where(hit, number, 0).max(axis=1),
            "strongest": np.argmax(total, axis=1),
        }
        chosen = np.stack([which[name] for name in returns], axis=1)
        best = [
            np.argmax(np.where(number == echo[:, None], weight, -1), axis=1) for echo in chosen.T
        ]
        found = np.where(np.any(hit, axis=1, keepdims=True), mean[row, chosen], np.inf)
        return Echoes(order[row, np.stack(best, axis=1)], found, power_sums[row, chosen])


class Scan:
    """The measurements of a sensor: arrays of the shape of its beams.

    The shape is that of the poses, then that of the sensor's beams, then, if it reports several
    returns, one for each. Points and normals have an axis of three after these. All lengths are in
    units of the scene, and all angles in degrees. A miss has range inf, ids `raysheaf.INVALID_ID`,
    label -1, intensity 0, and NaN for points and angles.

    The sensor's frame is its own at the time of each beam. All arrays but the ids are computed when
    they are first used. Normals, incidence and intensity need the scene for this, and raise an
    `Error` if it has changed since the scan.
    """

    hits: Hits
    """The hits, with their `uv`, `interpolate` and `material_id`. Their `t` is without noise."""

    def __init__(
        self,
        placing: Placing,
        hits: Hits,
        t: NDArray[Any],
        start: float,
        looks: Looks,
        returned: Optional[Doubles] = None,
        all_subrays: Optional[tuple[Doubles, Doubles]] = None,
    ) -> None:
        self.hits = hits
        self._placing, self._t, self._start, self._looks = placing, t, start, looks
        self._returned = returned  # the intensity of returns of subrays
        self._all_subrays = all_subrays  # t and intensity, (n, s)
        self._extra = hits.array.ndim - len(placing.poses) - len(placing.beams.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        return self.hits.shape

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether a return came back."""
        return self.hits.hit

    def _each(self, values: Doubles, axes: int = 0) -> Doubles:
        """Values of beams, or of vectors of so many axes, with the axis of returns."""
        at = values.ndim - axes
        return values.reshape(*values.shape[:at], *(1,) * self._extra, *values.shape[at:])

    @cached_property
    def range(self) -> Floats:
        """Distances along the beams from where they begin."""
        with np.errstate(invalid="ignore"):
            far = self._t * self._each(self._placing.beams.lengths)
        return np.where(self.hit, far, np.inf).astype(np.float32)

    @cached_property
    def _local(self) -> Doubles:
        beams = self._placing.beams
        t = np.where(self.hit, self._t, np.nan)
        origins = np.broadcast_to(beams.origins, beams.axes.shape)
        return np.asarray(self._each(origins, 1) + t[..., None] * self._each(beams.axes, 1))

    @cached_property
    def local_position(self) -> Floats:
        """(..., 3), points in the sensor's frame."""
        return self._local.astype(np.float32)

    @cached_property
    def position(self) -> Floats:
        """(..., 3), points in the world."""
        return self._placing.moved(self._local, self._extra).astype(np.float32)

    @cached_property
    def normal(self) -> Floats:
        """(..., 3), unit normals in the world, perpendicular to the triangle, towards the sensor."""
        return Points(self.hits.array, self.hits._asked).facing_normal()

    @cached_property
    def _cosines(self) -> Doubles:
        lengths = self._each(self._placing.beams.lengths)
        return cosines(self.normal, self._each(self._placing.axes, 1)) / lengths

    @cached_property
    def local_normal(self) -> Floats:
        """(..., 3), the same in the sensor's frame."""
        return self._placing.turned(self.normal, self._extra, back=True).astype(np.float32)

    @property
    def incidence(self) -> Floats:
        """Angles between beams and normals: 0 where the beam meets the surface head-on, up to 90."""
        return np.degrees(np.arccos(np.minimum(self._cosines, 1))).astype(np.float32)

    @cached_property
    def intensity(self) -> Floats:
        """The cosine of the incidence times the reflectance of the label; 0 for a miss.

        It does not fall with the distance. With subrays, it is the sum over those of the return,
        divided by the number of all subrays.
        """
        found = self._returned
        if found is None:
            found = self._looks.intensity(self.hits, self._cosines)
        return np.where(self.hit, found, 0).astype(np.float32)

    @property
    def geom_id(self) -> NDArray[np.uint32]:
        """The mesh: the id that `Scene.add` returned."""
        return self.hits.geom_id

    @property
    def inst_id(self) -> NDArray[np.uint32]:
        """The instance of the mesh."""
        return self.hits.inst_id

    @property
    def prim_id(self) -> NDArray[np.uint32]:
        """The triangle within its mesh."""
        return self.hits.prim_id

    @cached_property
    def label(self) -> NDArray[np.int32]:
        """The label of the instance; -1 for a miss, and for an instance that has none."""
        return self._looks.label(self.hits)

    @property
    def time(self) -> Doubles:
        """Seconds: when each beam was sent."""
        return np.broadcast_to(self._start + self._each(self._placing.beams.times), self.shape)

    def waveform(self, edges: ArrayLike) -> Floats:
        """(..., n), the intensity that comes back from each of n bins of ranges.

        The bin i is from ``edges[i]`` to, excluding, ``edges[i + 1]``. Without noise, drop-out and
        the choice of returns, of all subrays.
        """
        bounds = _arrays.doubles(edges, "edges")
        if bounds.ndim != 1 or len(bounds) < 2 or not (np.diff(bounds) > 0).all():
            raise ValueError("edges: two or more numbers, each above the one before, are expected")
        beams = self._placing.poses + self._placing.beams.shape
        if self._all_subrays is not None:
            far, power = self._all_subrays
        else:
            lengths = np.broadcast_to(self._placing.beams.lengths, beams)
            clean = np.where(self.hit, self.hits.t, np.inf) * np.where(lengths > 0, lengths, 1)
            intensity = self._looks.intensity(self.hits, self._cosines)
            far, power = clean.reshape(-1, 1), intensity.reshape(-1, 1)
        bins = len(bounds) - 1
        place = np.searchsorted(bounds, far, side="right") - 1
        inside = (place >= 0) & (place < bins) & np.isfinite(far)
        rows = np.broadcast_to(np.arange(len(far))[:, None], far.shape)
        places = (rows * bins + place)[inside]
        found = np.bincount(places, power[inside], len(far) * bins)
        return found.reshape(*beams, bins).astype(np.float32)

    @property
    def beam(self) -> NDArray[np.uint32]:
        """The number of the beam in the sensor, counted in C order."""
        shape = self._placing.beams.shape
        numbers = np.arange(math.prod(shape), dtype=np.uint32).reshape(shape)
        wide = numbers.reshape(*shape, *(1,) * self._extra)
        return np.broadcast_to(wide, self.shape)

    @property
    def pose(self) -> NDArray[np.uint32]:
        """The number of the pose, counted in C order."""
        poses = self._placing.poses
        numbers = np.arange(math.prod(poses), dtype=np.uint32)
        wide = numbers.reshape(*poses, *(1,) * (len(self.shape) - len(poses)))
        return np.broadcast_to(wide, self.shape)

    def cloud(
        self, fields: Optional[Sequence[str]] = None, *, frame: str = "world"
    ) -> NDArray[np.void]:
        """(n,), a structured array of the n returns that came back.

        Parameters
        ----------
        fields : sequence of str, optional
            Attributes of the scan: "position" (x, y, z), "normal" (normal_x, normal_y, normal_z),
            "range", "incidence", "intensity", "time", "beam", "pose", "geom_id", "inst_id",
            "prim_id", "label". By default position, range, time, beam, inst_id and prim_id, and
            label if there are labels.
        frame : "world" or "sensor"
            That of positions and normals.
        """
        if frame not in ("world", "sensor"):
            raise ValueError(f'frame: {frame!r} is given; "world" or "sensor" is expected')
        if fields is None:
            fields = ["position", "range", "time", "beam", "inst_id", "prim_id"]
            fields += ["label"] * (self._looks.labels is not None)
        columns: dict[str, NDArray[Any]] = {}
        seen = self.hit
        for name in fields:
            if name in _POINT_FIELDS:
                values = getattr(self, name if frame == "world" else "local_" + name)[seen]
                columns.update(zip(_POINT_FIELDS[name], values.T))
            elif name in _FIELDS:
                columns[name] = getattr(self, name)[seen]
            else:
                known = ", ".join([*_POINT_FIELDS, *_FIELDS])
                raise ValueError(f"fields: {name!r} is given; names of {known} are expected")
        kinds = [(name, column.dtype.newbyteorder("<")) for name, column in columns.items()]
        cloud = np.empty(int(seen.sum()), kinds)
        for name, column in columns.items():
            cloud[name] = column
        return cloud

    def save(
        self,
        path: Union[str, "os.PathLike[str]"],
        fields: Optional[Sequence[str]] = None,
        *,
        frame: str = "world",
    ) -> None:
        """Write the array of `cloud` as a binary .ply or .pcd, whichever the name ends in."""
        _clouds.write(path, self.cloud(fields, frame=frame))

    def __repr__(self) -> str:
        name = type(self).__name__
        return (
            f"<raysheaf.sensors.{name} of shape {self.shape}: {int(self.hit.sum())} returns of "
            f"{self.hits.size}>"
        )




class DepthImage(Scan):
    """The `Scan` of a camera, of shape (height, width) after that of the poses."""

    @cached_property
    def depth(self) -> Floats:
        """Distances along the camera's axis; inf for a miss."""
        return np.array(self._t, np.float32)


class Heights(Scan):
    """The `Scan` of a `HeightScan`, of the shape of the grid after that of the poses."""

    @cached_property
    def height(self) -> Floats:
        """Heights of the ground above the sensor's origin, negative below it; NaN for a miss."""
        return self.local_position[..., 2]


def without(hits: Hits, lost: NDArray[np.bool_]) -> Hits:
    """The hits, of which some are misses."""
    if not lost.any():
        return hits
    array = hits.array.copy()
    array[lost] = np.array((np.inf, 0, 0, INVALID_ID, INVALID_ID, INVALID_ID), array.dtype)
    return Hits(array, hits._asked)
