#!/usr/bin/python3
"""Holds every #include to the folder rules of docs/architecture.md.

    app -> query, ingest -> engine, storage -> include/talus

and inside each of these to its rooms, which know only rooms below them. No room may grow beyond 30 files. And the
library never speaks the program's language: no option of the command line stands in a sentence of engine, storage,
query or ingest; it names fields, and app/terminal/fields.cpp translates them.

check_includes.py ROOT                  fails with file:line for each include that breaks a rule
check_includes.py --expect-marked ROOT  fails unless exactly the lines marked `// refused` do: the self test
"""
import re
import sys
from collections import Counter
from pathlib import Path

from marked_lines import report

FOLDERS = ["include", "engine", "storage", "query", "ingest", "app", "bindings"]
MOST_FILES = 30  # of a folder itself

# Which of our headers a file may see, by the folder that it is in. The engine and the storage know the words (units,
# failure, description, quadtree) but not the verbs; query and ingest do not know each other.
OURS = {
    "include": r"talus/",
    "engine": r"engine/|talus/(units|failure|array|description|quadtree|increment|progression|stream|strip|bitree)\.hpp",
    "storage": r"storage/|talus/(units|failure)\.hpp",
    "query": r"(query|engine|storage)/|talus/(?!ingest\.hpp|talus\.hpp)",
    "ingest": r"(ingest|engine|storage)/|talus/(?!database\.hpp|talus\.hpp)",
    "app": r"(app|query|ingest)/|talus/",
    "bindings": r"(query|ingest)/|talus/",
}

# The rooms, and which others of the same folder each may know. A folder's own files stand above its rooms, unless the room
# is named with them: "query" below.
ROOMS = {
    "engine/machine": "",
    "engine/geo": "machine",
    "engine/quadtree": "machine",
    "engine/error": "machine geo quadtree",
    "engine/dense": "machine",
    "engine/page": "machine geo quadtree error dense",
    "engine/tile": "machine geo quadtree error page",
    "engine/stream": "machine geo quadtree page",
    "engine/strip": "machine quadtree page stream",
    "engine/bitree": "machine quadtree error",
    "query/pages": "",
    "query/selection": "pages",
    "query/surface": "pages selection",
    "query/bounded": "pages selection",
    "query/export": "",
    "query/rasters": "export",
    "query/accuracy": "pages",
    "query/verify": "pages selection accuracy .",
    "ingest/files": "",
    "ingest/raster": "files",
    "ingest/mosaic": "files raster",
    "ingest/job": "files raster mosaic",
    "app/terminal": "",
    "app/files": "terminal",
    "app/options": "terminal files",
    "app/accuracy": "terminal",
    "app/commands": "terminal files options accuracy",
}

# What of others is let in, and where. Headers not named here are let in nowhere but in the standard library.
GDAL = r"(gdal|ogr|cpl|vrt)[a-z0-9_]*\.h"
THEIRS = [
    ("GDAL", GDAL, r"ingest/|query/rasters/", "ingest/ and query/rasters/"),
    ("LMDB", r"lmdb\.h", r"storage/[^/]*\.cpp$", "storage/*.cpp"),
    ("xxHash", r"xxh(ash|3)\.h", r"(storage/[^/]*|engine/stream/stream_bytes|engine/page/digest)\.cpp$",
     "storage/*.cpp, engine/stream/stream_bytes.cpp and engine/page/digest.cpp"),
    ("GeographicLib", r"GeographicLib/", r"engine/geo/", "engine/geo/"),
    ("zstd", r"(zstd|zdict)\w*\.h", r"engine/", "engine/"),
    ("JSON", r"nlohmann/", r"(engine|app|query/export)/", "engine/, app/ and query/export/"),
    ("CLI11", r"CLI/", r"app/", "app/"),
    ("fmt", r"fmt/", r"(engine|storage|query|ingest|app)/", "our sources, not the public headers"),
]

# The engine is functions over memory: no file, clock or thread. One header may speak to the system, of memory; one runs
# a function on several threads, and whoever calls it waits.
NOT_IN_ENGINE = r"(chrono|condition_variable|ctime|filesystem|fstream|future|iostream|mutex|thread|unistd\.h|sys/.*)$"

STANDARD = re.compile(r"[a-z_]+$|(sys/)?[a-z]+\.h$")  # <vector>, and POSIX: <fcntl.h>, <sys/stat.h>
INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')


def objection(file, quote, header):
    """The rule that `#include header` in `file` breaks, or None. `file` is relative to the root."""
    for name, pattern, places, where in THEIRS:
        if re.match(pattern, header):
            return None if re.match(places, file) else f"{name} belongs in {where} only"
    if quote == '"':
        folder = file.split("/")[0]
        if re.match(OURS[folder], header):
            return objection_of_rooms(file, header)
        if not re.match(r"(app|query|ingest|engine|storage|bindings|talus)/", header):
            return "say our headers from the root: \"engine/quadtree/grid.hpp\", \"talus/units.hpp\""
        return f"{folder} does not know {header}"
    if (file, header) in {("engine/machine/large_memory.hpp", "sys/mman.h"), ("engine/machine/parallel.hpp", "thread"),
                          ("engine/machine/parallel.hpp", "mutex")}:
        return None
    if file.startswith("engine/") and re.match(NOT_IN_ENGINE, header):
        return "the engine has no files, clocks or threads"
    if not STANDARD.match(header):
        return "a third party the rules do not know: see THEIRS in tests/check_includes.py"
    return None


def objection_of_rooms(file, header):
    """The same between the rooms of one folder."""
    room, other = (name.rsplit("/", 1)[0] for name in (file, header))
    folder = room.split("/")[0]
    if other.split("/")[0] != folder or room == other or room == folder:
        return None
    if room not in ROOMS:
        return f"{room} is a room that the rules do not know: see ROOMS in tests/check_includes.py"
    allowed = ROOMS[room].split()
    name = "." if other == folder else other.split("/", 1)[1]
    return None if name in allowed else f"{room} does not know {other}"


OPTION = re.compile(r'"(?:[^"\\\\]|\\\\.)*?(?<![\\w-])--[a-z][a-z-]+')


def speaks_of_an_option(name, line):
    """A string of the library that names an option. gdalinfo is another program."""
    if name.split("/")[0] not in ("engine", "storage", "query", "ingest", "include") or line.lstrip().startswith("//"):
        return False
    found = OPTION.search(line)
    return found is not None and "gdalinfo" not in line


def findings(root):
    """Pairs of (file:line, sentence), and the places marked `// refused`."""
    broken, marked, files, rooms = {}, set(), 0, Counter()
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[chi][pn][pc]")):
            files += 1
            name = path.relative_to(root).as_posix()
            rooms[name.rsplit("/", 1)[0]] += 1
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                place = f"{name}:{number}"
                if line.rstrip().endswith("// refused"):
                    marked.add(place)
                if speaks_of_an_option(name, line):
                    broken[place] = f"{place}: {line.strip()}\n    the library names fields of its options, not those of the program"
                include = INCLUDE.match(line)
                if not include:
                    continue
                rule = objection(name, *include.groups())
                if rule:
                    broken[place] = f"{place}: {line.strip()}\n    {rule}"
        if (root / folder / "CROWDED").exists():  # the self test's word for a room that must be refused
            marked.add(folder)
    for room, count in rooms.items():
        if count > MOST_FILES:
            broken[room] = f"{room}: {count} files of its own, more than {MOST_FILES}: it needs rooms"
    return broken, marked, files


if __name__ == "__main__":
    sys.exit(report(sys.argv[1:], __doc__, findings, "rules"))
