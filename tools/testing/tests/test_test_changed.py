"""Which change is tested, and which libraries it touches."""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import test_changed

DAY_S = 24 * 3600
NOW = 1_800_000_000


class Repository(unittest.TestCase):
    """A repository of the test's own with two libraries and a driver."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name) / "origin"
        self.root.mkdir()
        self.use(self.root)
        self.git("init", "--quiet", "--initial-branch=main")
        for library in ("libs/skill", "libs/motion", "libs/drivers/ur"):
            self.write(f"{library}/CMakeLists.txt", f"metier_add_test({library.split('/')[-1]}_tests\n")
        self.write("libs/plain/CMakeLists.txt", "metier_add_library(plain)\n")
        order = ("libs/motion", "${device_folder}", "libs/skill")
        self.write("CMakeLists.txt", "".join(f"add_subdirectory({folder})\n" for folder in order))
        self.first = self.commit(NOW - 3 * DAY_S)

    def use(self, root: Path):
        before = test_changed.ROOT
        test_changed.ROOT = root
        self.addCleanup(setattr, test_changed, "ROOT", before)

    def git(self, *arguments: str, at: int = NOW) -> str:
        names = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b"}
        dates = {"GIT_AUTHOR_DATE": f"{at} +0000", "GIT_COMMITTER_DATE": f"{at} +0000"}
        ran = subprocess.run(
            ["git", *arguments], cwd=test_changed.ROOT, env={**os.environ, **names, **dates}, check=True, capture_output=True, text=True
        )
        return ran.stdout.strip()

    def write(self, path: str, text: str):
        file = test_changed.ROOT / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def commit(self, at: int) -> str:
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message=change", at=at)
        return self.git("rev-parse", "HEAD")

    def touched(self, base: str | None = None) -> list[str]:
        with contextlib.redirect_stdout(io.StringIO()) as said:
            found = test_changed.libraries_of_change(base)
        self.said = said.getvalue()
        return [library.folder for library in found]

    def test_the_lowest_library_comes_first_however_little_of_it_changed(self):
        self.write("libs/skill/src/a.cpp", "1\n2\n3\n4\n")
        self.write("libs/drivers/ur/src/a.cpp", "1\n2\n3\n")
        self.write("libs/motion/src/a.cpp", "1\n")
        self.write("docs/a.md", "1\n2\n3\n4\n5\n")
        self.write("libs/plain/src/a.cpp", "1\n")
        self.commit(NOW)
        self.assertEqual(self.touched(self.first), ["libs/motion", "libs/drivers/ur", "libs/skill"])

    def test_what_is_not_committed_counts(self):
        self.write("libs/motion/CMakeLists.txt", "metier_add_test(motion_tests\n# more\n")
        self.assertEqual(self.touched(self.first), ["libs/motion"])

    def test_a_branch_is_measured_from_where_it_left_main(self):
        self.git("checkout", "--quiet", "-b", "branch")
        self.write("libs/skill/src/a.cpp", "1\n")
        self.commit(NOW)
        self.git("checkout", "--quiet", "main")
        self.write("libs/motion/src/a.cpp", "1\n")
        self.commit(NOW)
        self.git("checkout", "--quiet", "branch")
        self.assertEqual(self.touched(), ["libs/skill"])
        self.assertIn("since main", self.said)

    def test_a_merge_is_measured_from_its_first_parent(self):
        self.test_a_branch_is_measured_from_where_it_left_main()
        self.git("checkout", "--quiet", "main")
        self.git("merge", "--quiet", "--no-edit", "branch")
        self.assertEqual(self.touched(), ["libs/skill"])
        self.assertIn("merge commit", self.said)

    def test_on_main_the_last_day_counts(self):
        self.write("libs/motion/src/a.cpp", "1\n")
        self.commit(NOW - 2 * DAY_S)
        self.write("libs/skill/src/a.cpp", "1\n")
        self.commit(NOW - 3600)
        self.write("docs/a.md", "1\n")
        self.commit(NOW)
        self.assertEqual(self.touched(), ["libs/skill"])

    def clone(self, depth: int):
        there = self.root.parent / f"clone{depth}"
        self.git("clone", "--quiet", f"--depth={depth}", f"file://{self.root}", str(there))
        self.use(there)
        self.git("checkout", "--quiet", "--detach")
        self.git("branch", "--quiet", "--delete", "--force", "main")
        self.git("remote", "remove", "origin")

    def test_a_shallow_clone_tests_what_it_knows(self):
        for i in range(3):
            self.write("libs/motion/src/a.cpp", f"{i}\n")
            self.commit(NOW - 10 + i)
        self.clone(2)
        self.assertEqual(self.touched(), ["libs/motion"])

    def test_a_single_commit_is_tested_by_a_fixed_set_which_is_said(self):
        self.clone(1)
        self.assertEqual(self.touched(), list(test_changed.WITHOUT_BASE))
        self.assertIn("nothing to compare with", self.said)

    def test_a_base_that_is_not_there_is_refused(self):
        with self.assertRaisesRegex(SystemExit, "no commit nowhere"):
            self.touched("nowhere")


class Environment(unittest.TestCase):
    """What CMakePresets.json sets for the tests of a preset."""

    def test_what_libraries_do_is_left_out_under_the_sanitizers(self):
        for preset, variable in (("asan", "LSAN_OPTIONS"), ("tsan", "TSAN_OPTIONS")):
            options = test_changed.environment_of(preset)[variable]
            file = options.removeprefix("suppressions=").split(":")[0]
            self.assertTrue(Path(file).is_file(), options)

    def test_a_preset_without_one_has_none(self):
        self.assertEqual(test_changed.environment_of("dev"), {})


class Time(unittest.TestCase):
    """Libraries that the time does not suffice for."""

    def run_with(self, statuses: dict[str, int | None], minutes: float) -> tuple[int, str]:
        libraries = [test_changed.Library(folder, ("tests",), 1) for folder in statuses]
        configure, test = test_changed.subprocess.run, test_changed.test
        test_changed.subprocess.run = lambda *_, **__: None
        test_changed.test = lambda library, *_: statuses[library.folder]
        try:
            with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
                return test_changed.run(libraries, "asan", 1, minutes), out.getvalue()
        finally:
            test_changed.subprocess.run, test_changed.test = configure, test

    def test_what_was_left_out_is_said_and_no_failure(self):
        status, said = self.run_with({"libs/a": 0, "libs/b": None}, 5)
        self.assertEqual(status, 0)
        self.assertIn("left out, as 5 minutes were over: libs/b", said)

    def test_none_is_begun_once_the_time_is_over(self):
        self.assertIn("left out, as 0 minutes were over: libs/a", self.run_with({"libs/a": 1}, 0)[1])

    def test_a_failure_is_said_and_others_are_tested(self):
        status, said = self.run_with({"libs/a": 1, "libs/b": 0}, 5)
        self.assertEqual(status, 1)
        self.assertIn("FAILED: libs/a", said)
        self.assertIn("passed: libs/b", said)

    def test_a_command_is_ended_with_all_that_it_started(self):
        begin = time.monotonic()
        self.assertIsNone(test_changed.call(["sh", "-c", "sleep 60 & wait"], 0.1))
        self.assertLess(time.monotonic() - begin, 30)


if __name__ == "__main__":
    unittest.main()
