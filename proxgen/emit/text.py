"""Small pieces of C text: numbers, shapes, comments. Templates hold structure; formatting is here."""

import math
import re
import textwrap
from collections.abc import Iterable, Sequence

from proxgen.errors import GenerateError
from proxgen.program import Argument

WIDTH = 110
"""Greatest number of columns of a line, as in `.clang-format`."""

_KEYWORDS = frozenset(
    """
    auto bool break case char class const continue default delete do double else enum explicit export extern
    false float for friend goto if inline int long mutable namespace new nullptr operator private protected
    public register restrict return short signed sizeof static struct switch template this throw true try
    typedef typename union unsigned using virtual void volatile while
    """.split()  # noqa: SIM905
)
"""Words that are taken in C or C++."""


def identifier(name: str) -> str:
    """`name`, if it is an identifier in C and in C++, where double underscores are reserved.

    Raises:
        GenerateError: if it is not.
    """
    if not re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name) or name in _KEYWORDS:
        raise GenerateError(
            f"'{name}' cannot be a name in C: letters, digits and single underscores between them, no keyword"
        )
    return name


def number(value: float) -> str:
    """A double literal: the shortest that is read back to exactly the same bits; negative zero becomes zero.

    Raises:
        GenerateError: for NaN and infinity, which have no literal.
    """
    if not math.isfinite(value):
        raise GenerateError(f"{value} cannot be written as a C number; unlimited values are +-1e20")
    return repr(float(value) + 0.0)


def braces(values: Iterable[float]) -> str:
    """An initialiser such as `{1.0, 2.5}`."""
    return "{" + ", ".join(number(value) for value in values) + "}"


def plain(value: float | Iterable[float]) -> str:
    """A number, or several, for a human reader: six significant digits."""
    if isinstance(value, float | int):
        return f"{value + 0.0:.6g}"
    return ", ".join(plain(entry) for entry in value)


def string(text: str) -> str:
    """A C string literal of printable ASCII.

    Raises:
        GenerateError: if `text` holds anything else.
    """
    if not all(" " <= character <= "~" for character in text):
        raise GenerateError(f"{text!r} cannot be written as a C string")
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def shape_text(argument: Argument) -> str:
    """The shape in words: `scalar`, `7`, `3x7 row-major`."""
    if not argument.shape:
        return "scalar"
    text = "x".join(str(size) for size in argument.shape)
    return f"{text} row-major" if len(argument.shape) == 2 else text


def comment_text(text: str) -> str:
    """`text` on one line, with nothing in it that would end or nest a C comment."""
    return " ".join(_harmless(text).split())


def block_comment(paragraphs: Sequence[str]) -> str:
    """A block comment, wrapped at the greatest width; an empty paragraph is an empty line.

    A paragraph that begins with two spaces is an item: its continuation lines are indented by four more.
    """
    lines: list[str] = []
    for paragraph in paragraphs:
        indent = paragraph[: len(paragraph) - len(paragraph.lstrip(" "))]
        words = comment_text(paragraph) if not indent else _keep_columns(paragraph.strip())
        later = indent + "    " if indent else ""
        lines += textwrap.wrap(
            words,
            WIDTH - 3,
            initial_indent=indent,
            subsequent_indent=later,
            break_long_words=False,
            break_on_hyphens=False,
        ) or [""]
    if len(lines) == 1:
        return f"/* {lines[0]} */"
    return "/* " + "\n".join([lines[0], *(f" * {line}".rstrip() for line in lines[1:])]) + "\n */"


def _keep_columns(text: str) -> str:
    """An item's text, harmless in a comment, with the runs of spaces that align its columns."""
    return _harmless(text).replace("\n", " ")


def _harmless(text: str) -> str:
    """Text that neither ends nor nests a C comment, joins lines, nor hides what follows it from a reader.

    A URDF calls its joints as it likes: a backslash, or the trigraph of one, joins the line with the next.
    """
    shown = "".join(c if c.isprintable() or c.isspace() else "?" for c in text)
    return shown.replace("\\", "/").replace("??/", "? ?/").replace("*/", "* /").replace("/*", "/ *")
