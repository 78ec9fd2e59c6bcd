"""The changes that a mutant may be: each finds the places where it can be made."""

import re
from dataclasses import dataclass

from source_text import blanked, matching, split_top, statement_end, statement_starts


@dataclass(frozen=True)
class Change:
    """text[start:end] becomes `new`."""

    kind: str
    start: int
    end: int
    new: str


FLIPPED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
BOUNDARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
_COMPARISON = re.compile(r"(?<= )(<=|>=|==|!=|<|>)(?=[ \n])")
# What only says something, or only makes it faster, is left alone.
_LEFT_ALONE = re.compile(
    r"spdlog::|\b(log_?|logger_?)(->|\.)|\.reserve\(|\.shrink_to_fit\(|static_assert|\bassert\(|std::move\("
)


def comparisons(code: str):
    for match in _COMPARISON.finditer(code):
        if not _line(code, match.start()).lstrip().startswith(("template", "operator")):
            yield Change("comparison", *match.span(), FLIPPED[match[0]])


def _line(code: str, at: int) -> str:
    begin = code.rfind("\n", 0, at) + 1
    end = code.find("\n", at)
    return code[begin : end if end >= 0 else len(code)]


def conditions(code: str):
    for match in re.finditer(r"\bif \(", code):
        opening = match.end() - 1
        closing = matching(code, opening)
        if closing > 0:
            yield _negated(code, opening, closing)
    for match in re.finditer(r"(?<= )(&&|\|\|)(?=[ \n])", code):
        yield Change("condition", *match.span(), "||" if match[0] == "&&" else "&&")


def _negated(code: str, opening: int, closing: int) -> Change:
    begin, end = split_top(code, opening + 1, closing, ";")[-1]
    declared = re.match(r"\s*(?:const )?auto[&*]* (\w+) = ", code[begin:end])
    if declared:
        return Change("condition", end, end, f"; !{declared[1]}")
    begin += len(code[begin:end]) - len(code[begin:end].lstrip())
    # Marks where to put brackets: the text between stays what it is.
    return Change("condition", begin, end, "!(\0)")


def limits(code: str):
    """A clamp, min or max gives one of the values that it chooses from."""
    for match in re.finditer(r"\bstd::(clamp|min|max)(<[^()<>]*(<[^()<>]*>)?>)?\(", code):
        opening = match.end() - 1
        closing = matching(code, opening)
        if closing < 0:
            continue
        arguments = split_top(code, opening + 1, closing, ",")
        if match[1] == "clamp" and len(arguments) == 3:
            chosen = arguments[:1]
        elif match[1] != "clamp" and len(arguments) == 2 and code[arguments[0][0]] != "{":
            chosen = arguments
        else:
            continue
        for begin, end in chosen:
            yield Change("limit", match.start(), closing + 1, f"(\1{begin}:{end}\1)")


_NUMBER = r"(?:\d[\d']*\.?\d*(?:e[+-]?\d+)?|\bk[A-Z]\w*|std::numbers::pi)"


def units(code: str):
    """A factor is a divisor, a time is in another unit."""
    for match in re.finditer(r"(?<= )([*/])(?= )", code):
        before, after = code[: match.start()].rstrip(), code[match.end() :].lstrip()
        if re.search(_NUMBER + r"$", before[-40:]) or re.match(_NUMBER, after[:40]):
            yield Change("unit", *match.span(), "/" if match[1] == "*" else "*")
    for match in re.finditer(r"(?<=[0-9])(s|ms|us)\b", code):
        yield Change("unit", *match.span(), {"s": "ms", "ms": "s", "us": "ms"}[match[1]])
    for match in re.finditer(r"\bstd::chrono::(milliseconds|microseconds|nanoseconds)\b(?!>&)", code):
        other = {"milliseconds": "seconds", "microseconds": "milliseconds", "nanoseconds": "microseconds"}
        yield Change("unit", match.start(1), match.end(1), other[match[1]])


def locks(code: str):
    for match in re.finditer(r"(?:const )?std::(?:lock_guard|scoped_lock)(?:<[^;]*>)? \w+[({][^;]*[)}];", code):
        yield Change("lock", *match.span(), ";")


_CALL = re.compile(r"[A-Za-z_][\w:]*(?:(?:\.|->|::)\w+|\([^;{}]*?\)|\[[^;{}]*?\])*\(")
_NO_CALL = re.compile(r"(return|throw|if|for|while|switch|case|else|do|using|delete|co_\w+|sizeof|new)\b")


def calls(code: str):
    for start in statement_starts(code):
        if not _CALL.match(code, start) or _NO_CALL.match(code, start):
            continue
        end = statement_end(code, start)
        if end < 0 or not _is_call(code[start : end - 1]) or _depth_is_zero(code, start):
            continue
        if not _LEFT_ALONE.search(code[start:end]):
            yield Change("call", start, end, ";")


def _is_call(statement: str) -> bool:
    """Whether it is one call (`a.b(c).d(e)`) and neither a declaration nor an assignment."""
    if "{" in statement and "[" not in statement:
        return False
    position = 0
    while True:
        name = re.compile(r"[A-Za-z_][\w:]*(?:<[\w:, ]*>)?").match(statement, position)
        if not name:
            return False
        position = name.end()
        while position < len(statement) and statement[position] in "([":
            position = matching(statement, position) + 1
            if position == 0:
                return False
        rest = statement[position:]
        if not rest.strip():
            return statement.rstrip().endswith(")")
        link = re.match(r"\s*(\.|->)", rest)
        if not link:
            return False
        position += link.end()


def _depth_is_zero(code: str, at: int) -> bool:
    """Whether `at` is in no function: at the margin, where only declarations are."""
    return code[code.rfind("\n", 0, at) + 1 : at] == ""


def off_by_ones(code: str):
    for match in re.finditer(r"(?<=[\w)\]]) [+-] 1(?![\w.'])", code):
        yield Change("off by one", *match.span(), "")
    for match in _COMPARISON.finditer(code):
        line = _line(code, match.start())
        counted = re.search(r"\bfor \(|size\(\)|count|\bi\b|axis", line)
        if match[0] in BOUNDARY and counted and not line.lstrip().startswith("template"):
            yield Change("off by one", *match.span(), BOUNDARY[match[0]])
    for match in re.finditer(r"\bfor \([\w:]+ \w+ = (0)[;,]", code):
        yield Change("off by one", match.start(1), match.end(1), "1")


def errors(code: str):
    """A refusal is not returned."""
    for start in statement_starts(code):
        if re.match(r"return (fail|refuse\w*|refused\w*|tl::unexpected|tl::make_unexpected|wrong\w*)\b", code[start : start + 60]):
            end = statement_end(code, start)
            if end > 0:
                yield Change("error", start, end, ";")


# Weights: how many of a hundred mutants are of this kind.
OPERATORS = {
    "comparison": (comparisons, 20),
    "condition": (conditions, 20),
    "call": (calls, 20),
    "error": (errors, 12),
    "limit": (limits, 8),
    "unit": (units, 8),
    "off by one": (off_by_ones, 7),
    "lock": (locks, 5),
}


def changes(text: str) -> list[Change]:
    """Every change that can be made to this source text, in the order of their places."""
    code = blanked(text)
    found = []
    for operator, _ in OPERATORS.values():
        found += [_finished(change, text) for change in operator(code)]
    return sorted(set(found), key=lambda change: (change.start, change.end, change.new))


def _finished(change: Change, text: str) -> Change:
    """The change with the text that its marks stand for, and as many lines as before."""
    old, new = text[change.start : change.end], change.new
    new = new.replace("\0", old)
    new = re.sub("\1(\\d+):(\\d+)\1", lambda m: text[int(m[1]) : int(m[2])].strip(), new)
    new += "\n" * (old.count("\n") - new.count("\n"))
    return Change(change.kind, change.start, change.end, new)
