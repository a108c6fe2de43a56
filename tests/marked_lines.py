"""What checks of sources and documents share: findings are reported, or held against marks as a self test."""
import sys
from pathlib import Path


def report(arguments, manual, findings, what):
    """Runs findings(root), which gives {place: sentence}, the marked places, and how many files were read."""
    expect_marked = arguments[:1] == ["--expect-marked"]
    if len(arguments) != 1 + expect_marked:
        sys.exit(manual)
    broken, marked, files = findings(Path(arguments[-1]).resolve())
    if files == 0:
        sys.exit(f"{arguments[-1]}: nothing here to check")
    if expect_marked:
        wrong = sorted(marked ^ broken.keys())
        for place in wrong:
            print(f"{place}: {'should have been refused' if place in marked else 'should have been let in'}")
        print(f"{len(marked)} marked {what}, {len(wrong)} of them misjudged")
        return 1 if wrong or not marked else 0
    for sentence in broken.values():
        print(sentence)
    print(f"{files} files, {len(broken)} broken {what}")
    return 1 if broken else 0
