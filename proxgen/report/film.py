"""A run as a film: a GIF, or a WebP (smaller, more colours), rendered and marked picture by picture.

Written by Pillow, which matplotlib needs anyway; an MP4 would need an encoder that no Python package holds.
"""

from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from proxgen.errors import SimulationError
from proxgen.files import write_whole
from proxgen.model.robot_model import RobotModel
from proxgen.report.derive import label, zones
from proxgen.report.overlay import Overlay, meaningful_colours
from proxgen.report.stage import Stage, fitting_camera
from proxgen.report.stills import draw_moment
from proxgen.simulation.log import RolloutLog

Progress = Callable[[int, int], None]
"""Called after each picture with the number of pictures done and the number of all."""

FORMATS = (".gif", ".webp")

RATE = 10
"""Pictures per second; a GIF counts time in hundredths of a second."""

_SCALE = 1.5
"""Pictures are rendered this many times larger, then made smaller, for smooth edges."""
_TRAIL = 4.0
"""How long the tool's path stays in the picture [s]."""
_COLOURS = 128

TITLE = "Film"
CAPTION = (
    "Blue: the tool's path. Bars: distances to obstacles. Dots: the skin, in colour where it feels something."
)


def write_film(
    path: Path,
    log: RolloutLog,
    model: RobotModel,
    *,
    start: float = 0.0,
    end: float | None = None,
    pictures: int = 120,
    size: tuple[int, int] = (480, 360),
    progress: Progress | None = None,
) -> Path:
    """Render a run as a film that repeats for ever.

    Args:
        path: the file; its name ends in one of `FORMATS`.
        log: the run.
        model: the arm that ran.
        start: of the part that is shown [s].
        end: of this part; by default that of the run [s].
        pictures: at most so many; a longer part is shown faster instead.
        size: width and height [pixels].
        progress: called after every picture.

    Returns:
        The file, written whole or not at all.

    Raises:
        SimulationError: an unknown format, or nothing to show.
    """
    check_format(path)
    cycles = chosen_cycles(log, start, end, pictures)
    camera = fitting_camera(log, model, *size, cycles=(cycles[0], cycles[-1]))
    speed = (cycles[-1] - cycles[0]) * log.meta["period"] * RATE / max(len(cycles) - 1, 1)
    images = []
    with Stage(log, model, camera) as stage:
        for number, cycle in enumerate(cycles):
            since = max(cycle - round(_TRAIL / log.meta["period"]), cycles[0])
            images.append(_picture(stage, cycle, since, speed))
            if progress is not None:
                progress(number + 1, len(cycles))
    return write_whole(path, _encoded(images, path.suffix))


def check_format(path: Path) -> None:
    """Refuse a file name whose ending is not one of `FORMATS`.

    Raises:
        SimulationError: it is not.
    """
    if path.suffix not in FORMATS:
        raise SimulationError(f"a film is a file of type {' or '.join(FORMATS)}, not '{path.name}'")


def chosen_cycles(log: RolloutLog, start: float, end: float | None, pictures: int) -> list[int]:
    """Cycles at equal steps of time: `RATE` per second of the run, or fewer if that gives too many pictures.

    Raises:
        SimulationError: no cycle lies in this part of the run.
    """
    period = float(log.meta["period"])
    first = max(round(start / period), 0)
    after = log.cycles if end is None else min(round(end / period), log.cycles)
    if first >= after:
        raise SimulationError(f"the run has no cycle to show from {start:g} s on")
    count = min(pictures, max(int((after - first) * period * RATE), 1))
    return [round(cycle) for cycle in np.linspace(first, after - 1, count).tolist()]


def _picture(stage: Stage, cycle: int, since: int, speed: float) -> Image.Image:
    """One cycle, the path since another one, the time, and what the colours mean."""
    log = stage.log
    overlay = Overlay(stage.shoot(cycle, _SCALE), _SCALE)
    draw_moment(overlay, stage, cycle, since)
    overlay.words((12.0, 9.0), label(log), 11.0)
    faster = f"   × {speed:.1f}" if speed > 1.05 else ""
    overlay.words((12.0, 26.0), f"t = {log.time[cycle]:4.1f} s{faster}", 11.0)
    reached = int(log.targets_reached[cycle])
    overlay.words((overlay.width - 12.0, 9.0), f"targets reached: {reached}", 11.0, "ra")
    overlay.legend(zones(log))
    return overlay.picture()


def _encoded(images: Sequence[Image.Image], suffix: str) -> bytes:
    """A film as bytes."""
    buffer, options = BytesIO(), {"save_all": True, "loop": 0, "duration": 1000 // RATE}
    if suffix == ".webp":
        images[0].save(buffer, "WEBP", append_images=images[1:], quality=70, method=4, **options)
        return buffer.getvalue()
    # One palette for all, and no dithering: what stands still then has the same bytes in every picture.
    sample = images[:: max(len(images) // 8, 1)]
    width, height = images[0].size
    sheet = Image.new("RGB", (width, height * (len(sample) + 1)))
    for number, image in enumerate(sample):
        sheet.paste(image, (0, number * height))
    colours = meaningful_colours()
    for number, colour in enumerate(colours):
        left = number * width // len(colours)
        sheet.paste(colour, (left, len(sample) * height, width, (len(sample) + 1) * height))
    palette = sheet.quantize(_COLOURS, Image.Quantize.MEDIANCUT)
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    flat[0].save(buffer, "GIF", append_images=flat[1:], optimize=False, **options)
    return buffer.getvalue()
