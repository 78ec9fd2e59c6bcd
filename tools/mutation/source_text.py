"""C++ source as text whose comments and literals are blanked, and where its pieces begin and end."""

OPENING = {"(": ")", "[": "]", "{": "}"}
CLOSING = {")", "]", "}"}


def blanked(text: str) -> str:
    """The text with comments, string and character literals and preprocessor lines as spaces.

    Every other character keeps its place.
    """
    out = list(text)
    position = 0
    while position < len(text):
        end = _end_of_blank(text, position)
        if end > position:
            for i in range(position, end):
                if out[i] != "\n":
                    out[i] = " "
            position = end
        else:
            position += 1
    return "".join(out)


def _end_of_blank(text: str, at: int) -> int:
    """Where the comment, literal or directive that begins at `at` ends; `at` if none does."""
    two = text[at : at + 2]
    if two == "//":
        return _find(text, "\n", at)
    if two == "/*":
        return _find(text, "*/", at) + 2
    if text[at] == "#" and text[text.rfind("\n", 0, at) + 1 : at].strip() == "":
        return _end_of_directive(text, at)
    if two == 'R"':
        delimiter = text[at + 2 : text.index("(", at)]
        closing = f"){delimiter}\""
        return _find(text, closing, at) + len(closing)
    if text[at] == '"':
        return _end_of_quoted(text, at, '"')
    if text[at] == "'" and not (at > 0 and text[at - 1].isalnum()):  # else it groups digits
        return _end_of_quoted(text, at, "'")
    return at


def _find(text: str, what: str, start: int) -> int:
    found = text.find(what, start)
    return len(text) if found < 0 else found


def _end_of_directive(text: str, at: int) -> int:
    end = _find(text, "\n", at)
    while end < len(text) and text[end - 1] == "\\":
        end = _find(text, "\n", end + 1)
    return end


def _end_of_quoted(text: str, at: int, quote: str) -> int:
    position = at + 1
    while position < len(text) and text[position] != quote:
        position += 2 if text[position] == "\\" else 1
    return min(position + 1, len(text))


def matching(code: str, opening: int) -> int:
    """Place of the bracket that closes the one at `opening`, or -1."""
    depth = 0
    for position in range(opening, len(code)):
        if code[position] in OPENING:
            depth += 1
        elif code[position] in CLOSING:
            depth -= 1
            if depth == 0:
                return position
    return -1


def split_top(code: str, start: int, end: int, separator: str) -> list[tuple[int, int]]:
    """Ranges of code[start:end] between separators that are in no brackets."""
    parts, depth, begin = [], 0, start
    for position in range(start, end):
        letter = code[position]
        if letter in OPENING:
            depth += 1
        elif letter in CLOSING:
            depth -= 1
        elif letter == separator and depth == 0:
            parts.append((begin, position))
            begin = position + 1
    parts.append((begin, end))
    return parts


def statement_end(code: str, start: int) -> int:
    """Place after the semicolon that ends the statement at `start`, or -1."""
    depth = 0
    for position in range(start, len(code)):
        letter = code[position]
        if letter in OPENING:
            depth += 1
        elif letter in CLOSING:
            depth -= 1
            if depth < 0:
                return -1
        elif letter == ";" and depth == 0:
            return position + 1
    return -1


def statement_starts(code: str):
    """Places where a statement may begin: after a semicolon or a brace, and after space."""
    fresh = True
    for position, letter in enumerate(code):
        if letter.isspace():
            continue
        if fresh:
            yield position
        fresh = letter in ";{}"
