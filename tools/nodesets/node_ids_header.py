#!/usr/bin/env python3
"""Makes a C++ header with the numeric NodeIds of NodeIds.csv files, one namespace for each file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from address_space import NodeSetError
from node_ids import read_node_ids


def header_text(models: list[tuple[str, str, Path]]) -> str:
    """`models`: name of the C++ namespace, URI, NodeIds.csv."""
    parts = [
        "// Made by tools/nodesets/node_ids_header.py from nodesets/*/NodeIds.csv.\n"
        "#pragma once\n\n#include <cstdint>\n#include <string_view>\n\n"
        "/// Numeric NodeIds by browse path, and the URI of the namespace that they belong to.\n"
        "namespace metier::nodesets {\n"
    ]
    for name, uri, path in models:
        ids = read_node_ids(path)
        if not ids:
            raise NodeSetError(f"{path} has no ids")
        parts.append(f'\nnamespace {name} {{\ninline constexpr std::string_view kUri = "{uri}";\n')
        parts += [f"inline constexpr std::uint32_t k{_camel(symbol)} = {number};\n" for symbol, (number, _) in ids.items()]
        parts.append(f"}}  // namespace {name}\n")
    parts.append("\n}  // namespace metier::nodesets\n")
    return "".join(parts)


def _camel(symbol: str) -> str:
    return symbol[0].upper() + symbol[1:]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="+", metavar="NAME=URI=CSV", help="C++ namespace, URI, NodeIds.csv")
    parser.add_argument("--output", type=Path, required=True, help="header to write")
    options = parser.parse_args(arguments)
    try:
        models = []
        for text in options.models:
            parts = text.split("=")
            if len(parts) != 3:
                raise NodeSetError(f"'{text}' is not NAME=URI=CSV")
            models.append((parts[0], parts[1], Path(parts[2])))
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(header_text(models), encoding="utf-8")
    except (NodeSetError, OSError) as error:
        print(f"node_ids_header: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
