"""A small folder of model sources for the tests, beside the real NodeSet of OPC UA."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from address_space import AddressSpace  # noqa: E402
from generate_nodesets import DEFAULT_BASE, Generator  # noqa: E402

URI = "urn:test:model"

MODEL = """
[model]
uri = "urn:test:model"
prefix = "Test"
version = "1.0.0"
published = "2020-01-01T00:00:00Z"
doc = "a model for tests."
requires = {}
dictionary = { name = "test_Model", symbol = "testModel", xml_uri = "urn:test:model:types" }

[[data_type]]
name = "Colour"
doc = "A colour."
values = [["Red", "Like a rose."], ["Blue", "Like the sky."]]

[[type]]
name = "IPaintedType"
base = "BaseInterfaceType"
abstract = true
doc = "Something painted."
[type.children]
"Colour" = { type = "BaseDataVariableType", data = "Colour", rule = "Mandatory", doc = "Its colour." }

[[type]]
name = "CarType"
base = "BaseObjectType"
interfaces = ["IPaintedType"]
doc = "A car."
[type.children]
"Speed" = { type = "AnalogUnitType", data = "Double", rule = "Mandatory", unit = "m/s", range = [0, 50], doc = "Its speed [m/s]." }
"Radio" = { type = "BaseObjectType", rule = "Optional", doc = "Its radio." }
"Radio/Volume" = { type = "BaseDataVariableType", data = "Byte", rule = "Mandatory", doc = "How loud it is." }
"Drive" = { method = true, rule = "Mandatory", doc = "Drives.", inputs = [["Where", "String", -1, "To which place."]] }

[[instance]]
name = "MyCar"
parent = "0#85"
type = "CarType"
doc = "A certain car."
include = ["Radio"]
[instance.children]
"Speed" = { value = 3 }
"""


class ModelFolder(unittest.TestCase):
    """A temporary root with one folder `cars`."""

    def setUp(self) -> None:
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.root = Path(directory.name)
        self.folder = self.root / "cars"
        self.folder.mkdir()
        (self.root / "descriptions.toml").write_text(_real("descriptions.toml"), encoding="utf-8")
        header = _real("published_2020.csv").splitlines()[0]
        (self.root / "published_2020.csv").write_text(header + "\n", encoding="utf-8")
        (self.root / "published_differences.csv").write_text("namespace,browse_path,column,now,reason\n")
        self.write_model(MODEL)

    def write_model(self, text: str) -> None:
        (self.folder / "model.toml").write_text(text, encoding="utf-8")

    def generate(self) -> AddressSpace:
        """Generates the files of `cars` and returns the space that holds them."""
        generator = Generator(self.root, DEFAULT_BASE, self.root)
        space = generator.make("cars")
        for path, text in generator.files.items():
            path.write_text(text, encoding="utf-8")
        return space

    def arguments(self) -> list[str]:
        return ["cars", "--root", str(self.root), "--base", str(DEFAULT_BASE), "--official", str(self.root)]

    def node(self, space: AddressSpace, *names: str):
        """The node at a browse path below the type or instance that the first name tells."""
        own = [n for n in space.nodes.values() if n.node_id.uri == URI]
        found = next(n for n in own if n.browse_name.name == names[0])
        for name in names[1:]:
            found = next(c for _, c in space.children(found.node_id) if c.browse_name.name == name)
        return found


def _real(name: str) -> str:
    return (Path(__file__).resolve().parents[3] / "nodesets" / name).read_text(encoding="utf-8")
