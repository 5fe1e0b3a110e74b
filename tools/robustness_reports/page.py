"""docs/robustness.md: the reports, the answers of exact arithmetic, of raysheaf and of the peers."""

from . import answers, reports
from .peers import PEERS, shown

QUESTIONS = {"closest": "t", "any": "hits anything", "count": "triangles", "places": "places", "all": "every t",
             "triangle": "triangle", "side": "side", "normal": "normal", "distance": "distance",
             "signed": "signed distance", "inside": "inside", "refused": "t"}
RIGHT = "✓"


def truth_cell(report, truth):
    kind, name = report.query.kind, QUESTIONS[report.query.kind]
    if kind == answers.REFUSED:
        return "none"
    if len(truth) == 1 and kind != "normal":
        return shown(truth[0]) if truth[0] == answers.INF else f"{name}: {shown(truth[0])}"
    return f"{len(truth)} × {name}" if len(truth) > 1 else name


def raysheaf_cell(report, truth, given):
    if report.query.kind == answers.REFUSED:
        return f"refused: {given[0]}"
    good = sum(answers.agrees(report.query, g, t) for g, t in zip(given, truth))
    return RIGHT if good == len(truth) else f"**{good} of {len(truth)}**"


def peer_cell(report, verdict):
    if verdict is None:
        return ""
    if report.query.kind == answers.REFUSED:
        return str(verdict)
    return RIGHT if verdict is True else f"**{verdict}**"


def table(report_list, judged, given, peers):
    rows = ["| Report | It says or asks | Exact | raysheaf | " + " | ".join(PEERS) + " |", "|---" * (4 + len(PEERS)) + "|"]
    for report in report_list:
        key = report.key
        asks = report.asks + (f" ({report.note})" if report.note else "")
        cells = [f"[{report.project.split('/')[1]} {report.number}]({report.link})", asks,
                 truth_cell(report, judged[key]), raysheaf_cell(report, judged[key], given[key]),
                 *(peer_cell(report, peers["reports"].get(key, {}).get(peer)) for peer in PEERS)]
        rows.append("".join(f"| {cell} " if cell else "| " for cell in cells) + "|")
    return "\n".join(rows) + "\n"


def page(peers, judged, given):
    """`judged` and `given`: the answers by the key of each report."""
    all_reports = list(reports.all_reports())
    summary = []
    for peer in PEERS:
        found = [peers["reports"].get(key, {}).get(peer) for key, truth in judged.items()
                 if truth[0] != answers.REFUSED]
        asked = [verdict for verdict in found if verdict is not None]
        summary.append(f"| {peer} {peers['versions'][peer]} | {len(asked)} | {sum(v is True for v in asked)} |")
    kept = sum(all(answers.agrees(r.query, g, t) for g, t in zip(given[r.key], judged[r.key])) for r in all_reports)
    summary.insert(0, f"| raysheaf | {len(all_reports)} | {kept} |")
    text = INTRODUCTION.format(reports=len(all_reports), questions=sum(map(len, judged.values())),
                               programs=len({r.project for r in all_reports}), summary="\n".join(summary))
    for group, report_list in reports.GROUPS.items():
        text += f"\n## {group}\n\n" + table(report_list, judged, given, peers)
    return text


INTRODUCTION = """# Robustness, report by report

Programs that cast rays at meshes, or measure distances to them, are reported to fail in the same few ways: a ray slips through an edge, a point in plain sight is inside, a distance has the wrong sign. This page collects {reports} public reports about {programs} programs and shows what raysheaf answers to a small case of each, {questions} rays and points in all, next to exact arithmetic and three peers. Exact arithmetic is done in integers and fractions by [a Python program](../tools/robustness_reports/exact.py) that shares no code with raysheaf.

| | Reports with such a question | All answers right |
|---|---:|---:|
{summary}

<!-- not run -->
```sh
tools/robustness --markdown docs/robustness.md
```

The command needs the [Python module](python.md). It asks raysheaf and exact arithmetic again and writes this page; a test does the same. `tools/robustness --peers` also asks the peers, if their wheels are installed, and records their answers.

## How to read the tables

**Report** links to the report. If the report gives numbers, the case has them; otherwise it is a mesh of the same kind, of few triangles. The peers' columns therefore say nothing about the program in the first column, which may have changed since, and reports about slowness are checked for their answers only.

**Exact** is the answer. For several rays or points it is their number and the question: t of the closest hit, the number of triangles that a ray hits, the number of different places where it does, the distance, negative inside.

**raysheaf** has a ✓ if all hits, misses, counts and signs are those of exact arithmetic, each t is within 2 units in the last place, and each distance within 2⁻⁴⁶ of itself or of 16, whichever is greater.

**The peers** have a ✓ if every answer is right, where t and distances may be wrong by 10⁻⁴ of themselves plus 10⁻⁶ of the mesh's size. Otherwise the cell shows, in bold, how many answers are right, or the only answer, or the error. It is empty if the peer has no such question. `trimesh` is trimesh's own engine in float64, `embreex` is Embree as trimesh's `mesh.ray` calls it, including trimesh's code around it; all have their default settings. Everyone gets the same float32 numbers, and peers get instances and moved meshes as the final vertices.

Some answers are right by definition, and another program may define them otherwise. In raysheaf

* a ray in the plane of a triangle misses it, and a triangle without area has no hits, but has distances;
* a hit at t = 0 counts; `skip` leaves a triangle out, and `t_min` the beginning of a ray;
* `all_hits` and `hit_counts` have each triangle at an edge, while the [trimesh adapter](python.md#trimesh) reports the place once; a peer's count of places is right, too;
* solids may overlap and may be inside out, and on an open mesh six rays vote ([limits](limits.md#queries));
* rays and vertices that are not valid are refused, with an error that names them.
"""
