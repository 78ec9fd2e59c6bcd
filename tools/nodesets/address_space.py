"""Reads NodeSet2.xml files into one graph whose NodeIds carry namespace URIs, not indexes."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Iterator, NamedTuple

NS0 = "http://opcfoundation.org/UA/"
UANODESET = "http://opcfoundation.org/UA/2011/03/UANodeSet.xsd"
UATYPES = "http://opcfoundation.org/UA/2008/02/Types.xsd"
TAG = "{" + UANODESET + "}"


class NodeId(NamedTuple):
    uri: str
    identifier: str

    def __str__(self) -> str:
        return f"nsu={self.uri};{self.identifier}"


class QualifiedName(NamedTuple):
    uri: str
    name: str


class Reference(NamedTuple):
    type_id: NodeId
    target: NodeId
    forward: bool


def standard(number: int) -> NodeId:
    """NodeId of the OPC UA namespace."""
    return NodeId(NS0, f"i={number}")


HAS_MODELLING_RULE = standard(37)
HAS_ENCODING = standard(38)
HAS_TYPE_DEFINITION = standard(40)
GENERATES_EVENT = standard(41)
HAS_SUBTYPE = standard(45)
HAS_PROPERTY = standard(46)
HAS_COMPONENT = standard(47)
HAS_ORDERED_COMPONENT = standard(49)
HAS_INTERFACE = standard(17603)
HAS_ADD_IN = standard(17604)
ORGANIZES = standard(35)
CHILD_REFERENCES = (HAS_PROPERTY, HAS_COMPONENT, HAS_ORDERED_COMPONENT, HAS_ADD_IN, ORGANIZES)
MODELLING_RULES = {
    standard(78): "Mandatory",
    standard(80): "Optional",
    standard(11508): "OptionalPlaceholder",
    standard(11510): "MandatoryPlaceholder",
}


@dataclass
class Node:
    node_id: NodeId
    node_class: str
    browse_name: QualifiedName
    display_name: str = ""
    description: str = ""
    symbolic_name: str = ""
    data_type: NodeId | None = None
    attributes: dict[str, str] = field(default_factory=dict)
    references: list[Reference] = field(default_factory=list)
    value: ElementTree.Element | None = None
    definition: ElementTree.Element | None = None


@dataclass
class Model:
    uri: str
    version: str
    publication_date: str
    required: list[tuple[str, str, str]] = field(default_factory=list)


class NodeSetError(Exception):
    """A NodeSet or model source that cannot be used; the text says where and why."""


class AddressSpace:
    """The nodes of any number of NodeSets, with references seen from both ends."""

    def __init__(self) -> None:
        self.nodes: dict[NodeId, Node] = {}
        self.models: dict[str, Model] = {}
        self._outgoing: dict[NodeId, list[tuple[NodeId, NodeId]]] = {}
        self._incoming: dict[NodeId, list[tuple[NodeId, NodeId]]] = {}

    def add(self, node: Node) -> None:
        if node.node_id in self.nodes:
            raise NodeSetError(f"{node.node_id} ({node.browse_name.name}) is there twice")
        self.nodes[node.node_id] = node
        for reference in node.references:
            self._link(node.node_id, reference)

    def _link(self, source: NodeId, reference: Reference) -> None:
        ends = (source, reference.target) if reference.forward else (reference.target, source)
        outgoing = self._outgoing.setdefault(ends[0], [])
        if (reference.type_id, ends[1]) not in outgoing:
            outgoing.append((reference.type_id, ends[1]))
            self._incoming.setdefault(ends[1], []).append((reference.type_id, ends[0]))

    def targets(self, source: NodeId, type_id: NodeId) -> list[NodeId]:
        return [target for kind, target in self._outgoing.get(source, []) if kind == type_id]

    def sources(self, target: NodeId, type_id: NodeId) -> list[NodeId]:
        return [source for kind, source in self._incoming.get(target, []) if kind == type_id]

    def has_reference(self, source: NodeId, type_id: NodeId, target: NodeId) -> bool:
        return (type_id, target) in self._outgoing.get(source, [])

    def children(self, parent: NodeId) -> Iterator[tuple[NodeId, Node]]:
        """Pairs of reference type and child node; nodes that are not loaded are left out."""
        for kind, target in self._outgoing.get(parent, []):
            if kind in CHILD_REFERENCES and target in self.nodes:
                yield kind, self.nodes[target]

    def type_definition(self, node_id: NodeId) -> NodeId | None:
        return next(iter(self.targets(node_id, HAS_TYPE_DEFINITION)), None)

    def modelling_rule(self, node_id: NodeId) -> str:
        rule = next(iter(self.targets(node_id, HAS_MODELLING_RULE)), None)
        return MODELLING_RULES.get(rule, "") if rule else ""

    def supertype(self, node_id: NodeId) -> NodeId | None:
        return next(iter(self.sources(node_id, HAS_SUBTYPE)), None)

    def type_chain(self, node_id: NodeId | None) -> list[Node]:
        """The type, its interfaces, then its supertype and so on, most derived first."""
        chain: list[Node] = []
        while node_id is not None and node_id in self.nodes:
            chain.append(self.nodes[node_id])
            for interface in self.targets(node_id, HAS_INTERFACE):
                chain += self.type_chain(interface)
            node_id = self.supertype(node_id)
        return chain

    def is_subtype(self, node_id: NodeId | None, ancestor: NodeId) -> bool:
        while node_id is not None:
            if node_id == ancestor:
                return True
            node_id = self.supertype(node_id)
        return False

    def load(self, path: Path) -> Model:
        """Adds all nodes of a NodeSet2.xml and returns its model entry; the nodes must not be changed."""
        if not path.is_file():
            raise NodeSetError(f"{path} is not there")
        nodes, model = _read(path, path.stat().st_mtime_ns)
        for node in nodes:
            self.add(node)
        self.models[model.uri] = model
        return model


@lru_cache(maxsize=32)
def _read(path: Path, _modified: int) -> tuple[list[Node], Model]:
    """Reads a file once, however many address spaces take it, as long as it does not change."""
    reader = _Reader(path)
    return reader.nodes(), reader.model()


class _Reader:
    """Reads one file; keeps its namespace table and aliases."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._root = ElementTree.parse(path).getroot()
        except (OSError, ElementTree.ParseError) as error:
            raise NodeSetError(f"{path}: {error}") from error
        if self._root.tag != TAG + "UANodeSet":
            raise NodeSetError(f"{path}: the root element is not UANodeSet")
        uris = self._root.find(TAG + "NamespaceUris")
        self._uris = [NS0] + [e.text.strip() for e in (uris if uris is not None else [])]
        aliases = self._root.find(TAG + "Aliases")
        self._aliases = {
            e.get("Alias"): self._node_id(e.text) for e in (aliases if aliases is not None else [])
        }

    def nodes(self) -> list[Node]:
        return [self._node(element) for element in self._root if element.get("NodeId")]

    def model(self) -> Model:
        element = self._root.find(f"{TAG}Models/{TAG}Model")
        if element is None:
            raise NodeSetError(f"{self._path}: no Models/Model element")
        required = [
            (e.get("ModelUri", ""), e.get("Version", ""), e.get("PublicationDate", ""))
            for e in element.findall(TAG + "RequiredModel")
        ]
        return Model(
            element.get("ModelUri", ""),
            element.get("Version", ""),
            element.get("PublicationDate", ""),
            required,
        )

    def _node_id(self, text: str | None) -> NodeId:
        text = (text or "").strip()
        index, identifier = 0, text
        if text.startswith("ns="):
            head, _, identifier = text.partition(";")
            index = int(head[3:])
        if index >= len(self._uris) or "=" not in identifier:
            raise NodeSetError(f"{self._path}: '{text}' is not a NodeId of this file")
        return NodeId(self._uris[index], identifier)

    def _resolve(self, text: str | None) -> NodeId:
        name = (text or "").strip()
        return self._aliases[name] if name in self._aliases else self._node_id(name)

    def _qualified_name(self, text: str) -> QualifiedName:
        head, colon, rest = text.partition(":")
        if colon and head.isdigit():
            return QualifiedName(self._uris[int(head)], rest)
        return QualifiedName(NS0, text)

    def _text(self, element: ElementTree.Element, tag: str) -> str:
        found = element.find(TAG + tag)
        return (found.text or "").strip() if found is not None else ""

    def _node(self, element: ElementTree.Element) -> Node:
        data_type = element.get("DataType")
        references = element.find(TAG + "References")
        return Node(
            node_id=self._node_id(element.get("NodeId")),
            node_class=element.tag[len(TAG) + 2:],
            browse_name=self._qualified_name(element.get("BrowseName", "")),
            display_name=self._text(element, "DisplayName"),
            description=self._text(element, "Description"),
            symbolic_name=element.get("SymbolicName", ""),
            data_type=self._resolve(data_type) if data_type else None,
            attributes=dict(element.attrib),
            references=[
                Reference(
                    self._resolve(e.get("ReferenceType")),
                    self._node_id(e.text),
                    e.get("IsForward", "true") != "false",
                )
                for e in (references if references is not None else [])
            ],
            value=self._value(element.find(TAG + "Value")),
            definition=element.find(TAG + "Definition"),
        )

    def _value(self, value: ElementTree.Element | None) -> ElementTree.Element | None:
        """The value with the NodeIds in it made independent of this file's namespace table."""
        for identifier in value.iter("{" + UATYPES + "}Identifier") if value is not None else ():
            if (identifier.text or "").strip().startswith("ns="):
                identifier.text = str(self._node_id(identifier.text))
        return value
