"""The libraries whose code is changed, and the test programs that should notice."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Library:
    """A library, its own test programs, and those of libraries that are built on it."""

    name: str
    target: str
    tests: tuple[str, ...]
    dependants: tuple[str, ...] = ()

    @property
    def folder(self) -> str:
        return f"libs/{self.name}"

    def sources(self, root: Path) -> list[str]:
        """Its source files, relative to `root`."""
        found = (root / self.folder / "src").rglob("*.cpp")
        return sorted(str(path.relative_to(root)) for path in found)

    def object_of(self, source: str) -> str:
        """The object of a source file, relative to the build's folder."""
        inside = source.removeprefix(self.folder + "/")
        return f"{self.folder}/CMakeFiles/{self.target}.dir/{inside}.o"


def _driver(name: str) -> Library:
    return Library(f"drivers/{name}", f"metier_{name}_driver", (f"{name}_driver_tests",))


# In the order in which their mutants are tried: first those whose tests take little time.
LIBRARIES = {
    library.name: library
    for library in (
        Library("skill", "metier_skill", ("skill_tests",), ("composition_tests",)),
        Library("device", "metier_device", ("device_tests",), ("joint_simulator_tests", "ur_driver_tests")),
        Library("composition", "metier_composition", ("composition_tests", "synchronized_move_tests")),
        _driver("netft"),
        _driver("wsg50"),
        _driver("ur"),
        _driver("edo"),
        _driver("iiwa"),
        Library("records", "metier_records", ("records_tests", "recorded_programs_tests")),
        Library("robot_skills", "metier_robot_skills", ("robot_skills_tests",), ("gripper_nodeset_tests",)),
        Library("motion", "metier_motion", ("motion_tests", "motion_allocation_tests"), ("robot_skills_tests",)),
        Library("client", "metier_client", ("skill_client_tests", "remote_arm_tests", "remote_skill_tests")),
    )
}
