#!/usr/bin/env python3
"""Compares how much of the public headers is comment with the least share that they must have.

  tools/lint/comment_share.py            status 1 if the share of all public headers is too small
  tools/lint/comment_share.py --all      prints the share of each library, smallest first
  tools/lint/comment_share.py --headers  prints the share of each header, smallest first

Counted are lines of headers in include/ of libs, libs/drivers and virtual that are not empty, without `#include`
and `#pragma`. A line with code and a comment counts half for each: it says the unit or meaning of one value.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LEAST = 0.50
LIBRARY = re.compile(r"((?:libs/drivers|libs|virtual)/[^/]+)/include/.+\.hpp")


def lines_of(text: str) -> tuple[float, float]:
    """Lines of comment, and all lines that count."""
    comments = total = 0.0
    for line in (line.strip() for line in text.splitlines()):
        if not line or line.startswith(("#include", "#pragma")):
            continue
        total += 1
        if line.startswith(("//", "/*", "*")):
            comments += 1
        elif "//" in line:
            comments += 0.5
    return comments, total


def headers(root: Path) -> dict[str, tuple[float, float]]:
    """Lines of comment and all lines of each public header."""
    listed = subprocess.run(["git", "ls-files", "*.hpp"], cwd=root, capture_output=True, text=True, check=True)
    return {
        path: lines_of((root / path).read_text())
        for path in listed.stdout.splitlines()
        if LIBRARY.fullmatch(path) and (root / path).is_file()
    }


def shares(root: Path) -> dict[str, tuple[float, float]]:
    """Lines of comment and all lines of each library's public headers."""
    counted: dict[str, tuple[float, float]] = {}
    for path, (comments, total) in headers(root).items():
        library = LIBRARY.fullmatch(path)[1]
        before = counted.get(library, (0.0, 0.0))
        counted[library] = (before[0] + comments, before[1] + total)
    return counted


def show(counted: dict[str, tuple[float, float]]) -> None:
    """Prints a share for each name, smallest first."""
    for name, (own, lines) in sorted(counted.items(), key=lambda item: item[1][0] / max(item[1][1], 1)):
        print(f"{own / max(lines, 1):6.1%} of {lines:5.0f}  {name}")


def main(arguments: list[str]) -> int:
    counted = shares(ROOT)
    comments, total = (sum(values) for values in zip(*counted.values()))
    if "--headers" in arguments:
        show(headers(ROOT))
    if "--all" in arguments:
        show(counted)
        print(f"{comments / total:6.1%} of {total:5.0f}  together")
    if comments < LEAST * total:
        print(
            f"lint: {comments / total:.1%} of the lines of public headers are comments, at least {LEAST:.0%} must be: say units, "
            "frames, ranges, errors and threads (tools/lint/comment_share.py --headers shows where)",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
