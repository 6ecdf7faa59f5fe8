"""How the times of whole cycles are spread, how they grow, and what they are beside those of peers."""

from pathlib import Path

import numpy as np

from proxgen.bench.peers import PeerBenchmark
from proxgen.bench.replay import BACKENDS
from proxgen.bench.run import Benchmark
from proxgen.bench.scaling import PARTS, Scaling
from proxgen.report.style import BLUE, SERIES, STEEL, house_style, legend_above, new_figure, save


def draw(measured: Benchmark | PeerBenchmark | Scaling, path: Path) -> Path:
    """Draw what was measured, whichever of the three it is.

    Args:
        measured: by `run_benchmark`, `run_peers` or `run_scaling`.
        path: the PNG to write; an SVG if the name ends so.

    Returns:
        The file.
    """
    if isinstance(measured, Benchmark):
        return draw_times(measured, path)
    return draw_peers(measured, path) if isinstance(measured, PeerBenchmark) else draw_scaling(measured, path)


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
                label=f"{measured.name}, {BACKENDS[measured.backend]}",
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
        axes.xaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_major_formatter(lambda share, _: f"{100.0 * share:g} %")
        legend_above(axes, columns=4)
        return save(figure, path)


def draw_peers(benchmark: PeerBenchmark, path: Path) -> Path:
    """Draw the median time of a cycle of every controller, scene by scene, on a logarithmic scale.

    Args:
        benchmark: what was measured.
        path: the PNG to write.

    Returns:
        The file.
    """
    bars: list[tuple[str, float, bool]] = []
    for result in benchmark.results:
        scene = result["name"].partition(":")[0]
        own = [
            (f"proxgen {BACKENDS.get(name, name)}, {scene}", of["p50_us"], True)
            for name, of in result["against"].items()
        ]
        bars += [bar for bar in own if bar[0] not in {name for name, _, _ in bars}]
        bars.append((f"{result['backend']}, {scene}", result["p50_us"], False))
    bars.sort(key=lambda bar: bar[1])
    with house_style():
        figure = new_figure(0.6 + 0.26 * len(bars))
        axes = figure.subplots()
        times = [time for _, time, _ in bars]
        colours = [BLUE if own else STEEL for _, _, own in bars]
        axes.barh([name for name, _, _ in bars], times, color=colours, height=0.7)
        for place, time in enumerate(times):
            axes.annotate(
                f"{time:.2f}" if time < 10.0 else f"{time:.0f}",
                (time, place),
                (3, 0),
                textcoords="offset points",
                va="center",
            )
        axes.set(xscale="log", xlabel="median time of a cycle [µs]")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.invert_yaxis()
        return save(figure, path)


def draw_scaling(scaling: Scaling, path: Path) -> Path:
    """Draw the median times of a cycle and its parts over the size of the arm, one panel per quantity.

    Args:
        scaling: what was measured.
        path: the PNG to write.

    Returns:
        The file.
    """
    with house_style():
        figure = new_figure(3.4)
        panels = figure.subplots(1, len(scaling.sweeps), squeeze=False)[0]
        for axes, (name, sweep) in zip(panels, scaling.sweeps.items(), strict=True):
            for part, colour in zip(PARTS, SERIES, strict=False):
                axes.plot(sweep["value"], sweep[part], color=colour, marker="o", markersize=3, label=part)
            axes.set(xlabel=name, ylim=(0.0, None))
        panels[0].set_ylabel("median time [µs]")
        # The figure's, not a panel's: it would make that panel narrower than the others.
        figure.legend(*panels[-1].get_legend_handles_labels(), loc="outside upper right", ncols=len(PARTS))
        return save(figure, path)
