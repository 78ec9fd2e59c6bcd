"""The form of a commit's subject."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import commit_subjects


class Subject(unittest.TestCase):
    def test_a_library_and_what_holds(self):
        self.assertIsNone(commit_subjects.wrong_with("motion: a plan keeps its limits"))
        self.assertIsNone(commit_subjects.wrong_with("skill, device: names are kept"))

    def test_without_a_library(self):
        for subject in ("Fix planner", "motion:", ": holds"):
            self.assertIn("<library>", commit_subjects.wrong_with(subject))

    def test_too_long(self):
        self.assertIsNone(commit_subjects.wrong_with("ur: " + "x" * 68))
        self.assertIn("73 characters, at most 72", commit_subjects.wrong_with("ur: " + "x" * 69))


if __name__ == "__main__":
    unittest.main()
