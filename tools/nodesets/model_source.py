"""Reads a model source (model.toml): what a NodeSet adds, one line per node that is written by hand."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from address_space import NodeSetError

NODE_KEYS = {
    "type", "data", "rank", "dims", "rule", "value", "unit", "range", "doc", "access", "method",
    "inputs", "outputs", "symbol", "notifier", "include", "interfaces", "events", "refs", "state",
    "transition", "reference",
}
ROOT_KEYS = {
    "name", "base", "abstract", "doc", "symbol", "interfaces", "events", "children", "extends",
    "parent", "type", "notifier", "include", "refs", "published_as", "reference", "inverse",
}


@dataclass
class Spec:
    """A node as the source names it, with the nodes below it."""

    name: str
    properties: dict = field(default_factory=dict)
    children: dict[str, "Spec"] = field(default_factory=dict)

    def child(self, name: str) -> "Spec":
        return self.children.setdefault(name, Spec(name))

    def at(self, path: str) -> "Spec":
        spec = self
        for name in path.split("/"):
            spec = spec.child(name)
        return spec


@dataclass
class Source:
    """A whole model source; `requires` maps prefixes to (folder or official name)."""

    path: Path
    uri: str
    prefix: str
    version: str
    published: str
    doc: str
    requires: dict[str, str]
    axes: int
    data_types: list[dict]
    types: list[Spec]
    extensions: list[Spec]
    instances: list[Spec]
    dictionary: dict


def _spec(path: Path, table: dict, name: str) -> Spec:
    unknown = set(table) - ROOT_KEYS
    if unknown:
        raise NodeSetError(f"{path}: {name}: unknown key {', '.join(sorted(unknown))}")
    spec = Spec(name, {k: v for k, v in table.items() if k != "children"})
    for child_path, properties in table.get("children", {}).items():
        unknown = set(properties) - NODE_KEYS
        if unknown:
            raise NodeSetError(f"{path}: {name}/{child_path}: unknown key {', '.join(sorted(unknown))}")
        spec.at(child_path).properties.update(properties)
    return spec


def read(path: Path) -> Source:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise NodeSetError(f"{path}: {error}") from error
    try:
        model = table["model"]
        return Source(
            path=path,
            uri=model["uri"],
            prefix=model["prefix"],
            version=model["version"],
            published=model["published"],
            doc=model["doc"],
            requires=model["requires"],
            axes=model.get("axes", 0),
            data_types=table.get("data_type", []),
            types=[_spec(path, t, t["name"]) for t in table.get("type", [])],
            extensions=[_spec(path, t, t["extends"]) for t in table.get("extend", [])],
            instances=[_spec(path, t, t["name"]) for t in table.get("instance", [])],
            dictionary=model.get("dictionary", {}),
        )
    except KeyError as error:
        raise NodeSetError(f"{path}: key {error} is missing") from error
