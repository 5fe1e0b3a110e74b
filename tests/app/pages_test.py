"""tools/pages: the pages and plots of `raysheaf bench`. RAYSHEAF_APP names the program."""

import argparse
import importlib.util
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
TOOL = ROOT / "tools/pages"
sys.path.insert(0, str(ROOT / "tools"))
from bench_pages import ablation, compare, scale, text  # noqa: E402

GIVEN = argparse.Namespace(command="compare", plot="")
HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None


def pages(*arguments, **environment):
    return subprocess.run([sys.executable, TOOL, *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, **environment}, check=False)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def bench(self, *arguments):
        """The file of figures that the program writes."""
        path = self.folder / "figures.json"
        subprocess.run([os.environ["RAYSHEAF_APP"], "bench", *arguments, "--json", path, "-q"], check=True,
                       stdout=subprocess.DEVNULL)
        return path

    def page(self, *arguments):
        done = pages(*arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def assert_plot(self, path):
        svg = path.read_text(encoding="utf-8")
        self.assertTrue(xml.etree.ElementTree.fromstring(svg).tag.endswith("svg"))
        self.assertNotRegex(svg, r"\bnan\b|\binf\b")


class Text(unittest.TestCase):
    def test_numbers(self):
        for value, shown in ((0, "0"), (0.00123456, "0.00123"), (1.005, "1.00"), (36.61, "36.6"), (12345, "12345")):
            self.assertEqual(text.three_digits(value), shown)
        for cell, shown in (("1234567", "1 234 567"), ("~1234", "~1 234"), ("12.5", "12.5"), ("-", "-"), ("", "")):
            self.assertEqual(text.grouped(cell), shown)
        self.assertEqual(text.short_number(999_638), "1 M")
        self.assertEqual(text.enumerated(["a"]), "a")
        self.assertEqual(text.enumerated(["a", "b", "c"]), "a, b and c")

    def test_tables(self):
        self.assertEqual(text.table(["a", "b"], [["x", 1], ["", 2]], [1]), "| a | b |\n|---|---:|\n| x | 1 |\n| | 2 |\n")


def made_case(scene, ratio, **more):
    zeros = dict.fromkeys(("compared", "mismatches", "settled", "ours_right", "peer_right", "brute_force_compared",
                           "brute_force_mismatches", "update_ms", "order_ms", "hierarchy_ms", "trace_ms",
                           "peer_build_ms", "peer_trace_ms"), 0)
    return {**zeros, "scene": scene, "size": "8x8", "triangles": 66450, "kind": "shadow", "mode": "rebuild",
            "rays": 1000, "along": "", "ours_ms": ratio, "peer_ms": 1, "peer_way": "LOW, occluded1",
            "peer_version": "4.4.0", "ratio": ratio, "cpu_ratio": ratio, "hits_equal": True, "ours_bytes": 1 << 20,
            "peer_bytes": 1 << 20, "plan": "tree built, streams", **more}


def made_comparison(cases):
    return {"command": "raysheaf bench compare", "peer": "Embree 4.4.0", "threads": 2, "runs": 1, "notes": [],
            "peak_bytes": 1 << 20, "cases": cases}


class Compare(Folder):
    def test_cases_with_other_hits_are_marked(self):
        page = compare.page(made_comparison([made_case("a", 0.4), made_case("b", 0.9, hits_equal=False)]), GIVEN)
        self.assertIn("| a | 66450 | 0.400 |", page)
        self.assertIn("| b | 66450 | 0.900 ≠ |", page)
        self.assertIn("| *geometric mean* | | *0.600* |", page)
        self.assertIn("| *geometric mean, processor time* | | *0.600* |", page)
        self.assertIn("| a | rebuild | 1.0 | 16 | 1.0 | 16 |", page)

    def test_each_size_has_its_rows_and_means(self):
        page = compare.page(made_comparison([made_case("a", 0.4), made_case("a", 0.3, size="16x24")]), GIVEN)
        self.assertIn("| a 16x24 | 66450 | 0.300 |", page)
        self.assertIn("| *geometric mean 8x8* | | *0.400* |", page)

    def test_large_scenes_that_are_rebuilt_have_their_own_means(self):
        page = compare.page(made_comparison([made_case("a", 0.4), made_case("b", 0.2, triangles=999_638)]), GIVEN)
        self.assertIn("| *geometric mean* | | *0.400* |", page)
        self.assertIn("| *geometric mean, 1 M triangles and more* | | *0.200* |", page)

    def test_the_steepest_step_of_the_growth(self):
        growth = [made_case("hall", 1, along="triangles", triangles=count, ours_ms=ms,
                            peer_ms=2) for count, ms in ((1000, 1), (10_000, 5), (100_000, 500))]
        page = compare.page(made_comparison(growth), GIVEN)
        self.assertIn("| triangles | rebuild | shadow | 1000 | 100000 | 1.00 to 500 | 2.00 to 2.00 | 2.00 | 0.00 |",
                      page)

    def test_names_cannot_break_the_page(self):
        self.assertIn("| a?b |", compare.page(made_comparison([made_case("a\nb", 1)]), GIVEN))

    @unittest.skipUnless(HAS_MATPLOTLIB, "matplotlib is not installed")
    def test_plots(self):
        path = self.folder / "plot.svg"
        compare.plot(made_comparison([made_case("a", 0.4), made_case("<b>", 0.9)]), path)
        self.assert_plot(path)
        before = path.read_bytes()
        compare.plot(made_comparison([made_case("a", 0.4), made_case("<b>", 0.9)]), path)
        self.assertEqual(path.read_bytes(), before)
        compare.plot(made_comparison([made_case("hall", 1, along="rays")]), path)
        self.assert_plot(path)

    def test_the_committed_growth(self):
        page = self.page("compare", ROOT / "bench/results/growth-2-threads.csv")
        self.assertIn("| rays | rebuild | mirror reflection | 10000 | 9998244 | 3.55 to 417 |", page)

    def test_the_committed_page(self):
        page = self.page("compare", ROOT / "bench/results/compare-2-threads.csv").splitlines()
        committed = (ROOT / "docs/results/compare.md").read_text(encoding="utf-8").splitlines()
        self.assertEqual([line for line in committed if line not in page],
                         ["tools/pages compare FILE.csv --markdown FILE.md --svg FILE.svg",
                          "![The figures as a plot](../images/compare.svg)"])


def made_row(scene, bound, percent, ms, key="raster"):
    return {"scene": scene, "batch": "shadow", "key": key, "key_bits": None, "bound": bound, "levels": 2,
            "branching": 8, "mesh_culling": True, "rays": 100, "triangles": 100, "total": 100 * percent,
            "relative": percent / 100, "times_ms": {"total": ms}}


class Ablation(Folder):
    ROWS = [made_row("a", "sphere-cone", 1, 1), made_row("a", "shaft", 0.5, 2), made_row("b", "sphere-cone", 4, 4),
            made_row("b", "shaft", 0.5, 8)]

    def test_means_are_over_the_scenes(self):
        pairs = ablation.Figures({"results": self.ROWS}).pairings("shadow")
        self.assertEqual([pair["bound"] for pair in pairs], ["sphere-cone", "shaft"])
        self.assertAlmostEqual(pairs[0]["percent"], 2)
        self.assertAlmostEqual(pairs[1]["percent"], 0.5)
        self.assertEqual(ablation.against_sphere_cone(pairs, "shaft", "percent"), "0.250")
        self.assertEqual(ablation.against_sphere_cone(pairs, "shaft", "ms"), "2.00")

    def test_a_cell_is_the_least_over_the_other_settings(self):
        rows = [{**made_row("a", "shaft", percent, 1), "branching": branching}
                for percent, branching in ((3, 4), (2, 8))]
        rows += [{**made_row("a", "frustum", 2.5, 1), "branching": 4}]
        measured = ablation.Figures({"results": rows})
        self.assertEqual(ablation.key_pivot(measured.rows).markdown(),
                         "| | shaft | frustum |\n|---|---:|---:|\n| raster | **2.00** | 2.50 |\n")
        self.assertEqual(ablation.tree_pivot(measured.rows, False).markdown(),
                         "| | branching 4 | branching 8 |\n|---|---:|---:|\n| 2 levels | 2.50 | **2.00** |\n")

    def test_names_of_plots(self):
        self.assertEqual(ablation.plot_path("d/a.svg", "x y/z", "time"), "d/a-x-y-z-time.svg")

    def test_a_whole_page(self):
        figures = self.bench("ablation", "builtin:cornell", "--size", "24x24", "--rays", "shadow,reflection1", "--keys",
                             "crsh,five-hilbert", "--bounds", "sphere-cone,shaft", "--levels", "1,2")
        page = self.page("ablation", figures)
        self.assertIn("raysheaf bench ablation builtin:cornell --rays shadow,reflection1 ", page)
        for part in ("## The effect of a bound", "### cornell, reflections, bounce 1", "| five-hilbert, 64 bits |",
                     "The smallest over keys and bounds", "; the hull of two boxes is"):
            self.assertIn(part, page)
        if HAS_MATPLOTLIB:
            page = self.folder / "page.md"
            (self.folder / "images").mkdir()
            self.page("ablation", figures, "--markdown", page, "--svg", self.folder / "images/a.svg")
            for what in ("tests", "time"):
                self.assertIn(f"(images/a-cornell-{what}.svg)", page.read_text(encoding="utf-8"))
                self.assert_plot(self.folder / f"images/a-cornell-{what}.svg")


def straight_samples():
    return [{"triangles": triangles, "pixels": pixels, "decoding": 2e-8 * triangles, "culling": 0,
             "tracing": 0.01 + 3e-8 * triangles + 1e-6 * pixels, "shading": 0, "rest": 2e-6 * pixels,
             "bytes": 12 * triangles} for triangles in (1e6, 8e6) for pixels in (65536, 262144)]


class Scale(Folder):
    def test_the_fit_finds_straight_lines(self):
        model = scale.Model(straight_samples())
        cost = model.cost(1e9, 1e6)
        for part, expected in (("decoding", 20), ("tracing", 31.01), ("rest", 2), ("culling", 0)):
            self.assertAlmostEqual(cost[part], expected, 4)
        self.assertAlmostEqual(cost["bytes"] / 12e9, 1)
        self.assertGreaterEqual(min(map(min, model.fits.values())), -1e-12)

    def test_more_resources_are_no_slower_except_the_network(self):
        model = scale.Model(straight_samples())
        def forecast(ranks, disk=2e9, network=1.25e9):
            return scale.forecast_geometry(model, 1e9, 262144, 2, scale.Machines(ranks, 8, 0, disk, network, 20e-6))
        one, sixteen = forecast(1), forecast(16)
        self.assertEqual((one.network_s, one.bound_by), (0, "cores"))
        self.assertAlmostEqual(one.disk_s, 6, 3)
        self.assertLess(sixteen.total_s, one.total_s)
        self.assertGreater(sixteen.network_s, 0)
        self.assertEqual(forecast(16, disk=1e6).bound_by, "disk")
        self.assertEqual(forecast(16, disk=1e6, network=1e3).bound_by, "network")
        machines = scale.Machines(16, 8, 0, 1e6, 1e3, 20e-6)
        self.assertLess(scale.forecast_rays(model, 1e9, 262144, 1, machines).total_s,
                        scale.forecast_rays(model, 1e9, 262144, 0, machines).total_s)

    def test_the_serial_part_is_recovered(self):
        for cores in (2, 16):
            for serial in (0, 0.1, 1):
                clock = scale.Machines(1, cores, serial).clock_seconds(3)
                self.assertAlmostEqual(scale.serial_part(3, clock, cores), serial)
            self.assertEqual(scale.serial_part(3, 0.1, cores), 0, "faster than all cores can be")
        self.assertEqual(scale.serial_part(3, 3, 1), 0)

    def test_the_committed_page(self):
        page = self.page("scale", ROOT / "bench/results/scale-2-threads.json")
        self.assertEqual(page, (ROOT / "docs/results/scale.md").read_text(encoding="utf-8"))

    def test_other_machines(self):
        page = self.page("scale", ROOT / "bench/results/scale-2-threads.json", "--triangles", "5M", "--machines", 3)
        self.assertTrue(page.startswith("# Scale: what 5 M triangles would take\n"))
        self.assertIn("on 3 machines that share the triangles", page)


def split(line):
    """A line without its numbers, and the numbers without separators of digit groups."""
    line = re.sub(r"(\d) (?=\d{3}(?!\d))", r"\1", line)
    return re.sub(r"\d+(\.\d+)?", "#", line), [float(n) for n in re.findall(r"\d+(?:\.\d+)?", line)]


class Paper(Folder):
    def test_the_page_of_the_builtin_scenes(self):
        """Figures may differ in their last digits: OpenGL decides pixels at silhouettes, libm computes angles."""
        figures = self.bench("paper", "--size", "48x48", "--as-published", "--method", "brute", "--method", "rah",
                             "--method", "crsh")
        ours = self.page("paper", figures, "--no-times").splitlines()
        committed = (ROOT / "docs/results/reproduction-builtin.md").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(ours), len(committed))
        for line, expected in zip(map(split, ours), map(split, committed)):
            self.assertEqual(line[0], expected[0])
            for a, b in zip(line[1], expected[1]):
                self.assertTrue(math.isclose(a, b, rel_tol=0.01, abs_tol=0.01), (line, expected))
        self.assertIn("| scene | rays | method | raygen |", self.page("paper", figures))


    def test_the_findings_of_the_papers_scenes(self):
        levels = [{"level": level, "tests": 80, "hits": 50, "misses": 30} for level in (2, 1)]
        published = [{**level, "tests_rounded": True, "hits_rounded": False} for level in levels]
        paper = {"rays": 100, "total": 500, "brute_force": 1000, "depth": 2, "branching": 8, "levels": published,
                 "times_ms": dict.fromkeys(("raygen", "order", "hierarchy", "traverse", "intersect"))}
        tables = [{"scene": scene, "method": "rah", "kind": kind, "bounce": 0, "rays": 1234, "levels": levels,
                   "final_tests": 400, "total": 560, "paper": paper}
                  for scene, kind in (("office", "shadow"), ("cornell", "shadow"), ("cornell", "reflection"),
                                      ("sponza", "shadow"))]
        names = ("signed", "signed, rows from above", "unsigned", "exact", "signed, azimuth by y and x",
                 "signed, crsh key", "signed, undersized triangles", "signed, unrotated meshes",
                 "signed, exact counting")
        combinations = [{"method": method, "combination": name, "dropped_rays": 0, "deviation": 0.1 + i,
                         "tables": tables} for method in ("rah", "crsh") for i, name in enumerate(names)]
        results = [{**table, "triangles": 792, "chunks": 1, "hits": 2, "bound_tests": 0, "ray_bound_tests": 0,
                    "mesh_sphere_tests": 0, "brute_force": 1000, "relative": 0.56, "times_ms": {}} for table in tables]
        total = {"scene": "office", "method": "rah", "total": 560, "brute_force": 1000, "relative": 0.56,
                 "paper_total": 500, "paper_relative": 0.5}
        path = self.folder / "paper.json"
        path.write_text(json.dumps({
            "command": "raysheaf bench paper --scenes DIR", "builtin": False, "size": "512x512", "checked": True,
            "methods": ["rah"], "scenes": ["office", "cornell", "sponza"], "results": results, "tables": results,
            "totals": [total], "as_published": combinations, "phases": combinations, "sweep": tables}),
            encoding="utf-8")
        page = self.page("paper", path)
        for part in ("* **`rah`** makes 56.000 % in OFFICE (paper: 50.000 %) of the tests of brute force.",
                     "makes 1.120 to 1.120 of the published tests with `rah` (every switch at its default)",
                     "The paper gives 40 counts of totals and levels: 8 are off by more than 10 %",
                     "There are 1 234 shadow rays (published: 100) in CORNELL",
                     "total 1.120 to 1.120, hits of level 2 1.000 to 1.000, of level 1 1.000 to 1.000",
                     "| OFFICE | shadow | rah | 2 | 80 | 50 | 30 | ~80 | 1.000 | 50 | 1.000 |",
                     "| OFFICE | shadow | rah | final | 400 | - | - | 400 | 1.000 | - | - |",
                     "| OFFICE shadow | rah | signed | 1.120 | 0.038 |",
                     "| OFFICE | shadow | rah | total | 560 | 1.120 | - | - | yes |",
                     "| rah | 2 | 8 | 560 | 500 | 1.120 | 1.000, 1.000 |", "## Where the paper disagrees with itself"):
            self.assertIn(part, page)


class Usage(Folder):
    def test_bad_files_get_one_sentence(self):
        for content, words in (("{", "this is not what raysheaf bench paper --json writes"),
                               ("[]", "this is not what raysheaf bench paper --json writes"),
                               (json.dumps(made_comparison([])), "this is not what raysheaf bench paper --json writes")):
            path = self.folder / "file.json"
            path.write_text(content, encoding="utf-8")
            done = pages("paper", path)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(done.stderr, f"tools/pages: {path}: {words}\n")
        done = pages("scale", "nowhere.json")
        self.assertEqual((done.returncode, done.stderr), (1, "tools/pages: nowhere.json: No such file or directory\n"))
        done = pages("compare", path)
        self.assertEqual((done.returncode, done.stderr),
                         (1, f"tools/pages: {path}: this is not what raysheaf bench compare --csv writes\n"))
        path = ROOT / "bench/results/growth-2-threads.csv"
        done = pages("compare", path, "--markdown", self.folder / "no/page.md")
        self.assertEqual(done.returncode, 1)
        self.assertTrue(done.stderr.endswith("no/page.md: No such file or directory\n"), done.stderr)

    def test_wrong_usage(self):
        for arguments in ((), ("cake",), ("paper",), ("paper", "f", "--svg", "f"), ("scale", "f", "--triangles", "0")):
            self.assertEqual(pages(*arguments).returncode, 2, arguments)

    def test_without_matplotlib_a_plot_is_one_sentence(self):
        (self.folder / "matplotlib.py").write_text("raise ModuleNotFoundError(name='matplotlib')", encoding="utf-8")
        done = pages("compare", ROOT / "bench/results/growth-2-threads.csv", "--svg", self.folder / "g.svg",
                     PYTHONPATH=str(self.folder))
        self.assertEqual((done.returncode, done.stderr),
                         (1, "tools/pages: --svg needs the Python package matplotlib, which is not installed\n"))


if __name__ == "__main__":
    unittest.main()
