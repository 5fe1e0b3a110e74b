"""A lidar rotates while objects around it move, and sees each of them at a different moment.

The cars have transforms for the whole rotation, and each beam has a time, so that one query answers
all of them. The image shows the sensor's points from above; an object that moves with the rotation
appears longer than it is, and one that moves against it shorter.
"""

import numpy as np
from pictures import arguments, box, colours, grid

import raysheaf

HEIGHT, RANGE = 1.8, 40.0  # metres
TURN = 0.1  # seconds
STEPS = 33  # transforms of a car: it turns by less than a degree from one to the next


def moved(x, y, angle):
    c, s = np.cos(angle), np.sin(angle)
    return [[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0]]


class Street:
    """Two walls, and cars that drive in circles, during one rotation of the sensor."""

    def __init__(self, cars=9):
        self.scene = raysheaf.Scene()
        line = np.linspace(-RANGE, RANGE, 9)
        self.scene.add(*grid(line, line, lambda x, y: 0 * x))
        for y in (-18, 18):
            self.scene.add(*box([-RANGE, y, 0], [RANGE, y + 0.3, 3]))
        car = self.scene.add(*box([-2.2, -0.9, 0.2], [2.2, 0.9, 1.6]), place=False)
        self.cars = [self.scene.instance(car) for _ in range(cars)]
        for k, one in enumerate(self.cars):
            radius, speed = 6 + k % 3 * 4, 30.0 * (1 if k % 2 else -1)
            angles = k * 2 * np.pi / cars + speed / radius * np.linspace(0, TURN, STEPS)
            self.scene.set_transform(
                one,
                [moved(radius * np.cos(a), radius * np.sin(a), a + np.pi / 2) for a in angles],
            )


def sweep(street, columns, beams=64):
    """One rotation: points (columns, beams, 3), nan for those out of range."""
    down = np.radians(np.linspace(-25, 8, beams))
    times = np.arange(columns)[:, None] / columns
    turn = 2 * np.pi * times
    directions = np.stack(
        [np.cos(turn) * np.cos(down), np.sin(turn) * np.cos(down), np.sin(down) + 0 * turn], axis=-1
    )
    hits = street.scene.closest_hit([0, 0, HEIGHT], directions, t_max=RANGE, times=times)
    return hits.position


def main(output="lidar_sweep.png", size=720):
    points = sweep(Street(), columns=size)
    seen = points[np.isfinite(points[..., 0])]
    pixel = np.clip(((seen[:, :2] / 24 + 1) / 2 * size).astype(int), 1, size - 1)
    order = np.argsort(seen[:, 2])  # higher points cover lower ones
    image = np.zeros((size, size, 3))
    shown = colours(seen[order, 2], -0.5, 2.5)
    for right, down in ((0, 0), (0, 1), (1, 0), (1, 1)):  # a dot is four pixels
        image[size - 1 - pixel[order, 1] + down, pixel[order, 0] - right] = shown
    raysheaf.write_png(output, image)
    return points


if __name__ == "__main__":
    given = arguments(__doc__, "lidar_sweep.png", 720)
    main(given.output, given.size)
