"""The paper, reproduced: the page of `bench paper`, with the published counts next to the measured ones."""

from .paper_counts import (METHODS, deviation, has_published, is_far, level_ratio, nearest, of_method, over,
                           published_level, shown_percent, shown_ratio, shown_rays, shown_scene, total_ratio)
from .paper_findings import INCONSISTENCIES, KEYS_AND_BOUNDS, explanations, in_short
from .text import command_block, enumerated, grouped, table

OPTIONS = (("--no-times", False, "omit the table of times"),)

SWITCHES = ("*signed* without additions means the defaults: equation 9 with a signed distance along the axis, the key "
            "as coded with the azimuth atan2(x, x), rows from below, minimum spheres of triangles, mesh spheres that "
            "rotate with their meshes, and the last node counted as if it were full.")
STAGES = ("raygen", "order", "hierarchy", "traverse", "intersect")


def sheet(title, note, heading, rows):
    """A section with a table; whole numbers in groups of three digits, columns of numbers to the right."""
    rows = [["-" if cell is None else str(cell) for cell in row] for row in rows]
    right = [i for i in range(len(heading)) if all(set(row[i]) <= set("0123456789.~- ") for row in rows)]
    return f"## {title}\n\n{note}\n\n" + table(heading, [list(map(grouped, row)) for row in rows], right) + "\n"


def totals_sheet(figures):
    rows = [[shown_scene(figures, t["scene"]), t["method"], t["total"], t["brute_force"], shown_percent(t["relative"]),
             t["paper_total"], None if t["paper_relative"] is None else shown_percent(t["paper_relative"]),
             shown_ratio(over(t["total"], t["paper_total"]))] for t in figures["totals"]]
    return sheet("Totals", "Tests of all kinds of rays, and their percentage of the tests of brute force.",
                 ["scene", "method", "tests", "brute force", "%", "paper: tests", "paper: %", "ours / paper"], rows)


def level_rows(m):
    def published(level, what, factor=1):
        count = level[what]
        return None if count is None else ("~" if level[what + "_rounded"] else "") + str(count * factor)
    for level in m["levels"]:
        paper = published_level(m, level["level"])
        yield [level["level"], level["tests"], level["hits"], level["misses"], published(paper, "tests"),
               shown_ratio(level_ratio(m, level, "tests")), published(paper, "hits"),
               shown_ratio(level_ratio(m, level, "hits"))]
    by_bounds = m["bound_tests"] + m["ray_bound_tests"] > 0
    if by_bounds:
        yield ["bundles", m["bound_tests"], *[None] * 6]
        yield ["rays", m["ray_bound_tests"], *[None] * 6]
    if by_bounds or m["levels"]:
        leaves = published_level(m, 1)  # final tests are eight times the hits of the leaves
        yield ["final", m["final_tests"], None, None, published(leaves, "hits", 8),
               shown_ratio(over(m["final_tests"], (leaves["hits"] or 0) * 8)), None, None]
    yield ["total", m["total"], None, None, m["paper"] and m["paper"]["total"], shown_ratio(total_ratio(m)), None, None]


def who(figures, m):
    return [shown_scene(figures, m["scene"]), shown_rays(m), m["method"]]


def levels_sheet(figures):
    rows = [who(figures, m) + row for scene in figures["scenes"]
            for m in figures["results"] + [m for m in figures["tables"] if m["bounce"] == 0] if m["scene"] == scene
            for row in level_rows(m)]
    dual = (" `dual` has no levels: its lines are tests of bundles with boxes, of rays with boxes, and of "
            "rays with triangles." if "dual" in figures["methods"] else "")
    return sheet("Levels", "From the top down; final tests are ray-triangle tests. ~ marks counts that the paper gives "
                 "to three or four digits." + dual,
                 ["scene", "rays", "method", "level", "tests", "hits", "misses", "paper: tests", "ours / paper",
                  "paper: hits", "ours / paper"], rows)


def rays_sheet(figures):
    rows = [[*who(figures, m)[:2], m["rays"], m["triangles"], m["method"], m["chunks"], m["mesh_sphere_tests"],
             m["hits"] if m["times_ms"] else None] for m in figures["results"]]
    return sheet("Rays", "No total includes the tests of ray nodes with mesh spheres.",
                 ["scene", "rays", "number", "triangles", "method", "chunks sorted", "mesh sphere tests",
                  "rays that hit"], rows)


def times_sheet(figures):
    def cells(times):
        return ["-" if times[stage] is None else f"{times[stage]:.2f}" for stage in STAGES]
    rows = []
    for m in figures["results"]:
        if m["times_ms"]:
            rows.append(who(figures, m) + cells(m["times_ms"]))
            if m["paper"] and m["paper"]["times_ms"]["hierarchy"] is not None:
                rows.append([*who(figures, m)[:2], m["method"] + ", authors", *cells(m["paper"]["times_ms"])])
    return sheet("Times", "Milliseconds a batch. Lines marked \"authors\", if there are any, are from the authors' log "
                 "and were measured on a GTX TITAN; their order is compression, sort and decompression.",
                 ["scene", "rays", "method", *STAGES], rows)


# The switches of the published program

def compared(m, default):
    """Divided by the published total, or by that of the defaults if none was published."""
    return total_ratio(m) if m["paper"] else over(m["total"], default["total"])


def switches_sheet(figures, method):
    combinations = of_method(figures["as_published"], method)
    defaults = combinations[0]["tables"]
    note = ("Total tests divided by those of the first row, because nothing was published for these scenes. "
            if figures["builtin"] else
            "Total tests divided by the published ones; the last column is the mean of |ln| of this ratio and of the "
            "ratios of each level's hits, over all tables. ")
    rows = [[c["combination"], *(shown_ratio(compared(m, d)) for m, d in zip(c["tables"], defaults)),
             shown_ratio(c["deviation"])] for c in combinations]
    return sheet(f"Switches of the published {method}", note + SWITCHES,
                 ["combination", *(" ".join(who(figures, {**m, "method": method})[:2]) for m in defaults),
                  "deviation"], rows)


def nearest_sheet(figures):
    rows = []
    for method in METHODS:
        combinations = of_method(figures["as_published"], method)
        for i, m in enumerate(combinations[0]["tables"]):
            if m["paper"]:
                best = min(combinations, key=lambda c: deviation(c["tables"][i]))
                m = best["tables"][i]
                rows.append([f"{shown_scene(figures, m['scene'])} {shown_rays(m)}", method, best["combination"],
                             shown_ratio(total_ratio(m)), shown_ratio(deviation(m))])
        best = nearest(figures, method)
        rows.append(["all", method, best["combination"], None, shown_ratio(best["deviation"])])
    return sheet("Nearest combinations", "The nearest by the total and by the hits of each level that the paper gives.",
                 ["table", "method", "nearest combination", "total, ours / paper", "deviation"], rows)


def nearest_levels_sheet(figures):
    rows = []
    for method in METHODS:
        for m in nearest(figures, method)["tables"]:
            def add(level, tests, tests_ratio, hits=None, hits_ratio=0):
                rows.append([*who(figures, {**m, "method": method}), level, tests, shown_ratio(tests_ratio), hits,
                             shown_ratio(hits_ratio), "yes" if is_far(tests_ratio) or is_far(hits_ratio) else "no"])
            for level in m["levels"]:
                add(level["level"], level["tests"], level_ratio(m, level, "tests"), level["hits"],
                    level_ratio(m, level, "hits"))
            add("final", m["final_tests"], 0)
            add("total", m["total"], total_ratio(m))
    return sheet("Levels of the nearest combinations", "For each method, the combination that is nearest to all tables.",
                 ["scene", "rays", "method", "level", "tests", "ours / paper", "hits", "ours / paper",
                  "differs by more than 10 %"], rows)


def phases_sheet(figures):
    rows = []
    for method in METHODS:
        phases = of_method(figures["phases"], method)
        for i, first in enumerate(phases[0]["tables"]):
            tables = [c["tables"][i] for c in phases]
            extents = [[compared(m, first) for m in tables]]
            for l, level in enumerate(first["levels"]):
                known = published_level(first, level["level"])["hits"]
                extents.append([over(m["levels"][l]["hits"], known or level["hits"]) for m in tables])
            rows.append([*who(figures, {**first, "method": method}),
                         *(shown_ratio(end) for ratios in extents for end in (min(ratios), max(ratios)))])
    return sheet("The effect of a few rays",
                 "The defaults without the first 0, 1, 2, 4, 8, 16 and 32 rays, so that every node holds other rays. "
                 "The table has the least and the greatest count divided by the published one, or by that with all "
                 "rays if none was published.",
                 ["scene", "rays", "method", "total from", "to", "level 2 hits from", "to", "level 1 hits from", "to"],
                 rows)


def sweep_sheet(figures):
    rows = [[m["method"], m["paper"]["depth"], m["paper"]["branching"], m["total"], m["paper"]["total"],
             shown_ratio(total_ratio(m)),
             ", ".join(shown_ratio(level_ratio(m, level, "hits")) for level in m["levels"])]
            for m in figures["sweep"] if m["paper"]]
    return sheet("Depth and branching",
                 "CORNELL's shadow rays with the defaults, compared with the authors' log: the total, and ours / paper "
                 "of the hits of each level.",
                 ["method", "levels", "branching", "tests", "paper: tests", "ours / paper", "hits, from the top down"],
                 rows)


def switches(figures):
    if "as_published" not in figures:
        return ""
    text = "".join(switches_sheet(figures, method) for method in METHODS)
    if nearest(figures, "rah")["deviation"] > 0:
        text += nearest_sheet(figures) + nearest_levels_sheet(figures) + sweep_sheet(figures)
    return text + phases_sheet(figures)


# The page

def relatives(figures, method):
    """"0.572 % in OFFICE (paper: 1.862 %), ...\""""
    return enumerated([
        f"{shown_percent(t['relative'])} % in {shown_scene(figures, t['scene'])}" +
        (f" (paper: {shown_percent(t['paper_relative'])} %)" if t["paper_relative"] else "")
        for t in figures["totals"] if t["method"] == method])


def page(figures, given):
    scenes = "the built-in scenes, for which nothing was published" if figures["builtin"] else "the paper's scenes"
    text = ("# The paper's experiment on the built-in scenes\n\n" if figures["builtin"]
            else "# The paper, reproduced\n\n")
    text += ("Reis, Costa and Pereira (\"Coherent Ray-Space Hierarchy via Ray Hashing and Sorting\", 2017) count the "
             "tests that their method `crsh` makes for shadow rays and mirror reflections, and compare them with brute "
             "force and with `rah`, the method that `crsh` extends. `raysheaf bench paper` repeats the experiment on "
             f"{scenes}, at {figures['size']} pixels, with two levels of branching 8, and `tools/pages` writes this "
             "page. Every figure is measured, except those of the paper.\n\n")
    for method in ("crsh", "rah", "dual"):
        if method in figures["methods"]:
            text += f"* **`{method}`** makes {relatives(figures, method)} of the tests of brute force.\n"
    if figures["checked"]:
        text += ("* **Hits** of every method and batch were compared with those of brute force; they are the same, bit "
                 "for bit.\n")
    if has_published(figures):
        text += in_short(figures)
    text += "\n" + command_block(figures, given, " --no-times" if given.no_times else "")
    text += totals_sheet(figures) + levels_sheet(figures) + rays_sheet(figures)
    if not given.no_times:
        text += times_sheet(figures)
    if has_published(figures):
        text += explanations(figures)
    text += switches(figures)
    return text.rstrip("\n") + "\n" if figures["builtin"] else text + INCONSISTENCIES + KEYS_AND_BOUNDS
