"""Puts figures and tables onto one page that opens from disk, without a network, and prints well."""

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from proxgen.files import write_whole
from proxgen.report import style
from proxgen.templates import environment


@dataclass(frozen=True)
class Picture:
    """A figure on the page.

    Attributes:
        title: a few words; the alternative text, too.
        caption: what to see in it.
        file: the picture beside the page, relative to it.
        data: the same, base64.
        kind: its media type.
    """

    title: str
    caption: str
    file: str
    data: str
    kind: str = "image/png"


@dataclass(frozen=True)
class Section:
    """A part of the page: a heading, a sentence, perhaps a table, figures.

    Attributes:
        anchor: name of the link to it.
        title: the heading.
        lead: what it shows.
        rows: of the table; no table without.
        columns: headings of the table's columns after the first.
        corner: heading of the first column.
        remarks: what is wrong, as a list.
        figures: below the table.
        claims: a table of claims, above the other one.
    """

    anchor: str
    title: str
    lead: str = ""
    rows: Sequence[Any] = ()
    columns: Sequence[str] = ()
    corner: str = ""
    remarks: Sequence[str] = ()
    figures: Sequence[Picture] = ()
    claims: Sequence[Any] = ()


@dataclass(frozen=True)
class Verdict:
    """The banner at the top."""

    passed: bool
    sentence: str


@dataclass(frozen=True)
class Page:
    """Everything that the template shows."""

    title: str
    subtitle: str
    footer: str
    sections: Sequence[Section]
    cards: Sequence[Any] = ()
    verdict: Verdict | None = None


@dataclass
class Gallery:
    """Draws figures, writes each as PNG into a folder, and keeps what the page needs to show it."""

    directory: Path
    names: set[str] = field(default_factory=set)

    def add(self, name: str, title: str, caption: str, draw: Callable[[], Figure]) -> Picture:
        """Draw one figure in the house style and write it to `figures/NAME.png`."""
        if name in self.names:
            raise ValueError(f"two figures called '{name}'")
        self.names.add(name)
        file = f"figures/{name}.png"
        with style.house_style():
            path = style.save(draw(), self.directory / file)
        return Picture(title, caption, file, _encoded(path))

    def show(self, path: Path, title: str, caption: str) -> Picture:
        """A picture that is there already: a PNG, GIF or WebP in this folder."""
        file = str(path.relative_to(self.directory))
        return Picture(title, caption, file, _encoded(path), f"image/{path.suffix.removeprefix('.')}")


def _encoded(path: Path) -> str:
    """A file as base64."""
    return base64.b64encode(path.read_bytes()).decode("ascii")


def write_page(path: Path, page: Page) -> Path:
    """Render the page and write it, whole or not at all."""
    text = environment("report").get_template("report.html.j2").render(vars(page))
    return write_whole(path, text)
