"""Poses of sensors, and trajectories between them."""

from __future__ import annotations

from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays

Doubles = NDArray[np.float64]

_MOST_SHEAR = 1e-4


def rigid(value: Any, name: str) -> Doubles:
    """(..., 3, 4), rotations and translations, from matrices with or without their last row."""
    expected = "one of shape (..., 4, 4) or (..., 3, 4)"
    array = _arrays.with_last_axis(value, name, 4, expected)
    if array.ndim < 2 or array.shape[-2] not in (3, 4):
        raise ValueError(
            f"{name}: an array of shape {array.shape} is given; {expected} is expected"
        )
    matrices = np.array(array[..., :3, :], np.float64)
    x, y, z = np.moveaxis(matrices[..., :3], -1, 0)
    with np.errstate(all="ignore"):
        bent = np.abs(matrices[..., :3] @ np.swapaxes(matrices[..., :3], -1, -2) - np.eye(3))
        right = (bent < _MOST_SHEAR).all((-1, -2)) & (np.sum(np.cross(x, y) * z, -1) > 0)
    right &= np.isfinite(matrices[..., 3]).all(-1)
    right &= (array[..., 3:, :] == (0, 0, 0, 1)).all((-1, -2))
    if not right.all():
        place = [int(i) for i in np.argwhere(~right)[0]]
        raise ValueError(
            f"{name}{place or ''}: {array[tuple(place)].tolist()} is given; a rotation and a "
            "translation are expected"
        )
    return matrices


def _axis_and_angle(turn: Doubles) -> tuple[Doubles, Doubles]:
    """The unit axes of rotations (..., 3, 3), or zero for none, and their angles from 0 to pi."""
    back = np.swapaxes(turn, -1, -2)
    sines = (turn - back)[..., [2, 0, 1], [1, 2, 0]] / 2  # of the angle, times the axis
    cosine = (np.trace(turn, axis1=-2, axis2=-1) - 1) / 2
    outer = (turn + back) / 2 - cosine[..., None, None] * np.eye(3)  # axis times axis, scaled
    widest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    column = np.take_along_axis(outer, widest[..., None, None], axis=-1)[..., 0]
    column = np.where(np.sum(column * sines, -1, keepdims=True) < 0, -column, column)
    axis = np.where(cosine[..., None] < 0, column, sines)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / np.where(length > 0, length, 1)
    return axis, np.arctan2(np.linalg.norm(sines, axis=-1), cosine)


class Trajectory:
    """Where a sensor is at any time: its poses at some times, and between them.

    Between two poses the origin moves along a straight line at constant speed, while the sensor
    turns about one axis at a constant rate, the shorter way round.

    Parameters
    ----------
    times : (n,) array
        Seconds, ascending; at least two.
    poses : (..., n, 4, 4) or (..., n, 3, 4)
        Rotations and translations from the sensor's frame to the world; axes before that of the
        times are those of several sensors, mostly one in each world.

    Raises ValueError for poses that are not rigid, and for times that do not ascend.

    >>> import numpy as np
    >>> from raysheaf.sensors import Trajectory
    >>> poses = np.array([np.eye(4), [[0, -1, 0, 2], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]])
    >>> drive = Trajectory([10, 11], poses)        # 2 m forward, and a quarter turn to the left
    >>> drive.at(10.5).round(3)
    array([[ 0.707, -0.707,  0.   ,  1.   ],
           [ 0.707,  0.707,  0.   ,  0.   ],
           [ 0.   ,  0.   ,  1.   ,  0.   ]])
    """

    times: Doubles
    """(n,), in seconds."""
    poses: Doubles
    """(..., n, 3, 4)."""

    def __init__(self, times: ArrayLike, poses: ArrayLike) -> None:
        self.times = np.array(_arrays.floats(times, "times", "an array"), np.float64)
        self.poses = rigid(poses, "poses")
        if self.times.ndim != 1 or self.poses.shape[-3:-2] != self.times.shape:
            raise ValueError(
                f"poses: an array of shape {np.shape(poses)} is given for times of shape "
                f"{self.times.shape}; (..., n, 4, 4) is expected for (n,)"
            )
        if len(self.times) < 2 or not (np.diff(self.times) > 0).all():
            raise ValueError("times: two or more, each later than the one before, are expected")
        turns = self.poses[..., :3]
        first = turns[..., :-1, :, :]
        axes, self._angles = _axis_and_angle(np.swapaxes(first, -1, -2) @ turns[..., 1:, :, :])
        x, y, z = np.moveaxis(axes, -1, 0)
        zero = np.zeros_like(x)
        cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(*x.shape, 3, 3)
        self._parts = first, first @ cross, first @ cross @ cross  # of Rodrigues' formula

    def at(self, times: ArrayLike) -> Doubles:
        """The poses at times of shape (t...): (..., t..., 3, 4).

        Raises ValueError for a time before the first or after the last one of the trajectory.
        """
        at = np.asarray(_arrays.floats(times, "times", "an array"), np.float64)
        begin, end = self.times[[0, -1]].tolist()
        wrong = ~((at >= begin) & (at <= end))
        if wrong.any():
            raise ValueError(
                f"times: {at[wrong][0].item()} s is given; the trajectory lasts from {begin} to {end} s"
            )
        i = np.clip(np.searchsorted(self.times, at, side="right") - 1, 0, len(self.times) - 2)
        part = (at - self.times[i]) / (self.times[i + 1] - self.times[i])
        angle = (self._angles[..., i] * part)[..., None, None]
        still, sine, cosine = (one[..., i, :, :] for one in self._parts)
        origins = self.poses[..., 3]
        step = origins[..., i + 1, :] - origins[..., i, :]
        matrices = np.empty((*angle.shape[:-2], 3, 4))
        matrices[..., :3] = still + np.sin(angle) * sine + (1 - np.cos(angle)) * cosine
        matrices[..., 3] = origins[..., i, :] + part[..., None] * step
        return matrices

    def __repr__(self) -> str:
        begin, end = self.times[[0, -1]].tolist()
        return f"<raysheaf.sensors.Trajectory of {len(self.times)} poses from {begin:g} to {end:g} s>"


Pose = Union[ArrayLike, Trajectory]
