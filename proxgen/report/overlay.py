"""What is drawn onto a rendered picture: the tool's path, distances to obstacles, the skin, a few words.

Everything is drawn at a multiple of the final size, for smooth edges once it is made smaller.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from proxgen.report import style
from proxgen.report.derive import Zone
from proxgen.report.stage import Gap, Modules
from proxgen.simulation.world import Shot

Array = NDArray[np.float64]

_FAINT = 70
"""Opacity of what lies behind something; 255 is opaque."""


class Overlay:
    """A transparent sheet over a picture; lengths are in pixels of the final picture.

    Attributes:
        width, height: of the final picture [pixels].
    """

    def __init__(self, shot: Shot, scale: float) -> None:
        """Lay an empty sheet over a picture that is `scale` times larger than shown."""
        self._shot, self._scale = shot, scale
        self.width, self.height = round(shot.camera.width / scale), round(shot.camera.height / scale)
        size = (shot.camera.width, shot.camera.height)
        self._sheet = Image.new("RGBA", size, (255, 255, 255, 0))
        self._pen = ImageDraw.Draw(self._sheet)

    def picture(self) -> Image.Image:
        """Picture and sheet together, at the size in which they are shown."""
        below = Image.fromarray(self._shot.pixels).convert("RGBA")
        whole = Image.alpha_composite(below, self._sheet).convert("RGB")
        return whole.resize((self.width, self.height), Image.Resampling.LANCZOS)

    def path(self, points: Array, colour: str, width: float = 2.0) -> None:
        """A line through points (K, 3), faint where something is in front of it."""
        if len(points) < 2:
            return
        places, _ = self._shot.camera.project(points)
        hidden = self._shot.hidden(points)
        for index in range(len(points) - 1):
            opacity = _FAINT if hidden[index] or hidden[index + 1] else 255
            self._line(places[index], places[index + 1], _rgba(colour, opacity), width)

    def gap(self, gap: Gap, width: float = 3.0) -> None:
        """The way from a link to an obstacle, in the colour of its zone and with a dark rim; dots end it."""
        ends = np.stack([gap.link, gap.obstacle])
        places, _ = self._shot.camera.project(ends)
        for colour, wider in ((style.INK, 1.2), (zone_colour(gap.zone), 0.0)):
            self._line(places[0], places[1], _rgba(colour), width + wider)
            for place in places:
                self._dot(place, 1.2 * width + 0.5 * wider, _rgba(colour))

    def modules(self, modules: Modules) -> None:
        """The skin's modules that face the camera; in colour those that feel something."""
        camera = self._shot.camera
        eye = np.array(camera.target) - camera.distance * camera.axes[2]
        facing = ((eye - modules.position) * modules.normal).sum(axis=1) > 0.0
        places, depth = camera.project(modules.position)
        seen = facing & ~self._shot.hidden(modules.position, tolerance=0.02)
        for index in np.flatnonzero(seen):
            radius = 0.011 * camera.focal_length / float(depth[index]) / self._scale
            self._dot(places[index], radius, _rgba(style.INK, 200))
            felt = style.VERMILLION if modules.closed[index] else style.SKY if modules.near[index] else None
            if felt is not None:
                self._dot(places[index], 0.75 * radius, _rgba(felt))

    def ring(self, point: Array, colour: str, radius: float = 9.0, width: float = 2.0) -> None:
        """A circle around a point (3,)."""
        (place,), _ = self._shot.camera.project(point[None])
        box = _box(place, self._scale * radius)
        self._pen.ellipse(box, outline=_rgba(colour), width=round(self._scale * width))

    def words(self, place: tuple[float, float], text: str, size: float = 13.0, anchor: str = "la") -> None:
        """A text at a place from the upper left corner; `anchor` says which point of it lies there."""
        at = (self._scale * place[0], self._scale * place[1])
        self._pen.text(at, text, font=_font(self._scale * size), fill=_rgba(style.INK), anchor=anchor)

    def legend(self, zones: Sequence[Zone], size: float = 11.0) -> None:
        """Below to the left: which colour means which distance."""
        left, middle = 12.0, self.height - 12.0
        self.words((left, middle), "obstacle nearer than", size, "lm")
        left += self._length("obstacle nearer than", size) + 12.0
        for zone in zones:
            ends = self._scale * np.array([[left, middle], [left + 18.0, middle]])
            for colour, wider in ((style.INK, 1.2), (zone_colour(zone), 0.0)):
                self._line(ends[0], ends[1], _rgba(colour), 3.0 + wider)
            text = f"{zone.begin:.2f} m"
            self.words((left + 23.0, middle), text, size, "lm")
            left += 23.0 + self._length(text, size) + 14.0

    def _length(self, text: str, size: float) -> float:
        """How wide a text is [pixels]."""
        return _font(self._scale * size).getlength(text) / self._scale

    def _line(self, start: Array, end: Array, colour: tuple[int, ...], width: float) -> None:
        """A straight line between two places [fine pixels]."""
        self._pen.line([*start.tolist(), *end.tolist()], fill=colour, width=round(self._scale * width))

    def _dot(self, place: Array, radius: float, colour: tuple[int, ...]) -> None:
        """A disc at a place [fine pixels]."""
        self._pen.ellipse(_box(place, self._scale * radius), fill=colour)


def meaningful_colours() -> list[str]:
    """Colours that say something, which a film with few colours must not lose."""
    return [style.BLUE, style.GREEN, style.INK, *style.ZONE_LINES.values()]


def zone_colour(zone: Zone) -> str:
    """The colour of a line in a zone: what its shade is a tint of."""
    return style.ZONE_LINES[zone.shade]


def _box(place: Array, radius: float) -> tuple[float, float, float, float]:
    """The square around a disc."""
    return place[0] - radius, place[1] - radius, place[0] + radius, place[1] + radius


def _rgba(colour: str, opacity: int = 255) -> tuple[int, ...]:
    """`#rrggbb` and an opacity as numbers to 255."""
    return (*bytes.fromhex(colour.removeprefix("#")), opacity)


@cache
def _font(size: float) -> ImageFont.FreeTypeFont:
    """The figures' letters, which matplotlib brings along."""
    file = Path(mpl.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(file, round(size))
