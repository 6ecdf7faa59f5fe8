"""How the times of whole cycles are spread: one curve per set of inputs and back end."""

from pathlib import Path

import numpy as np

from proxgen.bench.run import Benchmark
from proxgen.report.style import SERIES, house_style, legend_above, new_figure, save


def draw_times(benchmark: Benchmark, path: Path) -> Path:
    """Draw which share of the cycles takes longer than a time, raw, both axes logarithmic.

    Args:
        benchmark: what was measured.
        path: the PNG to write.

    Returns:
        The file.
    """
    with house_style():
        figure = new_figure(4.0)
        axes = figure.subplots()
        names = list(dict.fromkeys(measured.name for measured in benchmark.replays))
        for measured in benchmark.replays:
            times = np.sort(measured.whole.ravel()) * 1e6
            share = 1.0 - np.arange(len(times)) / len(times)
            axes.plot(
                times,
                share,
                color=SERIES[names.index(measured.name) % len(SERIES)],
                linestyle="-" if measured.backend == "daqp" else "--",
                label=f"{measured.name}, {measured.backend}",
            )
        axes.set(
            xscale="log",
            yscale="log",
            xlabel="time of a cycle [µs]",
            ylabel="share of cycles that take longer",
        )
        for level, name in ((0.5, "p50"), (1e-2, "p99"), (1e-3, "p99.9")):
            axes.axhline(level, color="#7b8794", linewidth=0.6)
            axes.annotate(name, (1.0, level), xycoords=("axes fraction", "data"), ha="right", va="bottom")
        legend_above(axes, columns=4)
        return save(figure, path)
