"""Tests what tools/release refuses, and the dates of packages, in a small checkout: release_files.py CMAKE."""
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CMAKE = sys.argv.pop() if len(sys.argv) > 1 else "cmake"
TIME = 1000000000  # 2001-09-09 01:46:40 UTC

# A project without sources, whose packages are raysheaf's.
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(raysheaf VERSION 1.2.3 LANGUAGES NONE)
set(CMAKE_INSTALL_DATADIR share)
include(cmake/Package.cmake)
"""
CHANGELOG = "# Changelog\n\n## 1.2.3 (unreleased)\n\nThe words of this version.\n\n## 1.2.2\n\nOld words.\n"
# Files that repeat the version.
WITH_VERSION = {
    "packaging/vcpkg/raysheaf/vcpkg.json": '{\n  "version": "1.2.3",\n',
    "packaging/conda/recipe.yaml": "context:\n  version: 1.2.3\n",
    "CITATION.cff": "cff-version: 1.2.0\nversion: 1.2.3\n",
}


@unittest.skipUnless(shutil.which("git"), "a release is made from a commit")
class Release(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = pathlib.Path(folder.name, "out")
        self.root = pathlib.Path(folder.name, "checkout")
        for name in ["tools/release", "cmake/Package.cmake", "packaging/debian", "LICENSE"]:
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, self.root / name)
        self.write("CMakeLists.txt", PROJECT)
        self.write("CHANGELOG.md", CHANGELOG)
        for name, text in WITH_VERSION.items():
            self.write(name, text)
        self.write("cmake/install_packages.sh", "#!/bin/sh\n")
        (self.root / "cmake/install_packages.sh").chmod(0o755)
        self.write(".gitignore", "/build/\n")
        self.git("init")
        self.commit()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def git(self, *arguments):
        date = f"{TIME} +0200"
        env = {**os.environ, "GIT_AUTHOR_DATE": date, "GIT_COMMITTER_DATE": date, "GIT_CONFIG_GLOBAL": os.devnull,
               "GIT_CONFIG_SYSTEM": os.devnull}
        subprocess.run(["git", "-c", "user.name=A", "-c", "user.email=a@example.invalid", *arguments], cwd=self.root,
                       env=env, check=True, capture_output=True)

    def commit(self):
        self.git("add", ".")
        self.git("commit", "-m", "a commit")

    def run_tool(self, *arguments):
        return subprocess.run([self.root / "tools/release", *arguments], text=True, capture_output=True, check=False)

    def refuses(self, message, *arguments, code=1):
        done = self.run_tool(*(arguments or ["--only", "notes", self.out]))
        self.assertEqual((done.returncode, done.stdout), (code, ""))
        self.assertEqual(done.stderr, f"tools/release: {message}\n")
        self.assertFalse(self.out.exists())

    def test_arguments(self):
        self.refuses("'--fast' is no option; there is --only PART", "--fast", code=2)
        for part in ["rpm", ""]:
            self.refuses(f"'{part}' is no part; there are source, notes, debian, aarch64 and wheels", "--only", part,
                         code=2)
        self.refuses("OUT, the folder for the files, is missing", "--only", "notes", code=2)
        self.refuses("one folder is expected, not 'a' and 'b'", "a", "b", code=2)
        self.refuses(f"'{self.root}' exists and is not an empty folder", self.root, code=2)
        self.refuses("--only aarch64 needs --only debian, whose dependencies it takes", "--only", "aarch64", self.out,
                     code=2)

    def test_changes_that_are_not_committed(self):
        self.write("CHANGELOG.md", CHANGELOG + "\n")
        self.refuses("there are changes that are not committed")

    def test_a_folder_without_a_commit(self):
        shutil.rmtree(self.root / ".git")
        self.refuses("this folder is no checkout of git, and files are made from a commit")

    def test_tags(self):
        self.git("tag", "v1.2.4")
        self.refuses("the tag is v1.2.4, and CMakeLists.txt has version 1.2.3")
        self.git("tag", "--delete", "v1.2.4")
        self.git("tag", "v1.2.3")
        self.refuses("CHANGELOG.md has no date for 1.2.3, and the tag v1.2.3 releases it")
        self.write("CHANGELOG.md", CHANGELOG.replace("unreleased", "2001-09-09"))
        self.commit()
        self.git("tag", "--force", "v1.2.3")
        self.refuses("CITATION.cff does not have the date of 1.2.3 in CHANGELOG.md, 2001-09-09")
        self.write("CITATION.cff", WITH_VERSION["CITATION.cff"] + 'date-released: "2001-09-09"\n')
        self.commit()
        self.git("tag", "--force", "v1.2.3")
        self.assertEqual(self.run_tool("--only", "notes", self.out).returncode, 0)

    def test_versions(self):
        for name, text in WITH_VERSION.items():
            self.write(name, text.replace("1.2.3", "1.2.30"))
            self.commit()
            self.refuses(f"{name} has another version than 1.2.3")
            self.write(name, text)

    def test_source_and_notes(self):
        done = self.run_tool("--only", "source", "--only", "notes", self.out)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual((self.out / "NOTES.md").read_text(encoding="utf-8"), "The words of this version.\n\n")
        archive = self.out / "raysheaf-1.2.3-source.tar.gz"
        with tarfile.open(archive) as tar:
            self.assertIn("raysheaf-1.2.3/CMakeLists.txt", tar.getnames())
            self.assertEqual({member.mtime for member in tar.getmembers()}, {TIME})
        sums = "".join(f"{hashlib.sha256((self.out / name).read_bytes()).hexdigest()}  {name}\n"
                       for name in ["NOTES.md", archive.name])
        self.assertEqual((self.out / "SHA256SUMS").read_text(encoding="utf-8"), sums)

    def test_a_changelog_without_the_version(self):
        self.write("CHANGELOG.md", CHANGELOG.replace("1.2.3", "1.2.1"))
        self.commit()
        done = self.run_tool("--only", "notes", self.out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("CHANGELOG.md has no section '## 1.2.3'\n", done.stderr)

    @unittest.skipUnless(shutil.which("gzip"), "Debian's changelog is packed with gzip")
    def test_debians_changelog(self):
        os.utime(self.root / "CHANGELOG.md", (TIME + 1, TIME + 1))
        env = {name: value for name, value in os.environ.items() if name != "SOURCE_DATE_EPOCH"}
        for extra, second in [({"SOURCE_DATE_EPOCH": str(TIME)}, 40), ({}, 41)]:
            subprocess.run([CMAKE, "-S", self.root, "-B", self.root / "build"], env={**env, **extra}, check=True,
                           capture_output=True)
            lines = (self.root / "build/changelog").read_text(encoding="utf-8").splitlines()
            self.assertEqual(lines[0], "raysheaf (1.2.3) unstable; urgency=medium")
            self.assertRegex(lines[-1], rf"^ -- .* <.*>  Sun, 09 Sep 2001 01:46:{second} \+0000$")


if __name__ == "__main__":
    unittest.main()
