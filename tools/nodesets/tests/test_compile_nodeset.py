"""When a NodeSet is compiled, and when an earlier outcome is taken."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[1] / "compile_nodeset.py"
# Counts its runs, fails where it is told to, and writes what it was given.
COMPILER = """
import sys
from pathlib import Path
runs = Path(__file__).with_name("runs")
runs.write_text(runs.read_text() + "x" if runs.exists() else "x")
*given, out = sys.argv[1:]
print("compiled")
if "fail" in given:
    sys.exit(3)
Path(out + ".c").write_text(" ".join(given) + Path(given[0]).read_text())
Path(out + ".h").write_text("header")
"""


class Compiling(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = Path(kept.name)
        self.compiler = self.folder / "compiler"
        self.compiler.mkdir()
        (self.compiler / "nodeset_compiler.py").write_text(COMPILER)
        self.model = self.folder / "model.xml"
        self.model.write_text("model")

    def compile(self, build: str, *more: str) -> int:
        (self.folder / build).mkdir(exist_ok=True)
        return subprocess.run(
            [sys.executable, PROGRAM, "--cache", self.folder / "cache", "--out", self.folder / build / "space",
             "--compiler", self.compiler, "--inputs", self.model, "--", str(self.model), *more],
            check=False).returncode

    def runs(self) -> int:
        return len((self.compiler / "runs").read_text())

    def made(self, build: str) -> str:
        return (self.folder / build / "space.c").read_text()

    def test_a_second_build_takes_the_outcome_of_the_first(self):
        self.assertEqual(self.compile("ci"), 0)
        self.assertEqual(self.compile("tsan"), 0)
        self.assertEqual(self.runs(), 1)
        self.assertEqual(self.made("tsan"), f"{self.model}model")
        self.assertEqual(self.made("ci"), self.made("tsan"))
        self.assertEqual((self.folder / "tsan" / "space.log").read_text(), "compiled\n")

    def test_a_changed_model_argument_or_compiler_is_compiled(self):
        self.compile("ci")
        self.model.write_text("changed")
        self.compile("ci")
        self.assertEqual(self.made("ci"), f"{self.model}changed")
        self.compile("ci", "more")
        (self.compiler / "nodeset_compiler.py").write_text(COMPILER + "# newer\n")
        self.compile("ci", "more")
        self.assertEqual(self.runs(), 4)

    def test_a_failure_is_told_and_not_kept(self):
        for _ in range(2):
            self.assertEqual(self.compile("ci", "fail"), 3)
        self.assertEqual(self.runs(), 2)
        self.assertFalse((self.folder / "ci" / "space.c").exists())
        self.assertEqual(list((self.folder / "cache").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
