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
    def test_names_changed_sources_and_headers(self):
        lines = {"libs/b.hpp": 1, "libs/a.cpp": 2, "README.md": 3}
        self.assertEqual(json.loads(tidy_changed.line_filter(lines)), [{"name": "/libs/a.cpp"}, {"name": "/libs/b.hpp"}])


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
