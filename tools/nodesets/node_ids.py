"""Keeps NodeIds stable: published ones come from the facts file, others from NodeIds.csv or are new."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from address_space import NodeSetError

FIRST_NEW_ID = 20001
LAST_ID = 65535


def symbol_of(path: list[str]) -> str:
    """The name of a node in NodeIds.csv and in code: its browse path with only letters and digits."""
    return "_".join(re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") for name in path)


def read_published(path: Path, uri: str) -> dict[str, tuple[int, str]]:
    """Browse path to (identifier, node class) of one namespace of the published model."""
    with path.open(encoding="utf-8", newline="") as file:
        return {
            row["browse_path"]: (int(row["node_id"]), row["node_class"])
            for row in csv.DictReader(file)
            if row["namespace"] == uri
        }


def read_node_ids(path: Path) -> dict[str, tuple[int, str]]:
    """Symbol to (identifier, node class) of a NodeIds.csv; empty if there is none yet."""
    if not path.exists():
        return {}
    with path.open(encoding="utf-8", newline="") as file:
        return {row[0]: (int(row[1]), row[2]) for row in csv.reader(file) if row}


class IdRegistry:
    """Gives each browse path of one namespace its identifier."""

    def __init__(self, published: dict[str, tuple[int, str]], known: dict[str, tuple[int, str]]) -> None:
        self._published = published
        self._known = known
        self._taken = {number for number, _ in published.values()}
        self._taken |= {number for number, _ in known.values()}
        self._next = FIRST_NEW_ID
        self.assigned: dict[str, tuple[int, str]] = {}

    def assign(self, path: list[str], symbol: str, node_class: str) -> int:
        if symbol in self.assigned:
            raise NodeSetError(f"two nodes are named {symbol}: {'/'.join(path)}")
        number = self._number("/".join(path), symbol)
        self.assigned[symbol] = (number, node_class)
        return number

    def _number(self, browse_path: str, symbol: str) -> int:
        if browse_path in self._published:
            return self._published[browse_path][0]
        if symbol in self._known:
            return self._known[symbol][0]
        while self._next in self._taken:
            self._next += 1
        if self._next > LAST_ID:
            raise NodeSetError(f"no free identifier for {browse_path}")
        self._taken.add(self._next)
        return self._next

    def csv_text(self) -> str:
        rows = sorted(self.assigned.items(), key=lambda item: item[1][0])
        return "".join(f"{symbol},{number},{node_class}\n" for symbol, (number, node_class) in rows)
