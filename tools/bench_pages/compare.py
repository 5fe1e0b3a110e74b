"""raysheaf and Embree: the page of `bench compare`, and the plots of its ratios or of its growth."""

import csv
import math

from .text import command_block, geometric_mean, printable, table, three_digits, unique

FILE = "csv"

KINDS = {"shadow": "shadow", "mirror": "mirror reflection", "second": "second bounce",
         "ao": "ambient occlusion", "random": "random"}
MODES = {"rebuild": "Rebuild: new vertices and indices in every frame",
         "refit": "Refit: new vertices in every frame, the same indices",
         "static": "Static: only the rays are new"}
MEBIBYTE = 1 << 20
LARGE = 900_000  # triangles of a scene that is rebuilt and counts among the large ones
TEXTS = {"scene", "size", "kind", "mode", "along", "plan", "peer_version", "peer_way", "ratios"}


def read(file):
    """The figures of `bench compare --csv`: facts of the run after `#`, and a line for each case."""
    lines = file.read().splitlines()
    facts = [line[2:].split(": ", 1) for line in lines if line.startswith("# ")]
    figures = {name: value for name, value in facts if name != "note"}
    figures["notes"] = [value for name, value in facts if name == "note"]
    for name in ("threads", "runs", "peak_bytes"):
        figures[name] = int(figures[name])
    figures["cases"] = [{name: text if name in TEXTS else float(text or 0) for name, text in row.items()}
                        for row in csv.DictReader(line for line in lines if not line.startswith("#"))]
    for case in figures["cases"]:
        case.update({name: int(case[name]) for name in ("triangles", "rays", "compared", "mismatches", "settled",
                                                        "ours_right", "peer_right", "brute_force_compared",
                                                        "brute_force_mismatches", "ours_bytes", "peer_bytes")})
    return figures


class Cases:
    """The cases of a file, without its growth. The label has the size if several sizes were compared."""

    def __init__(self, figures):
        self.all = [case for case in figures["cases"] if not case["along"]]
        sizes = unique(case["size"] for case in self.all)
        self.sizes = sizes if len(sizes) > 1 else [""]
        for case in self.all:
            case["label"] = printable(case["scene"]) + (" " + case["size"] if len(sizes) > 1 else "")
        self.labels = unique(case["label"] for case in self.all)
        self.kinds = present(KINDS, "kind", self.all)
        self.modes = present(MODES, "mode", self.all)

    def of(self, **wanted):
        return [case for case in self.all if all(case[key] == value for key, value in wanted.items())]


def present(names, key, cases):
    """The names that occur, in their order."""
    return [name for name in names if any(case[key] == name for case in cases)]


def ratio_cell(case):
    """"0.420", with "≠" if hits differ."""
    text = three_digits(case["ratio"])
    return text if case["hits_equal"] else text + " ≠"


def ratio_table(cases, mode):
    rows = []
    for label in cases.labels:
        line = {case["kind"]: case for case in cases.of(label=label, mode=mode)}
        triangles = next(case["triangles"] for case in cases.of(label=label))
        rows.append([label, triangles, *(ratio_cell(line[k]) if k in line else "" for k in cases.kinds)])
    for size in cases.sizes:
        for large, name in ((False, "geometric mean"), (True, "geometric mean, 1 M triangles and more")):
            here = [case for case in cases.of(mode=mode) if size in ("", case["size"])
                    and (mode == "rebuild" and case["triangles"] >= LARGE) == large]
            for ratio, of in (("ratio", ""), ("cpu_ratio", ", processor time")):
                found = [[case[ratio] for case in here if case["kind"] == kind] for kind in cases.kinds]
                if here:
                    cells = [f"*{three_digits(geometric_mean(each))}*" if each else "" for each in found]
                    rows.append([f"*{name} {size}".rstrip() + of + "*", "", *cells])
    heading = ["Scene", "Triangles", *(KINDS[kind] for kind in cases.kinds)]
    return table(heading, rows, range(1, len(heading))) + "\n"


def time_table(cases, mode):
    rows = [[case["label"], f"{case['rays']} {case['kind']}",
             *(three_digits(case[part])
               for part in ("update_ms", "order_ms", "hierarchy_ms", "trace_ms", "ours_ms")),
             case["plan"], *(three_digits(case[part]) for part in ("peer_build_ms", "peer_trace_ms", "peer_ms")),
             f"{case['peer_version']} {case['peer_way']}"] for case in cases.of(mode=mode)]
    return table(["Scene", "Rays", "Update", "Order", "Hierarchy", "Trace", "raysheaf, all", "Plan",
                  "Embree: build", "Trace", "Embree, all", "Embree's call"], rows,
                 (2, 3, 4, 5, 6, 8, 9, 10)) + "\n"


def hits_paragraph(cases):
    def total(field):
        return sum(case[field] for case in cases.all)
    unequal = sum(not case["hits_equal"] for case in cases.all)
    return (f"**Hits.** Embree answers {total('mismatches')} of {total('compared')} rays differently. Exact "
            f"arithmetic on the floats as given decided {total('settled')} of these: raysheaf is right in "
            f"{total('ours_right')}, Embree in {total('peer_right')}. The hits of a case count as equal if at most "
            f"one ray in 10 000 differs; {unequal or 'no'} cases exceed this (marked ≠). Brute force answered "
            f"{total('brute_force_compared')} of the rays too; {total('brute_force_mismatches') or 'none'} "
            "differ.\n\n")


def memory_table(cases):
    rows = []
    for label in cases.labels:
        for mode in cases.modes:
            here = cases.of(label=label, mode=mode)
            if not here:
                continue
            both = [max(case[side] for case in here) for side in ("ours_bytes", "peer_bytes")]
            cells = [cell for size in both
                     for cell in (f"{size / MEBIBYTE:.1f}", f"{size / here[0]['triangles']:.0f}")]
            rows.append([label, mode, *cells])
    return ("## Memory\n\nraysheaf's figure includes buffers that queries keep for the next query, and grows with "
            "the number of rays. Arrays of the caller are not counted on either side.\n\n" +
            table(["Scene", "Mode", "raysheaf, MiB", "bytes a triangle", "Embree, MiB", "bytes a triangle"], rows,
                  (2, 3, 4, 5)) + "\n")


# The growth: times along the number of triangles, or of rays.

def our_ms(case):
    return max(case["ours_ms"], 1e-4)


def peer_ms(case):
    return max(case["peer_ms"], 1e-4)


def growth_lines(figures):
    """(along, mode, kind, points) of every line, points in the order of their counts."""
    for along in ("triangles", "rays"):
        for mode in MODES:
            for kind in KINDS:
                line = [p for p in figures["cases"] if (p["along"], p["mode"], p["kind"]) == (along, mode, kind)]
                if line:
                    yield along, mode, kind, sorted(line, key=lambda p: p[along])


def steepest(line, along, time):
    """The largest exponent p between two consecutive points if time grows as count^p; 0 without points."""
    steps = [math.log(time(b) / time(a)) / math.log(b[along] / a[along])
             for a, b in zip(line, line[1:]) if b[along] > a[along]]
    return max([0, *steps])


def growth_section(lines):
    rows = []
    for along, mode, kind, line in lines:
        first, last = line[0], line[-1]
        if len(line) > 1:
            rows.append([along, mode, KINDS[kind], first[along], last[along],
                         *(f"{three_digits(first[side])} to {three_digits(last[side])}"
                           for side in ("ours_ms", "peer_ms")),
                         f"{steepest(line, along, our_ms):.2f}", f"{steepest(line, along, peer_ms):.2f}"])
    return ("## Growth\n\nThe scenes are generated halls of the same shape. *Steepest* is the largest exponent p "
            "between two consecutive points, half a decade apart, if time grows as count^p: 1 is linear.\n\n" +
            table(["Along", "Mode", "Rays", "From", "To", "raysheaf, ms", "Embree, ms", "raysheaf, steepest",
                   "Embree, steepest"], rows, range(3, 9)) + "\n")


def page(figures, given):
    cases = Cases(figures)
    text = ("# raysheaf and Embree, case by case\n\n"
            f"`raysheaf bench compare` runs raysheaf and {figures['peer']} in one process, alternating, with "
            f"{figures['threads']} threads each; `tools/pages` writes this page. A ratio is raysheaf's time divided "
            f"by Embree's, the median over {figures['runs']} rounds: below 1, raysheaf is faster. If two versions of "
            "Embree are installed, the faster one counts in each case, and the table names it. Times are medians "
            "in milliseconds. They cover everything that a frame needs on both sides: updates of the scene, "
            "hierarchies, reading the rays from the caller's array, and writing the hits in the caller's order. "
            "For each case, Embree was tried with every build and call that may be its fastest, and the fastest "
            "counts.\n\n" + command_block(figures, given, kind=FILE))
    if given.plot:
        text += f"![The figures as a plot]({given.plot})\n\n"
    if figures["notes"]:
        text += "".join(f"* {printable(note)}.\n" for note in figures["notes"]) + "\n"
    lines = list(growth_lines(figures))
    if lines:
        text += growth_section(lines)
    if cases.all:
        text += hits_paragraph(cases)
        for mode in cases.modes:
            text += f"## {MODES[mode]}\n\n" + ratio_table(cases, mode) + time_table(cases, mode)
        text += memory_table(cases)
    return text + (f"The process used at most {figures['peak_bytes'] / MEBIBYTE:.0f} MiB, which includes both "
                   "libraries, the scene, and the preparation of the rays.\n")


def plot(figures, path):
    from . import plots
    lines = list(growth_lines(figures))
    if lines:
        plots.growth(figures, lines, our_ms, peer_ms, path)
    else:
        plots.ratios(figures, Cases(figures), MODES, path)
