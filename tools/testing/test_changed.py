#!/usr/bin/env python3
"""Runs the unit tests of the libraries that a change touches, the lowest library first.

  tools/testing/test_changed.py --preset asan               the change is found by itself
  tools/testing/test_changed.py --preset tsan --base main   everything since the common ancestor with main
  tools/testing/test_changed.py --list                      only prints the libraries and their test programs

Builds the test programs of one library, runs them, and goes on with the next: what a library is
built on is there when its turn comes. It begins no library after --minutes, ends a build after half
as long again, and prints which libraries it left out.
Without --base the change is, whichever is there first: a merge commit against its first parent, the
branch against origin/main or main, or the last 24 hours before the newest commit.
"""

import argparse
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BRANCHES = ("origin/main", "origin/HEAD", "main")
DAY_S = 24 * 3600
WITHOUT_BASE = ("libs/skill", "libs/motion")
LEFT_OUT_LABELS = "fuzz|slow_under_sanitizers"
# Latest end of a build, as a share of the time in which libraries may begin.
LATEST_END = 1.5


@dataclass(frozen=True)
class Library:
    """A folder with test programs, and how many lines of it changed."""

    folder: str
    programs: tuple[str, ...]
    lines: int


# ---- which change ----


def git(*arguments: str) -> str | None:
    """What git prints, or None if it fails."""
    ran = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return ran.stdout.strip() if ran.returncode == 0 else None


def find_base(asked: str | None) -> tuple[str | None, str]:
    """The commit that the change is measured against, and how that was chosen."""
    if asked is not None:
        common = git("merge-base", asked, "HEAD") or git("rev-parse", "--verify", asked + "^{commit}")
        return common, f"since {asked}"
    if git("rev-parse", "--verify", "HEAD^2^{commit}"):
        first = git("rev-parse", "--verify", "HEAD^1^{commit}")
        if first:
            return first, "of the merge commit"
    head = git("rev-parse", "HEAD")
    for branch in BRANCHES:
        common = git("merge-base", branch, "HEAD")
        if common and common != head:
            return common, f"since {branch}"
    return before_last_day(), "of the last 24 hours"


def before_last_day() -> str | None:
    """The newest commit a day older than HEAD, or the oldest that a shallow clone has; None if that is HEAD."""
    newest = git("log", "-1", "--format=%ct", "HEAD")
    if newest is None:
        return None
    before = git("rev-list", "-1", "--first-parent", f"--before={int(newest) - DAY_S}", "HEAD")
    if before:
        return before
    known = (git("rev-list", "--first-parent", "HEAD") or "").split()
    return known[-1] if len(known) > 1 else None


def changed_lines(base: str) -> dict[str, int]:
    """Lines added and removed per file, also those that are not committed yet."""
    lines: dict[str, int] = {}
    for row in (git("diff", "--numstat", "--no-renames", base) or "").splitlines():
        added, removed, path = row.split("\t", 2)
        lines[path] = sum(int(count) for count in (added, removed) if count.isdigit())
    return lines


# ---- which libraries ----


def test_folders() -> dict[str, tuple[str, ...]]:
    """Every folder of a library or virtual controller that has test programs, with these."""
    found = {}
    for pattern in ("libs/*/CMakeLists.txt", "libs/drivers/*/CMakeLists.txt", "virtual/*/CMakeLists.txt"):
        for lists in ROOT.glob(pattern):
            folder = lists.parent
            texts = [path.read_text() for path in sorted(folder.rglob("CMakeLists.txt"))]
            programs = tuple(name for text in texts for name in re.findall(r"metier_add_test\((\w+)", text))
            if programs:
                found[str(folder.relative_to(ROOT))] = programs
    return found


def height(folder: str) -> int:
    """Its place in the root's CMakeLists.txt, where the lowest library is the first."""
    text = (ROOT / "CMakeLists.txt").read_text()
    at = text.find(f"add_subdirectory({folder})")
    return at if at >= 0 else text.find("add_subdirectory(${device_folder})")


def touched(lines: dict[str, int]) -> list[Library]:
    """The libraries of these files, the lowest first."""
    folders = test_folders()
    counts: dict[str, int] = {}
    for path, count in lines.items():
        parts = path.split("/")
        for depth in (3, 2):
            folder = "/".join(parts[:depth])
            if folder in folders:
                counts[folder] = counts.get(folder, 0) + count
                break
    ordered = sorted(counts, key=lambda folder: (height(folder), folder))
    return [Library(folder, folders[folder], counts[folder]) for folder in ordered]


def libraries_of_change(asked: str | None) -> list[Library]:
    base, how = find_base(asked)
    if base is None and asked is not None:
        raise SystemExit(f"test: there is no commit {asked}")
    if base is None:
        print("test: this clone holds one commit: nothing to compare with. A fixed set is tested.")
        folders = test_folders()
        return [Library(folder, folders[folder], 0) for folder in WITHOUT_BASE]
    libraries = touched(changed_lines(base))
    print(f"test: the change {how} ({base[:10]}) touches {len(libraries)} libraries with tests")
    return libraries


# ---- builds and runs ----


class Budget:
    """Time from now on [s]: for beginning libraries, and for ending what has begun."""

    def __init__(self, minutes: float):
        self._begin = time.monotonic()
        self._seconds = 60 * minutes

    def may_begin(self) -> bool:
        return time.monotonic() - self._begin < self._seconds

    def left(self) -> float:
        return max(1.0, LATEST_END * self._seconds - (time.monotonic() - self._begin))


def environment_of(preset: str) -> dict[str, str]:
    """The environment of its tests in CMakePresets.json: what the sanitizer is to leave out, for example."""
    presets = json.loads((ROOT / "CMakePresets.json").read_text())["testPresets"]
    [found] = [entry.get("environment", {}) for entry in presets if entry["name"] == preset]
    return {name: value.replace("${sourceDir}", str(ROOT)) for name, value in found.items()}


def call(command: list[str], seconds: float, environment: dict[str, str] | None = None) -> int | None:
    """Its exit status; None if it was ended because the time was over."""
    process = subprocess.Popen(command, cwd=ROOT, start_new_session=True, env={**os.environ, **(environment or {})})
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def test(library: Library, preset: str, jobs: int, budget: Budget) -> int | None:
    """Builds and runs its tests: 0 if they pass; None if the time was over before."""
    print(f"test: {preset}: {library.folder}", flush=True)
    built = call(["cmake", "--build", "--preset", preset, "--target", *library.programs], budget.left())
    if built != 0:
        return built
    return call(
        ["ctest", "--test-dir", f"build/{preset}/{library.folder}", "--output-on-failure", "--no-tests=error"]
        + ["-j", str(jobs), "-LE", LEFT_OUT_LABELS],
        budget.left(),
        environment_of(preset),
    )


def run(libraries: list[Library], preset: str, jobs: int, minutes: float) -> int:
    """0 if all tests that were run pass."""
    if not libraries:
        return 0
    subprocess.run(["cmake", "--preset", preset], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    budget = Budget(minutes)
    passed, failed, left_out = [], [], []
    for library in libraries:
        status = test(library, preset, jobs, budget) if budget.may_begin() else None
        (left_out if status is None else failed if status else passed).append(library.folder)
    print(f"test: {preset}: passed: {', '.join(passed) or 'none'}")
    if left_out:
        print(f"test: {preset}: left out, as {minutes:g} minutes were over: {', '.join(left_out)}")
    if failed:
        print(f"test: {preset}: FAILED: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", help="a commit or branch; default: found as said above")
    parser.add_argument("--preset", default="dev", help="of CMakePresets.json (default: dev)")
    parser.add_argument("--minutes", type=float, default=60.0, help="begins no library after that time")
    parser.add_argument("--jobs", type=int, default=2, help="tests at a time")
    parser.add_argument("--list", action="store_true", help="only prints the libraries")
    options = parser.parse_args()
    libraries = libraries_of_change(options.base)
    for library in libraries:
        print(f"  {library.lines:6} lines  {library.folder}: {' '.join(library.programs)}")
    return 0 if options.list else run(libraries, options.preset, options.jobs, options.minutes)


if __name__ == "__main__":
    raise SystemExit(main())
