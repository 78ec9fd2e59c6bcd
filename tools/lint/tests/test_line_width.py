"""Length of the lines of Markdown files."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import line_width

LONG = "word " * 20 + "end"  # 103 characters


class Lines(unittest.TestCase):
    def test_a_long_line_is_named_with_its_length(self):
        self.assertEqual(line_width.problems("a.md", f"short\n{LONG}\n"), ["a.md:2: 103 characters, at most 100"])

    def test_a_hundred_characters_are_allowed_whatever_bytes_they_take(self):
        self.assertEqual(line_width.problems("a.md", "ä " * 50), [])

    def test_code_tables_and_single_words_are_left_alone(self):
        address = "https://example.org/" + "x" * 100
        text = f"```\n{LONG}\n```\n| {LONG} |\n    {LONG}\n{address}\n- {address}\n"
        self.assertEqual(line_width.problems("a.md", text), [])

    def test_a_line_after_code_counts_again(self):
        self.assertEqual(len(line_width.problems("a.md", f"```\n{LONG}\n```\n{LONG}\n")), 1)


if __name__ == "__main__":
    unittest.main()
