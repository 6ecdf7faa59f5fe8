"""YAML text to a tree of plain values that remembers the line of every key; nothing is ever evaluated.

PyYAML parses; the values are made here, from its nodes, for three reasons: line numbers are kept, duplicate
keys are seen, and scalars are those of YAML 1.2. (PyYAML follows YAML 1.1, where `1e-3` is a text, `on` is
true and `1:30` is ninety.)
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from proxgen.config.origin import Mark
from proxgen.config.paths import did_you_mean
from proxgen.errors import Problem

MAX_VALUES = 100_000
"""Aliases of aliases can stand for more values than a memory holds; no honest file comes near this."""

_TAG = "tag:yaml.org,2002:"
_NULL = re.compile(r"~|null|Null|NULL|")
_BOOL = re.compile(r"true|True|TRUE|false|False|FALSE")
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(
    r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
)


@dataclass
class Node:
    """A value with its place: a scalar, a list of nodes, or a dict of nodes by key.

    Attributes:
        value: None, bool, int, float, str, list[Node] or dict[str, Node].
        mark: the line of its key, of its list item, or of itself.
    """

    value: Any
    mark: Mark

    def plain(self) -> Any:
        """The value without its marks."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def marks(self, prefix: str = "") -> dict[str, Mark]:
        """Marks of all values below, by dotted path."""
        children: dict[Any, Node] = {}
        if isinstance(self.value, dict):
            children = self.value
        elif isinstance(self.value, list):
            children = dict(enumerate(self.value))
        found: dict[str, Mark] = {}
        for key, node in children.items():
            path = f"{prefix}.{key}" if prefix else f"{key}"
            found[path] = node.mark
            found |= node.marks(path)
        return found


@dataclass
class Document:
    """A YAML file as read.

    Attributes:
        root: the tree, or None if there is nothing that could be read.
        problems: all that is wrong with the text.
    """

    root: Node | None
    problems: list[Problem] = field(default_factory=list)


class _Composer(yaml.SafeLoader):
    """PyYAML up to its nodes, with the scalars of YAML 1.2."""

    yaml_implicit_resolvers = {}  # noqa: RUF012 - PyYAML's own way; none of YAML 1.1 are taken over


for _name, _pattern, _first in (
    ("null", _NULL, ["~", "n", "N", ""]),
    ("bool", _BOOL, list("tTfF")),
    ("int", _INT, list("-+0123456789")),
    ("float", _FLOAT, list("-+.0123456789")),
):
    _Composer.add_implicit_resolver(f"{_TAG}{_name}", re.compile(rf"^(?:{_pattern.pattern})$"), _first)


def read_yaml(path: Path) -> Document:
    """Read a file; what cannot be read is a problem of the document, never an exception."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return Document(None, [Problem(path, 0, "", f"the file does not exist{did_you_mean(path)}")])
    except IsADirectoryError:
        return Document(None, [Problem(path, 0, "", "this is a folder; a YAML file is needed")])
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        return Document(None, [Problem(path, 0, "", f"the file cannot be read: {reason}")])
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        return Document(None, [Problem(path, line, "", "the text is not UTF-8")])
    return parse_yaml(text, path)


def parse_yaml(text: str, file: Path) -> Document:
    """Turn YAML text into a document.

    Args:
        text: one YAML document whose root is a mapping.
        file: named in marks and problems.
    """
    try:
        composed = _Composer(text).get_single_node()
        if composed is None:
            return Document(None, [Problem(file, 0, "", "the file is empty")])
        builder = _Builder(file)
        root = builder.node(composed, "", Mark(file, composed.start_mark.line + 1))
    except yaml.MarkedYAMLError as error:
        return Document(None, [_syntax_problem(error, file)])
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        message = f"not valid YAML: the character U+{error.character:04X} is not allowed"
        return Document(None, [Problem(file, line, "", message)])
    except RecursionError:
        return Document(None, [Problem(file, 0, "", "not valid YAML: nested too deeply")])
    if not isinstance(root.value, dict):
        message = "expected keys with values (such as `robot:`) at the top of the file"
        if text.lstrip("\ufeff \t\r\n").startswith("<"):
            message += "; this is XML, and `proxgen init` makes a YAML file from a URDF"
        return Document(None, [*builder.problems, Problem(file, root.mark.line, "", message)])
    return Document(root, builder.problems)


class _Builder:
    """PyYAML nodes to our nodes, with all problems collected."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[Problem] = []
        self._values = 0
        self._open: list[yaml.Node] = []

    def node(self, node: yaml.Node, path: str, mark: Mark) -> Node:
        """One node and all below it."""
        self._values += 1
        if self._values > MAX_VALUES:
            message = f"its aliases stand for more than {MAX_VALUES} values"
            raise yaml.MarkedYAMLError(problem=message, problem_mark=node.start_mark)
        if any(node is outer for outer in self._open):
            self.problems.append(Problem(self.file, mark.line, path, "an alias contains itself"))
            return Node(None, mark)
        self._open.append(node)
        try:
            if isinstance(node, yaml.MappingNode) and node.tag == f"{_TAG}map":
                return Node(self._mapping(node, path), mark)
            if isinstance(node, yaml.SequenceNode) and node.tag == f"{_TAG}seq":
                items = [
                    self.node(item, f"{path}.{index}", Mark(self.file, item.start_mark.line + 1))
                    for index, item in enumerate(node.value)
                ]
                return Node(items, mark)
            if isinstance(node, yaml.ScalarNode):
                return Node(self._scalar(node, path), mark)
            self._report(node, path, f"the tag '{_shown(node.tag)}' is not allowed; write plain values")
            return Node(None, mark)
        finally:
            self._open.pop()

    def _mapping(self, node: yaml.MappingNode, path: str) -> dict[str, Node]:
        """Keys in the order of the file; of a key that is repeated the first value stays."""
        values: dict[str, Node] = {}
        for key_node, value_node in node.value:
            mark = Mark(self.file, key_node.start_mark.line + 1)
            if not isinstance(key_node, yaml.ScalarNode):
                self._report(key_node, path, "a key must be a plain name, not a list or a mapping")
                continue
            key = key_node.value
            inner = f"{path}.{key}" if path else key
            if key == "<<" and key_node.style is None:
                self._report(key_node, path, "merge keys ('<<') are not supported; use 'extends' or an alias")
            elif key in values:
                message = f"the key '{key}' is given twice, first in line {values[key].mark.line}"
                self.problems.append(Problem(self.file, mark.line, inner, message))
            else:
                values[key] = self.node(value_node, inner, mark)
        return values

    def _scalar(self, node: yaml.ScalarNode, path: str) -> Any:
        """The Python value of a scalar."""
        text: str = node.value
        kind = node.tag.removeprefix(_TAG)
        try:
            if kind == "str":
                return text
            if kind == "null":
                return None
            if kind == "bool" and _BOOL.fullmatch(text):
                return text.lower() == "true"
            if kind == "int" and _INT.fullmatch(text):
                return int(text, 0) if text.startswith(("0o", "0x")) else int(text)
            if kind == "float" and _FLOAT.fullmatch(text):
                return float(re.sub(r"\.(inf|nan)", r"\1", text.lower()))
        except ValueError:  # Python refuses to read integers of thousands of digits
            self._report(node, path, "a number of this many digits cannot be read")
            return None
        known = kind in {"bool", "int", "float"}
        message = (
            f"'{text}' is not of type {kind}" if known else f"the tag '{_shown(node.tag)}' is not allowed"
        )
        self._report(node, path, f"{message}; write plain values")
        return None

    def _report(self, node: yaml.Node, path: str, message: str) -> None:
        """Add a problem at the node's own line."""
        self.problems.append(Problem(self.file, node.start_mark.line + 1, path.lstrip("."), message))


def _shown(tag: str) -> str:
    """A tag as it is written in a file."""
    return tag.replace(_TAG, "!!")


def _misplaced(problem: str, mark: yaml.Mark, begin: yaml.Mark) -> str:
    """What, at a mark, neither continues a section, which begins at another one, nor ends it."""
    section = f"the section that begins in line {begin.line + 1}"
    found = "a list item ('-')" if "'-'" in problem else problem.partition("found ")[2] or problem
    if f"{mark.buffer}"[mark.pointer - mark.column : mark.pointer].strip():
        return f"{'text' if '<scalar>' in found else found} after a value that has ended, in {section}"
    if mark.column != begin.column:
        return f"indented by {mark.column} spaces, but the keys of {section} by {begin.column}"
    return f"{found} among the keys of {section}"


def _syntax_problem(error: yaml.MarkedYAMLError, file: Path) -> Problem:
    """PyYAML's account of a syntax error, in one sentence."""
    mark, begin = error.problem_mark or error.context_mark, error.context_mark
    message = f"not valid YAML: {error.problem or error.context}"
    if error.context == "while parsing a block mapping" and mark and begin:
        message = f"not valid YAML: {_misplaced(f'{error.problem}', mark, begin)}"
    elif error.problem == "could not find expected ':'" and begin:
        mark, message = begin, "not valid YAML: no ':' after the key"
    elif "character '\\t'" in message:
        message = "not valid YAML: a tab; indentation must be made of spaces"
    elif "mapping values are not allowed" in message:
        message += " (a ':' too many, or the indentation is wrong)"
    elif "expected a single document" in f"{error.context}":
        message = "not valid YAML: a second document begins here ('---'); one is allowed"
    elif error.context and error.problem and error.context_mark:
        message += f" ({error.context}, which begins in line {error.context_mark.line + 1})"
    return Problem(file, mark.line + 1 if mark else 0, "", message)
