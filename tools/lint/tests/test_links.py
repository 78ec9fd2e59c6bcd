"""Relative links of Markdown files."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import links


class Tree(unittest.TestCase):
    """A source tree of the test's own with two pages."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "docs").mkdir()
        (self.root / "docs/page.md").write_text("# Page\n## Which `kinds`: a, b\n")

    def problems(self, text: str) -> list[str]:
        (self.root / "README.md").write_text(text)
        return links.problems(self.root, ["README.md", "docs/page.md"])

    def test_a_file_a_folder_and_a_heading(self):
        self.assertEqual(self.problems("[a](docs/page.md) [b](docs) [c](docs/page.md#which-kinds-a-b)"), [])

    def test_a_missing_file(self):
        self.assertEqual(self.problems("[a](docs/other.md)"), ["README.md: docs/other.md: no such file"])

    def test_a_missing_heading(self):
        found = self.problems("# Here\n[a](docs/page.md#none) [b](#here) [c](#there)")
        self.assertEqual(
            found, ["README.md: docs/page.md#none: no such heading", "README.md: #there: no such heading"]
        )

    def test_code_and_addresses_of_the_web_are_left_alone(self):
        self.assertEqual(self.problems("```\n[a](nothing)\n```\n[b](https://example.org/x)"), [])


if __name__ == "__main__":
    unittest.main()
