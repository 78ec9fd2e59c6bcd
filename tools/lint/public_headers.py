#!/usr/bin/env python3
"""Names the headers in include/ that nothing outside of their library includes.

  tools/lint/public_headers.py     prints one line for each; status 1 if there is one

A library is a folder of libs, libs/drivers or virtual. Its own sources, tests, fuzz targets and benchmarks do
not count; the tests of another library do. A header that a public header includes is public too. Such a header
belongs into src/, or, if it is there for users of the installed libraries, into public_headers.toml with a reason.
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ALLOWED = "tools/lint/public_headers.toml"
HEADER = re.compile(r"(?P<library>(?:libs/drivers|libs|virtual)/[^/]+)/include/(?P<name>.+\.hpp)")
LIBRARY = re.compile(r"(?:libs/drivers|libs|virtual)/[^/]+")
# CMake files name headers in the sources that they write.
READ = (".cpp", ".hpp", ".cmake", "CMakeLists.txt")
INCLUDED = re.compile(r"\bmetier/[\w/]+\.hpp\b")


def files() -> list[str]:
    """Paths of all files that git knows, and of new ones that it does not ignore."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [path for path in listed.splitlines() if path.endswith(READ) and (ROOT / path).is_file()]


def library_of(path: str) -> str:
    """The library that a file belongs to; its folder at the top for all that is in none."""
    found = LIBRARY.match(path)
    return found.group() if found else path.split("/")[0]


def private_headers() -> dict[str, str]:
    """Headers in include/ that need not be there, as path by the name that others would include."""
    known, users, included = {}, {}, {}
    for path in files():
        if found := HEADER.fullmatch(path):
            known[found["name"]] = path
        names = set(INCLUDED.findall((ROOT / path).read_text(errors="replace")))
        included[path] = names
        for name in names:
            users.setdefault(name, set()).add(library_of(path))
    public = {name for name, path in known.items() if users.get(name, set()) - {library_of(path)}}
    waiting = list(public)
    while waiting:
        more = {name for name in included[known[waiting.pop()]] if name in known} - public
        public |= more
        waiting += more
    return {name: path for name, path in known.items() if name not in public}


def problems() -> list[str]:
    """One line for each header in the wrong place, and for each exception that is none any more."""
    allowed = tomllib.loads((ROOT / ALLOWED).read_text()) if (ROOT / ALLOWED).is_file() else {}
    private = private_headers()
    wrong = [
        f"{path}: nothing outside of {library_of(path)} includes it: move it to {library_of(path)}/src, "
        f"or name it in {ALLOWED} with a reason"
        for name, path in sorted(private.items())
        if name not in allowed
    ]
    wrong += [
        f"{ALLOWED}: {name} is no exception: it does not exist, or others include it"
        for name in sorted(allowed)
        if name not in private
    ]
    wrong += [f"{ALLOWED}: {name} has no reason" for name, reason in sorted(allowed.items()) if not str(reason).strip()]
    return wrong


def main() -> int:
    found = problems()
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
