#!/usr/bin/env python3
"""Makes NodeSet2.xml and NodeIds.csv of each folder under nodesets/ from its model.toml.

NodeIds never change: published ones come from nodesets/published_2020.csv, all others keep
what NodeIds.csv says; a new node gets the next free identifier above 20000.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from pathlib import Path

import model_source
import standard_parts
from address_space import AddressSpace, Model, NodeSetError
from builder import Builder
from names import Names
from node_ids import IdRegistry, read_node_ids, read_published
from nodeset_writer import Writer

REPOSITORY = Path(__file__).resolve().parents[2]
DEFAULT_BASE = Path("/usr/share/open62541/schema/Opc.Ua.NodeSet2.xml")
DEFAULT_OFFICIAL = REPOSITORY / "nodesets/node_modules/node-opcua-nodesets/nodesets"
XML_NAME = "NodeSet2.xml"


class Generator:
    """Makes the folders in the order in which they need each other, each one once."""

    def __init__(self, root: Path, base: Path, official: Path) -> None:
        self._root = root
        self._base = base
        self._official = official
        self._descriptions = tomllib.loads((root / "descriptions.toml").read_text(encoding="utf-8"))
        self.files: dict[Path, str] = {}

    def make(self, folder: str) -> AddressSpace:
        """Generates one folder into `files`; returns the space with it and all that it requires."""
        source = model_source.read(self._root / folder / "model.toml")
        space = AddressSpace()
        models = [space.load(self._base)]
        prefixes = {source.prefix: source.uri}
        for prefix, name in source.requires.items():
            models.append(self._load(space, folder, name))
            prefixes[prefix] = models[-1].uri
        names = Names(space, source.uri, prefixes)
        ids = IdRegistry(
            read_published(self._root / "published_2020.csv", source.uri),
            read_node_ids(self._root / folder / "NodeIds.csv"),
        )
        builder = Builder(source, space, names, ids, self._descriptions)
        _build(builder, source)
        self.files[self._root / folder / XML_NAME] = Writer(space, source, models).text(builder.built)
        self.files[self._root / folder / "NodeIds.csv"] = ids.csv_text()
        return space

    def _load(self, space: AddressSpace, folder: str, name: str) -> Model:
        path = self._official / name if name.endswith(".xml") else self._root / name / XML_NAME
        if not path.exists():
            raise NodeSetError(f"{folder} requires {path}, which is not there")
        return space.load(path)


def _build(builder: Builder, source: model_source.Source) -> None:
    standard_parts.add_metadata(builder, source)
    for table in source.data_types:
        standard_parts.add_data_type(builder, source, table)
    for spec in source.types:
        builder.type_node(spec)
    for spec in source.extensions:
        builder.extension(spec)
    if source.dictionary:
        standard_parts.add_dictionaries(builder, source)
    for spec in source.instances:
        builder.instance(spec)


def differences(files: dict[Path, str]) -> list[Path]:
    """The files that do not hold what the model sources give."""
    return [p for p, text in files.items() if not p.exists() or p.read_text(encoding="utf-8") != text]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders under the root, each after those that it requires")
    parser.add_argument("--root", type=Path, default=REPOSITORY / "nodesets", help="default: %(default)s")
    parser.add_argument("--base", type=Path, default=DEFAULT_BASE, help="NodeSet of OPC UA itself (%(default)s)")
    parser.add_argument("--official", type=Path, default=DEFAULT_OFFICIAL,
                        help="folder with the NodeSets of the OPC Foundation (%(default)s)")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a file is out of date")
    options = parser.parse_args(arguments)
    try:
        return _run(options)
    except NodeSetError as error:
        print(f"generate_nodesets: {error}", file=sys.stderr)
        return 1


def _run(options: argparse.Namespace) -> int:
    generator = Generator(options.root, options.base, options.official)
    stale: list[Path] = []
    for folder in options.folders:
        generator.files.clear()
        generator.make(folder)
        changed = differences(generator.files)
        stale += changed
        for path in [] if options.check else changed:
            path.write_text(generator.files[path], encoding="utf-8")
            print(f"wrote {path}")
    if options.check and stale:
        names = ", ".join(str(p) for p in stale)
        raise NodeSetError(f"out of date, run tools/nodesets/generate_nodesets.py: {names}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
