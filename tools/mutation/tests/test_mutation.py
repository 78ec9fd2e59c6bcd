"""What the operators change, and that nothing else is touched."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import mutate
from libraries import LIBRARIES
from operators import changes
from source_text import blanked
from workbench import Outcome, _failed_test, failed_tests, gtest_filter, link_command, slow_tests

ROOT = Path(__file__).resolve().parents[3]

SOURCE = """#include <a>
// if (a < b) { c(); }
void f() {
    const std::lock_guard lock(mutex_);
    const auto text = "x < y && z";
    const char letter = '<';
    if (i < limit) {
        notify(1'000, i);
    }
    if (const auto found = find(i); !found) {
        return fail(Errc::not_found,
                    "no " + i);
    }
    if (auto* one = take()) {
        one->go();
    }
    const double v = std::clamp(speed, -kMost, kMost) * 1000.0;
    spdlog::warn("late");
    Thing thing(1);
    for (int k = 0; k < n; ++k) {
        sum += k + 1;
    }
    std::this_thread::sleep_for(5ms);
}
"""


def lines(kind: str, source: str = SOURCE) -> set[str]:
    """The lines that changes of that kind make."""
    found = set()
    for change in changes(source):
        if change.kind == kind:
            changed = source[: change.start] + change.new + source[change.end :]
            found |= {line.strip() for line in set(changed.splitlines()) - set(source.splitlines())}
    return found


class Libraries(unittest.TestCase):
    """The table of libraries is that of the build."""

    def test_every_test_program_is_one_of_the_build(self):
        lists = [path for path in ROOT.rglob("CMakeLists.txt") if "build" not in path.relative_to(ROOT).parts]
        built = set(re.findall(r"metier_add_test\((\w+)", "".join(path.read_text() for path in lists)))
        named = {program for library in LIBRARIES.values() for program in library.tests + library.dependants}
        self.assertEqual(named - built, set())


class Operators(unittest.TestCase):
    def test_comparisons_are_flipped(self):
        self.assertEqual(lines("comparison"), {"if (i >= limit) {", "for (int k = 0; k >= n; ++k) {"})

    def test_conditions_are_negated(self):
        self.assertEqual(
            lines("condition"),
            {"if (!(i < limit)) {", "if (const auto found = find(i); !(!found)) {", "if (auto* one = take(); !one) {"},
        )

    def test_calls_are_dropped_but_no_declarations_and_no_logs(self):
        gone = [c for c in changes(SOURCE) if c.kind == "call"]
        self.assertEqual(
            [SOURCE[c.start : c.end] for c in gone],
            ["notify(1'000, i);", "one->go();", "std::this_thread::sleep_for(5ms);"],
        )

    def test_a_lock_is_removed(self):
        [change] = [c for c in changes(SOURCE) if c.kind == "lock"]
        self.assertEqual(SOURCE[change.start : change.end], "const std::lock_guard lock(mutex_);")

    def test_a_limit_is_dropped(self):
        self.assertEqual(lines("limit"), {"const double v = (speed) * 1000.0;"})
        self.assertEqual(lines("limit", "a = std::min(x, f(y, z));\n"), {"a = (x);", "a = (f(y, z));"})

    def test_units_are_changed(self):
        self.assertEqual(
            lines("unit"),
            {"const double v = std::clamp(speed, -kMost, kMost) / 1000.0;", "std::this_thread::sleep_for(5s);"},
        )

    def test_a_refusal_is_not_returned_and_lines_stay_where_they_are(self):
        [change] = [c for c in changes(SOURCE) if c.kind == "error"]
        self.assertEqual(change.new, ";\n")

    def test_counts_are_off_by_one(self):
        self.assertEqual(
            lines("off by one"),
            {"if (i <= limit) {", "for (int k = 1; k < n; ++k) {", "for (int k = 0; k <= n; ++k) {", "sum += k;"},
        )

    def test_comments_and_literals_are_left_alone(self):
        code = blanked(SOURCE)
        self.assertEqual(len(code), len(SOURCE))
        self.assertEqual(code.count("\n"), SOURCE.count("\n"))
        for word in ("include", "x < y", "'<'", "// if"):
            self.assertNotIn(word, code)
        self.assertIn("1'000", code)
        self.assertEqual(blanked('R"(a "b" c)" + d').strip(), "+ d")


class Mutants(unittest.TestCase):
    def test_every_one_is_found_again_in_its_source(self):
        chosen = mutate.choose(60, 7, list(LIBRARIES.values()), ROOT)
        self.assertEqual(len(set(chosen)), 60)
        for mutant in chosen:
            text = (ROOT / mutant.source).read_text()
            start = mutate.place_of(mutant, text)
            self.assertIsNotNone(start, mutant)
            shifted = "// a line\n" + text
            self.assertEqual(mutate.place_of(mutant, shifted), start + len("// a line\n"))

    def test_a_seed_gives_the_same_ones(self):
        libraries = [LIBRARIES["device"], LIBRARIES["skill"]]
        self.assertEqual(mutate.choose(9, 3, libraries, ROOT), mutate.choose(9, 3, libraries, ROOT))
        self.assertNotEqual(mutate.choose(9, 3, libraries, ROOT), mutate.choose(9, 4, libraries, ROOT))

    def test_every_library_has_sources(self):
        for library in LIBRARIES.values():
            self.assertTrue(library.sources(ROOT), library.name)

    def test_the_latest_outcome_counts(self):
        [mutant] = mutate.choose(1, 1, [LIBRARIES["device"]], ROOT)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "outcome.jsonl"
            for result in ("survived", "caught"):
                mutate.note(file, mutant, Outcome(result, "x"), 1.0)
            self.assertEqual(mutate.read(file), {mutant: Outcome("caught", "x")})


class TestPrograms(unittest.TestCase):
    def test_the_first_failure_is_named(self):
        output = "[ RUN      ] A.b\n[  FAILED  ] A.b (1 ms)\n[ RUN      ] C.d\n"
        self.assertEqual(_failed_test(output), "A.b")
        self.assertEqual(_failed_test("[  FAILED  ] A/B.c/2, where GetParam() = 3 (1 ms)\n"), "A/B.c/2")

    def test_a_crash_is_that_of_the_test_under_way(self):
        self.assertEqual(_failed_test("[ RUN      ] A.b\n[       OK ] A.b\n[ RUN      ] C.d\n"), "C.d")

    def test_each_failure_is_named_once(self):
        output = "[  FAILED  ] A.b (1 ms)\n[  FAILED  ] A/B.c/2, where GetParam() = 3 (9 ms)\n"
        listed = "[  FAILED  ] 2 tests, listed below:\n[  FAILED  ] A.b\n"
        self.assertEqual(failed_tests(output + listed), ["A.b", "A/B.c/2"])

    def test_slow_ones_are_run_last(self):
        output = "[       OK ] A.b (9 ms)\n[       OK ] A/B.c/2, where GetParam() = 3 (900 ms)\n[       OK ] C.d (501 ms)\n"
        self.assertEqual(slow_tests(output), ["A/B.c/2", "C.d"])
        self.assertEqual(gtest_filter(["*"], []), "*")
        self.assertEqual(gtest_filter(["*"], ["A/B.c/2", "C.d"]), "*-A/B.c/2:C.d")
        self.assertEqual(gtest_filter(["C.d"], ["A.b"]), "C.d-A.b")

    def test_the_object_of_a_mutant_is_linked_before_its_library(self):
        command = ": && /usr/bin/c++ -O1 a.o -o libs/x/x_tests  libs/x/libmetier_x.a  libs/y/libmetier_y.a && :\n"
        self.assertEqual(
            link_command(command, "libs/x/x_tests", "libmetier_x.a", "/m/mutant.o", "/m/x_tests"),
            ["/usr/bin/c++", "-O1", "a.o", "-o", "/m/x_tests"]
            + ["/m/mutant.o", "libs/x/libmetier_x.a", "libs/y/libmetier_y.a"],
        )


if __name__ == "__main__":
    unittest.main()
