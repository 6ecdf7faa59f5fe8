"""Lays rendered C out as the repository's `.clang-format` wants it, for robots' names of any length.

A template cannot know how long a line becomes once the robot's name is in it. So templates write one
declaration per line, and `tidy` wraps it, and aligns what clang-format aligns: macros that follow each other,
and comments behind the code of lines that follow each other. clang-format itself is not needed to generate.
"""

import re
import textwrap
from itertools import groupby

from proxgen.emit.text import WIDTH

_MACRO = re.compile(r"^(#define \w+(?:\([^)]*\))?) +(?!\\$)(\S.*)$")
_TRAILING = re.compile(r"^(\s*[^\s/#*].*?[;,{]) +(/\* .* \*/)$")
_CONSTRUCTOR = re.compile(r"^( *\S.*\)(?: noexcept)?|) *: (\w+\(.*)$")
_COMMENT = re.compile(r"^(\s*)(/\*|\*)(\s+)(.*?)(\s*\*/)?$")


def tidy(text: str) -> str:
    """The whole text of a file: long lines wrapped, macros and trailing comments aligned, one final newline.

    What stands between `/* clang-format off */` and `/* clang-format on */` keeps its line breaks.
    """
    lines: list[str] = []
    in_comment = verbatim = False
    source = _join_declarations(_protect_macros([raw.rstrip() for raw in text.splitlines()]))
    for index, line in enumerate(source):
        verbatim = verbatim or line.strip() == "/* clang-format off */"
        if verbatim or len(line) <= WIDTH or _TRAILING.match(line):
            lines.append(line)
        elif in_comment or line.lstrip().startswith("/*"):
            *done, rest = _wrap_comment(line)
            if done and (joined := _joined(rest, source[index + 1] if index + 1 < len(source) else "")):
                source[index + 1] = joined
            else:
                done.append(rest)
            lines += done
        else:
            lines += _wrap_declaration(line)
        verbatim = verbatim and line.strip() != "/* clang-format on */"
        in_comment = _ends_in_comment(line, in_comment)
    lines = _align(_align(lines, _MACRO), _TRAILING)
    return "\n".join(lines).strip("\n") + "\n"


def _ends_in_comment(line: str, in_comment: bool) -> bool:
    """Whether a block comment is open at the end of a line."""
    opened, closed = line.rfind("/*"), line.rfind("*/")
    return opened > closed or (in_comment and closed < 0)


def _protect_macros(lines: list[str]) -> list[str]:
    """Macros of several lines keep their breaks, and their backslashes stand in the last column."""
    result: list[str] = []
    for continued, run in groupby(_with_previous(lines), key=lambda pair: _is_continued(*pair)):
        group = [line for _, line in run]
        if continued:
            padded = [_backslash_last(line) for line in group]
            group = ["/* clang-format off */", *padded, "/* clang-format on */"]
        result += group
    return result


def _backslash_last(line: str) -> str:
    """The line with the backslash that continues it, if there is one, in the last column."""
    return line[:-1].rstrip().ljust(WIDTH - 1) + "\\" if line.endswith("\\") else line


def _with_previous(lines: list[str]) -> list[tuple[str, str]]:
    """Each line with the one before it."""
    return list(zip(["", *lines], lines, strict=False))


def _is_continued(previous: str, line: str) -> bool:
    """Whether a line is part of a macro of several lines."""
    return previous.endswith("\\") or line.endswith("\\")


def _join_declarations(lines: list[str]) -> list[str]:
    """Put declarations that a template broke back on one line: its breaks suit the name of one robot only."""
    result: list[str] = []
    in_comment = verbatim = False
    depth = 0
    for line in lines:
        verbatim = (verbatim or line.strip() == "/* clang-format off */") and line != "/* clang-format on */"
        if depth > 0:
            result[-1] += ("" if result[-1].endswith("(") else " ") + line.strip()
        else:
            result.append(line)
        code = not (verbatim or in_comment or line.startswith("#") or line.endswith("\\"))
        if depth > 0 or (code and line.rstrip().endswith((",", "("))):
            depth += line.count("(") - line.count(")")
        in_comment = _ends_in_comment(line, in_comment)
    return result


def _wrap_comment(line: str) -> list[str]:
    """Wrap one line of a block comment; the lines that it becomes keep its indentation behind the star."""
    match = _COMMENT.match(line)
    if not match:
        return [line]
    indent, marker, space, words, closing = match.groups()
    star = indent + (" *" if marker == "/*" else "*")
    wrapped = textwrap.wrap(
        words,
        WIDTH,
        initial_indent=indent + marker + space,
        subsequent_indent=star + space,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [*wrapped, star + "/"] if closing else wrapped


def _joined(rest: str, following: str) -> str | None:
    """What is left of a wrapped line of a comment, and the line that goes on with its sentence; else None."""
    left, right = _COMMENT.match(rest), _COMMENT.match(following)
    if not (left and right and right[4][:1].islower() and left.group(1, 3) == right.group(1, 3)):
        return None
    return f"{rest} {right[4]}{right[5] or ''}"


def _wrap_declaration(line: str) -> list[str]:
    """Break a declaration or call behind commas, under its first argument; a constructor also before `:`."""
    if match := _CONSTRUCTOR.match(line):
        head, initialisers = match.groups()
        column = len(line) - len(line.lstrip()) + (4 if head else 0)
        return [*filter(None, [head]), *_pack(" " * column + ": ", initialisers)]
    column = line.find("(") + 1
    if column == 0 or line.startswith("#"):
        return [line]
    return _pack(line[:column], line[column:])


def _pack(head: str, items: str) -> list[str]:
    """Items behind `head`, as many on each line as fit, not broken inside their own parentheses."""
    first, *others = _items(items)
    lines = [head + first]
    for item in others:
        if len(lines[-1]) + 1 + len(item) <= WIDTH:
            lines[-1] += " " + item
        else:
            lines.append(" " * len(head) + item)
    return lines


def _items(text: str) -> list[str]:
    """`text` split behind its commas, except inside parentheses."""
    items, depth = [""], 0
    for piece in re.split(r"(?<=,) ", text):
        items[-1] += f" {piece}" if items[-1] else piece
        depth += piece.count("(") - piece.count(")")
        if depth <= 0 and piece.endswith(","):
            items.append("")
    return items


def _align(lines: list[str], pattern: re.Pattern[str]) -> list[str]:
    """Put the second group of each run of matching lines into one column."""
    result: list[str] = []
    for _, run in groupby(lines, key=lambda line: pattern.match(line) is not None):
        group = list(run)
        parts = [match.groups() for line in group if (match := pattern.match(line))]
        column = max((len(code) for code, _ in parts), default=0)
        aligned = [f"{code.ljust(column)} {tail}" for code, tail in parts] or group
        if pattern is _TRAILING and max(map(len, aligned)) > WIDTH:
            aligned = [line for code, tail in parts for line in _comment_above(code, tail)] or group
        result += aligned
    return result


def _comment_above(code: str, comment: str) -> list[str]:
    """A trailing comment moved above its code, wrapped if need be."""
    line = code[: len(code) - len(code.lstrip())] + comment
    return [*(_wrap_comment(line) if len(line) > WIDTH else [line]), code]
