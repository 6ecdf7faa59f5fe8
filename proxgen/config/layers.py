"""`extends`: a file that says only what is different from presets and other files.

Layers are laid over each other in their order, the file itself last. Sections are merged key by key; lists
whose items have names (capsules, cuffs, obstacles) item by item; every other value replaces the one below.
"""

from pathlib import Path

from proxgen.config.paths import did_you_mean, is_file
from proxgen.config.yaml_lines import Document, Node, parse_yaml, read_yaml
from proxgen.errors import Problem, unknown_name

EXTENDS = "extends"

PRESETS = Path(__file__).parent / "presets"
"""Folder of the presets that come with proxgen."""


def preset_names() -> list[str]:
    """Names of all presets."""
    return sorted(path.stem for path in PRESETS.glob("*.yaml"))


def read_layers(path: Path) -> Document:
    """Read a file and everything that it extends.

    Returns:
        One tree in which every value has the place where it was written, and the problems of all files.
    """
    return _with_bases(read_yaml(path), path, (path,))


def _with_bases(document: Document, path: Path, chain: tuple[Path, ...]) -> Document:
    """The document laid over its bases; `chain` are the files that led here."""
    if document.root is None or EXTENDS not in document.root.value:
        return document
    names = document.root.value.pop(EXTENDS)
    items = names.value if isinstance(names.value, list) else [names]
    merged = Node({}, document.root.mark)
    problems = document.problems
    for index, item in enumerate(items):
        key = f"{EXTENDS}.{index}" if isinstance(names.value, list) else EXTENDS
        base = _read_base(item, path, chain)
        if isinstance(base, str):
            problems.append(Problem(item.mark.file, item.mark.line, key, base))
            continue
        problems += base.problems
        if base.root is not None:
            merged = merge(merged, base.root)
    return Document(merge(merged, document.root), problems)


def _read_base(item: Node, path: Path, chain: tuple[Path, ...]) -> Document | str:
    """A preset or a file, or what is wrong with its name."""
    name = item.value
    if not isinstance(name, str) or not name:
        return f"expected the name of a preset or of a file (presets: {', '.join(preset_names())})"
    if not name.endswith((".yaml", ".yml")):
        if name not in preset_names():
            return f"{unknown_name('preset', name, preset_names())}; a file is named with its ending, .yaml"
        return parse_yaml((PRESETS / f"{name}.yaml").read_text(encoding="utf-8"), Path(f"preset {name}"))
    file = path.parent / name
    if not is_file(file):
        return f"the file '{name}' does not exist{did_you_mean(file, Path(name))}"
    if any(file.resolve() == other.resolve() for other in chain):
        return f"the file '{name}' extends itself ({' -> '.join(f'{other}' for other in (*chain, file))})"
    return _with_bases(read_yaml(file), file, (*chain, file))


def merge(below: Node, above: Node) -> Node:
    """The tree `above` laid over the tree `below`; neither is changed."""
    if isinstance(below.value, dict) and isinstance(above.value, dict):
        merged = dict(below.value)
        for key, node in above.value.items():
            merged[key] = merge(merged[key], node) if key in merged else node
        return Node(merged, above.mark)
    named_below, named_above = _by_name(below), _by_name(above)
    if named_below and named_above:
        merged = dict(named_below)
        for name, node in named_above.items():
            merged[name] = merge(merged[name], node) if name in merged else node
        return Node(list(merged.values()), above.mark)
    return above


def _by_name(node: Node) -> dict[str, Node]:
    """The items of a list by their names; empty unless every item has a name of its own."""
    items = node.value if isinstance(node.value, list) else []
    named = {}
    for item in items:
        name = item.value.get("name") if isinstance(item.value, dict) else None
        if name is not None and isinstance(name.value, str):
            named[name.value] = item
    return named if len(named) == len(items) else {}
