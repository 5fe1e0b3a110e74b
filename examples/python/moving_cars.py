"""A sweep of a lidar over cars that drive past: without times on the left, with times on the right.

Both halves show the points from above, coloured by the time of their beam, from the first (dark)
to the last. The grey outlines are the cars when the sweep begins. Without times every beam meets
the cars there. With times each beam meets them where they are when it is sent: cars are shifted by
how far they have come, and longer or shorter, because their ends are seen at different times.
"""

import numpy as np
from pictures import arguments, box, colours

import raysheaf
from raysheaf.sensors import SpinningLidar

SWEEP = 0.1  # seconds
WIDE, LONG = 0.9, 2.2  # half of a car, in metres
VIEW = 12.0  # metres to each side
# Where cars are when the sweep begins, and their velocities, along x.
CARS = [((-7, 4), 30), ((4, 4), 30), ((-3, -4), -30), ((8, -4), -30), ((-8, 8), 30), ((5, -8), -30)]


def street():
    """The scene; from time 0 to time 1 each car drives for as long as the sweep takes."""
    scene = raysheaf.Scene()
    car = scene.add(*box([-LONG, -WIDE, 0.2], [LONG, WIDE, 1.5]), place=False)
    for (x, y), speed in CARS:
        both = np.stack([np.eye(3, 4)] * 2)
        both[:, :2, 3] = [x, y], [x + speed * SWEEP, y]
        scene.set_transform(scene.instance(car), both)
    return scene


def sweeps(scene, steps):
    """The same sweep twice: everything as it is at time 0, and each beam at its own time."""
    lidar = SpinningLidar(elevation=np.linspace(-50, 0, 300), steps=steps, rate=1 / SWEEP)
    pose = np.eye(4)
    pose[2, 3] = 2.5
    return lidar.scan(scene, pose), lidar.scan(scene, pose, moving=(0, SWEEP))


def main(output="moving_cars.png", size=360):
    both = sweeps(street(), steps=4 * size)
    halves = np.zeros((2, size, size, 3))
    edge = np.linspace(-1, 1, 2 * size)
    lines = np.concatenate([[edge, 1 + 0 * edge], [1 + 0 * edge, edge]], axis=1).T * [LONG, WIDE]
    for image, scan in zip(halves, both):

        def draw(points, colour):
            pixel = ((points / VIEW + 1) / 2 * size).astype(int)
            inside = ((pixel >= 0) & (pixel < size)).all(axis=1)
            x, y = pixel[inside].T
            image[size - 1 - y, x] = colour[inside] if np.ndim(colour) == 2 else colour

        draw(scan.position[scan.hit][:, :2], colours(scan.time[scan.hit], 0, SWEEP))
        for (x, y), _ in CARS:
            for sign in (-1, 1):
                draw(sign * lines + [x, y], 0.5)
        draw(np.stack(np.meshgrid(*[np.linspace(-0.1, 0.1, 7)] * 2), axis=-1).reshape(-1, 2), 1.0)
    raysheaf.write_png(output, np.concatenate(list(halves), axis=1))
    return both


if __name__ == "__main__":
    given = arguments(__doc__, "moving_cars.png", 360)
    main(given.output, given.size)
