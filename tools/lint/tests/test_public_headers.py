"""Which headers are public, and which are not."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import public_headers


class Tree(unittest.TestCase):
    """A source tree of the test's own with a library, a driver and a program."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(setattr, public_headers, "ROOT", public_headers.ROOT)
        public_headers.ROOT = Path(folder.name)
        subprocess.run(["git", "init", "--quiet"], cwd=folder.name, check=True)
        self.write("libs/motion/include/metier/motion/planner.hpp", "")
        self.write("libs/drivers/ur/include/metier/ur_driver/arm.hpp", "")
        self.write("apps/metier/src/main.cpp", "metier/motion/planner.hpp", "metier/ur_driver/arm.hpp")

    def write(self, path: str, *included: str):
        file = public_headers.ROOT / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("".join(f'#include "{name}"\n' for name in included))

    def allow(self, text: str):
        file = public_headers.ROOT / public_headers.ALLOWED
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def test_all_are_included_from_outside(self):
        self.assertEqual(public_headers.problems(), [])

    def test_names_the_header_and_where_it_belongs(self):
        self.write("libs/drivers/ur/include/metier/ur_driver/wire.hpp")
        problems = public_headers.problems()
        self.assertEqual(len(problems), 1)
        self.assertIn("libs/drivers/ur/include/metier/ur_driver/wire.hpp: nothing outside of libs/drivers/ur ", problems[0])
        self.assertIn("move it to libs/drivers/ur/src", problems[0])

    def test_own_sources_tests_and_fuzz_targets_do_not_count(self):
        self.write("libs/drivers/ur/include/metier/ur_driver/wire.hpp")
        for path in ("src/wire.cpp", "tests/wire_test.cpp", "fuzz/wire_fuzz.cpp", "benchmarks/wire_benchmark.cpp"):
            self.write(f"libs/drivers/ur/{path}", "metier/ur_driver/wire.hpp")
        self.assertEqual(len(public_headers.problems()), 1)

    def test_another_driver_is_outside(self):
        self.write("libs/drivers/ur/include/metier/ur_driver/wire.hpp")
        self.write("libs/drivers/edo/tests/wire_test.cpp", "metier/ur_driver/wire.hpp")
        self.assertEqual(public_headers.problems(), [])

    def test_a_public_header_makes_those_public_that_it_includes(self):
        self.write("libs/motion/include/metier/motion/planner.hpp", "metier/motion/limits.hpp")
        self.write("libs/motion/include/metier/motion/limits.hpp", "metier/motion/axis.hpp")
        self.write("libs/motion/include/metier/motion/axis.hpp")
        self.assertEqual(public_headers.problems(), [])

    def test_two_that_include_each_other_are_not_public(self):
        self.write("libs/motion/include/metier/motion/a.hpp", "metier/motion/b.hpp")
        self.write("libs/motion/include/metier/motion/b.hpp", "metier/motion/a.hpp")
        self.assertEqual(len(public_headers.problems()), 2)

    def test_cmake_may_write_the_source_that_includes(self):
        self.write("libs/device/include/metier/driver/driver.hpp")
        self.write("cmake/Tables.cmake", "metier/driver/driver.hpp")
        self.assertEqual(public_headers.problems(), [])

    def test_an_exception_has_a_reason(self):
        self.write("libs/motion/include/metier/motion/shapes.hpp")
        self.allow('"metier/motion/shapes.hpp" = "for users of the installed library"\n')
        self.assertEqual(public_headers.problems(), [])
        self.allow('"metier/motion/shapes.hpp" = " "\n')
        self.assertEqual(len(public_headers.problems()), 1)

    def test_an_exception_that_is_none_is_refused(self):
        self.allow('"metier/motion/planner.hpp" = "for later"\n"metier/motion/gone.hpp" = "for later"\n')
        self.assertEqual(len(public_headers.problems()), 2)


if __name__ == "__main__":
    unittest.main()
