"""pictures.py [FOLDER]: the drawings of docs/concepts.md, docs/images/concepts-*.svg.

They show the rays, bundles and counts that plane.py computes. The program needs only the standard
library and rounds numbers to a tenth of a pixel, so that it writes the same bytes everywhere.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from plane import (
    FLOOR,
    LAMPS,
    MESHES,
    Node,
    Point,
    Ray,
    bound,
    circle_of,
    first_hit,
    key,
    levels,
    meets,
    shadow_rays,
)

FOLDER = Path(__file__).resolve().parents[1] / "images"
PALETTE = ["#2a78d6", "#e0632f", "#2f9e63", "#b0409a", "#c08a00", "#1b98a8", "#7a5ad0", "#d0405a"]
INK, SOFT, PAPER = "#30343a", "#9aa1aa", "#ffffff"


def number(value: float) -> str:
    text = f"{value:.1f}"
    return "0.0" if text == "-0.0" else text


class Picture:
    def __init__(self, width: int, height: int, title: str) -> None:
        self.head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" role="img" font-family="sans-serif" font-size="13">\n<title>{title}</title>\n'
            f'<rect width="{width}" height="{height}" fill="{PAPER}"/>\n'
        )
        self.lines: list[str] = []

    def add(self, tag: str, text: str = "", **attributes: object) -> None:
        written = "".join(
            f' {name.replace("_", "-")}="{number(v) if isinstance(v, float) else v}"'
            for name, v in attributes.items()
        )
        self.lines.append(f"<{tag}{written}>{text}</{tag}>" if text else f"<{tag}{written}/>")

    def text(
        self, x: float, y: float, words: str, fill: str = INK, anchor: str = "start", **more: object
    ) -> None:
        self.add("text", words, x=float(x), y=float(y), fill=fill, text_anchor=anchor, **more)

    def line(
        self, a: Point, b: Point, stroke: str, width: float = 1.0, opacity: float = 1.0
    ) -> None:
        self.add(
            "line",
            x1=float(a[0]),
            y1=float(a[1]),
            x2=float(b[0]),
            y2=float(b[1]),
            stroke=stroke,
            stroke_width=width,
            stroke_opacity=opacity,
        )

    def polygon(self, points: list[Point], **attributes: object) -> None:
        at = " ".join(f"{number(x)},{number(y)}" for x, y in points)
        self.add("polygon", points=at, **attributes)

    def save(self, path: Path) -> None:
        path.write_text(self.head + "\n".join(self.lines) + "\n</svg>\n", encoding="utf-8")


def moved(points: list[Point], by: Point) -> list[Point]:
    return [(x + by[0], y + by[1]) for x, y in points]


def draw_meshes(
    picture: Picture, by: Point = (0, 0), marked: dict[int, set[int]] | None = None
) -> None:
    """Draws all meshes; with `marked`, its segments bold and all others faint."""
    for m, mesh in enumerate(MESHES):
        picture.polygon(moved(mesh.corners, by), fill="#eceff3", stroke="none")
        for s, segment in enumerate(mesh.segments()):
            bold = marked is None or s in marked.get(m, set())
            a, b = moved(list(segment), by)
            picture.line(
                a, b, INK if bold else "#c3c9d1", 2.5 if bold and marked is not None else 1.5
            )


def draw_ray(
    picture: Picture, ray: Ray, colour: str, by: Point = (0, 0), opacity: float = 0.8
) -> None:
    t = first_hit(ray)
    a = (ray.origin[0] + by[0], ray.origin[1] + by[1])
    b = (a[0] + t * ray.direction[0], a[1] + t * ray.direction[1])
    picture.line(a, b, colour, 1.1, opacity)
    picture.add("circle", cx=b[0], cy=b[1], r=2.2, fill=colour)


def draw_lamps(picture: Picture, by: Point) -> None:
    for x, y in LAMPS:
        picture.add("circle", cx=x + by[0], cy=y + by[1], r=6, fill="#f5b800", stroke=INK)
    picture.line((by[0], FLOOR + by[1]), (by[0] + 690, FLOOR + by[1]), INK, 1.5)


def outline(node: Node, length: float) -> list[Point]:
    """Draws the hull of the circle of origins and of the cone that leaves it, up to `length`."""
    left, right = node.axis - node.half, node.axis + node.half
    (x, y), r = node.center, max(node.radius, 2.0)
    back = [
        (x + r * math.cos(a), y + r * math.sin(a))
        for a in (
            right + math.pi / 2 + (left + 2 * math.pi - right - math.pi) * i / 12 for i in range(13)
        )
    ]
    start_left, start_right = back[-1], back[0]
    far_left = (start_left[0] + length * math.cos(left), start_left[1] + length * math.sin(left))
    far_right = (
        start_right[0] + length * math.cos(right),
        start_right[1] + length * math.sin(right),
    )
    return [*back, far_left, far_right]


def draw_node(
    picture: Picture, node: Node, colour: str, by: Point, length: float, clip: str
) -> None:
    picture.polygon(
        moved(outline(node, length), by),
        fill=colour,
        fill_opacity=0.13,
        stroke=colour,
        stroke_opacity=0.7,
        clip_path=f"url(#{clip})",
    )
    picture.add(
        "circle",
        cx=node.center[0] + by[0],
        cy=node.center[1] + by[1],
        r=max(node.radius, 2.0),
        fill="none",
        stroke=colour,
        stroke_width=1.5,
        clip_path=f"url(#{clip})",
    )


def frame(picture: Picture, name: str, by: Point) -> None:
    """Begins a panel of 690 by 300 that clips its contents."""
    clip = (
        f'<clipPath id="{name}"><rect x="{by[0]}" y="{by[1]}" width="690" height="300"/></clipPath>'
    )
    picture.lines.append(clip)
    picture.add(
        "rect", x=float(by[0]), y=float(by[1]), width=690, height=300, fill="none", stroke="#d5dae0"
    )


def draw_order(folder: Path) -> None:
    """Draws bundles of the same rays in the order of the pixels, and after sorting."""
    rays = shadow_rays()
    picture = Picture(730, 700, "Rays in bundles, as they come and sorted")
    orders = {
        "In the order of the pixels: every bundle of four holds rays of both lamps": list(
            range(len(rays))
        ),
        "Sorted by lamp and direction: the same rays, narrow bundles": sorted(
            range(len(rays)), key=lambda i: (key(rays[i]), i)
        ),
    }
    for row, (words, order) in enumerate(orders.items()):
        by = (20.0, 35.0 + 345.0 * row)
        picture.text(20, by[1] - 12, words, font_weight="bold")
        frame(picture, f"order{row}", by)
        draw_meshes(picture, by)
        leaves = levels(rays, order)[0]
        shown = [leaves[i] for i in (2, 13)] if row == 0 else leaves[1::3]
        for n, node in enumerate(shown):
            draw_node(picture, node, PALETTE[n % len(PALETTE)], by, 900, f"order{row}")
            for i in node.rays:
                draw_ray(picture, rays[i], PALETTE[n % len(PALETTE)], by)
        draw_lamps(picture, by)
    picture.save(folder / "concepts-order.svg")


def draw_tree(folder: Path) -> None:
    """Draws the implicit tree over sorted rays, which only their positions determine."""
    count = 32
    picture = Picture(730, 205, "The tree over the rays")
    step = 20.0
    for row, (size, words) in enumerate([(16, "level 2"), (4, "level 1"), (1, "rays")]):
        y = 30.0 + 55 * row
        picture.text(20, y + 17, words)
        for i in range(0, count, size):
            picture.add(
                "rect",
                x=80 + i * step + 2,
                y=y,
                width=size * step - 4,
                height=26.0,
                rx=5,
                fill=PALETTE[(i // 4) % len(PALETTE)] if size < 16 else SOFT,
                fill_opacity=0.75 if size < 16 else 0.45,
            )
            if size > 1:
                picture.text(
                    80 + (i + size / 2) * step,
                    y + 17,
                    f"rays {i} to {i + size - 1}",
                    "#ffffff" if size == 4 else INK,
                    "middle",
                    font_size=10 if size == 4 else 13,
                )
                for c in range(0, size, size // 4):
                    child = size // 4
                    picture.line(
                        (80 + (i + size / 2) * step, y + 26),
                        (80 + (i + c + child / 2) * step, y + 55),
                        SOFT,
                    )
    picture.text(
        80,
        194,
        "Node i has the nodes 4 i to 4 i + 3 below it: no pointers, nothing to store but bounds.",
        SOFT,
    )
    picture.save(folder / "concepts-tree.svg")


def draw_culling(folder: Path) -> None:
    """Draws the candidates that remain at each level on the path down to one leaf."""
    rays = shadow_rays()
    order = sorted(range(len(rays)), key=lambda i: (key(rays[i]), i))
    tree = levels(rays, order)
    leaf = tree[0][6]
    path = [next(n for n in level if set(leaf.rays) <= set(n.rays)) for level in tree[1::-1]]
    total = sum(len(m.corners) for m in MESHES)
    picture = Picture(730, 1045, "What is left to test, level by level")

    meshes = set(range(len(MESHES)))
    left = {m: set(range(len(MESHES[m].corners))) for m in meshes}
    for row, node in enumerate(path):
        tests = 0
        if row == 0:
            tests += len(MESHES)
            left = {m: left[m] for m in meshes if meets(node, MESHES[m].center, MESHES[m].radius)}
        kept: dict[int, set[int]] = {}
        for m, segments in left.items():
            tests += len(segments)
            kept[m] = {s for s in segments if meets(node, *circle_of(MESHES[m].segments()[s]))}
        left = {m: s for m, s in kept.items() if s}
        by = (20.0, 35.0 + 345.0 * row)
        alive = sum(len(s) for s in left.values())
        picture.text(
            20,
            by[1] - 12,
            f"Level {len(path) - row}, {len(node.rays)} rays in one bound: {tests} tests, "
            f"{alive} of {total} segments stay",
            font_weight="bold",
        )
        frame(picture, f"cull{row}", by)
        draw_meshes(picture, by, left)
        if row == 0:
            for m, mesh in enumerate(MESHES):
                picture.add(
                    "circle",
                    cx=mesh.center[0] + by[0],
                    cy=mesh.center[1] + by[1],
                    r=mesh.radius,
                    fill="none",
                    stroke=INK if m in left else SOFT,
                    stroke_dasharray="4 4",
                )
        draw_node(picture, node, PALETTE[0], by, 800, f"cull{row}")
        draw_lamps(picture, by)
    by = (20.0, 35.0 + 345.0 * len(path))
    alive = sum(len(s) for s in left.values())
    picture.text(
        20,
        by[1] - 12,
        f"The rays themselves: {len(leaf.rays)} x {alive} final tests instead of "
        f"{len(leaf.rays)} x {total}",
        font_weight="bold",
    )
    frame(picture, "final", by)
    draw_meshes(picture, by, left)
    for i in leaf.rays:
        draw_ray(picture, rays[i], PALETTE[0], by, 1.0)
    draw_lamps(picture, by)
    picture.save(folder / "concepts-culling.svg")


def draw_bound(folder: Path) -> None:
    """Draws one bundle with its circle and cone, and how circles are tested against it."""
    rays = [
        Ray((80 + 14 * math.sin(9 * i), 95 + 13 * i), (math.cos(a), math.sin(a)), 420.0)
        for i, a in enumerate((-0.12, 0.02, 0.1, 0.24))
    ]
    node = Node([0, 1, 2, 3], *bound(rays, [0, 1, 2, 3]))
    picture = Picture(730, 330, "A bundle of rays in a circle and a cone")
    by = (20.0, 15.0)
    frame(picture, "bound", by)
    draw_node(picture, node, PALETTE[0], by, 900, "bound")
    for ray in rays:
        a = (ray.origin[0] + by[0], ray.origin[1] + by[1])
        picture.line(
            a, (a[0] + 330 * ray.direction[0], a[1] + 330 * ray.direction[1]), PALETTE[0], 1.3
        )
        picture.add("circle", cx=a[0], cy=a[1], r=2.5, fill=PALETTE[0])
    for center, radius in (((420.0, 60.0), 26.0), ((330.0, 262.0), 22.0), ((540.0, 190.0), 30.0)):
        kept = meets(node, center, radius)
        colour = PALETTE[1] if kept else SOFT
        picture.add(
            "circle",
            cx=center[0] + by[0],
            cy=center[1] + by[1],
            r=radius,
            fill=colour,
            fill_opacity=0.2,
            stroke=colour,
            stroke_width=1.5,
        )
        picture.text(
            center[0] + by[0] + radius + 8,
            center[1] + by[1] + 4,
            "stays" if kept else "missed by all four: dropped",
            colour if kept else INK,
        )
    picture.text(by[0] + 30, by[1] + 170, "origins: a sphere", PALETTE[0])
    picture.text(by[0] + 445, by[1] + 130, "directions: a cone", PALETTE[0])
    picture.save(folder / "concepts-bound.svg")


def draw_all(folder: Path) -> None:
    for draw in (draw_bound, draw_order, draw_tree, draw_culling):
        draw(folder)


if __name__ == "__main__":
    draw_all(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
