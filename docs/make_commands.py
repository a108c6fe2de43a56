#!/usr/bin/python3
"""Writes docs/commands.md from the program's help.

make_commands.py PROGRAM            writes the help of the program, its subcommands and its topics below the marker in
                                    commands.md
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


def help_of(program, *word):
    """The lines that `program help WORD` prints."""
    # The width and the language of a terminal must not change the page.
    environment = {**os.environ, "LC_ALL": "C.UTF-8", "COLUMNS": "100"}
    done = subprocess.run([program, "help", *word], env=environment, capture_output=True, encoding="utf-8")
    if done.returncode != 0 or not done.stdout.strip():
        sys.exit(f"{program} help {' '.join(word)} failed with exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout.strip("\n").splitlines()


def names_below(heading, lines):
    """The names that the program lists below a heading."""
    if heading not in lines:
        sys.exit(f"the program's help has no line `{heading}`")
    names = []
    for line in lines[lines.index(heading) + 1:]:
        name = re.match(r"  ([a-z][a-z0-9-]*)(\s|$)", line)
        if name:
            names.append(name[1])
        elif not line.startswith(" "):
            break
    return names


def page(program, by_hand):
    """The whole page: what is written by hand, then a section for the program, each subcommand and each topic."""
    top = help_of(program)
    text = [by_hand.rstrip("\n"), "", MARKER, "", "## talus", "", "```", *top, "```"]
    for name in names_below("Subcommands:", top):
        text += ["", f"## talus {name}", "", "```", *help_of(program, name), "```"]
    for name in names_below("Topics:", top):
        text += ["", f"## talus help {name}", "", "```", *help_of(program, name), "```"]
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
