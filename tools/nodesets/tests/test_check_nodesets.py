"""Which faults the check of NodeSets finds."""

import unittest

from support import MODEL, URI, ModelFolder

from check_nodesets import Checker
from generate_nodesets import DEFAULT_BASE


class Faults(ModelFolder):
    def faults(self) -> list[str]:
        return list(Checker(self.root, "cars", DEFAULT_BASE, self.root).faults())

    def damage(self, old: str, new: str) -> None:
        path = self.folder / "NodeSet2.xml"
        text = path.read_text(encoding="utf-8")
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    def assert_fault(self, text: str) -> None:
        self.assertTrue(any(text in fault for fault in self.faults()), self.faults())

    def test_a_generated_model_has_none(self):
        self.generate()
        self.assertEqual(self.faults(), [])

    def test_a_target_that_is_not_there(self):
        self.generate()
        self.damage(">i=85<", ">i=99999<")
        self.assert_fault("which is not there")

    def test_a_missing_description(self):
        self.generate()
        self.damage("<Description>A certain car.</Description>", "<Description></Description>")
        self.assert_fault("MyCar has no Description")

    def test_a_parameter_without_unit(self):
        self.write_model(MODEL.replace('"Radio/Volume"', '"Options/Volume"').replace('"Radio" = {', '"Options" = {'))
        self.generate()
        self.assert_fault("CarType/Options/Volume has no EngineeringUnits")

    def test_an_id_below_the_range(self):
        self.generate()
        number = self.node(self.generate(), "CarType").node_id.identifier
        self.damage(f'NodeId="ns=1;{number}"', 'NodeId="ns=1;i=77"')
        self.assert_fault("77 (CarType) is neither published nor in")

    def test_a_node_that_is_not_listed(self):
        self.generate()
        path = self.folder / "NodeIds.csv"
        path.write_text("".join(path.read_text().splitlines(keepends=True)[1:]))
        self.assert_fault("is not in NodeIds.csv as")

    def test_an_instance_without_a_mandatory_child(self):
        space = self.generate()
        speed = self.node(space, "MyCar", "Speed").node_id.identifier
        self.damage(f'NodeId="ns=1;{speed}" BrowseName="1:Speed"', f'NodeId="ns=1;{speed}" BrowseName="1:Haste"')
        self.assert_fault("MyCar lacks Speed")

    def test_a_published_fact_that_changed(self):
        space = self.generate()
        number = self.node(space, "CarType", "Speed").node_id.identifier[2:]
        with (self.root / "published_2020.csv").open("a") as file:
            file.write(f"{URI},CarType/Speed,{number},Variable,AnalogUnitType,Float,-1,,Mandatory,HasComponent,,\n")
        self.assert_fault("data_type is 'Double', published 'Float'")

    def test_a_listed_difference_is_no_fault(self):
        self.test_a_published_fact_that_changed()
        with (self.root / "published_differences.csv").open("a") as file:
            file.write(f"{URI},CarType/Speed,data_type,Double,doubles are enough\n")
        self.assertEqual(self.faults(), [])


if __name__ == "__main__":
    unittest.main()
