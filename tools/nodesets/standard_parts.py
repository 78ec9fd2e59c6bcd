"""Adds what every NodeSet has: namespace metadata, enumerations, type dictionaries."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
from xml.sax.saxutils import escape, quoteattr

from address_space import HAS_COMPONENT, HAS_PROPERTY, HAS_SUBTYPE, UANODESET, Reference, standard
from builder import Builder, Place
from model_source import Source, Spec

NAMESPACES = standard(11715)
ENUMERATION = standard(29)
BINARY_TYPE_SYSTEM = standard(93)
XML_TYPE_SYSTEM = standard(92)

METADATA = {
    "NamespaceUri": ("String", -1),
    "NamespaceVersion": ("String", -1),
    "NamespacePublicationDate": ("DateTime", -1),
    "IsNamespaceSubset": ("Boolean", -1),
    "StaticNodeIdTypes": ("IdType", 1),
    "StaticNumericNodeIdRange": ("NumericRange", 1),
    "StaticStringNodeIdPattern": ("String", -1),
    "DefaultRolePermissions": ("RolePermissionType", 1),
    "DefaultUserRolePermissions": ("RolePermissionType", 1),
    "DefaultAccessRestrictions": ("AccessRestrictionType", -1),
}


def add_metadata(builder: Builder, source: Source) -> None:
    """The object below Server/Namespaces that shows URI, version and id range of the namespace."""
    known = {
        "NamespaceUri": source.uri,
        "NamespaceVersion": source.version,
        "NamespacePublicationDate": source.published,
        "IsNamespaceSubset": False,
        "StaticNodeIdTypes": [0],
        "StaticNumericNodeIdRange": ["1:65535"],
    }
    spec = Spec(source.uri, {"type": "0:NamespaceMetadataType", "doc": f"Facts about the namespace: {source.doc}"})
    for name, (data, rank) in METADATA.items():
        properties = {"type": "0:PropertyType", "data": f"0:{data}", "rank": rank}
        if name in known:
            properties["value"] = known[name]
        spec.children[f"0:{name}"] = Spec(name, properties)
    path = f"Root/Objects/Server/Namespaces/{source.uri}"
    builder.raw(Place(NAMESPACES, [path], ["NamespaceMetadata"], instance=True), spec, HAS_COMPONENT)


def add_data_type(builder: Builder, source: Source, table: dict) -> None:
    """An enumeration with its EnumStrings; the values count from zero."""
    fields = "".join(
        f"<Field Name={quoteattr(name)} Value=\"{number}\"><Description>{escape(doc)}</Description></Field>"
        for number, (name, doc) in enumerate(table["values"])
    )
    definition = f'<Definition xmlns="{UANODESET}" Name={quoteattr(table["name"])}>{fields}</Definition>'
    node = builder.data_type(table["name"], table["doc"])
    node.references.append(Reference(HAS_SUBTYPE, ENUMERATION, False))
    node.definition = ElementTree.fromstring(definition)
    builder.commit(node)
    strings = Spec("0:EnumStrings", {
        "type": "0:PropertyType", "data": "0:LocalizedText", "rank": 1, "rule": "Mandatory",
        "value": [name for name, _ in table["values"]],
    })
    place = Place(node.node_id, [table["name"], "EnumStrings"], [table["name"], "EnumStrings"])
    builder.raw(place, strings, HAS_PROPERTY)


def add_dictionaries(builder: Builder, source: Source) -> None:
    """The deprecated type dictionaries that tools of the 1.03 age read (and Debian's compiler)."""
    name = source.dictionary["name"]
    for kind, parent, text, uri in (
        ("OPC Binary", BINARY_TYPE_SYSTEM, binary_schema(source), source.uri),
        ("XML Schema", XML_TYPE_SYSTEM, xml_schema(source), source.dictionary["xml_uri"]),
    ):
        suffix = "BinarySchema" if kind == "OPC Binary" else "XmlSchema"
        symbol = f"{source.dictionary['symbol']}_{suffix}"
        value = base64.b64encode(text.encode()).decode()
        spec = Spec(name, {
            "type": "0:DataTypeDictionaryType", "data": "0:ByteString", "value": value, "symbol": symbol,
            "doc": f"Data types of the namespace in the {kind} language.",
        })
        spec.child("0:NamespaceUri").properties = {"type": "0:PropertyType", "data": "0:String", "value": uri}
        spec.child("0:Deprecated").properties = {"type": "0:PropertyType", "data": "0:Boolean", "value": True}
        place = Place(parent, [f"Root/Types/DataTypes/{kind}/{name}"], [symbol], instance=True)
        builder.raw(place, spec, HAS_COMPONENT)


def binary_schema(source: Source) -> str:
    types = "".join(
        f'  <opc:EnumeratedType Name="{table["name"]}" LengthInBits="32">\n'
        + "".join(
            f'    <opc:EnumeratedValue Name="{name}" Value="{number}"/>\n'
            for number, (name, _) in enumerate(table["values"])
        )
        + "  </opc:EnumeratedType>\n"
        for table in source.data_types
    )
    return (
        '<opc:TypeDictionary xmlns:opc="http://opcfoundation.org/BinarySchema/"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:ua="http://opcfoundation.org/UA/"'
        f' xmlns:tns="{source.uri}" DefaultByteOrder="LittleEndian" TargetNamespace="{source.uri}">\n'
        '  <opc:Import Namespace="http://opcfoundation.org/UA/"/>\n'
        f"{types}</opc:TypeDictionary>\n"
    )


def xml_schema(source: Source) -> str:
    uri = source.dictionary["xml_uri"]
    types = "".join(
        f'  <xs:simpleType name="{table["name"]}">\n    <xs:restriction base="xs:string">\n'
        + "".join(
            f'      <xs:enumeration value="{name}_{number}"/>\n' for number, (name, _) in enumerate(table["values"])
        )
        + f'    </xs:restriction>\n  </xs:simpleType>\n'
        f'  <xs:element name="{table["name"]}" type="tns:{table["name"]}"/>\n'
        for table in source.data_types
    )
    return (
        f'<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:tns="{uri}" targetNamespace="{uri}"'
        f' elementFormDefault="qualified">\n{types}</xs:schema>\n'
    )


