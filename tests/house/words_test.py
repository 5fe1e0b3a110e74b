"""tools/words finds the turns of phrase that it should find, at their places, and no others."""

import contextlib
import importlib.machinery
import importlib.util
import io
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
TOOL = Path(__file__).resolve().parents[2] / "tools/words"
loader = importlib.machinery.SourceFileLoader("words", str(TOOL))
words = importlib.util.module_from_spec(importlib.util.spec_from_loader("words", loader))
sys.modules["words"] = words
loader.exec_module(words)

BAD = [
    "Of a thousand rays, five miss.",
    "Rays miss. Nor do they count.",
    "Whoever cancels finds everything whole.",
    "Who changes a scene waits.",
    "What is too small for it is 0.",
    "All tests pass but for one.",
    "Such rays hit the front side alone.",
    "It is slow beside Embree.",
    "Nobody reads it.",
    "A loader's losses are told as a warning.",
    "If the build lacks it, the program says so.",
    "Rays are looked over there.",
    "It gives back memory.",
    "The cost is half again as much.",
    "A dearer test can lose.",
    "Three branches that cannot be foretold.",
    "A minimum ball of each mesh.",
    "Both programs ran in turns.",
    "Rays that run alike share a node.",
    "Where there is none, the CPU is used.",
    "Doxygen must be there.",
    "Where clang-14 can be had, it fuzzes.",
    "It computes the tree anew.",
    "First hits are found by OpenGL.",
    "Every query stands on the tree.",
    "In a loud hour it takes 300 ms.",
]
GOOD = [
    "Of course it is exact.",
    "Five of a thousand rays miss.",
    "Who sees whom?",
    "What is tried",
    "It fails with what the system reports.",
    "All tests pass except one.",
    "This mesh takes 3 s, let alone ten of them.",
    "It is slow compared with Embree.",
    "The loader reports a warning.",
    "The buffer returns to its pool.",
    "The cost grows by 50 %.",
    "Ballistic curves use spheres.",
    "There are three ways; is there a fourth?",
    "Where there is a device, it is used.",
]


class Words(unittest.TestCase):
    def found(self, name: str, text: str):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.write_text(text, encoding="utf-8")
            return words.findings(path)

    def test_bad_sentences_are_found_in_every_kind_of_file(self):
        for sentence in BAD:
            for name, text in {
                "page.md": f"# Page\n\n{sentence}\n",
                "table.md": f"| {sentence} |\n",
                "list.md": f"* {sentence}\n",
                "a.h": f"// {sentence}\nint a = 0;\n",
                "b.h": f"int a = 0;  ///< {sentence}\n",
                "c.cpp": f'throw Error("{sentence}");\n',
                "d.py": f"a = 0  # {sentence}\n",
                "e.py": f'"""{sentence}"""\n',
                "f.sh": f"# {sentence}\n",
                "g.sh": f'echo "{sentence}"\n',
            }.items():
                self.assertTrue(self.found(name, text), f"{name}: {sentence}")

    def test_good_sentences_pass(self):
        for sentence in GOOD:
            for name, text in {"page.md": sentence, "a.h": f"// {sentence}\n"}.items():
                self.assertEqual(self.found(name, text + "\n"), [], f"{name}: {sentence}")

    def test_code_is_not_prose(self):
        self.assertEqual(self.found("page.md", "`ball`\n\n```python\nball = 1  # beside\n```\n"), [])
        self.assertEqual(self.found("a.cpp", "int ball = beside(alone);\n"), [])
        self.assertEqual(self.found("a.cpp", 'name("ball"); // https://x.org/ball beside\n'), [])
        self.assertEqual(self.found("a.json", '"what is told is told."'), [])

    def test_a_phrase_may_go_over_lines(self):
        page = self.found("page.md", "\nAll tests of this kind pass but\nfor one.\n")
        self.assertEqual([finding.line for finding in page], [2])
        code = self.found("a.cpp", 'a("All tests pass but "\n  "for one");\n// See\n// beside.\n')
        self.assertEqual([finding.line for finding in code], [1, 4])

    def test_counts_may_fall_and_not_rise(self):
        with tempfile.TemporaryDirectory() as folder:
            root, page = Path(folder), Path(folder) / "docs/page.md"
            (root / "tools").mkdir()
            page.parent.mkdir()
            kept = words.ROOT, words.BASELINE
            words.ROOT, words.BASELINE = root, root / "tools/words.baseline"
            try:
                page.write_text("One ball.\n\nTwo balls.\n")
                self.assertEqual(self.run_tool(), 1)  # a file that no baseline lists
                self.assertEqual(self.run_tool("--lower"), 0)  # writes the baseline
                self.assertEqual(self.run_tool(), 0)
                page.write_text("One ball.\n\nTwo balls.\n\nThree balls.\n")
                self.assertEqual(self.run_tool(), 1)
                self.assertEqual(self.run_tool("--lower"), 1)  # it raises no number
                page.write_text("One ball.\n")
                self.assertEqual(self.run_tool("--lower"), 0)
                self.assertIn("1 docs/page.md", words.BASELINE.read_text())
                page.write_text("One ball.\n\nTwo balls.\n")
                self.assertEqual(self.run_tool(), 1)
            finally:
                words.ROOT, words.BASELINE = kept

    def run_tool(self, *arguments: str) -> int:
        with contextlib.redirect_stdout(io.StringIO()):
            return words.main(list(arguments))


if __name__ == "__main__":
    unittest.main()
