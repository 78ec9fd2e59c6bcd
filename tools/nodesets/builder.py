"""Builds the nodes of one model: types as written, instances expanded from their types."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import values
from address_space import (
    GENERATES_EVENT, HAS_COMPONENT, HAS_INTERFACE, HAS_MODELLING_RULE, HAS_PROPERTY, HAS_SUBTYPE,
    HAS_TYPE_DEFINITION, MODELLING_RULES, ORGANIZES, AddressSpace, Node, NodeId, NodeSetError,
    QualifiedName, Reference, standard,
)
from model_source import Source, Spec
from names import Names
from node_ids import IdRegistry, symbol_of

PROPERTY_TYPE = standard(68)
BASE_OBJECT_TYPE = standard(58)
RULE_IDS = {name: node_id for node_id, name in MODELLING_RULES.items()}
TURN = 2 * math.pi
FRAME_LEAVES = {"0:CartesianCoordinates": ("XYZ", "m"), "0:Orientation": ("ABC", "rad")}


@dataclass
class Place:
    """Where a node is built: its parent, its names, and whether it is part of a type or an instance."""

    parent: NodeId | None
    path: list[str]
    symbol: list[str]
    instance: bool = False
    include: list[str] = field(default_factory=list)
    below: str = ""

    def child(self, parent: NodeId, name: str) -> "Place":
        below = f"{self.below}/{name}" if self.below else name
        return Place(parent, [*self.path, name], [*self.symbol, name], self.instance, self.include, below)

    def includes(self) -> bool:
        return any(_matches(pattern.split("/"), self.below.split("/")) for pattern in self.include)


def _matches(pattern: list[str], path: list[str]) -> bool:
    return len(pattern) == len(path) and all(fnmatchcase(n, p) for p, n in zip(pattern, path))


@dataclass
class Templates:
    """Nodes that a new node takes from: `grow` gives it children, `look` only their attributes."""

    grow: list[Node] = field(default_factory=list)
    look: list[Node] = field(default_factory=list)

    def first(self) -> Node | None:
        return next(iter([*self.grow, *self.look]), None)


class Builder:
    def __init__(self, source: Source, space: AddressSpace, names: Names, ids: IdRegistry,
                 descriptions: dict[str, str]) -> None:
        self._source = source
        self._space = space
        self._names = names
        self._ids = ids
        self._descriptions = descriptions
        self._instances: dict[str, NodeId] = {}
        self.built: list[Node] = []

    # -- roots ---------------------------------------------------------------------------------

    def type_node(self, spec: Spec) -> None:
        table = spec.properties
        base = self._names.type_id(table["base"])
        node_class = self._space.nodes[base].node_class
        place = Place(None, [table.get("published_as", spec.name)], [table.get("symbol", spec.name)],
                      include=table.get("include", []))
        node = self._new(place, node_class, self._names.browse_name(spec.name), table)
        node.references.append(Reference(HAS_SUBTYPE, base, False))
        if table.get("abstract"):
            node.attributes["IsAbstract"] = "true"
        if "inverse" in table:
            node.attributes["InverseName"] = table["inverse"]
        interfaces = [self._names.type_id(i) for i in table.get("interfaces", [])]
        self._add_type_references(node, interfaces, table)
        self.commit(node)
        grow = [n for i in interfaces for n in self._space.type_chain(i)]
        look = self._space.type_chain(base)
        self._children(node, place, Templates(grow, look), spec)

    def extension(self, spec: Spec) -> None:
        """Nodes of this model below a type of another one."""
        foreign = self._space.nodes[self._names.type_id(spec.properties["extends"])]
        name = spec.properties["extends"].partition(":")[2]
        self._extend(foreign, Place(None, [name], [name]), spec)

    def _extend(self, foreign: Node, place: Place, spec: Spec) -> None:
        """Children of a node of another model; those that it has get children themselves."""
        there = {child.browse_name: child for _, child in self._space.children(foreign.node_id)}
        added = Spec(spec.name, spec.properties)
        for name, child in spec.children.items():
            node = there.get(self._names.browse_name(name))
            if node is None or child.properties:
                added.children[name] = child
            else:
                self._extend(node, place.child(node.node_id, node.browse_name.name), child)
        look = self._space.type_chain(foreign.node_id)
        self._children(foreign, place, Templates([], look), added)

    def instance(self, spec: Spec) -> None:
        table = spec.properties
        place = Place(self.resolve(table["parent"]), [spec.name], [table.get("symbol", spec.name)],
                      instance=True, include=table.get("include", []))
        kind = self._names.type_id(table.get("reference", "0:HasComponent"))
        self._node(place, spec, Templates(), kind)

    def raw(self, place: Place, spec: Spec, kind: NodeId) -> NodeId:
        """A node that a generator step adds by itself (metadata, dictionaries)."""
        return self._node(place, spec, Templates(), kind)

    def data_type(self, name: str, doc: str) -> Node:
        """A data type node without references; `commit` takes it when it is complete."""
        place = Place(None, [name], [name])
        return self._new(place, "DataType", self._names.browse_name(name), {"doc": doc})

    # -- one node ------------------------------------------------------------------------------

    def _node(self, place: Place, spec: Spec, templates: Templates, kind: NodeId) -> NodeId:
        table, model = spec.properties, templates.first()
        type_id = self._type_of(place, spec, model)
        node_class = self._class_of(table, model, type_id)
        browse = model.browse_name if model else self._names.browse_name(spec.name)
        node = self._new(place, node_class, browse, table, model)
        if place.parent is not None:
            node.references.append(Reference(kind, place.parent, False))
        if node_class in ("Object", "Variable"):
            node.references.append(Reference(HAS_TYPE_DEFINITION, type_id, True))
        rule = table.get("rule", self._rule(model))
        if rule and not place.instance:
            node.references.append(Reference(HAS_MODELLING_RULE, RULE_IDS[rule], True))
        if node_class == "Method" and place.instance and model:
            node.attributes["MethodDeclarationId"] = str(model.node_id)
        interfaces = [self._names.type_id(i) for i in table.get("interfaces", [])]
        self._add_type_references(node, interfaces, table)
        if node_class == "Variable":
            self._variable(node, place, table, model, type_id)
        self.commit(node)
        if len(place.path) == 1:
            self._instances[spec.name] = node.node_id
        grown = [*templates.grow, *[n for i in interfaces for n in self._space.type_chain(i)]]
        if type_id:
            grown += self._space.type_chain(type_id)
        self._add_facets(node, spec, grown)
        self._children(node, place, Templates(grown, templates.look), spec)
        return node.node_id

    def _new(self, place: Place, node_class: str, browse: QualifiedName, table: dict,
             model: Node | None = None) -> Node:
        number = self._ids.assign(place.path, symbol_of(place.symbol), node_class)
        node = Node(NodeId(self._source.uri, f"i={number}"), node_class, browse, browse.name)
        node.description = table.get("doc") or (model.description if model else "") \
            or self._descriptions.get(browse.name, "")
        if not node.description:
            raise NodeSetError(f"{'/'.join(place.path)} has no description (doc = ...)")
        node.symbolic_name = table.get("symbol", "")
        if table.get("notifier"):
            node.attributes["EventNotifier"] = "1"
        return node

    def commit(self, node: Node) -> None:
        self._space.add(node)
        self._names.add(node)
        self.built.append(node)

    def _type_of(self, place: Place, spec: Spec, model: Node | None) -> NodeId | None:
        table = spec.properties
        if "type" in table:
            return self._names.type_id(table["type"])
        if "state" in table:
            return standard(2307)
        if "transition" in table:
            return standard(2310)
        if table.get("method") or (model and model.node_class == "Method"):
            return None
        if model:
            return self._space.type_definition(model.node_id)
        raise NodeSetError(f"{'/'.join(place.path)} has no type")

    def _class_of(self, table: dict, model: Node | None, type_id: NodeId | None) -> str:
        if type_id is None:
            return "Method"
        if model:
            return model.node_class
        return self._space.nodes[type_id].node_class.replace("Type", "")

    def _rule(self, model: Node | None) -> str:
        return self._space.modelling_rule(model.node_id) if model else ""

    def _add_type_references(self, node: Node, interfaces: list[NodeId], table: dict) -> None:
        for interface in interfaces:
            node.references.append(Reference(HAS_INTERFACE, interface, True))
        for event in table.get("events", []):
            node.references.append(Reference(GENERATES_EVENT, self._names.type_id(event), True))
        for kind, target, direction in table.get("refs", []):
            forward = direction == "forward"
            node.references.append(Reference(self._names.type_id(kind), self.resolve(target), forward))

    # -- variables -----------------------------------------------------------------------------

    def _variable(self, node: Node, place: Place, table: dict, model: Node | None, type_id: NodeId) -> None:
        variable_type = self._space.nodes[type_id]
        self._data_type(node, table, model, variable_type)
        rank = table.get("rank", int(self._inherited("ValueRank", "-1", model, variable_type)))
        rank = -1 if rank == -2 and "rank" not in table else rank
        node.attributes["ValueRank"] = str(rank)
        if rank > 0:
            dims = table.get("dims") or self._inherited("ArrayDimensions", "", model)
            if not isinstance(dims, str):
                dims = ",".join(str(d) for d in dims)
            node.attributes["ArrayDimensions"] = dims or ",".join(["0"] * rank)
        access = table.get("access")
        level = {"r": "1", "rw": "3"}[access] if access else self._inherited("AccessLevel", "1", model)
        node.attributes["AccessLevel"] = level
        self._value(node, place, table, model, rank)

    def _data_type(self, node: Node, table: dict, model: Node | None, variable_type: Node) -> None:
        if "data" in table:
            node.data_type = self._names.type_id(table["data"])
        elif model and model.data_type:
            node.data_type = model.data_type
        else:
            node.data_type = self._inherited_data_type(variable_type)

    def _inherited_data_type(self, variable_type: Node) -> NodeId:
        for node in self._space.type_chain(variable_type.node_id):
            if node.data_type:
                return node.data_type
        return standard(24)

    def _inherited(self, attribute: str, default: str, *models: Node | None) -> str:
        for model in models:
            if model and attribute in model.attributes:
                return model.attributes[attribute]
        return default

    def _value(self, node: Node, place: Place, table: dict, model: Node | None, rank: int) -> None:
        encoding = self._names.encoding_name(node.data_type)
        if "value" in table:
            node.value = values.element(encoding, table["value"])
        elif model is not None and model.value is not None:
            node.value = copy.deepcopy(model.value)
        elif place.instance:
            node.value = values.default_element(encoding, rank, self._length(node))

    def _length(self, node: Node) -> int:
        first = int(node.attributes.get("ArrayDimensions", "0").split(",")[0] or 0)
        return first or self._source.axes

    # -- children ------------------------------------------------------------------------------

    def _children(self, node: Node, place: Place, templates: Templates, spec: Spec) -> None:
        grown = self._children_of(templates.grow)
        looked = self._children_of(templates.look)
        wanted = {self._names.browse_name(name): child for name, child in spec.children.items()}
        for browse in [*grown, *[b for b in wanted if b not in grown]]:
            nodes = grown.get(browse, (None, []))[1]
            kind = (grown.get(browse) or looked.get(browse) or (None, []))[0]
            child_place = place.child(node.node_id, browse.name)
            child = wanted.get(browse)
            if child is None and not self._grows(nodes[0], child_place):
                continue
            child = child or Spec(browse.name)
            child_templates = Templates(nodes, looked.get(browse, (None, []))[1])
            self._node(child_place, child, child_templates, self._kind(child, kind))

    def _grows(self, template: Node, place: Place) -> bool:
        rule = self._rule(template)
        if rule == "Mandatory":
            return True
        return rule == "Optional" and place.includes()

    def _kind(self, spec: Spec, inherited: NodeId | None) -> NodeId:
        if "reference" in spec.properties:
            return self._names.type_id(spec.properties["reference"])
        if inherited is not None:
            return inherited
        is_property = spec.properties.get("type") == "PropertyType"
        return HAS_PROPERTY if is_property else HAS_COMPONENT

    def _children_of(self, templates: list[Node]) -> dict[QualifiedName, tuple[NodeId, list[Node]]]:
        found: dict[QualifiedName, tuple[NodeId, list[Node]]] = {}
        for template in templates:
            for kind, child in self._space.children(template.node_id):
                if kind != ORGANIZES:
                    found.setdefault(child.browse_name, (kind, []))[1].append(child)
        return found

    # -- facets: what follows from one key of the source ----------------------------------------

    def _add_facets(self, node: Node, spec: Spec, grown: list[Node]) -> None:
        table = spec.properties
        rule = {"rule": "Mandatory", "type": "PropertyType"}
        for key, name in (("inputs", "0:InputArguments"), ("outputs", "0:OutputArguments")):
            if key in table:
                arguments = [self._argument(a) for a in table[key]]
                spec.child(name).properties = {**rule, "data": "Argument", "rank": 1, "value": arguments}
        is_scalar = node.attributes.get("ValueRank") == "-1"
        encoding = self._names.encoding_name(node.data_type) if is_scalar else ""
        if encoding == "3DFrame":
            self._frame_facets(spec, table, rule)
        elif encoding == "3DVector":
            self._vector_facets(spec, table, rule)
        elif "unit" in table:
            self._unit_facets(spec, table["unit"], table["range"], rule)
        for key, name in (("state", "0:StateNumber"), ("transition", "0:TransitionNumber")):
            if key in table:
                spec.child(name).properties = {**rule, "data": "UInt32", "value": table[key]}

    def _unit_facets(self, spec: Spec, unit: str, limits: list, rule: dict) -> None:
        units = {**rule, "data": "EUInformation", "value": values.engineering_units(unit)}
        spec.child("0:EngineeringUnits").properties.update(units)
        spec.child("0:EURange").properties.update({**rule, "data": "Range", "value": limits})

    def _frame_facets(self, spec: Spec, table: dict, rule: dict) -> None:
        for part, (leaves, unit) in FRAME_LEAVES.items():
            property_name = "0:LengthUnit" if unit == "m" else "0:AngleUnit"
            units = {**rule, "data": "EUInformation", "value": values.engineering_units(unit)}
            spec.child(part).child(property_name).properties.update(units)
            limits = table.get("range") if unit == "m" else [-TURN, TURN]
            for leaf in leaves if "range" in table else "":
                self._unit_facets(spec.child(part).child(f"0:{leaf}"), unit, limits, rule)

    def _vector_facets(self, spec: Spec, table: dict, rule: dict) -> None:
        if "unit" not in table:
            return
        units = {**rule, "data": "EUInformation", "value": values.engineering_units(table["unit"])}
        spec.child("0:VectorUnit").properties.update(units)
        for leaf in "XYZ" if "range" in table else "":
            self._unit_facets(spec.child(f"0:{leaf}"), table["unit"], table["range"], rule)

    def _argument(self, row: list) -> dict:
        name, data, rank, doc = row
        return {"name": name, "data_type": self._names.type_id(data), "rank": rank, "doc": doc}

    # -- references to other nodes ---------------------------------------------------------------

    def resolve(self, text: str) -> NodeId:
        """A node by type name, or by `<type or root>/<browse path>`, or by `DI#5001`."""
        prefix, hash_mark, number = text.partition("#")
        if hash_mark:
            return NodeId(self._names.uri(prefix), f"i={number}")
        first, *rest = text.split("/")
        node_id = self._root(first)
        for name in rest:
            browse = self._names.browse_name(name)
            found = [n.node_id for _, n in self._space.children(node_id) if n.browse_name == browse]
            if not found:
                raise NodeSetError(f"'{text}': there is no {name}")
            node_id = found[0]
        return node_id

    def _root(self, name: str) -> NodeId:
        return self._instances[name] if name in self._instances else self._names.type_id(name)
