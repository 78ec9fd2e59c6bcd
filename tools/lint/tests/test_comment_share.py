"""Lines of comment in public headers."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import comment_share


class Lines(unittest.TestCase):
    def test_comments_and_code_count_each(self):
        self.assertEqual(comment_share.lines_of("/// A pose [m].\nstruct Pose;\n"), (1, 2))

    def test_a_comment_beside_code_counts_half(self):
        self.assertEqual(comment_share.lines_of("double width;  ///< [m]\n"), (0.5, 1))

    def test_empty_lines_and_includes_do_not_count(self):
        self.assertEqual(comment_share.lines_of("#pragma once\n\n#include <array>\nint a;\n"), (0, 1))

    def test_headers_of_this_project_are_found(self):
        self.assertIn("libs/motion", comment_share.shares(comment_share.ROOT))

    def test_a_library_has_the_lines_of_its_headers(self):
        of_headers = [
            lines
            for path, (_, lines) in comment_share.headers(comment_share.ROOT).items()
            if path.startswith("libs/motion/")
        ]
        self.assertGreater(len(of_headers), 1)
        self.assertEqual(comment_share.shares(comment_share.ROOT)["libs/motion"][1], sum(of_headers))


if __name__ == "__main__":
    unittest.main()
