"""Which files clang-tidy is run over, and what becomes of its findings."""

import json
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import tidy_changed


class SourcesTest(unittest.TestCase):
    def test_takes_sources_that_exist_the_largest_change_first(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name in ("a.cpp", "b.cpp", "c.cpp", "d.hpp"):
                (root / name).touch()
            lines = {"a.cpp": 1, "b.cpp": 30, "c.cpp": 30, "d.hpp": 99, "gone.cpp": 50}
            self.assertEqual(tidy_changed.sources(lines, root), ["b.cpp", "c.cpp", "a.cpp"])


class LineFilterTest(unittest.TestCase):
    def test_names_changed_lines_of_sources_and_headers(self):
        ranges = {"libs/b.hpp": [[1, 2]], "libs/a.cpp": [[3, 3], [9, 12]], "README.md": [[3, 4]]}
        self.assertEqual(
            json.loads(tidy_changed.line_filter(ranges)),
            [{"name": "/libs/a.cpp", "lines": [[3, 3], [9, 12]]}, {"name": "/libs/b.hpp", "lines": [[1, 2]]}],
        )


class ChangedRangesTest(unittest.TestCase):
    def test_takes_them_from_a_diff_without_context(self):
        diff = """\
diff --git a/libs/a.cpp b/libs/a.cpp
--- a/libs/a.cpp
+++ b/libs/a.cpp
@@ -2 +3 @@ int one() {
-    return 2;
+    return 1;
@@ -8,0 +9,4 @@
+a
+b
+c
+d
@@ -20,2 +24,0 @@ removed
-x
-y
diff --git a/libs/b.hpp b/libs/b.hpp
--- /dev/null
+++ b/libs/b.hpp
@@ -0,0 +1,2 @@
+x
+y
"""
        self.assertEqual(
            tidy_changed.changed_ranges(diff), {"libs/a.cpp": [[3, 3], [9, 12]], "libs/b.hpp": [[1, 2]]}
        )


class CheckTest(unittest.TestCase):
    def test_collects_the_findings(self):
        with mock.patch.object(tidy_changed, "tidy", side_effect=lambda name, _: "bad" if name == "b.cpp" else ""):
            self.assertEqual(tidy_changed.check(["a.cpp", "b.cpp"], 1.0, "[]"), (["bad"], 0))

    def test_begins_no_file_after_its_time(self):
        with mock.patch.object(tidy_changed, "tidy") as tidy:
            self.assertEqual(tidy_changed.check(["a.cpp", "b.cpp"], 0.0, "[]"), ([], 2))
            tidy.assert_not_called()


if __name__ == "__main__":
    unittest.main()
