"""The counts of `bench paper`: measured tables, compared with the published ones where there are any.

A ratio is ours divided by the paper's, or 0, which stands for an unknown figure.
"""

import math

METHODS = ("rah", "crsh")
DEFAULTS = "signed"  # the combination without switches


def over(ours, theirs):
    return ours / theirs if theirs else 0


def total_ratio(table):
    return over(table["total"], table["paper"]["total"]) if table["paper"] else 0


def published_level(table, level):
    levels = table["paper"]["levels"] if table["paper"] else []
    unknown = {"tests": None, "hits": None, "tests_rounded": False, "hits_rounded": False}
    return next((published for published in levels if published["level"] == level), unknown)


def level_ratio(table, level, what):
    """`what`: "tests" or "hits" of one of the table's levels."""
    return over(level[what], published_level(table, level["level"])[what])


def deviation(table):
    """Mean of |ln ratio| over the total and the hits of every known level."""
    ratios = [total_ratio(table), *(level_ratio(table, level, "hits") for level in table["levels"])]
    known = [abs(math.log(ratio)) for ratio in ratios if ratio > 0]
    return sum(known) / len(known) if known else 0


def is_far(ratio):
    """Whether it differs by more than the 10 % above which the page explains the cause."""
    return ratio > 0 and abs(ratio - 1) > 0.1


def of_method(combinations, method):
    return [combination for combination in combinations if combination["method"] == method]


def nearest(figures, method):
    """The combination of switches with the smallest deviation, the first of equals."""
    return min(of_method(figures["as_published"], method), key=lambda combination: combination["deviation"])


def table_of(combinations, method, name, scene, kind="shadow"):
    """One table of the combination of that name."""
    combination = next(c for c in of_method(combinations, method) if c["combination"] == name)
    return next(t for t in combination["tables"] if (t["scene"], t["kind"]) == (scene, kind))


def has_published(figures):
    """Whether the switches were tried for the paper's scenes at the paper's size."""
    return "as_published" in figures and all(table["paper"] for table in nearest(figures, "rah")["tables"])


def shown_ratio(ratio):
    return f"{ratio:.3f}" if ratio > 0 else "-"


def shown_percent(fraction):
    return f"{fraction * 100:.3f}"


def shown_scene(figures, scene):
    """"OFFICE", as the paper writes its own, or "builtin:office"."""
    return "builtin:" + scene if figures["builtin"] else scene.upper()


def shown_rays(table):
    """"shadow", "reflection 1", or "reflection 1 + 2" of both bounces."""
    return table["kind"] if table["kind"] == "shadow" else f"{table['kind']} {table['bounce'] or '1 + 2'}"
