#!/usr/bin/env python3
"""Checks the subjects of the commits of a change: `<library>: <what now holds>`, at most 72 characters.

  tools/lint/commit_subjects.py [BASE]     commits since BASE; without it those since this rule holds, of the last
                                           24 hours

Merge commits keep the words of git. Status 1 if a subject is wrong; each is printed with what is wrong.
"""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 72


def wrong_with(subject: str) -> str | None:
    """What is wrong with a subject; None if it is right."""
    if len(subject) > LONGEST:
        return f"{len(subject)} characters, at most {LONGEST}"
    name, colon, holds = subject.partition(": ")
    if not colon or not name.strip() or not holds.strip():
        return "not of the form `<library>: <what now holds>`"
    return None


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def subjects(base: str | None) -> list[str]:
    """Short hash and subject of each commit that is checked."""
    since = [f"{base}..HEAD"]
    if base is None:
        began = git("log", "--diff-filter=A", "--format=%H", "--", "tools/lint/commit_subjects.py").split()
        since = [f"{began[0]}..HEAD" if began else "HEAD", "--since=24 hours ago"]
    return git("log", "--no-merges", "--format=%h %s", *since).splitlines()


def main(arguments: list[str]) -> int:
    status = 0
    for line in subjects(arguments[0] if arguments else None):
        commit, _, subject = line.partition(" ")
        if problem := wrong_with(subject):
            print(f"lint: commit {commit}: {problem}: {subject}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
