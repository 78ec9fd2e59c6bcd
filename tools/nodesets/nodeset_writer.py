"""Writes the nodes of one model as NodeSet2.xml."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from xml.sax.saxutils import escape, quoteattr

from address_space import HAS_SUBTYPE, NS0, UANODESET, AddressSpace, Model, Node, NodeId, QualifiedName, Reference
from model_source import Source

HEADER = """<?xml version="1.0" encoding="utf-8"?>
<!-- Made by tools/nodesets/generate_nodesets.py from model.toml; change that file, not this one. -->
"""


class Writer:
    def __init__(self, space: AddressSpace, source: Source, required: list[Model]) -> None:
        self._space = space
        self._source = source
        self._required = required
        self._uris = [NS0, source.uri, *[m.uri for m in required if m.uri != NS0]]

    def text(self, nodes: list[Node]) -> str:
        parts = [HEADER, f'<UANodeSet xmlns="{UANODESET}" LastModified="{self._source.published}">\n']
        parts.append(self._namespaces())
        parts.append(self._models())
        parts.append(self._aliases(nodes))
        parts += [self._node(node) for node in nodes]
        parts.append("</UANodeSet>\n")
        return "".join(parts)

    def _namespaces(self) -> str:
        lines = "".join(f"    <Uri>{escape(uri)}</Uri>\n" for uri in self._uris[1:])
        return f"  <NamespaceUris>\n{lines}  </NamespaceUris>\n"

    def _models(self) -> str:
        required = "".join(
            f'      <RequiredModel ModelUri={quoteattr(m.uri)} Version="{m.version}"'
            f' PublicationDate="{m.publication_date}"/>\n'
            for m in self._required
        )
        return (
            f'  <Models>\n    <Model ModelUri={quoteattr(self._source.uri)} Version="{self._source.version}"'
            f' PublicationDate="{self._source.published}">\n{required}    </Model>\n  </Models>\n'
        )

    def _aliases(self, nodes: list[Node]) -> str:
        used = {r.type_id for n in nodes for r in n.references} | {n.data_type for n in nodes if n.data_type}
        self._names = {i: self._space.nodes[i].browse_name.name for i in used if i.uri == NS0}
        lines = sorted(f'    <Alias Alias="{name}">{i.identifier}</Alias>\n' for i, name in self._names.items())
        return f"  <Aliases>\n{''.join(lines)}  </Aliases>\n"

    def _id(self, node_id: NodeId) -> str:
        index = self._uris.index(node_id.uri)
        return f"ns={index};{node_id.identifier}" if index else node_id.identifier

    def _name(self, node_id: NodeId) -> str:
        return self._names.get(node_id) or self._id(node_id)

    def _browse(self, name: QualifiedName) -> str:
        index = self._uris.index(name.uri)
        return f"{index}:{name.name}" if index else name.name

    def _attributes(self, node: Node) -> str:
        pairs = [("NodeId", self._id(node.node_id)), ("BrowseName", self._browse(node.browse_name))]
        if node.symbolic_name:
            pairs.append(("SymbolicName", node.symbolic_name))
        parent = node.references[0] if node.references else None
        if parent and not parent.forward and parent.type_id != HAS_SUBTYPE:
            pairs.append(("ParentNodeId", self._id(parent.target)))
        if node.data_type:
            pairs.append(("DataType", self._name(node.data_type)))
        for key in ("ValueRank", "ArrayDimensions", "AccessLevel", "EventNotifier", "IsAbstract"):
            value = node.attributes.get(key, "")
            if value and (key, value) != ("AccessLevel", "1"):
                pairs.append((key, value))
        if node.attributes.get("AccessLevel") == "3":
            pairs.append(("UserAccessLevel", "3"))
        if "MethodDeclarationId" in node.attributes:
            pairs.append(("MethodDeclarationId", self._local(node.attributes["MethodDeclarationId"])))
        return " ".join(f"{key}={quoteattr(value)}" for key, value in pairs)

    def _node(self, node: Node) -> str:
        tag = "UA" + node.node_class
        lines = [
            f"  <{tag} {self._attributes(node)}>",
            f"    <DisplayName>{escape(node.display_name)}</DisplayName>",
            f"    <Description>{escape(node.description)}</Description>",
            "    <References>",
            *[self._reference(r) for r in node.references],
            "    </References>",
            *self._inverse_name(node),
            *([self._xml(node.definition)] if node.definition is not None else []),
            *([self._xml(node.value)] if node.value is not None else []),
            f"  </{tag}>\n",
        ]
        return "\n".join(lines)

    def _inverse_name(self, node: Node) -> list[str]:
        name = node.attributes.get("InverseName")
        return [f"    <InverseName>{escape(name)}</InverseName>"] if name else []

    def _reference(self, reference: Reference) -> str:
        direction = "" if reference.forward else ' IsForward="false"'
        return (
            f'      <Reference ReferenceType="{self._name(reference.type_id)}"{direction}>'
            f"{self._id(reference.target)}</Reference>"
        )

    def _xml(self, element: ElementTree.Element) -> str:
        return "    " + self._local(_plain(element, UANODESET))

    def _local(self, text: str) -> str:
        return re.sub(r"nsu=([^;<]+);(i=\d+)", lambda m: self._id(NodeId(m[1], m[2])), text)


def _plain(element: ElementTree.Element, namespace: str) -> str:
    """The element as text, with default namespaces instead of prefixes."""
    uri, _, tag = element.tag[1:].partition("}")
    declared = "" if uri == namespace else f' xmlns="{uri}"'
    attributes = "".join(f" {key}={quoteattr(value)}" for key, value in element.attrib.items())
    inner = "".join(_plain(child, uri) for child in element)
    text = escape(element.text) if element.text and element.text.strip() else ""
    if not inner and not text:
        return f"<{tag}{declared}{attributes}/>"
    return f"<{tag}{declared}{attributes}>{text}{inner}</{tag}>"


