#!/usr/bin/env python3
"""Runs open62541's NodeSet compiler, or copies what it has made of the same files before.

  compile_nodeset.py --cache build/nodesets --out PREFIX --compiler DIR --inputs FILE... -- ARGUMENT...

Compiles to PREFIX.c and PREFIX.h, with the output of DIR/nodeset_compiler.py in PREFIX.log. One
NodeSet takes 10 s, and the builds of all presets need the same ones: they share the cache.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MADE = (".c", ".h", ".log")


def key_of(compiler: Path, inputs: list[Path], arguments: list[str]) -> str:
    """Names everything that the outcome depends on."""
    digest = hashlib.sha256("\0".join(arguments).encode())
    for path in [*sorted(compiler.glob("*.py")), *inputs]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def compile_to(out: Path, compiler: Path, arguments: list[str]) -> int:
    with open(f"{out}.log", "wb") as log:
        command = [sys.executable, str(compiler / "nodeset_compiler.py"), *arguments, str(out)]
        return subprocess.run(command, stdout=log, check=False).returncode


def store(cached: Path, name: str, compiler: Path, arguments: list[str]) -> int:
    """Compiles into the cache: whole, or not at all. The status of the compiler."""
    cached.parent.mkdir(parents=True, exist_ok=True)
    # It is gone at the end if it was renamed.
    with tempfile.TemporaryDirectory(dir=cached.parent, ignore_cleanup_errors=True) as folder:
        status = compile_to(Path(folder) / name, compiler, arguments)
        if status == 0:
            try:
                os.rename(folder, cached)
            except OSError:
                if not cached.is_dir():  # else another build was quicker
                    raise
    return status


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cache", type=Path, required=True, help="folder shared by all builds")
    parser.add_argument("--out", type=Path, required=True, help="path of the results without .c and .h")
    parser.add_argument("--compiler", type=Path, required=True, help="folder of nodeset_compiler.py")
    parser.add_argument("--inputs", type=Path, nargs="+", required=True, help="files that the arguments name")
    parser.add_argument("arguments", nargs="+", help="those of nodeset_compiler.py but the last, after --")
    options = parser.parse_args()
    cached = options.cache / key_of(options.compiler, options.inputs, [options.out.name, *options.arguments])
    if not cached.is_dir():
        status = store(cached, options.out.name, options.compiler, options.arguments)
        if status != 0:
            return status
    for ending in MADE:
        shutil.copyfile(cached / f"{options.out.name}{ending}", f"{options.out}{ending}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
