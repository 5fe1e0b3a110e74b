"""Explains the published counts in words; the figures come from the file."""

from .paper_counts import (DEFAULTS, METHODS, is_far, level_ratio, nearest, of_method, over, shown_ratio,
                           shown_rays, shown_scene, table_of, total_ratio)
from .text import grouped


def extent(ratios):
    """"0.974 to 1.028", of those that are known."""
    known = [ratio for ratio in ratios if ratio > 0]
    return f"{shown_ratio(min(known))} to {shown_ratio(max(known))}"


def farthest(figures):
    """The known count of the nearest combinations that is farthest from the published one."""
    known = {}
    for method in METHODS:
        for m in nearest(figures, method)["tables"]:
            who = f"{shown_scene(figures, m['scene'])}, {shown_rays(m)} rays, `{method}`"
            known[who + ": total"] = total_ratio(m)
            for level in m["levels"]:
                for what in ("tests", "hits"):
                    known[f"{who}: {what} of level {level['level']}"] = level_ratio(m, level, what)
    known = {name: ratio for name, ratio in known.items() if ratio > 0}
    worst = max(known, key=lambda name: abs(known[name] - 1))
    far = sum(map(is_far, known.values()))
    return (f"The paper gives {len(known)} counts of totals and levels: "
            f"{'none is' if far == 0 else '1 is' if far == 1 else f'{far} are'} off by more than 10 %, and the farthest "
            f"is {worst}, with {shown_ratio(known[worst])} of the published count.")


def setting(combination):
    name = combination["combination"]
    return "every switch at its default" if name == DEFAULTS else f"nearest: *{name}*"


def in_short(figures):
    """Points of the page's summary."""
    rah, crsh = (nearest(figures, method) for method in METHODS)
    def ratio(name, scene, kind="shadow"):
        return shown_ratio(total_ratio(table_of(figures["as_published"], "crsh", name, scene, kind)))
    return (
        "* **The published program**, rebuilt with its quirks (`--as-published`), makes "
        f"{extent(map(total_ratio, rah['tables']))} of the published tests with `rah` ({setting(rah)}) and "
        f"{extent(map(total_ratio, crsh['tables']))} with `crsh` ({setting(crsh)}), over all tables. With other depths "
        f"and branchings it makes {extent(map(total_ratio, figures['sweep']))} of the tests in the authors' log of "
        f"CORNELL. {farthest(figures)}\n"
        "* **The published tables** were made with rows counted from below, equation 9 with a sign, and, by mistake, a "
        "key whose azimuth is atan2(x, x). Without this mistake, CORNELL's reflections would take "
        f"{ratio('signed, azimuth by y and x', 'cornell', 'reflection')} of the published tests. Two mistakes of the "
        "program as it can be read today are not in the tables: undersized triangle spheres, and mesh spheres that are "
        "not rotated.\n"
        "* **raysheaf's `crsh`** makes fewer tests than the published one, because its key follows a Hilbert curve on "
        "the octahedral map, its cones are measured on their rays, and its cone test is exact. With that key and "
        f"everything else as published, OFFICE takes {ratio('signed, crsh key', 'office')} of the published tests.\n")


def explanations(figures):
    """A section; `has_published` must hold."""
    def ratio(method, name, scene, kind="shadow"):
        return shown_ratio(total_ratio(table_of(figures["as_published"], method, name, scene, kind)))

    def padding():
        """The least part of its tests that a table keeps if the last node is counted without padding."""
        return min(over(table_of(figures["as_published"], method, "signed, exact counting", scene)["total"],
                        table_of(figures["as_published"], method, DEFAULTS, scene)["total"])
                   for method in METHODS for scene in figures["scenes"])

    def rays(scene):
        m = table_of(figures["as_published"], "rah", DEFAULTS, scene)
        return f"{grouped(str(m['rays']))} shadow rays (published: {grouped(str(m['paper']['rays']))})"

    def phases(scene):
        """The effect of a few rays on the total and on the hits of both levels of `rah`."""
        tables = [m for c in of_method(figures["phases"], "rah") for m in c["tables"]
                  if (m["scene"], m["kind"]) == (scene, "shadow")]
        top, leaves = (extent(level_ratio(m, m["levels"][at], "hits") for m in tables) for at in (0, -1))
        return f"total {extent(map(total_ratio, tables))}, hits of level 2 {top}, of level 1 {leaves}"

    above, corrected, undersized = "signed, rows from above", "signed, azimuth by y and x", "signed, undersized triangles"
    return f"""## What explains the published counts

Figures are raysheaf's count divided by the paper's. {farthest(figures)}

* **Rows from below.** Rays that face no light are trimmed, so a node of `rah` holds the end of one row and the beginning of the next. Which rows meet depends on where counting starts. Counted from below, as OpenGL does, CORNELL's shadow rays make {ratio('rah', DEFAULTS, 'cornell')} of the published tests; counted from above, {ratio('rah', above, 'cornell')}. Reflections fill every row and do not distinguish the two ({ratio('rah', DEFAULTS, 'cornell', 'reflection')} and {ratio('rah', above, 'cornell', 'reflection')}).
* **Equation 9 with a sign.** As printed, |C - H| has no sign and the cone opens in both directions: SPONZA would make {ratio('rah', 'unsigned', 'sponza')} (`rah`) and {ratio('crsh', 'unsigned', 'sponza')} (`crsh`) of the published tests. With the sign it makes {ratio('rah', DEFAULTS, 'sponza')} and {ratio('crsh', DEFAULTS, 'sponza')}. With the exact distance to the cone, which also rejects spheres behind the origins, CORNELL's shadow rays make {ratio('rah', 'exact', 'cornell')} and {ratio('crsh', 'exact', 'cornell')}.
* **The key as coded.** The program's azimuth is atan2(x, x), which contains only the sign of x. With it `crsh` makes {ratio('crsh', DEFAULTS, 'office')} of the published tests in OFFICE and {ratio('crsh', DEFAULTS, 'cornell', 'reflection')} for CORNELL's reflections; with the intended atan2(y, x), {ratio('crsh', corrected, 'office')} and {ratio('crsh', corrected, 'cornell', 'reflection')}. So the tables were made with the mistake, and correcting only the azimuth makes reflections worse.
* **Correct spheres.** The program, as it can be read today, gives triangles spheres that miss a vertex, and translates mesh spheres without rotating them. Neither was used for the tables: the first would leave {ratio('rah', undersized, 'cornell')} and {ratio('crsh', undersized, 'cornell')} of the published tests of CORNELL's shadow rays (`rah`, `crsh`), the second {ratio('crsh', 'signed, unrotated meshes', 'office')} in OFFICE.
* **Padded counting** follows from the tables themselves, in which the tests of a level are eight times the hits of the level above. Counting the last node without padding changes no total to less than {padding():.5f} of itself.

The remaining difference comes from where nodes begin: one ray more or less shifts every node after it. There are {rays('cornell')} in CORNELL, {rays('office')} in OFFICE, and {rays('sponza')} in SPONZA, whose vertex normals in the file at hand are not exactly the authors'. With the first 0 to 32 rays left out, `rah` makes these parts of the published counts in OFFICE: {phases('office')}; so the published counts lie within the effect of a few rays. In SPONZA: {phases('sponza')}; there, hits of level 2 stay above the published ones. The likely cause is the rays that the normals lose: they are missing within rows, where each gap puts distant pixels into one node. `crsh` sorts its rays and is hardly affected.

"""


INCONSISTENCIES = """## Where the paper disagrees with itself

| Where | What it says | What holds |
|---|---|---|
| CORNELL, shadow rays | 184 717 | 242 015: only with this number are `rah`'s tests at the top 2 995 344, as in its table and in the authors' log; the number in the text would make 2 286 504 |
| CORNELL, triangles | 790 | 792: six cubes of 12 triangles and a sphere of 720 |
| Headings of tables 2 and 3 | OFFICE | CORNELL, by their counts |
| Equation 1 | divides by a vector | divide by its length, unless it is 0; only if the direction lies outside the cone |
| Equation 6 | a cosine of a sum of vectors | an angle: half the angle between the axes, plus the larger of the two spreads |
| Equation 9 | an unsigned length along the axis | a signed one, for spreads below 90 degrees; beyond these, everything is accepted |
"""

# Only prose: the figures are on the pages that it names.
KEYS_AND_BOUNDS = """
## Which keys and bounds win

[Keys and bounds, measured](ablation.md) has the cross product, and [bounds](../bounds.md) shows how many tests each bounding volume leaves of the shadow rays of these three scenes. In short, the bounding volume must fit the key. All bundles of one light start at one point, so a key of directions along a Hilbert curve with four planes around each bundle is as tight as the bundle itself. Mirror and occlusion rays are best sorted by both of their ends and bounded by the boxes of both. The paper's configuration, a hash of directions with spheres and cones, never makes the fewest tests: its cones have no end and are as wide as the larger of two spreads. In time it is competitive if no mesh can be culled: nearly all tests of SPONZA are then those of the top level with every triangle, and its test is the cheapest.
"""
