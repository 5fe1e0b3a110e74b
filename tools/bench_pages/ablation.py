"""Keys and bounds, measured: the page of `bench ablation`, with two plots for each scene."""

import re

from .text import command_block, count, enumerated, geometric_mean, printable, table, three_digits, unique

RAYS = {"shadow": "shadow rays", "reflection1": "reflections, bounce 1", "reflection2": "reflections, bounce 2",
        "ao": "ambient occlusion"}


class Figures:
    """The measurements of a file."""

    def __init__(self, figures):
        self.rows = figures["results"]
        for row in self.rows:
            row["percent"] = 100 * row["relative"]
            row["ms"] = row["times_ms"]["total"]
            row["bits"] = "" if row["key_bits"] is None else f"{row['key_bits']} bits"
        self.scenes = unique(row["scene"] for row in self.rows)
        self.bounds = unique(row["bound"] for row in self.rows)
        self.batches = unique((row["scene"], row["batch"]) for row in self.rows)
        self.rays = unique(rays for _, rays in self.batches)
        self.trees = unique((row["levels"], row["branching"], row["mesh_culling"]) for row in self.rows)
        self.both_cullings = len({tree[2] for tree in self.trees}) > 1

    def of(self, scene, rays):
        return [row for row in self.rows if (row["scene"], row["batch"]) == (scene, rays)]

    def trees_text(self):
        if len(self.trees) != 1:
            return "the smallest over levels, branching and mesh culling"
        levels, branching, culling = self.trees[0]
        return f"{count(levels, 'level')}, branching {branching}, {'with' if culling else 'without'} mesh culling"

    def pairings(self, rays):
        """Every key and bound: geometric means over the scenes of the smallest percentage and time."""
        found = {}
        for row in self.rows:
            if row["batch"] == rays and row["total"] > 0:
                scenes = found.setdefault((row["key"], row["bits"], row["bound"]), {})
                scenes.setdefault(row["scene"], []).append(row)
        return [{"rays": rays, "key": key, "bits": bits, "bound": bound,
                 "percent": geometric_mean([least(rows, "percent")["percent"] for rows in scenes.values()]),
                 "ms": geometric_mean([max(least(rows, "ms")["ms"], 1e-3) for rows in scenes.values()])}
                for (key, bits, bound), scenes in found.items()]


def least(rows, figure):
    """The first of equals, or None."""
    return min(rows, key=lambda row: row[figure], default=None)


def is_crsh(row):
    """Whether these are key and bound of method `crsh`."""
    return (row["key"], row["bound"]) == ("crsh", "sphere-cone")


def pair_text(row):
    return f"`{row['key']}` with `{row['bound']}`"


def pair_with_bits(row):
    return f"`{row['key']}`" + (f" ({row['bits']})" if row["bits"] else "") + f", `{row['bound']}`"


class Pivot:
    """One setting by row, another by column; a cell is the row of the smallest percentage over all others."""

    def __init__(self, rows, line_of, column_of):
        self.columns = unique(map(column_of, rows))
        self.lines = {}
        for row in rows:
            self.lines.setdefault(line_of(row), {}).setdefault(column_of(row), []).append(row)
        self.lines = {name: [least(line.get(column, []), "percent") for column in self.columns]
                      for name, line in self.lines.items()}
        self.least = least(rows, "percent")

    def markdown(self):
        def cell(row):
            if row is None:
                return ""
            number = three_digits(row["percent"])
            return f"**{number}**" if row is self.least else number
        return table(["", *self.columns], [[", ".join(filter(None, name)), *map(cell, line)]
                                           for name, line in self.lines.items()], range(1, 1 + len(self.columns)))


def key_pivot(rows):
    return Pivot(rows, lambda row: (row["key"], row["bits"]), lambda row: row["bound"])


def tree_pivot(rows, both_cullings):
    def line(row):
        levels = count(row["levels"], "level")
        culling = "meshes culled" if row["mesh_culling"] else "no culling"
        return (culling, levels) if both_cullings else (levels, "")
    return Pivot(rows, line, lambda row: f"branching {row['branching']}")


def winners_table(kinds):
    rows = []
    for all_pairs in kinds:
        fewest, quickest = least(all_pairs, "percent"), least(all_pairs, "ms")
        crsh = least(filter(is_crsh, all_pairs), "percent")
        def factor(figure, best):
            return three_digits(crsh[figure] / best[figure]) + " ×" if crsh else ""
        rows.append([RAYS[fewest["rays"]], pair_with_bits(fewest), three_digits(fewest["percent"]),
                     factor("percent", fewest), pair_with_bits(quickest), three_digits(quickest["ms"]),
                     factor("ms", quickest)])
    return table(["Rays", "Fewest tests", "%", "fewer than `crsh`", "Least time", "ms", "quicker than `crsh`"],
                 rows, (2, 3, 5, 6))


def reasons_list(kinds, reasons):
    """The winners for each kind of rays; kinds with the same winner share a line."""
    winners = {}
    for all_pairs in kinds:
        best = least(all_pairs, "percent")
        winners.setdefault(pair_text(best), (best, []))[1].append(RAYS[best["rays"]])
    return "".join(f"* **{pair}** for {'; '.join(rays)}: {reasons[best['key']]}; {reasons[best['bound']]}.\n"
                   for pair, (best, rays) in winners.items())


def time_sentences(kinds):
    """Where the fewest tests lose against cheaper tests."""
    text = ""
    for all_pairs in kinds:
        fewest, quickest = least(all_pairs, "percent"), least(all_pairs, "ms")
        if fewest is quickest:
            text += f" For {RAYS[fewest['rays']]} the settings with the fewest tests also take the least time."
        else:
            text += (f" For {RAYS[fewest['rays']]}, {pair_text(quickest)} makes "
                     f"{three_digits(quickest['percent'] / fewest['percent'])} times the tests of the winner and takes "
                     f"{three_digits(100 * quickest['ms'] / fewest['ms'])} % of its time.")
    return text


def against_sphere_cone(all_pairs, bound, figure):
    """The mean over the keys of the figure with `bound` divided by that with `sphere-cone`."""
    plain = {(p["key"], p["bits"]): p[figure] for p in all_pairs if p["bound"] == "sphere-cone"}
    factors = [p[figure] / plain[p["key"], p["bits"]] for p in all_pairs
               if p["bound"] == bound and (p["key"], p["bits"]) in plain]
    return three_digits(geometric_mean(factors)) if factors else ""


def comparisons(bounds, kinds):
    heading = ["Bound", *(RAYS[all_pairs[0]["rays"]] for all_pairs in kinds)]
    def best_key(all_pairs, bound):
        best = least([p for p in all_pairs if p["bound"] == bound], "percent")
        return f"`{best['key']}` {three_digits(best['percent'])}" if best else ""
    text = ("## Bound and key must match\n\nThe best key of each bound, and its percentage of brute force:\n\n" +
            table(heading, [[f"`{bound}`", *(best_key(pairs, bound) for pairs in kinds)] for bound in bounds]) + "\n")
    if "sphere-cone" not in bounds or len(bounds) < 2:
        return text
    rows = [[f"`{bound}`", *(" / ".join(against_sphere_cone(pairs, bound, figure) for figure in ("percent", "ms"))
                             for pairs in kinds)] for bound in bounds if bound != "sphere-cone"]
    return (text + "## The effect of a bound\n\nTests / time, as multiples of those of `sphere-cone` with the same "
            "key; geometric means over all keys:\n\n" + table(heading, rows, range(1, len(heading))) + "\n")


def plot_path(svg, scene, what):
    """FILE-SCENE-tests.svg for FILE.svg; unusual letters of the scene become '-'."""
    name = re.sub(r"[^\w\u0080-\U0010ffff]", "-", scene)
    return f"{svg.removesuffix('.svg')}-{name}-{what}.svg"


def scene_section(measured, scene, svg):
    text = f"## Scene {printable(scene)}\n\n"
    if svg:
        text += (f"![Tests by key and bound]({plot_path(svg, scene, 'tests')})\n\n"
                 f"![Tests against time]({plot_path(svg, scene, 'time')})\n\n")
    for _, rays in (batch for batch in measured.batches if batch[0] == scene):
        rows = measured.of(scene, rays)
        text += (f"### {printable(scene)}, {RAYS[rays]}\n\n{rows[0]['rays']} rays, {rows[0]['triangles']} triangles; "
                 f"tests as a percentage of brute force:\n\n{key_pivot(rows).markdown()}\n")
        if len(measured.trees) > 1:
            text += ("The smallest over keys and bounds:\n\n" +
                     tree_pivot(rows, measured.both_cullings).markdown() + "\n")
    return text


def page(figures, given):
    measured = Figures(figures)
    scenes = enumerated([f"`{printable(scene)}`" for scene in figures["scenes"]])
    threads = f"{figures['threads']} threads" if figures["threads"] else "all cores"
    repeat = "measured once" if figures["repeat"] == 1 else f"the median of {figures['repeat']}"
    text = ("# Keys and bounds, measured\n\n"
            "This page combines every key that rays can be sorted by ([keys](../keys.md)) with every bounding volume "
            f"of a bundle of rays ([bounds](../bounds.md)), on {scenes}, at {figures['size']} pixels; "
            f"{measured.trees_text()}. Tests are counted as in the paper, as a percentage of brute force, without "
            f"tests of meshes. Times are milliseconds for order, hierarchy and trace on {threads}, {repeat}. "
            "Percentages fall as images grow, because their rays lie closer together. Figures for several scenes are "
            "geometric means. Shadow rays come from the scene's lights; every surface is a mirror; ambient occlusion "
            "sends four rays from each visible point, a quarter of the scene's diagonal long. These commands measure "
            "the figures, and write the page and its plots:\n\n" + command_block(figures, given))
    kinds = [pairs for pairs in map(measured.pairings, measured.rays) if pairs]
    if not kinds:
        return text + "The scenes have no such rays.\n"
    text += (winners_table(kinds) + "\n`crsh` means its own key with its own bound, `sphere-cone`.\n\n"
             "These need the fewest tests, for these reasons:\n\n" + reasons_list(kinds, figures["reasons"]) +
             "\nThe fewest tests do not always take the least time, because some tests are more expensive." +
             time_sentences(kinds) + "\n\n" + comparisons(measured.bounds, kinds))
    return text + "".join(scene_section(measured, scene, given.plot) for scene in measured.scenes).rstrip("\n") + "\n"


def plot(figures, path):
    from . import plots
    measured = Figures(figures)
    several = len(measured.trees) > 1
    for scene in measured.scenes:
        name = capital(printable(scene))
        rays = [rays for rays in measured.rays if measured.of(scene, rays)]
        maps = [(capital(RAYS[r]), key_pivot(measured.of(scene, r))) for r in rays]
        if several:
            maps += [(capital(RAYS[r]) + ": the hierarchy",
                      tree_pivot(measured.of(scene, r), measured.both_cullings)) for r in rays]
        plots.heat_maps(f"{name}: tests by key and bound",
                        f"Percentage of brute force, {figures['size']} pixels, {measured.trees_text()}. "
                        "Darker cells are smaller; each plot has its own scale.",
                        maps, plot_path(path, scene, "tests"))
        plots.scatters(f"{name}: tests against time",
                       f"{figures['size']} pixels. Colours stand for bounds, shapes for the parts of the key. Lower "
                       "and farther left is better.",
                       [(capital(RAYS[r]), labelled(measured.of(scene, r))) for r in rays],
                       measured.bounds, figures["families"], plot_path(path, scene, "time"))


def capital(text):
    return text[:1].upper() + text[1:]


def labelled(rows):
    """The rows that have tests; those with the fewest, with the least time, and of `crsh` get a label."""
    rows = [row for row in rows if row["total"] > 0]
    for best in (least(rows, "total"), least(rows, "ms"), least(filter(is_crsh, rows), "ms")):
        if best:
            best["label"] = f"{best['key']} {best['key_bits'] or ''}".rstrip() + f" · {best['bound']}"
    return rows
