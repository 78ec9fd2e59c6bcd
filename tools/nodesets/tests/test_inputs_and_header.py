"""The inputs of the NodeSet compiler, the C++ header, values and units."""

import contextlib
import io
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from support import URI, ModelFolder

import node_ids_header
import nodeset_inputs
import values
from address_space import UATYPES, NodeSetError


class CompilerInputs(ModelFolder):
    def run_tool(self) -> int:
        arguments = [str(self.folder / "NodeSet2.xml"), "--csv", str(self.root / "ids.csv"), "--bsd", str(self.root / "types.bsd")]
        self.errors = io.StringIO()
        with contextlib.redirect_stderr(self.errors):
            return nodeset_inputs.main(arguments)

    def test_data_types_and_layout_come_from_the_nodeset_alone(self):
        number = self.node(self.generate(), "Colour").node_id.identifier[2:]
        self.assertEqual(self.run_tool(), 0)
        self.assertEqual((self.root / "ids.csv").read_text(), f"Colour,{number},DataType\n")
        schema = ElementTree.parse(self.root / "types.bsd").getroot()
        self.assertEqual(schema.get("TargetNamespace"), URI)
        self.assertEqual([v.get("Name") for v in schema.iter("{http://opcfoundation.org/BinarySchema/}EnumeratedValue")],
                         ["Red", "Blue"])

    def test_structures_come_with_their_binary_encoding(self):
        self.generate()
        path = self.folder / "NodeSet2.xml"
        encoding = (
            '<UAObject NodeId="ns=1;i=30001" BrowseName="Default Binary"><DisplayName>Default Binary</DisplayName>'
            '<References><Reference ReferenceType="i=38" IsForward="false">ns=1;i=20012</Reference></References></UAObject></UANodeSet>'
        )
        number = self.node(self.generate(), "Colour").node_id.identifier
        path.write_text(path.read_text().replace("</UANodeSet>", encoding.replace("i=20012", number)))
        self.assertEqual(self.run_tool(), 0)
        self.assertIn("Colour_Encoding_DefaultBinary,30001,Object\n", (self.root / "ids.csv").read_text())

    def test_data_types_without_a_dictionary_are_refused(self):
        self.generate()
        path = self.folder / "NodeSet2.xml"
        path.write_text(path.read_text().replace('IsForward="false">i=93<', 'IsForward="false">i=92<'))
        self.assertEqual(self.run_tool(), 1)
        self.assertIn("no binary type dictionary", self.errors.getvalue())

    def test_a_file_that_is_no_nodeset_is_refused_by_name(self):
        (self.folder / "NodeSet2.xml").write_text("<html/>")
        self.assertEqual(self.run_tool(), 1)
        self.assertIn("NodeSet2.xml: the root element is not UANodeSet", self.errors.getvalue())


class Header(ModelFolder):
    def test_each_node_has_a_constant(self):
        number = self.node(self.generate(), "CarType", "Speed").node_id.identifier[2:]
        text = node_ids_header.header_text([("cars", URI, self.folder / "NodeIds.csv")])
        self.assertIn(f"inline constexpr std::uint32_t kCarType_Speed = {number};", text)
        self.assertIn(f'kUri = "{URI}"', text)

    def test_an_empty_list_is_refused(self):
        with self.assertRaisesRegex(NodeSetError, "has no ids"):
            node_ids_header.header_text([("cars", URI, Path("/nowhere.csv"))])


class Values(unittest.TestCase):
    def test_unit_ids_are_the_characters_of_the_common_code(self):
        self.assertEqual(values.unit_id("C81"), 4405297)
        self.assertEqual(values.unit_id("MTR"), 5067858)
        self.assertEqual(values.unit_id("2A"), 12865)
        self.assertEqual(values.unit_id(""), -1)

    def test_lists_become_arrays_but_a_range_is_one_value(self):
        self.assertTrue(values.encode("Double", [1, 2]).startswith(f'<ListOfDouble xmlns="{UATYPES}">'))
        self.assertTrue(values.encode("Range", [0, 1]).startswith("<ExtensionObject"))
        self.assertTrue(values.encode("Range", [[0, 1], [0, 2]]).startswith("<ListOfExtensionObject"))

    def test_text_is_escaped(self):
        self.assertIn("a &lt; b &amp; c", values.encode("String", "a < b & c"))

    def test_defaults_are_zero_of_the_asked_length(self):
        element = values.default_element("Double", 1, 3)
        self.assertEqual([e.text for e in element.iter(f"{{{UATYPES}}}Double")], ["0.0"] * 3)
        self.assertIsNone(values.default_element("3DFrame", 1, 3))


if __name__ == "__main__":
    unittest.main()
