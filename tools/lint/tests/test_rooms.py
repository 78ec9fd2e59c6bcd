"""The table of libraries against what CMake builds."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import rooms

TABLE = """# Architecture

## Libraries, lowest first
| library | is | uses |
|---|---|---|
| `base` | errors | std, fmt |
| `motion` | paths | Eigen |
| `device` | arms | motion |
| `drivers/*` | wires | device |
| `apps/metier` | the command | all |

## Threads
| `skill` | no row of the table | nothing |
"""


class Tree(unittest.TestCase):
    """A source tree of the test's own with two libraries and a driver."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("libs/base", "metier_add_library(base SOURCES src/a.cpp PUBLIC fmt::fmt)")
        self.write("libs/motion", "metier_add_library(motion SOURCES src/a.cpp\n    PUBLIC metier::base)")
        self.write("libs/device", "metier_add_library(device SOURCES src/a.cpp PUBLIC metier::motion)")
        self.write("libs/drivers/ur", "metier_add_driver(ur SOURCES src/a.cpp)")

    def write(self, folder: str, text: str):
        (self.root / folder).mkdir(parents=True, exist_ok=True)
        (self.root / folder / "CMakeLists.txt").write_text(text)

    def problems(self, table: str = TABLE) -> list[str]:
        return rooms.problems(rooms.rows(table), rooms.libraries(self.root))

    def test_a_true_table_is_right(self):
        self.assertEqual(self.problems(), [])

    def test_a_library_without_a_row(self):
        self.write("libs/skill", "metier_add_library(skill SOURCES src/a.cpp)")
        self.assertEqual(self.problems(), ["docs/architecture.md: no row for skill"])

    def test_a_row_without_a_library(self):
        (self.root / "libs/motion/CMakeLists.txt").write_text("")
        self.assertIn("docs/architecture.md: motion has a row, and CMake builds no such library", self.problems())

    def test_a_use_that_no_row_names(self):
        self.write("libs/drivers/ur", "metier_add_driver(ur SOURCES src/a.cpp PRIVATE metier::motion)")
        self.assertEqual(len(self.problems()), 1)
        self.assertIn("the row of drivers/* does not name motion, which CMake links to drivers/ur", self.problems()[0])

    def test_a_use_that_nobody_links(self):
        self.write("libs/device", "metier_add_library(device SOURCES src/a.cpp)")
        self.assertIn("the row of device names motion, which CMake does not link to it", self.problems()[0])

    def test_an_arrow_that_points_up(self):
        self.write("libs/motion", "metier_add_library(motion SOURCES src/a.cpp PUBLIC metier::device)")
        table = TABLE.replace("| paths | Eigen |", "| paths | Eigen, device |")
        self.assertIn("docs/architecture.md: motion uses device, whose row is below its own", self.problems(table))

    def test_too_many_rooms(self):
        more = "".join(f"| `apps/a{n}` | more | all |\n" for n in range(rooms.MOST_ROOMS))
        self.assertIn("at most 25", self.problems(TABLE.replace("\n\n## Threads", f"\n{more}\n## Threads"))[-1])

    def test_the_table_of_this_project_is_found(self):
        self.assertGreater(len(rooms.rows((rooms.ROOT / rooms.TABLE).read_text())), 10)


if __name__ == "__main__":
    unittest.main()
