#!/usr/bin/env python3
"""Checks the NodeSets under nodesets/: ids, published facts, references, texts, units, instances.

Prints one line for each fault and exits 1 if there is any.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path
from typing import Iterator

import model_source
from address_space import (
    HAS_INTERFACE, HAS_SUBTYPE, NS0, ORGANIZES, AddressSpace, Node, NodeId, NodeSetError, QualifiedName, standard,
)
from generate_nodesets import DEFAULT_BASE, DEFAULT_OFFICIAL, REPOSITORY, XML_NAME
from node_ids import FIRST_NEW_ID, LAST_ID, read_node_ids

ENUMERATION = standard(29)
NUMBER = standard(26)
RANGE = standard(884)
PROPERTY_TYPE = standard(68)
PARAMETER_OBJECTS = ("ParameterSet", "Options")
UNIT_PROPERTIES = ("EngineeringUnits", "EURange")


class Checker:
    """The NodeSet of one folder, with all that it requires."""

    def __init__(self, root: Path, folder: str, base: Path, official: Path) -> None:
        self.source = model_source.read(root / folder / "model.toml")
        self._root = root
        self._folder = folder
        self.space = AddressSpace()
        self.space.load(base)
        for name in self.source.requires.values():
            self.space.load(official / name if name.endswith(".xml") else root / name / XML_NAME)
        self.space.load(root / folder / XML_NAME)
        self.own = [n for n in self.space.nodes.values() if n.node_id.uri == self.source.uri]

    def faults(self) -> Iterator[str]:
        for check in (self.ids, self.texts, self.references, self.units, self.mandatory_children, self.published):
            for fault in check():
                yield f"{self._folder}: {fault}"

    def path(self, node: Node) -> list[str]:
        """The BrowseNames from the type or the root of the instance down to the node."""
        names = [node.browse_name.name]
        while True:
            parent = next((r for r in node.references if not r.forward and r.type_id != HAS_SUBTYPE), None)
            if parent is None or parent.target not in self.space.nodes:
                return names
            node = self.space.nodes[parent.target]
            if node.node_id.uri == NS0:
                return names
            names.insert(0, node.browse_name.name)

    # -- the checks ------------------------------------------------------------------------------

    def ids(self) -> Iterator[str]:
        """Identifiers are numeric, published or new, and those of NodeIds.csv."""
        published = {row["node_id"] for row in self._published_rows()}
        listed = {number: (symbol, kind) for symbol, (number, kind) in
                  read_node_ids(self._root / self._folder / "NodeIds.csv").items()}
        for node in self.own:
            kind, _, text = node.node_id.identifier.partition("=")
            if kind != "i" or not text.isdigit():
                yield f"{node.node_id} is not numeric"
                continue
            if text not in published and not FIRST_NEW_ID <= int(text) <= LAST_ID:
                yield f"{text} ({node.browse_name.name}) is neither published nor in {FIRST_NEW_ID}..{LAST_ID}"
            if listed.pop(int(text), ("", ""))[1] != node.node_class:
                yield f"{text} ({node.browse_name.name}) is not in NodeIds.csv as {node.node_class}"
        yield from (f"NodeIds.csv has {number} ({symbol}), the NodeSet does not" for number, (symbol, _) in listed.items())

    def texts(self) -> Iterator[str]:
        for node in self.own:
            if not node.display_name:
                yield f"{node.node_id.identifier} {node.browse_name.name} has no DisplayName"
            if not node.description:
                yield f"{node.node_id.identifier} {node.browse_name.name} has no Description"

    def references(self) -> Iterator[str]:
        for node in self.own:
            for reference in node.references:
                for target in (reference.type_id, reference.target):
                    if target not in self.space.nodes:
                        yield f"{node.node_id.identifier} {node.browse_name.name} refers to {target}, which is not there"
            if node.data_type and node.data_type not in self.space.nodes:
                yield f"{node.node_id.identifier} {node.browse_name.name} has the unknown data type {node.data_type}"

    def units(self) -> Iterator[str]:
        """Every numeric parameter has its unit and its range."""
        for node in self.own:
            if not self._is_numeric_parameter(node):
                continue
            have = {child.browse_name.name for _, child in self.space.children(node.node_id)}
            for name in UNIT_PROPERTIES:
                if name not in have:
                    yield f"{node.node_id.identifier} {'/'.join(self.path(node))} has no {name}"

    def _is_numeric_parameter(self, node: Node) -> bool:
        if node.node_class != "Variable" or self.space.type_definition(node.node_id) == PROPERTY_TYPE:
            return False
        is_number = self.space.is_subtype(node.data_type, NUMBER) and not self.space.is_subtype(node.data_type, ENUMERATION)
        if not is_number and node.data_type != RANGE:
            return False
        return any(name in PARAMETER_OBJECTS for name in self.path(node)[:-1])

    def mandatory_children(self) -> Iterator[str]:
        """Every object and variable has the mandatory children of its type, at every depth."""
        for node in self.own:
            definition = self.space.type_definition(node.node_id)
            if definition is not None:
                yield from self._missing(node, self._templates(node))

    def _templates(self, node: Node) -> list[Node]:
        definition = self.space.type_definition(node.node_id)
        sources = [definition, *self.space.targets(node.node_id, HAS_INTERFACE)]
        return [template for source in sources for template in self.space.type_chain(source)]

    def _missing(self, node: Node, templates: list[Node]) -> Iterator[str]:
        have = self._children([node])
        for name, declarations in self._children(templates).items():
            if name in have:
                yield from self._missing(have[name][0], declarations)
            elif self.space.modelling_rule(declarations[0].node_id) == "Mandatory":
                yield f"{node.node_id.identifier} {'/'.join(self.path(node))} lacks {name.name}"

    def _children(self, parents: list[Node]) -> dict[QualifiedName, list[Node]]:
        found: dict[QualifiedName, list[Node]] = {}
        for parent in parents:
            for kind, child in self.space.children(parent.node_id):
                if kind != ORGANIZES:
                    found.setdefault(child.browse_name, []).append(child)
        return found

    # -- published facts -------------------------------------------------------------------------

    def _published_rows(self) -> list[dict[str, str]]:
        return [r for r in _read_csv(self._root / "published_2020.csv") if r["namespace"] == self.source.uri]

    def published(self) -> Iterator[str]:
        """Every published node is as it was, but for the listed differences."""
        changes = {
            (r["browse_path"], r["column"]): r["now"]
            for r in _read_csv(self._root / "published_differences.csv")
            if r["namespace"] == self.source.uri
        }
        renamed = {path: now for (path, column), now in changes.items() if column == "browse_path"}
        for row in self._published_rows():
            node = self.space.nodes.get(NodeId(self.source.uri, f"i={row['node_id']}"))
            if node is None:
                yield f"the published node {row['node_id']} {row['browse_path']} is not there"
                continue
            facts = self._facts(node, row["browse_path"])
            for column, now in facts.items():
                expected = changes.get((row["browse_path"], column), row[column])
                if column == "browse_path":
                    first, slash, rest = row[column].partition("/")
                    expected = renamed.get(first, first) + slash + rest
                if now != expected:
                    yield f"{row['node_id']} {row['browse_path']}: {column} is '{now}', published '{expected}'"

    def _facts(self, node: Node, published_path: str) -> dict[str, str]:
        is_type = node.node_class.endswith("Type")
        variable = node.node_class == "Variable"
        facts = {
            "node_class": node.node_class,
            "type": self._name(self.space.supertype(node.node_id) if is_type else self.space.type_definition(node.node_id)),
            "data_type": self._name(node.data_type),
            "value_rank": node.attributes.get("ValueRank", "-1") if variable else "",
            "array_dimensions": node.attributes.get("ArrayDimensions", "") if variable else "",
            "modelling_rule": self.space.modelling_rule(node.node_id),
            "abstract": node.attributes.get("IsAbstract", ""),
            "interfaces": " ".join(self._name(i) for i in self.space.targets(node.node_id, HAS_INTERFACE)),
        }
        if not published_path.startswith("Root/"):
            facts["browse_path"] = "/".join(self.path(node))
        return facts

    def _name(self, node_id: NodeId | None) -> str:
        return self.space.nodes[node_id].browse_name.name if node_id in self.space.nodes else ""


def _read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders under the root")
    parser.add_argument("--root", type=Path, default=REPOSITORY / "nodesets", help="default: %(default)s")
    parser.add_argument("--base", type=Path, default=DEFAULT_BASE, help="NodeSet of OPC UA itself (%(default)s)")
    parser.add_argument("--official", type=Path, default=DEFAULT_OFFICIAL,
                        help="folder with the NodeSets of the OPC Foundation (%(default)s)")
    options = parser.parse_args(arguments)
    try:
        faults = [f for folder in options.folders
                  for f in Checker(options.root, folder, options.base, options.official).faults()]
    except (NodeSetError, OSError) as error:
        faults = [str(error)]
    for fault in faults:
        print(f"check_nodesets: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
