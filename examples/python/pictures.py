"""Helpers of the examples: a camera's rays, light on a surface, colours for numbers."""

from __future__ import annotations

import argparse

import numpy as np


def arguments(description: str, output: str, size: int) -> argparse.Namespace:
    """The command line of an example: the output file and the image's size."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("-o", "--output", default=output, help="the picture (default: %(default)s)")
    parser.add_argument(
        "--size",
        type=int,
        default=size,
        help="of the work and of the picture (default: %(default)s)",
    )
    return parser.parse_args()


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def camera_rays(eye, target, width, height, fov_degrees=40.0):
    """One ray per pixel, rows from the top: origin (3,) and directions (height, width, 3)."""
    forward = unit(np.subtract(target, eye).astype(float))
    right = unit(np.cross(forward, [0, 0, 1]))
    up = np.cross(right, forward)
    reach = np.tan(np.radians(fov_degrees) / 2)
    y, x = np.mgrid[height - 1 : -1 : -1, 0:width] + 0.5
    x, y = (2 * x - width) / height * reach, (2 * y / height - 1) * reach
    return np.asarray(eye, float), forward + x[..., None] * right + y[..., None] * up


def face_normals(vertices, triangles):
    a, b, c = (np.asarray(vertices, float)[triangles[:, k]] for k in range(3))
    return unit(np.cross(b - a, c - a))


def grid(x, y, height):
    """A height field over the lines x and y: vertices and triangles, facing up."""
    gx, gy = np.meshgrid(x, y)
    vertices = np.stack([gx, gy, height(gx, gy)], axis=-1).reshape(-1, 3)
    n = len(x)
    corner = (np.arange(len(y) - 1)[:, None] * n + np.arange(n - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + n], axis=-1)
    upper = np.stack([corner + n, corner + 1, corner + n + 1], axis=-1)
    return vertices, np.concatenate([lower, upper])


def box(low, high):
    """A closed box: 8 vertices, 12 triangles, facing out."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    vertices = np.asarray(low) + corners * np.subtract(high, low)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


# Dark blue, teal, green, yellow: lightness increases evenly, so that the map also works in grey.
_STEPS = np.array(
    [
        [0.27, 0.0, 0.33],
        [0.23, 0.32, 0.55],
        [0.13, 0.57, 0.55],
        [0.37, 0.79, 0.38],
        [0.99, 0.91, 0.14],
    ]
)


def colours(values, low=None, high=None):
    """Numbers as colours, from dark to light."""
    values = np.asarray(values, float)
    low = np.nanmin(values) if low is None else low
    high = np.nanmax(values) if high is None else high
    at = np.clip((values - low) / max(high - low, 1e-30), 0, 1) * (len(_STEPS) - 1)
    return np.stack(
        [np.interp(at, np.arange(len(_STEPS)), _STEPS[:, k]) for k in range(3)], axis=-1
    )


def srgb(linear):
    """Converts linear light to sRGB."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
