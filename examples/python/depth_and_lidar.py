"""A depth camera and a lidar side by side: what each of them measures in the same room.

The left half of the image has the camera's depth, from near (dark) to far. The right half has the
points of the lidar, projected into the camera by its matrix and coloured by their depth, too: the
two agree wherever both sensors see the same surface.
"""

import numpy as np
from pictures import arguments, colours

import raysheaf
from raysheaf.sensors import DepthCamera, SpinningLidar

NEAR, FAR = 1.0, 9.0  # metres, of the colours


def poses(camera):
    """The poses of the camera, in OpenCV's frame, and of a lidar half a metre above it."""
    frame = np.eye(4)
    frame[:3] = camera.to_world
    frame[:3, :3] /= np.linalg.norm(frame[:3, :3], axis=0)
    optical = frame @ np.diag([1, -1, -1, 1])  # the file's camera looks along -z, y is up
    up = np.array([0.0, 1.0, 0.0])
    ahead = optical[:3, 2] - (optical[:3, 2] @ up) * up
    ahead /= np.linalg.norm(ahead)
    lidar = np.eye(4)
    lidar[:3] = np.stack([ahead, np.cross(up, ahead), up, optical[:3, 3] + 0.5 * up], axis=1)
    return optical, lidar


def main(output="depth_and_lidar.png", size=360):
    office = raysheaf.load("builtin:office")
    wide, high = size, size * 3 // 4
    matrix = np.array([[0.8 * wide, 0, wide / 2], [0, 0.8 * wide, high / 2], [0, 0, 1]])
    camera = DepthCamera(matrix, (wide, high), far=50.0)
    optical, above = poses(office.cameras[0])
    image = camera.scan(office, optical)
    scan = SpinningLidar.with_rings(128, elevation=np.linspace(-35, 20, 128)).scan(office, above)

    halves = np.zeros((2, high, wide, 3))
    halves[0] = np.where(image.hit[..., None], colours(image.depth, NEAR, FAR), 0)
    seen = (scan.position[scan.hit] - optical[:3, 3]) @ optical[:3, :3]
    seen = seen[seen[:, 2] > 0.1]
    pixel = np.rint(seen / seen[:, 2:] @ matrix.T)[:, :2].astype(int)
    inside = ((pixel >= 0) & (pixel < [wide, high])).all(axis=1)
    pixel, depth = pixel[inside], seen[inside, 2]
    order = np.argsort(-depth)  # near points cover far ones
    halves[1, pixel[order, 1], pixel[order, 0]] = colours(depth[order], NEAR, FAR)
    raysheaf.write_png(output, np.concatenate(list(halves), axis=1))
    return image, scan


if __name__ == "__main__":
    given = arguments(__doc__, "depth_and_lidar.png", 360)
    main(given.output, given.size)
