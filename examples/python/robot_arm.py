"""A robot arm seen by a depth camera and by a lidar, which turns while the arm moves.

The six links are instances; one call of `set_transforms` moves all of them, from where they are at
the beginning of a sweep to where they are at its end. The image shows the camera's view at the
beginning, each link in its own colour, and on it the points of the lidar: each beam has a time, so
that points of the arm are where it is then.
"""

import numpy as np
from pictures import arguments, box, colours, grid

import raysheaf
from raysheaf.sensors import DepthCamera, SpinningLidar

SWEEP = 0.1  # seconds
MOMENTS = 17  # transforms of a link during the sweep, which turns by two degrees between them
LENGTHS = [0.35, 0.55, 0.45, 0.2, 0.15, 0.1]  # of the links, in metres
AXES = "zyyzyz"  # about which the joints turn


def turned(axis, angle):
    """(4, 4), a rotation about an axis."""
    i, j = {"z": (0, 1), "y": (2, 0)}[axis]
    matrix = np.eye(4)
    matrix[[i, j], [i, j]] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


class Arm:
    """Links in a row, each along the z axis of its own frame."""

    def __init__(self, scene):
        self.scene = scene
        self.links = []
        for k, length in enumerate(LENGTHS):
            thick = 0.08 - 0.01 * k
            mesh = scene.add(*box([-thick, -thick, 0], [thick, thick, length]), place=False)
            self.links.append(scene.instance(mesh))

    def places(self, angles):
        """(links, 4, 4), where the links are: forward kinematics."""
        frame, found = np.eye(4), []
        for axis, angle, length in zip(AXES, angles, LENGTHS):
            frame = frame @ turned(axis, angle)
            found.append(frame)
            frame = frame.copy()
            frame[:3, 3] += length * frame[:3, 2]
        return np.stack(found)

    def move(self, begin, end):
        """From joint angles at time 0 to others at time 1, in one call."""
        parts = np.linspace(0, 1, MOMENTS)[:, None]
        moments = [self.places(angles) for angles in (1 - parts) * begin + parts * end]
        self.scene.set_transforms(self.links, np.stack(moments, axis=1))


def looking(eye, target):
    """The pose of a camera, in OpenCV's frame."""
    ahead = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3] = np.stack([right, np.cross(ahead, right), ahead, eye], axis=1)
    return pose


def main(output="robot_arm.png", size=480):
    scene = raysheaf.Scene()
    line = np.linspace(-3, 3, 7)
    floor = scene.add(*grid(line, line, lambda x, y: 0 * x))
    arm = Arm(scene)
    begin = np.array([-0.2, 0.3, 0.9, 0.0, 0.6, 0.0])
    arm.move(
        begin, begin + [0.6, 0.0, 0.1, 0.5, -0.2, 0.0]
    )  # the base turns by six radians a second
    labels = {scene.instances(floor)[0]: 0, **{link: k + 1 for k, link in enumerate(arm.links)}}

    wide, high = size, size * 3 // 4
    matrix = np.array([[0.9 * wide, 0, wide / 2], [0, 0.9 * wide, high / 2], [0, 0, 1]])
    eye = looking([1.0, -1.6, 1.0], [0.25, 0, 0.55])
    image = DepthCamera(matrix, (wide, high)).scan(scene, eye, labels=labels)
    above = np.eye(4)
    above[:3, 3] = -0.2, -1.2, 1.0
    lidar = SpinningLidar(elevation=np.linspace(-60, 10, 64), steps=720, rate=1 / SWEEP)
    scan = lidar.scan(scene, above, moving=(0, SWEEP), labels=labels)

    light = 0.3 + 0.7 * np.abs(image.normal @ [0.48, -0.6, 0.64])
    hues = np.concatenate([[[0.35] * 3], colours(np.arange(1.0, 7.0), -1)])
    picture = np.where(image.hit[..., None], hues[image.label] * light[..., None], 0.05)
    seen = (scan.position[scan.hit] - eye[:3, 3]) @ eye[:3, :3]
    pixel = np.rint(seen / seen[:, 2:] @ matrix.T)[:, :2].astype(int)
    inside = ((pixel >= 0) & (pixel < [wide, high])).all(axis=1) & (seen[:, 2] > 0)
    pixel, label = pixel[inside], scan.label[scan.hit][inside]
    picture[pixel[:, 1], pixel[:, 0]] = np.where(label[:, None] > 0, 1.0, 0.6)
    raysheaf.write_png(output, picture)
    return arm, scan


if __name__ == "__main__":
    given = arguments(__doc__, "robot_arm.png", 480)
    main(given.output, given.size)
