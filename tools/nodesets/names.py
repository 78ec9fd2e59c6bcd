"""Resolves the names that a model source uses (`DI:ComponentType`, `Double`) to nodes."""

from __future__ import annotations

from address_space import NS0, AddressSpace, Node, NodeId, NodeSetError, QualifiedName

TYPE_CLASSES = ("ObjectType", "VariableType", "DataType", "ReferenceType")
BUILTIN = {
    "Boolean", "SByte", "Byte", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float",
    "Double", "String", "DateTime", "Guid", "ByteString", "NodeId", "LocalizedText", "QualifiedName",
    "StatusCode", "Range", "EUInformation", "Argument", "3DFrame", "3DVector",
    "3DCartesianCoordinates", "3DOrientation",
}


class Names:
    """Knows the prefixes of one model source; a name without prefix is the model's own or OPC UA's."""

    def __init__(self, space: AddressSpace, own_uri: str, prefixes: dict[str, str]) -> None:
        self._space = space
        self._own_uri = own_uri
        self._prefixes = {"0": NS0, **prefixes}
        self._types: dict[QualifiedName, NodeId] = {}
        for node in space.nodes.values():
            self.add(node)

    def add(self, node: Node) -> None:
        if node.node_class in TYPE_CLASSES:
            self._types[node.browse_name] = node.node_id

    def uri(self, prefix: str) -> str:
        if prefix not in self._prefixes:
            raise NodeSetError(f"prefix '{prefix}' is not in [model.requires]")
        return self._prefixes[prefix]

    def browse_name(self, text: str) -> QualifiedName:
        prefix, colon, name = text.partition(":")
        is_prefixed = colon and text != self._own_uri  # the metadata object is named after the URI
        return QualifiedName(self.uri(prefix), name) if is_prefixed else QualifiedName(self._own_uri, text)

    def type_id(self, text: str) -> NodeId:
        name = self.browse_name(text)
        if name in self._types:
            return self._types[name]
        if ":" not in text and QualifiedName(NS0, text) in self._types:
            return self._types[QualifiedName(NS0, text)]
        raise NodeSetError(f"there is no type '{text}'")

    def encoding_name(self, data_type: NodeId | None) -> str:
        """The builtin or known structure that values of a data type are written as, or ''."""
        while data_type is not None and data_type in self._space.nodes:
            node = self._space.nodes[data_type]
            if node.browse_name.uri == NS0 and node.browse_name.name in BUILTIN:
                return node.browse_name.name
            if data_type == NodeId(NS0, "i=29"):
                return "Int32"
            data_type = self._space.supertype(data_type)
        return ""
