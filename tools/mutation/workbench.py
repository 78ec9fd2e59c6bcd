"""Builds in which mutants are compiled and tested: the object of a mutant is linked before its library."""

import hashlib
import json
import os
import re
import shlex
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from libraries import Library

CAUGHT, SURVIVED, REFUSED, EQUIVALENT = "caught", "survived", "does not compile", "equivalent"
BUILD_TIMEOUT_S = 1800
FLAKY_REPEATS = 2
SLOW_TEST_MS = 500
FAIL_FAST = {"GTEST_FAIL_FAST": "1", "TSAN_OPTIONS": "halt_on_error=1 exitcode=66"}


@dataclass
class Outcome:
    result: str
    why: str = ""


class Workbench:
    """Works in the builds of `tree`: of `root` itself, or of a git worktree at the commit that `root` has checked out."""

    def __init__(self, root: Path, tree: Path, jobs: int):
        self.root, self.tree, self.jobs = root, tree.resolve(), jobs
        self._times: dict[tuple[str, str], float] = {}
        self._slow: dict[tuple[str, str], list[str]] = {}
        self._compilations: dict[str, dict[str, str]] = {}
        self._scratch = tempfile.TemporaryDirectory(prefix="mutant")

    def check_out(self) -> str:
        """Brings the tree, unless it is `root`, to the commit of `root`, which is returned."""
        commit = self._git(self.root, "rev-parse", "HEAD")
        if self.tree == self.root:
            return commit
        if not (self.tree / ".git").exists():
            self.tree.parent.mkdir(parents=True, exist_ok=True)
            self._git(self.root, "worktree", "add", "--force", "--detach", str(self.tree), commit)
        self._git(self.tree, "checkout", "--quiet", "--force", "--detach", commit)
        self._link_packages()
        return commit

    @staticmethod
    def _git(folder: Path, *arguments: str) -> str:
        ran = subprocess.run(["git", "-C", str(folder), *arguments], check=True, capture_output=True, text=True)
        return ran.stdout.strip()

    def _link_packages(self) -> None:
        """What scripts/setup has installed beside the sources is not in git."""
        for packages in self.root.glob("*/node_modules"):
            link = self.tree / packages.relative_to(self.root)
            if not link.exists():
                link.symlink_to(packages.resolve())

    def _folder(self, preset: str) -> Path:
        return self.tree / "build" / preset

    # ---- builds ----

    def prepare(self, preset: str, program: str) -> None:
        """Builds a program of the sources as they are, and measures how long it takes; once."""
        if (preset, program) in self._times:
            return
        if not (self._folder(preset) / "build.ninja").exists():
            subprocess.run(["cmake", "--preset", preset], cwd=self.tree, check=True, stdout=subprocess.DEVNULL)
        ran = _run(["ninja", "-C", str(self._folder(preset)), f"-j{self.jobs}", program], BUILD_TIMEOUT_S)
        if ran.status != 0:
            raise SystemExit(f"mutate: {preset}: {program} does not build:\n{ran.output[-3000:]}")
        self._time(preset, program)

    def _time(self, preset: str, program: str) -> None:
        """Runs all its tests; one that fails must pass when it is repeated alone."""
        path = self._program(preset, program)
        begin = time.monotonic()
        ran = self._run_program(preset, path, "*", {})
        self._times[preset, program] = time.monotonic() - begin
        self._slow[preset, program] = slow_tests(ran.output)
        failed = failed_tests(ran.output)
        if ran.status is None or (ran.status != 0 and not failed):
            raise SystemExit(f"mutate: {preset}: {program} does not end well without any change")
        for test in failed:
            if self._fails_again(preset, path, test):
                raise SystemExit(f"mutate: {preset}: {program} fails without any change: {test}")

    def compile(self, preset: str, source: str, text: str) -> Path | None:
        """The object that this text of a source file becomes; None if the compiler refuses it."""
        place, scratch = self.tree / source, Path(self._scratch.name)
        code, made = scratch / place.name, scratch / (place.name + ".o")
        code.write_text(text)
        command = shlex.split(self._compilation(preset, source))
        command[command.index("-o") + 1] = str(made)
        command[command.index("-c") + 1] = str(code)
        command += ["-iquote", str(place.parent), f"-fmacro-prefix-map={scratch}={place.parent}"]
        ran = _run(command, BUILD_TIMEOUT_S, {"CCACHE_DISABLE": "1"}, self._folder(preset))
        return made if ran.status == 0 else None

    def _compilation(self, preset: str, source: str) -> str:
        if preset not in self._compilations:
            entries = json.loads((self._folder(preset) / "compile_commands.json").read_text())
            self._compilations[preset] = {entry["file"]: entry["command"] for entry in entries}
        return self._compilations[preset][str(self.tree / source)]

    def is_as_before(self, preset: str, library: Library, source: str, made: Path) -> bool:
        """Whether the machine code of the object is that of the source file as it is."""
        before = self._folder(preset) / library.object_of(source)
        return self._digest(made) == self._digest(before)

    def _digest(self, made: Path) -> str:
        """Digest of an object without what only names lines."""
        bare = Path(self._scratch.name) / "bare.o"
        subprocess.run(["objcopy", "--strip-debug", str(made), str(bare)], check=True)
        return hashlib.sha256(bare.read_bytes()).hexdigest()

    def link(self, preset: str, library: Library, program: str, made: Path) -> Path:
        """The program with the object in place of that in the library, from which it is not taken any more."""
        target = self._program(preset, program).relative_to(self._folder(preset))
        ran = _run(["ninja", "-C", str(self._folder(preset)), "-t", "commands", "-s", str(target)], BUILD_TIMEOUT_S)
        linked = Path(self._scratch.name) / program
        command = link_command(ran.output, str(target), f"lib{library.target}.a", str(made), str(linked))
        ran = _run(command, BUILD_TIMEOUT_S, {}, self._folder(preset))
        if ran.status != 0:
            raise SystemExit(f"mutate: {program} does not link:\n{ran.output[-3000:]}")
        return linked

    def _program(self, preset: str, name: str) -> Path:
        """Where the program of the sources as they are is."""
        folders = [self._folder(preset) / folder for folder in ("libs", "virtual")]
        [path] = [path for folder in folders for path in folder.rglob(name) if path.is_file()]
        return path

    # ---- tests ----

    def run_tests(self, preset: str, linked: Path) -> str | None:
        """Runs a test program up to its first failure that shows again; that, or None. Slow tests come last."""
        slow = self._slow.get((preset, linked.name), [])
        if failed := self._first_failure(preset, linked, ["*"], slow):
            return failed
        return self._first_failure(preset, linked, slow, []) if slow else None

    def _first_failure(self, preset: str, linked: Path, tests: list[str], left_out: list[str]) -> str | None:
        leave_out = list(left_out)
        for _ in range(4):
            all_but_these = gtest_filter(tests, leave_out)
            ran = self._run_program(preset, linked, all_but_these)
            if ran.status == 0:
                return None
            test = _failed_test(ran.output)
            if ran.status is None:
                return f"{linked.name}: {test or 'no test'} does not end"
            again = test is not None and self._fails_again(preset, linked, test)
            if test is None or (not again and ran.status < 0):  # a test before it may have caused the crash
                again = self._fails_again(preset, linked, all_but_these)
            if again:
                return f"{linked.name}: {test or 'status ' + str(ran.status)}"
            leave_out += [test] if test else []
        return None

    def _fails_again(self, preset: str, linked: Path, tests: str) -> bool:
        return all(self._run_program(preset, linked, tests).status != 0 for _ in range(FLAKY_REPEATS))

    def _run_program(self, preset: str, path: Path, tests: str, environment: dict[str, str] = FAIL_FAST) -> "Ran":
        timeout = 60 + 4 * self._times.get((preset, path.name), 600)
        return _run([str(path), f"--gtest_filter={tests}"], timeout, environment, path.parent)


@dataclass
class Ran:
    status: int | None  # None: it did not end in time
    output: str


def _run(
    command: list[str], timeout: float, environment: dict[str, str] | None = None, folder: Path | None = None
) -> Ran:
    """Runs a command in a process group of its own, which ends with it."""
    process = subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, **(environment or {})},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        process_group=0,
    )
    try:
        output, _ = process.communicate(timeout=timeout)
        return Ran(process.returncode, output.decode(errors="replace"))
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        return Ran(None, output.decode(errors="replace"))


def link_command(command: str, target: str, archive: str, made: str, linked: str) -> list[str]:
    """Ninja's command that links `target`, to link `linked` instead with the object before the archive."""
    words = shlex.split(command.split("&&")[1])
    words[words.index(target)] = linked
    [at] = [i for i, word in enumerate(words) if Path(word).name == archive][:1]
    return words[:at] + [made] + words[at:]


def gtest_filter(tests: list[str], leave_out: list[str]) -> str:
    return ":".join(tests) + ("-" + ":".join(leave_out) if leave_out else "")


def slow_tests(output: str) -> list[str]:
    """The tests that took longer than SLOW_TEST_MS."""
    ended = re.findall(r"^\[       OK \] ([\w./]+).*\((\d+) ms\)$", output, re.MULTILINE)
    return [test for test, ms in ended if int(ms) > SLOW_TEST_MS]


def failed_tests(output: str) -> list[str]:
    return re.findall(r"^\[  FAILED  \] ([\w./]+).*\(\d+ ms\)$", output, re.MULTILINE)


def _failed_test(output: str) -> str | None:
    """The test that failed first, or the one under way when the program ended."""
    failed = re.search(r"^\[  FAILED  \] ([\w./]+)", output, re.MULTILINE)
    if failed:
        return failed[1].rstrip(",")
    begun = re.findall(r"^\[ RUN      \] ([\w./]+)", output, re.MULTILINE)
    return begun[-1] if begun else None
