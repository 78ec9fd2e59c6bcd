#!/usr/bin/env python3
"""Checks that lines of all Markdown files have at most 100 characters.

  tools/lint/line_width.py     prints one line for each that is longer; status 1 if there is one

Left alone: code blocks, tables, and lines that are one word, such as an address.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MOST = 100
FENCE = re.compile(r"\s*```")
CODE_OR_TABLE = re.compile(r"    .*|\s*\|.*")


def problems(name: str, text: str) -> list[str]:
    wrong = []
    in_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            in_code = not in_code
        one_word = " " not in line.strip().removeprefix("- ").removeprefix("> ")
        if len(line) > MOST and not in_code and not one_word and not CODE_OR_TABLE.fullmatch(line):
            wrong.append(f"{name}:{number}: {len(line)} characters, at most {MOST}")
    return wrong


def main() -> int:
    names = subprocess.run(
        ["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    wrong = [line for name in names for line in problems(name, (ROOT / name).read_text())]
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
