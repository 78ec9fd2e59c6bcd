#!/usr/bin/env python3
"""Compares the table of libraries in docs/architecture.md with what CMake builds.

  tools/lint/rooms.py     prints one line for each difference; status 1 if there is one

Checked: each library has a row and each row a library; a row names exactly the libraries that CMake links, `base`
aside; a library stands below those that it uses; there are at most 25 rows. A row with a star, as drivers/*, is for
all libraries of that folder that have no row of their own.
"""

import re
import sys
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLE = "docs/architecture.md"
MOST_ROOMS = 25
USED_BY_ALL = "base"
# Generated code, headers of others, and the tables that CMake makes of all drivers: no rooms of their own.
NO_ROOMS = {"nodesets", "warnings", "drivers", "virtual_controllers", "beast"}
ROW = re.compile(r"^\| \[?`(?P<name>[\w/*]+)`(?:\]\([^)]*\))? \|[^|]*\| (?P<uses>[^|]*) \|$", re.MULTILINE)
ADDED = re.compile(r"metier_add_(?P<kind>library|driver|virtual_controller)\(\s*(?P<name>\w+)(?P<rest>[^)]*)\)")
LINKED = re.compile(r"metier::(\w+)")


@dataclass(frozen=True)
class Row:
    name: str
    uses: frozenset[str]


def rows(text: str) -> list[Row]:
    """The rows of the table; words in `uses` that are no room are libraries of others."""
    section = text.partition("\n## Libraries")[2].partition("\n## ")[0]
    found = [(m["name"], [word.strip(" `") for word in m["uses"].split(",")]) for m in ROW.finditer(section)]
    names = {name for name, _ in found}
    return [Row(name, frozenset(word for word in uses if word in names or "/" in word)) for name, uses in found]


def libraries(root: Path) -> dict[str, set[str]]:
    """Each library, as the table names it, with the rooms that CMake links to it."""
    folders = {}
    for pattern in ("libs/*/CMakeLists.txt", "libs/drivers/*/CMakeLists.txt", "virtual/*/CMakeLists.txt"):
        for lists in sorted(root.glob(pattern)):
            for added in ADDED.finditer(lists.read_text()):
                folder = str(lists.parent.relative_to(root)).removeprefix("libs/")
                kind = {"driver": "_driver", "library": ""}.get(added["kind"], "")
                prefix = "virtual_" if added["kind"] == "virtual_controller" else ""
                target = prefix + added["name"] + kind
                folders[target] = (folder, set(LINKED.findall(added["rest"])))
                if added["kind"] == "driver":
                    folders[target][1].add("device")
                elif added["kind"] == "virtual_controller":
                    folders[target][1].add("virtual_controller")
    known = {target: folder for target, (folder, _) in folders.items()}
    return {
        folder: {known.get(used, used) for used in uses if used not in NO_ROOMS} - {folder, USED_BY_ALL}
        for folder, uses in folders.values()
    }


def row_of(library: str, table: list[Row]) -> Row | None:
    exact = [row for row in table if row.name == library]
    return (exact or [row for row in table if fnmatch(library, row.name)] or [None])[0]


def problems(table: list[Row], built: dict[str, set[str]]) -> list[str]:
    wrong = []
    place = {row.name: n for n, row in enumerate(table)}
    linked: dict[str, set[str]] = {}
    for library, uses in built.items():
        row = row_of(library, table)
        if row is None:
            wrong.append(f"{TABLE}: no row for {library}")
            continue
        rooms = {found.name if (found := row_of(used, table)) else used for used in uses} - {row.name}
        linked.setdefault(row.name, set()).update(rooms)
        for used in sorted(rooms - row.uses):
            wrong.append(f"{TABLE}: the row of {row.name} does not name {used}, which CMake links to {library}")
    for row in table:
        if row.name not in linked:
            if row.name.split("/")[0] not in ("apps", "web"):
                wrong.append(f"{TABLE}: {row.name} has a row, and CMake builds no such library")
            continue
        for used in sorted(row.uses - linked[row.name] - {USED_BY_ALL}):
            wrong.append(f"{TABLE}: the row of {row.name} names {used}, which CMake does not link to it")
        for used in sorted(row.uses):
            if place.get(used, -1) > place[row.name]:
                wrong.append(f"{TABLE}: {row.name} uses {used}, whose row is below its own")
    if len(table) > MOST_ROOMS:
        wrong.append(f"{TABLE}: {len(table)} rows, at most {MOST_ROOMS}: a reader cannot hold more in the head")
    return wrong


def main() -> int:
    found = problems(rows((ROOT / TABLE).read_text()), libraries(ROOT))
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
