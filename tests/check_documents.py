#!/usr/bin/python3
"""Holds every path and link in our documents to what exists.

check_documents.py ROOT                  fails with file:line for each link or path that leads nowhere
check_documents.py --expect-marked ROOT  fails unless exactly the lines marked `<!-- refused -->` do: the self test

A link is [text](target). A path is a word in backticks or in a block of code that begins with a folder of ours. It may
leave out its ending: `engine/quadtree/grid` stands for grid.hpp, grid.cpp or the folder. In a name, * and WORDS IN
CAPITALS stand for anything. Test names may begin below tests/, public headers below include/.

The table of rooms in docs/architecture.md must be ROOMS of check_includes.py.
"""
import re
import sys
from pathlib import Path

from marked_lines import report

from check_includes import ROOMS

# The first folder of a path, and where it lies.
OURS = {name: name for name in ("engine", "storage", "query", "ingest", "app", "include", "tests", "bench", "cmake", "docs",
                                ".ci")}
OURS |= {name: f"tests/{name}" for name in ("property", "hard", "cli", "golden", "reports", "support", "fuzz", "soak")}
OURS |= {"talus": "include/talus"}
ENDINGS = ("", ".hpp", ".cpp", ".inc", ".py", ".sh", "_test.cpp")

DOCUMENTS = ("*.md", "docs/**/*.md", "tests/**/*.md", "bench/**/*.md")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
SPAN = re.compile(r"`([^`]+)`")
WORD = re.compile(r"^[\w.*-]+(/[\w.*-]+)*/?$")


def slug(heading):
    """The anchor that a heading gets on a page: lower case, blanks are dashes, no punctuation."""
    plain = re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def anchors(page):
    return {slug(line.lstrip("#")) for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("#")}


def objection_to_link(document, target):
    """What is wrong with a link's target, or None."""
    if re.match(r"[a-z]+:", target):
        return None
    name, _, anchor = target.partition("#")
    page = (document.parent / name).resolve() if name else document
    if not page.exists():
        return f"the link leads to {name}, which does not exist"
    if anchor and page.suffix == ".md" and anchor not in anchors(page):
        return f"{page.name} has no heading for #{anchor}"
    return None


def objection_to_word(root, word):
    """What is wrong with a word that may be a path of ours, or None."""
    word = re.sub(r"(:\d+)?[.,;:)]*$", "", word.lstrip("("))
    first = word.split("/")[0]
    if "/" not in word or first not in OURS or not WORD.match(word):
        return None
    # WHAT in tests/soak/WHAT.sh stands for anything.
    pattern = "/".join(re.sub(r"\b[A-Z]{3,}\b", "*", part) if part != "README.md" else part
                       for part in word.rstrip("/").split("/"))
    below = OURS[first] + pattern[len(first):]
    # engine/border_test is a test, though engine/ is a folder of sources, too.
    for place in (below, f"tests/{pattern}"):
        for ending in ENDINGS:
            if any(root.glob(place + ending)):
                return None
    return f"{word} does not exist"


def objections_to_rooms(page):
    """Where the table of rooms on a page differs from ROOMS."""
    row = re.compile(r"\| `([a-z]+/[a-z]+)` \| ([^|]*) \|")
    shown = {row.match(line)[1]: " ".join(SPAN.findall(row.match(line)[2]))
             for line in page.read_text(encoding="utf-8").splitlines() if row.match(line)}
    return [f"room {room}: the page says '{shown.get(room)}', tests/check_includes.py says '{ROOMS.get(room)}'"
            for room in sorted(shown.keys() | ROOMS.keys()) if shown.get(room) != ROOMS.get(room)]


def findings(root):
    """Pairs of (file:line, sentence), the places marked `<!-- refused -->`, and the number of documents."""
    broken, marked = {}, set()
    documents = sorted({path for pattern in DOCUMENTS for path in root.glob(pattern) if "documents_bad" not in path.parts
                        or "documents_bad" in root.parts})
    for document in documents:
        text, in_code = [], False  # text: the lines outside blocks of code
        for number, line in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
            place = f"{document.relative_to(root)}:{number}"
            if line.rstrip().endswith("<!-- refused -->"):
                marked.add(place)
            fence = line.lstrip().startswith("```")
            in_code ^= fence
            text.append("" if in_code or fence else line)
            for span in [line] if in_code else SPAN.findall(line):
                for objection in filter(None, (objection_to_word(root, word) for word in span.split())):
                    broken[place] = f"{place}: {objection}"
        text = "\n".join(text)
        for link in LINK.finditer(text):  # a link's words may go over the end of a line
            objection = objection_to_link(document, link[1])
            if objection:
                place = f"{document.relative_to(root)}:{text.count(chr(10), 0, link.start(1)) + 1}"
                broken[place] = f"{place}: {objection}"
    architecture = root / "docs/architecture.md"
    if architecture.exists():
        for objection in objections_to_rooms(architecture):
            broken[objection] = f"docs/architecture.md: {objection}"
    return broken, marked, len(documents)


if __name__ == "__main__":
    sys.exit(report(sys.argv[1:], __doc__, findings, "paths and links"))
