#!/usr/bin/env python3
"""Makes the two files that the NodeSet compiler of open62541 needs besides a NodeSet2.xml:
a CSV with the ids of the data types and of their encodings, and a BSD with their layout.

Both follow from the NodeSet: the BSD lies in its type dictionary variable, the CSV in the nodes.
A NodeSet without data types gives an empty CSV and a BSD without types.
"""

from __future__ import annotations

import argparse
import base64
import sys
from pathlib import Path

from address_space import HAS_ENCODING, UATYPES, AddressSpace, Model, Node, NodeSetError, standard

DICTIONARY_TYPE = standard(72)
BINARY_TYPE_SYSTEM = standard(93)
EMPTY_BSD = (
    '<opc:TypeDictionary xmlns:opc="http://opcfoundation.org/BinarySchema/"'
    ' xmlns:ua="http://opcfoundation.org/UA/" DefaultByteOrder="LittleEndian" TargetNamespace="{uri}"/>\n'
)


def csv_text(space: AddressSpace, uri: str) -> str:
    """Rows `name,id,DataType` and `name_Encoding_DefaultBinary,id,Object` of one namespace."""
    rows = []
    for node in _data_types(space, uri):
        name = node.symbolic_name or node.browse_name.name
        rows.append(f"{name},{_number(node)},DataType\n")
        for encoding in space.targets(node.node_id, HAS_ENCODING):
            if encoding in space.nodes and space.nodes[encoding].browse_name.name == "Default Binary":
                rows.append(f"{name}_Encoding_DefaultBinary,{_number(space.nodes[encoding])},Object\n")
    return "".join(rows)


def bsd_text(space: AddressSpace, uri: str) -> str:
    """The content of the binary type dictionary of one namespace."""
    for node in space.nodes.values():
        if node.node_id.uri == uri and _is_binary_dictionary(space, node):
            return _content(node)
    if _data_types(space, uri):
        raise NodeSetError(f"{uri} has data types but no binary type dictionary (OPC Binary, i=93)")
    return EMPTY_BSD.format(uri=uri)


def _data_types(space: AddressSpace, uri: str) -> list[Node]:
    return [n for n in space.nodes.values() if n.node_id.uri == uri and n.node_class == "DataType"]


def _number(node: Node) -> str:
    kind, _, identifier = node.node_id.identifier.partition("=")
    if kind != "i":
        raise NodeSetError(f"{node.node_id}: only numeric NodeIds are supported for data types")
    return identifier


def _is_binary_dictionary(space: AddressSpace, node: Node) -> bool:
    """A dictionary variable that the OPC Binary type system holds; the others are XML schemas."""
    return (
        node.node_class == "Variable"
        and space.type_definition(node.node_id) == DICTIONARY_TYPE
        and any(node.node_id in space.targets(BINARY_TYPE_SYSTEM, kind) for kind in (standard(47), standard(35)))
    )


def _content(node: Node) -> str:
    element = node.value.find("{" + UATYPES + "}ByteString") if node.value is not None else None
    if element is None or not (element.text or "").strip():
        raise NodeSetError(f"{node.node_id}: the type dictionary is empty")
    try:
        return base64.b64decode(element.text).decode("utf-8-sig")
    except ValueError as error:
        raise NodeSetError(f"{node.node_id}: the type dictionary is not base64 of text: {error}") from error


def load(path: Path) -> tuple[AddressSpace, Model]:
    space = AddressSpace()
    return space, space.load(path)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nodeset", type=Path, help="a NodeSet2.xml")
    parser.add_argument("--csv", type=Path, required=True, help="file to write the ids to")
    parser.add_argument("--bsd", type=Path, required=True, help="file to write the layout to")
    options = parser.parse_args(arguments)
    try:
        space, model = load(options.nodeset)
        options.csv.write_text(csv_text(space, model.uri), encoding="utf-8")
        options.bsd.write_text(bsd_text(space, model.uri), encoding="utf-8")
    except (NodeSetError, OSError) as error:
        print(f"nodeset_inputs: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
