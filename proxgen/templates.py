"""How every template of the package is read: one set of rules for C, CMake, YAML, Markdown and HTML."""

from collections.abc import Callable
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined


def environment(room: str, **filters: Callable[..., Any]) -> Environment:
    """The templates of a room, `proxgen/<room>/templates/`.

    A name that the context lacks is an error; a line of nothing but a block tag leaves nothing behind;
    values are escaped in `*.html.j2` alone.

    Args:
        room: name of the package's folder.
        filters: what its templates may use besides the usual filters.
    """
    made = Environment(
        loader=PackageLoader(f"proxgen.{room}"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=lambda name: name is not None and name.endswith(".html.j2"),
    )
    made.filters.update(filters)
    return made
