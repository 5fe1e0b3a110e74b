"""Public reports about other programs: raysheaf answers each case as exact arithmetic does."""

from __future__ import annotations

import json
import sys
from fractions import Fraction
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from robustness_reports import answers, exact, page, reports  # noqa: E402

ALL = reports.all_reports()
CORNERS = [[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]


@pytest.fixture(scope="module")
def judged():
    return {report.key: answers.judged(report) for report in ALL}


@pytest.fixture(scope="module")
def asked():
    return {report.key: answers.answered(report) for report in ALL}


def test_there_are_sixty_reports_and_each_is_cited_once():
    assert len({report.link for report in ALL}) == len(ALL) >= 60


@pytest.mark.parametrize("report", ALL, ids=lambda report: report.key)
def test_answers_are_exact(report, judged, asked):
    given, right = asked[report.key], judged[report.key]
    assert len(given) == len(right) == len(report.query.origins)
    wrong = [
        (i, g, r) for i, (g, r) in enumerate(zip(given, right)) if not answers.agrees(report.query, g, r)
    ]
    assert not wrong


def test_the_page_is_what_the_tool_writes(judged, asked):
    recorded = json.loads((ROOT / "tools/robustness_reports/peers.json").read_text("utf-8"))
    assert recorded["reports"].keys() == judged.keys()
    written = page.page(recorded, judged, asked)
    kept = (ROOT / "docs/robustness.md").read_text("utf-8")
    assert written == kept, "run tools/robustness --markdown docs/robustness.md"


def test_the_judge_knows_edges_planes_and_sides():
    def first(origin, direction, **more):
        return exact.hits(CORNERS, [(0, 1, 2)], origin, direction, **more)

    assert first((2, 2, 3), (0, 0, -1)) == [(3, 0, 1)]  # on the longest edge, from the front
    assert first((1, 1, -0.1), (0, 0, 3)) == [(Fraction(0.1) / 3, 0, -1)]
    assert first((2, 2.0000000000000004, 3), (0, 0, -1)) == []
    assert first((-1, 1, 0), (1, 0, 0)) == []  # in the plane
    assert first((1, 1, -1), (0, 0, -1)) == []  # behind
    assert first((1, 1, 1), (0, 0, -1), t_max=0.5) == first((1, 1, 1), (0, 0, -1), sides="back") == []


def test_the_judge_knows_distances_and_the_inside():
    (squared,) = exact.squared_distances(CORNERS, [(0, 1, 2)], (4, 4, 1))
    assert squared == 9 and answers.square_root(squared) == 3
    assert exact.squared_distances([[0.0, 0, 0], [2, 0, 0], [6, 0, 0]], [(0, 1, 2)], (4, 3, 0)) == [9]
    vertices, faces = (x.tolist() for x in reports.HOLLOW)
    inside = [exact.inside(vertices, faces, (x, 0, 0)) for x in (0, 1.5, 3)]
    assert inside == [False, True, False]


def test_what_agrees_is_narrow():
    query = reports.rays("closest", (0, 0, 1), (0, 0, -1))
    assert answers.agrees(query, 1 + 2**-22, 1) and not answers.agrees(query, 1 + 2**-21, 1)
    assert not answers.agrees(query, float("inf"), 1)
    assert answers.agrees(reports.points("signed", (0, 0, 0)), -0.5, Fraction(-1, 2))
    assert not answers.agrees(reports.points("signed", (0, 0, 0)), 0.5, Fraction(-1, 2))
