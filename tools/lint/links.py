#!/usr/bin/env python3
"""Checks the relative links of all Markdown files.

  tools/lint/links.py     prints one line for each link that leads nowhere; status 1 if there is one

Checked: the file or folder exists, and a Markdown file has a heading for the part behind #. Code blocks and addresses
of the web are left alone.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
ELSEWHERE = re.compile(r"^[a-z]+:")


def text(file: Path) -> str:
    return CODE.sub("", file.read_text())


def anchor(heading: str) -> str:
    """The part behind # by which web views of Markdown lead to a heading."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def problems(root: Path, files: list[str]) -> list[str]:
    wrong = []
    for name in files:
        for link in LINK.findall(text(root / name)):
            if ELSEWHERE.match(link):
                continue
            path, _, part = link.partition("#")
            target = (root / name).parent / path if path else root / name
            if not target.exists():
                wrong.append(f"{name}: {link}: no such file")
            elif part and target.suffix == ".md" and part not in map(anchor, HEADING.findall(text(target))):
                wrong.append(f"{name}: {link}: no such heading")
    return wrong


def main() -> int:
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = problems(ROOT, listed.stdout.split())
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
