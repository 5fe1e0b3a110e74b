"""stage.py FOLDER: writes the pages of the repository to FOLDER in the layout that Sphinx expects.

The layout of docs/ does not change. The comment at the head of a header, which Doxygen ignores, is
placed before its reference. A file elsewhere in the repository that a page links to becomes a page,
too, `source/<its path>`: Markdown as it is, code as a code block, a folder as a list of its contents.
Links are adapted. Pages that no other page lists are appended to the index, and headers that the
reference does not list are appended to the reference. Unchanged pages are not written, so that Sphinx
does not read them again.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[2]
DOCS = PurePosixPath("docs")
CPP = DOCS / "api/cpp.md"
HEADER = "```{doxygenfile} "
# The public headers: the library's, and those of the libraries that link it.
HEADERS = {
    path.name: path
    for folder in ("include", "render/include", "scenes/include", "lab/include", "paper/include")
    for path in (ROOT / folder / "raysheaf").glob("*.h")
}
LINK = re.compile(r"(\]\()([^)\s]+)(\))")
LANGUAGES = {
    ".h": "cpp",
    ".cpp": "cpp",
    ".cu": "cpp",
    ".py": "python",
    ".cmake": "cmake",
    ".json": "json",
}
LONGEST = 2000  # the most lines of a file that are shown
TOCTREE = re.compile(r"```\{toctree\}\n(.*?)```", re.S)
MOST_ENTRIES = 25  # of the sidebar: the lists of the index


def normal(path: PurePosixPath) -> PurePosixPath:
    return PurePosixPath(os.path.normpath(path))


def is_in_docs(path: PurePosixPath) -> bool:
    """Whether the path stays the same: it is a page or an image."""
    return path.parts[:1] == DOCS.parts and path.suffix in (".md", ".svg", ".png", ".jpg")


def page_of(path: PurePosixPath) -> PurePosixPath:
    """The path of the page that shows a file of the repository."""
    if is_in_docs(path):
        return path.relative_to(DOCS)
    return PurePosixPath("source") / (path if path.suffix == ".md" else f"{path}.md")


def fenced(block: list[str]) -> list[str]:
    """Lines as a code block, of C++, or of text if they are a drawing."""
    language = "cpp" if all(line.isascii() for line in block) else "text"
    return [f"```{language}", *block, "```"]


def head_of(header: str) -> list[str]:
    """The comment at the head of a public header, as Markdown; lines that are indented are code."""
    lines: list[str] = [f"### raysheaf/{header}", ""]
    block: list[str] = []
    for line in HEADERS[header].read_text(encoding="utf-8").splitlines():
        if not line.startswith("//"):
            break
        text = line[2:].removeprefix(" ")
        if text.startswith("  "):
            block.append(text[2:])
            continue
        if block:
            lines += fenced(block)
            block = []
        lines.append(text)
    return [*lines, *(fenced(block) if block else []), ""]


def with_all_headers(text: str) -> str:
    """The C++ reference, with the public headers that it does not list appended."""
    forgotten = [name for name in sorted(HEADERS) if HEADER + name not in text.splitlines()]
    more = "".join(f"\n{HEADER}{name}\n```\n" for name in forgotten)
    return text + ("\n## More\n" + more if more else "")


def listed(text: str) -> list[str]:
    """The pages that a page's toctrees list."""
    lines = "".join(TOCTREE.findall(text)).split("\n")
    return [line for line in lines if line and not line.startswith(":")]


class Stage:
    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.written: set[Path] = set()
        self.waiting: list[PurePosixPath] = []

    def write(self, page: PurePosixPath, content: bytes) -> None:
        path = self.folder / page
        self.written.add(path)
        if not path.exists() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    def turned(self, path: PurePosixPath, link: str) -> str:
        """A link in the file `path`, adapted to its page; its target becomes a page, too."""
        target, mark, anchor = link.partition("#")
        if not target or "://" in link or link.startswith("mailto:"):
            return link
        found = normal(path.parent / target)
        if not (ROOT / found).exists():
            return link  # Sphinx reports it
        if not is_in_docs(found):
            self.waiting.append(found)
        up = os.path.relpath(page_of(found), page_of(path).parent)
        return up + mark + anchor

    def markdown(self, path: PurePosixPath) -> None:
        lines, fenced = [], False
        text = (ROOT / path).read_text(encoding="utf-8")
        for line in (with_all_headers(text) if path == CPP else text).splitlines():
            if line.startswith(HEADER) and not fenced:
                lines += head_of(line.removeprefix(HEADER))
            if line.startswith("```"):
                if fenced and lines[-1] == "":  # which ends a doctest
                    lines.pop()
                fenced = not fenced
            elif not fenced:
                line = LINK.sub(lambda m: m[1] + self.turned(path, m[2]) + m[3], line)
            lines.append(line)
        if not is_in_docs(path):
            lines = ["---", "orphan: true", "---", *lines]
        self.write(page_of(path), ("\n".join(lines) + "\n").encode())

    def add_forgotten(self) -> None:
        """Gives pages that no other page lists a list of their own, at the end of the index."""
        index = self.folder / "index.md"
        text = index.read_text(encoding="utf-8")
        sidebar = listed(text)
        if len(sidebar) > MOST_ENTRIES:
            sys.exit(f"docs/index.md lists {len(sidebar)} pages, more than {MOST_ENTRIES}")
        texts = [page.read_text(encoding="utf-8") for page in self.folder.glob("*.md")]
        named = {"index"}.union(*(listed(page) for page in texts))
        pages = sorted(p for p in (ROOT / DOCS).rglob("*.md"))
        names = [p.relative_to(ROOT / DOCS).with_suffix("").as_posix() for p in pages]
        forgotten = [name for name in names if name not in named]
        if forgotten:
            fence = ["", "```{toctree}", ":caption: More", ":hidden:", "", *forgotten, "```", ""]
            self.write(PurePosixPath("index.md"), (text + "\n".join(fence)).encode())

    def code(self, path: PurePosixPath) -> None:
        text = (ROOT / path).read_text(encoding="utf-8")
        if text.count("\n") > LONGEST:
            text = "".join(text.splitlines(True)[:LONGEST]) + "...\n"
        language = LANGUAGES.get(path.suffix, "text")
        page = f"---\norphan: true\n---\n# {path.name}\n\n`{path}`\n\n````{language}\n{text}````\n"
        self.write(page_of(path), page.encode())

    def listing(self, path: PurePosixPath) -> None:
        names = sorted(
            p.name + "/" * p.is_dir() for p in (ROOT / path).iterdir() if p.name[0] not in "._"
        )
        rows = "\n".join(f"* `{name}`" for name in names)
        self.write(page_of(path), f"---\norphan: true\n---\n# {path}\n\n{rows}\n".encode())

    def run(self) -> None:
        for file in sorted((ROOT / DOCS).rglob("*")):
            path = PurePosixPath(file.relative_to(ROOT).as_posix())
            if path.suffix == ".md":
                self.markdown(path)
            elif is_in_docs(path):
                self.write(page_of(path), file.read_bytes())
        while self.waiting:
            path = self.waiting.pop()
            if self.folder / page_of(path) in self.written:
                continue
            kind = self.listing if (ROOT / path).is_dir() else self.code
            (self.markdown if path.suffix == ".md" else kind)(path)
        self.add_forgotten()
        for file in self.folder.rglob("*"):
            if file.is_file() and file not in self.written:
                file.unlink()


if __name__ == "__main__":
    Stage(Path(sys.argv[1])).run()
