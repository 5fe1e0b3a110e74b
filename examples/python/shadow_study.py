"""A shadow study: how many hours of sun each spot between buildings has on a day.

One ray per quarter of an hour from each spot to the sun.
"""

import numpy as np
from pictures import arguments, box, colours, grid

import raysheaf
from raysheaf import radiation


def suns(latitude, day, hours):
    """Unit vectors to the sun (east, north, up) at solar hours: Cooper's declination (1969)."""
    declination = np.radians(23.45) * np.sin(2 * np.pi * (284 + day) / 365)
    angle, north = np.radians(15 * (np.asarray(hours) - 12)), np.radians(latitude)
    east = -np.cos(declination) * np.sin(angle)
    up = np.sin(north) * np.sin(declination) + np.cos(north) * np.cos(declination) * np.cos(angle)
    along = np.cos(north) * np.sin(declination) - np.sin(north) * np.cos(declination) * np.cos(
        angle
    )
    return np.stack([east, along, up], axis=-1)


def town(seed=3):
    """Blocks of 20 to 90 metres on a square of 400, with streets between them."""
    rng = np.random.default_rng(seed)
    for x in range(-160, 200, 80):
        for y in range(-160, 200, 80):
            if rng.random() < 0.75:
                half = rng.uniform(14, 28, 2)
                yield box(
                    [x - half[0], y - half[1], 0], [x + half[0], y + half[1], rng.uniform(20, 90)]
                )


def hours_of_sun(buildings, spots, latitude=48.0, day=80, step=0.25):
    """Hours from sunrise to sunset at which the sun is visible, for each of (n, 3) spots."""
    scene = raysheaf.Scene()
    for building in buildings:
        scene.add(*building)
    to_sun = suns(latitude, day, np.arange(step / 2, 24, step))
    to_sun = to_sun[to_sun[:, 2] > 0.01]
    return radiation.sun_hours(scene, spots, [0, 0, 1], to_sun, step)


def main(output="shadow_study.png", size=300):
    buildings = list(town())
    line = np.linspace(-200, 200, size)
    spots, _ = grid(line, line, lambda x, y: 0.1 + 0 * x)
    hours = hours_of_sun(buildings, spots).reshape(size, size)
    image = colours(hours, 0)
    for vertices, _ in buildings:
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        inside = (line > low[0]) & (line < high[0]), (line > low[1]) & (line < high[1])
        image[np.ix_(inside[1], inside[0])] = 0.35 + 0.5 * high[2] / 90
    raysheaf.write_png(output, image[::-1])
    return hours


if __name__ == "__main__":
    given = arguments(__doc__, "shadow_study.png", 300)
    main(given.output, given.size)
