#!/usr/bin/env python3
"""Changes the code at random places and says which changes no test notices.

  tools/mutation/mutate.py                        200 mutants over all libraries
  tools/mutation/mutate.py --count 20 --library skill --library motion
  tools/mutation/mutate.py --resume FILE          goes on with what FILE holds, and adds to it
  tools/mutation/mutate.py --resume FILE --again  tries what survived in FILE once more, after tests were added
  tools/mutation/mutate.py --resume FILE --report prints the outcome in FILE
  tools/mutation/mutate.py --own-tests            leaves out the tests of libraries that are built on it: quicker

It works in a git worktree of its own, at the commit that is checked out here, or with `--tree .` in the builds that
are here, and at the lowest priority. Each mutant is one change of one source file. README.md says which changes
there are.
"""

import argparse
import json
import os
import random
import time
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

import tomllib
from libraries import LIBRARIES, Library
from operators import OPERATORS, Change, changes
from workbench import CAUGHT, EQUIVALENT, REFUSED, SURVIVED, Outcome, Workbench

ROOT = Path(__file__).resolve().parents[2]
DEV, TSAN = "dev", "tsan"


@dataclass(frozen=True)
class Mutant:
    """A change of the n-th line of this text in a file: found again although lines were added elsewhere."""

    library: str
    source: str
    kind: str
    line: str  # the first line that the change touches, without space around it
    nth: int  # of the lines with that text, from 0
    column: int  # of the change in the line, space before the line not counted
    old: str
    new: str


def mutants_in(library: Library, root: Path) -> list[Mutant]:
    return [mutant for source in library.sources(root) for mutant in _mutants_of(library, source, root)]


def _mutants_of(library: Library, source: str, root: Path) -> list[Mutant]:
    text = (root / source).read_text()
    return [_named(library.name, source, text, change) for change in changes(text)]


def _named(library: str, source: str, text: str, change: Change) -> Mutant:
    begin = text.rfind("\n", 0, change.start) + 1
    end = text.find("\n", change.start)
    full = text[begin:end]
    line = full.strip()
    nth = sum(1 for earlier in text[:begin].splitlines() if earlier.strip() == line)
    column = change.start - begin - (len(full) - len(full.lstrip()))
    old = text[change.start : change.end]
    return Mutant(library, source, change.kind, line, nth, column, old, change.new)


def place_of(mutant: Mutant, text: str) -> int | None:
    """Where in the file the change begins; None if its line is not there any more."""
    start, seen = 0, 0
    for full in text.splitlines(keepends=True):
        if full.strip() == mutant.line:
            if seen == mutant.nth:
                at = start + len(full) - len(full.lstrip()) + mutant.column
                return at if text.startswith(mutant.old, at) else None
            seen += 1
        start += len(full)
    return None


def choose(count: int, seed: int, libraries: list[Library], root: Path) -> list[Mutant]:
    """Draws mutants: large libraries more often, by the root of their size; then a kind, then a place."""
    dice = random.Random(seed)
    pools = {library.name: mutants_in(library, root) for library in libraries}
    chosen: dict[Mutant, None] = {}
    while len(chosen) < min(count, sum(map(len, pools.values()))):
        names = sorted(pools)
        name = dice.choices(names, [len(pools[n]) ** 0.5 for n in names])[0]
        kinds = sorted({mutant.kind for mutant in pools[name]})
        kind = dice.choices(kinds, [OPERATORS[k][1] for k in kinds])[0]
        chosen[dice.choice([mutant for mutant in pools[name] if mutant.kind == kind])] = None
    return list(chosen)


# ---- one mutant ----


def listed_reason(mutant: Mutant) -> str | None:
    """Why this change is known to change no behaviour."""
    listed = tomllib.loads((Path(__file__).parent / "equivalent.toml").read_text())
    for entry in listed.get("equivalent", []):
        same = entry["source"] == mutant.source and entry["line"] == mutant.line
        if same and entry["old"] == mutant.old.strip() and entry["new"] == mutant.new.strip():
            return entry["reason"]
    return None


def judge(bench: Workbench, mutant: Mutant, own_tests: bool) -> Outcome:
    """Compiles the source file with the change, links and tests."""
    if reason := listed_reason(mutant):
        return Outcome(EQUIVALENT, reason)
    text = (bench.tree / mutant.source).read_text()
    start = place_of(mutant, text)
    if start is None:
        return Outcome(EQUIVALENT, "the line is not there any more")
    library = LIBRARIES[mutant.library]
    # A test notices a lock that is missing only with luck; the thread sanitizer does for certain.
    preset = TSAN if mutant.kind == "lock" else DEV
    bench.prepare(preset, library.tests[0])
    changed = text[:start] + mutant.new + text[start + len(mutant.old) :]
    made = bench.compile(preset, mutant.source, changed)
    if made is None:
        return Outcome(REFUSED)
    if bench.is_as_before(preset, library, mutant.source, made):
        return Outcome(EQUIVALENT, "the same machine code")
    for program in library.tests if own_tests else library.tests + library.dependants:
        bench.prepare(preset, program)
        if failed := bench.run_tests(preset, bench.link(preset, library, program, made)):
            return Outcome(CAUGHT, failed)
    return Outcome(SURVIVED)


# ---- many ----


def run(bench: Workbench, mutants: list[Mutant], options: argparse.Namespace) -> None:
    """Judges each, those of one library after the other, and notes it at once."""
    until = time.time() + 60 * options.minutes
    order = sorted(mutants, key=lambda m: (list(LIBRARIES).index(m.library), m.kind == "lock", m.source))
    for number, mutant in enumerate(order, 1):
        if time.time() > until:
            print(f"mutate: stops after {number - 1} of {len(order)}: the time is over")
            return
        begin = time.monotonic()
        outcome = judge(bench, mutant, options.own_tests)
        seconds = round(time.monotonic() - begin, 1)
        note(options.resume, mutant, outcome, seconds)
        print(f"{number}/{len(order)} {outcome.result} {seconds} s {shown(mutant)} {outcome.why}", flush=True)


def note(file: Path, mutant: Mutant, outcome: Outcome, seconds: float) -> None:
    with file.open("a") as stream:
        entry = {**asdict(mutant), **asdict(outcome), "seconds": seconds}
        stream.write(json.dumps(entry, ensure_ascii=False) + "\n")


def shown(mutant: Mutant) -> str:
    before = mutant.line[: mutant.column]
    after = mutant.line[mutant.column + len(mutant.old.split("\n")[0]) :]
    return f"{mutant.source} [{mutant.kind}]\n    - {mutant.line}\n    + {before}{mutant.new.strip()}{after}\n   "


def read(file: Path) -> dict[Mutant, Outcome]:
    """What was found, the latest of each mutant."""
    found: dict[Mutant, Outcome] = {}
    if file.exists():
        for line in file.read_text().splitlines():
            entry = json.loads(line)
            result, why = entry.pop("result"), entry.pop("why")
            entry.pop("seconds")
            found[Mutant(**entry)] = Outcome(result, why)
    return found


def report(found: dict[Mutant, Outcome]) -> float:
    """Prints the table and what survived; the share that was caught."""
    results = (CAUGHT, SURVIVED, REFUSED, EQUIVALENT)
    counts = Counter((m.library, outcome.result) for m, outcome in found.items())
    print(f"| {'library':<15} | mutants | " + " | ".join(results) + " |")
    print("|---|---|" + "---|" * len(results))
    for library in [name for name in LIBRARIES if any((name, r) in counts for r in results)]:
        row = [counts[library, result] for result in results]
        print(f"| {library:<15} | {sum(row)} | " + " | ".join(map(str, row)) + " |")
    row = [sum(counts[name, result] for name in LIBRARIES) for result in results]
    print(f"| {'all':<15} | {sum(row)} | " + " | ".join(map(str, row)) + " |")
    share = row[0] / (row[0] + row[1]) if row[0] + row[1] else 1.0
    print(f"\ncaught: {row[0]} of {row[0] + row[1]} = {100 * share:.1f} %\n")
    for mutant, outcome in found.items():
        if outcome.result == SURVIVED:
            print("survived: " + shown(mutant))
    return share


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--library", action="append", choices=list(LIBRARIES), help="this one alone; may be repeated")
    parser.add_argument("--without", action="append", choices=list(OPERATORS), default=[], help="no mutant of this kind")
    parser.add_argument("--resume", type=Path, default=ROOT / "build/mutation/outcome.jsonl", metavar="FILE")
    parser.add_argument("--again", action="store_true", help="tries what survived once more")
    parser.add_argument("--own-tests", action="store_true", help="without those of libraries that are built on it")
    parser.add_argument("--report", action="store_true", help="only prints what FILE holds")
    parser.add_argument("--minutes", type=float, default=1e6, help="begins no mutant after that time")
    parser.add_argument("--least", type=float, default=95.0, help="percent to be caught; below it the status is 1")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--tree", type=Path, default=ROOT / "build/mutation/tree", help=". uses the builds here")
    return parser.parse_args()


def main() -> int:
    options = arguments()
    found = read(options.resume)
    if not options.report:
        os.nice(15)
        bench = Workbench(ROOT, options.tree, options.jobs)
        print(f"mutate: commit {bench.check_out()}, seed {options.seed}, outcome in {options.resume}")
        if options.again:
            todo = [mutant for mutant, outcome in found.items() if outcome.result == SURVIVED]
        else:
            libraries = [LIBRARIES[name] for name in options.library or LIBRARIES]
            chosen = choose(options.count, options.seed, libraries, bench.tree)
            todo = [mutant for mutant in chosen if mutant not in found and mutant.kind not in options.without]
        options.resume.parent.mkdir(parents=True, exist_ok=True)
        run(bench, todo, options)
        found = read(options.resume)
    return 0 if 100 * report(found) >= options.least else 1


if __name__ == "__main__":
    raise SystemExit(main())
