#!/usr/bin/python3
"""Writes docs/commands.md from what the program says of itself.

make_commands.py PROGRAM            writes the help of the program and of each subcommand below the marker in commands.md
make_commands.py --check PROGRAM    writes nothing; fails if commands.md is not what the program says now

The text above the marker is written by hand and is kept as it is.
"""
import os
import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parent / "commands.md"
MARKER = "<!-- The rest is written by docs/make_commands.py. Change the program's help, then run ./dev docs. -->"


def help_of(program, *subcommand):
    """The lines that `program subcommand --help` prints."""
    # A terminal's width and language must not change the page.
    environment = {**os.environ, "LC_ALL": "C.UTF-8"}
    environment.pop("COLUMNS", None)
    done = subprocess.run([program, *subcommand, "--help"], env=environment, capture_output=True, encoding="utf-8")
    if done.returncode != 0 or not done.stdout.strip():
        sys.exit(f"{program} {' '.join(subcommand)} --help failed with exit code {done.returncode}: {done.stderr.strip()}")
    return [line.rstrip() for line in done.stdout.strip("\n").splitlines()]


def subcommands(lines):
    """The names that the program lists below `Subcommands:`."""
    begin = next((i for i, line in enumerate(lines) if re.match(r"subcommands:$", line.strip(), re.IGNORECASE)), None)
    if begin is None:
        sys.exit("the program's help has no line `Subcommands:`")
    names = []
    for line in lines[begin + 1:]:
        name = re.match(r"  ([a-z][a-z0-9-]*)(\s|$)", line)
        if name:
            names.append(name[1])
        elif not line.startswith(" "):
            break
    return names


def page(program, by_hand):
    """The whole page: what is written by hand, then one section for the program and one for each subcommand."""
    top = help_of(program)
    names = subcommands(top)
    text = [by_hand.rstrip("\n"), "", MARKER, "", "## talus", "", "```", *top, "```"]
    for name in names:
        text += ["", f"## talus {name}", "", "```", *help_of(program, name), "```"]
    return "\n".join(text) + "\n"


def main(arguments):
    check = arguments[:1] == ["--check"]
    if len(arguments) != 1 + check:
        sys.exit(__doc__)
    old = PAGE.read_text(encoding="utf-8")
    by_hand, marker, _ = old.partition(MARKER)
    if not marker:
        sys.exit(f"{PAGE} lacks the line that ends the part written by hand:\n{MARKER}")
    new = page(os.path.abspath(arguments[-1]), by_hand)
    if not check:
        PAGE.write_text(new, encoding="utf-8")
        return 0
    if new == old:
        return 0
    was, now = old.splitlines(), new.splitlines()
    first = next((i for i, (a, b) in enumerate(zip(was, now)) if a != b), min(len(was), len(now)))
    print(f"docs/commands.md is stale from line {first + 1} on; run ./dev docs\n"
          f"  the page:    {was[first] if first < len(was) else '(ends)'}\n"
          f"  the program: {now[first] if first < len(now) else '(ends)'}")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
