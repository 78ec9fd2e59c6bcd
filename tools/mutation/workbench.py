"""A copy of the source tree with builds of its own, in which mutants are compiled and tested."""

import hashlib
import os
import re
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from libraries import Library

CAUGHT, SURVIVED, REFUSED, EQUIVALENT = "caught", "survived", "does not compile", "equivalent"
BUILD_TIMEOUT_S = 1800
FLAKY_REPEATS = 2


@dataclass
class Outcome:
    result: str
    why: str = ""


class Workbench:
    """Works in `tree`, a git worktree at the commit that `root` has checked out."""

    def __init__(self, root: Path, tree: Path, jobs: int):
        self.root, self.tree, self.jobs = root, tree, jobs
        self._times: dict[tuple[str, str], float] = {}
        self._configured: set[str] = set()
        self._codes: dict[tuple[str, str], str | None] = {}

    def check_out(self) -> str:
        """Brings the tree to the commit of `root`, which is returned."""
        commit = self._git(self.root, "rev-parse", "HEAD")
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

    # ---- builds ----

    def build(self, preset: str, targets: list[str], environment: dict[str, str] | None = None) -> str | None:
        """Builds the targets; None if that went well, else what the compiler says."""
        folder = self.tree / "build" / preset
        if preset not in self._configured:
            subprocess.run(["cmake", "--preset", preset], cwd=self.tree, check=True, stdout=subprocess.DEVNULL)
            self._configured.add(preset)
        ran = _run(
            ["ninja", "-C", str(folder), f"-j{self.jobs}", *targets],
            BUILD_TIMEOUT_S,
            environment or {},
        )
        return None if ran.status == 0 else ran.output

    def prepare(self, preset: str, programs: list[str]) -> None:
        """Builds programs of the sources as they are, and measures how long they take; once each."""
        programs = [program for program in programs if (preset, program) not in self._times]
        said = self.build(preset, programs) if programs else None
        if said is not None:
            raise SystemExit(f"mutate: {preset}: the sources as they are do not compile:\n{said[-3000:]}")
        for program in programs:
            self._time(preset, program)

    def _time(self, preset: str, program: str) -> None:
        begin = time.monotonic()
        failed = self.run_tests(preset, program)
        if failed:
            raise SystemExit(f"mutate: {preset}: {program} fails without any change: {failed}")
        self._times[preset, program] = time.monotonic() - begin

    def code_as_it_is(self, preset: str, library: Library, source: str) -> str | None:
        """code_of() of a source file that is not changed; compiled once."""
        if (preset, source) not in self._codes:
            self._codes[preset, source] = self.code_of(preset, library, source)
        return self._codes[preset, source]

    def code_of(self, preset: str, library: Library, source: str) -> str | None:
        """A digest of the machine code that the source file becomes; None if it does not compile."""
        target = library.object_of(source)
        if self.build(preset, [target], {"CCACHE_READONLY": "1"}) is not None:  # the object of a mutant is of no use
            return None
        path = self.tree / "build" / preset / target
        bare = path.with_suffix(".bare")
        subprocess.run(["objcopy", "--strip-debug", str(path), str(bare)], check=True)
        digest = hashlib.sha256(bare.read_bytes()).hexdigest()
        bare.unlink()
        return digest

    # ---- tests ----

    def run_tests(self, preset: str, program: str) -> str | None:
        """Runs a test program up to its first failure that shows again; that, or None."""
        leave_out: list[str] = []
        for _ in range(4):
            ran = self._run_program(preset, program, "-" + ":".join(leave_out) if leave_out else "*")
            if ran.status == 0:
                return None
            test = _failed_test(ran.output)
            if ran.status is None:
                return f"{program}: {test or 'no test'} does not end"
            if test is None or self._fails_again(preset, program, test):
                return f"{program}: {test or 'status ' + str(ran.status)}"
            leave_out.append(test)
        return None

    def _fails_again(self, preset: str, program: str, test: str) -> bool:
        return all(self._run_program(preset, program, test).status != 0 for _ in range(FLAKY_REPEATS))

    def _run_program(self, preset: str, program: str, tests: str) -> "Ran":
        [path] = [p for p in (self.tree / "build" / preset / "libs").rglob(program) if p.is_file()] or [
            p for p in (self.tree / "build" / preset / "virtual").rglob(program) if p.is_file()
        ]
        timeout = 60 + 4 * self._times.get((preset, program), 300)
        environment = {"GTEST_FAIL_FAST": "1", "TSAN_OPTIONS": "halt_on_error=1 exitcode=66"}
        return _run([str(path), f"--gtest_filter={tests}"], timeout, environment, path.parent)


@dataclass
class Ran:
    status: int | None  # None: it did not end in time
    output: str


def _run(command: list[str], timeout: float, environment: dict[str, str], folder: Path | None = None) -> Ran:
    """Runs a command in a process group of its own, which ends with it."""
    process = subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, **environment},
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


def _failed_test(output: str) -> str | None:
    """The test that failed first, or the one under way when the program ended."""
    failed = re.search(r"^\[  FAILED  \] ([\w./]+)", output, re.MULTILINE)
    if failed:
        return failed[1].rstrip(",")
    begun = re.findall(r"^\[ RUN      \] ([\w./]+)", output, re.MULTILINE)
    return begun[-1] if begun else None
