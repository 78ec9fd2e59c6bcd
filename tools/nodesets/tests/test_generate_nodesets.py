"""What the generator makes of a model source."""

import contextlib
import io
import unittest

from support import MODEL, URI, ModelFolder

import generate_nodesets
from address_space import HAS_INTERFACE, UATYPES, AddressSpace, NodeSetError
from generate_nodesets import DEFAULT_BASE
from node_ids import FIRST_NEW_ID, read_node_ids


class TypesAndInstances(ModelFolder):
    def test_an_instance_gets_the_mandatory_children_of_its_type(self):
        space = self.generate()
        self.assertEqual(self.node(space, "MyCar", "Speed").node_class, "Variable")
        self.assertEqual(self.node(space, "MyCar", "Drive", "InputArguments").node_class, "Variable")

    def test_an_instance_gets_included_optional_children_with_what_is_below(self):
        self.assertEqual(self.node(self.generate(), "MyCar", "Radio", "Volume").node_class, "Variable")

    def test_an_instance_leaves_other_optional_children_out(self):
        self.write_model(MODEL.replace('include = ["Radio"]', ""))
        with self.assertRaises(StopIteration):
            self.node(self.generate(), "MyCar", "Radio")

    def test_a_type_holds_the_children_of_its_interfaces(self):
        space = self.generate()
        car = self.node(space, "CarType")
        self.assertEqual(space.targets(car.node_id, HAS_INTERFACE), [self.node(space, "IPaintedType").node_id])
        self.assertNotEqual(self.node(space, "CarType", "Colour"), self.node(space, "IPaintedType", "Colour"))

    def test_an_extension_adds_to_a_child_that_the_type_has(self):
        station = '{ type = "BaseDataVariableType", data = "String", rule = "Optional", doc = "What it plays." }'
        self.write_model(f'{MODEL}\n[[extend]]\nextends = "Test:CarType"\n[extend.children]\n"Radio/Station" = {station}\n')
        space = self.generate()
        names = [child.browse_name.name for _, child in space.children(self.node(space, "CarType").node_id)]
        self.assertEqual(names.count("Radio"), 1)
        self.assertEqual(self.node(space, "CarType", "Radio", "Station").node_class, "Variable")

    def test_a_unit_gives_the_properties_that_tell_it(self):
        space = self.generate()
        unit = self.node(space, "CarType", "Speed", "EngineeringUnits").value
        self.assertEqual(unit.find(f".//{{{UATYPES}}}UnitId").text, "5067859")
        limits = self.node(space, "MyCar", "Speed", "EURange").value
        self.assertEqual(limits.find(f".//{{{UATYPES}}}High").text, "50.0")

    def test_methods_of_instances_name_their_declaration(self):
        space = self.generate()
        declaration = self.node(space, "CarType", "Drive").node_id
        self.assertEqual(self.node(space, "MyCar", "Drive").attributes["MethodDeclarationId"], str(declaration))

    def test_the_written_file_reads_back_as_the_same_nodes(self):
        made = self.generate()
        read = AddressSpace()
        read.load(DEFAULT_BASE)
        read.load(self.folder / "NodeSet2.xml")
        for node_id, node in made.nodes.items():
            self.assertEqual(node.browse_name, read.nodes[node_id].browse_name)
            self.assertEqual(set(node.references), set(read.nodes[node_id].references))


class Ids(ModelFolder):
    def test_new_nodes_get_ids_above_20000(self):
        self.generate()
        numbers = [number for number, _ in read_node_ids(self.folder / "NodeIds.csv").values()]
        self.assertGreaterEqual(min(numbers), FIRST_NEW_ID)
        self.assertEqual(len(numbers), len(set(numbers)))

    def test_published_nodes_keep_their_ids(self):
        with (self.root / "published_2020.csv").open("a") as file:
            file.write(f"{URI},CarType/Speed,15003,Variable,AnalogUnitType,Double,-1,,Mandatory,,,\n")
        self.assertEqual(self.node(self.generate(), "CarType", "Speed").node_id.identifier, "i=15003")

    def test_ids_stay_when_a_node_is_put_before_others(self):
        before = self.node(self.generate(), "MyCar", "Speed").node_id
        extra = '[type.children]\n"Weight" = { type = "BaseDataVariableType", data = "Double", rule = "Mandatory", doc = "W." }\n"Speed"'
        self.write_model(MODEL.replace('[type.children]\n"Speed"', extra))
        space = self.generate()
        self.assertEqual(self.node(space, "MyCar", "Speed").node_id, before)
        self.assertIsNotNone(self.node(space, "MyCar", "Weight"))


class Errors(ModelFolder):
    def assert_refused(self, old: str, new: str, text: str) -> None:
        self.write_model(MODEL.replace(old, new))
        with self.assertRaisesRegex(NodeSetError, text):
            self.generate()

    def test_an_unknown_type_is_named(self):
        self.assert_refused('base = "BaseObjectType"', 'base = "NoSuchType"', "no type 'NoSuchType'")

    def test_an_unknown_key_is_named(self):
        self.assert_refused('unit = "m/s"', 'unti = "m/s"', "Speed: unknown key unti")

    def test_an_unknown_unit_is_named(self):
        self.assert_refused('unit = "m/s"', 'unit = "mph"', "unit 'mph' is not known")

    def test_a_missing_description_is_named(self):
        self.assert_refused(', doc = "Its radio."', "", "CarType/Radio has no description")

    def test_a_broken_source_names_file_and_line(self):
        self.assert_refused("[model]", "[model", r"model.toml: .*line 2")


class Freshness(ModelFolder):
    def run_check(self) -> int:
        with contextlib.redirect_stderr(io.StringIO()):
            return generate_nodesets.main([*self.arguments(), "--check"])

    def test_fresh_files_pass(self):
        self.generate()
        self.assertEqual(self.run_check(), 0)

    def test_a_changed_source_is_found_and_nothing_is_written(self):
        self.generate()
        before = (self.folder / "NodeSet2.xml").read_text()
        self.write_model(MODEL.replace("A certain car.", "Another car."))
        self.assertEqual(self.run_check(), 1)
        self.assertEqual((self.folder / "NodeSet2.xml").read_text(), before)


if __name__ == "__main__":
    unittest.main()
