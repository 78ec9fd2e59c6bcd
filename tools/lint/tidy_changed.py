#!/usr/bin/env python3
"""Runs clang-tidy over the C++ sources that a change touches, the largest change first.

  tools/lint/tidy_changed.py                     the change is found as tools/testing/test_changed.py finds it
  tools/lint/tidy_changed.py --base main         everything since the common ancestor with main
  tools/lint/tidy_changed.py --minutes 10        begins no file after 10 minutes, and prints how many it left out
  tools/lint/tidy_changed.py --list              only prints the files

Findings count in changed lines alone, those of headers where a changed source includes them.
Needs build/lint (cmake --preset lint). Status 1 if clang-tidy has findings, which it prints.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "testing"))
from test_changed import changed_lines, find_base, git  # noqa: E402: only now on the path

BUILD = "build/lint"
HUNK = re.compile(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@")


def sources(lines: dict[str, int], root: Path) -> list[str]:
    """The sources among changed files that still exist, most changed lines first."""
    there = [name for name in lines if name.endswith(".cpp") and (root / name).is_file()]
    return sorted(there, key=lambda name: (-lines[name], name))


def changed_ranges(diff: str) -> dict[str, list[list[int]]]:
    """First and last line of each piece of a file that a diff without context adds or changes."""
    ranges: dict[str, list[list[int]]] = {}
    name = ""
    for row in diff.splitlines():
        if row.startswith("+++ "):
            name = row.removeprefix("+++ b/")
        elif piece := HUNK.match(row):
            first, count = int(piece[1]), int(piece[2] or 1)
            if count > 0:
                ranges.setdefault(name, []).append([first, first + count - 1])
    return ranges


def line_filter(ranges: dict[str, list[list[int]]]) -> str:
    """The changed lines of sources and headers, as clang-tidy takes the lines whose findings count."""
    return json.dumps(
        [{"name": f"/{name}", "lines": pieces} for name, pieces in sorted(ranges.items()) if name.endswith((".cpp", ".hpp"))]
    )


def tidy(name: str, counted: str) -> str:
    """What clang-tidy finds in the counted files when it reads a source; empty if nothing."""
    command = ["clang-tidy", "--quiet", "-p", BUILD, f"--line-filter={counted}", name]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return ran.stdout if ran.returncode != 0 else ""


def check(names: list[str], minutes: float, counted: str) -> tuple[list[str], int]:
    """Findings of the files that could begin in time, and the number of the others."""
    deadline = time.monotonic() + minutes * 60
    left_out = 0
    findings = []

    def one(name: str) -> str | None:
        return tidy(name, counted) if time.monotonic() < deadline else None

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for found in pool.map(one, names):
            if found is None:
                left_out += 1
            elif found:
                findings.append(found)
    return findings, left_out


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", help="commit that the change is measured against")
    parser.add_argument("--minutes", type=float, default=30.0, help="begin no file after this time (30)")
    parser.add_argument("--list", action="store_true", help="only print the files")
    options = parser.parse_args()
    base, how = find_base(options.base)
    if base is None:
        print("tidy_changed: no commit to compare with")
        return 0
    lines = changed_lines(base)
    names = sources(lines, ROOT)
    if options.list:
        print("\n".join(names))
        return 0
    diff = git("diff", "--unified=0", "--no-renames", base) or ""
    findings, left_out = check(names, options.minutes, line_filter(changed_ranges(diff)))
    for found in findings:
        print(found)
    late = f", {left_out} left out for want of time" if left_out else ""
    print(f"tidy_changed: {len(names) - left_out} sources changed {how}{late}, {len(findings)} with findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
