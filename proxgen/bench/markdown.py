"""Tables for the documentation, from the JSON that the benchmarks wrote: nobody copies a figure by hand."""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from proxgen.bench.replay import BACKENDS, STAGES

Measured = Mapping[str, Mapping[str, Any]]
"""The JSON of `proxgen bench` as `bench`, with --peers as `peers`, with --scaling as `scaling`."""

_BLOCK = re.compile(r"(<!-- measured: ([a-z ]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def fill(page: str, measured: Measured) -> str:
    """A page with its measured blocks, from `<!-- measured: NAME -->` to `<!-- end -->`, made anew.

    Args:
        page: Markdown.
        measured: what the benchmarks wrote.

    Raises:
        KeyError: a block has a name that is not one of `BLOCKS`.
    """
    return _BLOCK.sub(lambda found: found[1] + BLOCKS[found[2]](measured) + "\n" + found[3], page)


def cycle_table(measured: Measured) -> str:
    """Whole cycles from C, raw and best of k apart, and from Python: a line per recording and back end."""
    results = measured["bench"]["results"]
    rows = []
    for raw in (row for row in results if row["name"].endswith(": cycle, raw")):
        name, backend = raw["name"].removesuffix(": cycle, raw"), raw["backend"]
        best = _find(results, f"{name}: cycle, best of ", backend)
        python = _find(results, f"{name}: cycle from Python, raw", backend)
        recorded = _find(results, f"{name}: cycle from Python, recorded arrays", backend)
        build = _find(results, f"{name}: QP build", backend)
        count = raw["instructions_per_cycle"]
        rows.append(
            (
                f"{name}, {BACKENDS[backend]}",
                *(_time(raw[key]) for key in ("p50_us", "p99_us", "p999_us", "max_us")),
                *(_time(best[key]) for key in ("p50_us", "p999_us")),
                _time(build["p50_us"]),
                _time(python["p50_us"]),
                _time(recorded["p50_us"]),
                f"{raw['cycles_per_s']:,.0f}",
                f"{raw['heap_allocations_per_cycle']:.0f}",
                "" if count is None else f"{count:,.0f}",
            )
        )
    best_of = next(row["name"] for row in results if ": cycle, best of " in row["name"]).rsplit(" ", 1)[1]
    return _table(
        (
            "recording, back end", "p50 [µs]", "p99", "p99.9", "max", f"best of {best_of}: p50", "p99.9",
            "QP build: p50", "from Python: p50", "recorded arrays", "cycles/s", "heap", "instructions",
        ),
        rows,
    )  # fmt: skip


def summary_table(measured: Measured) -> str:
    """The most important of `cycle_table`: gap and moving, with fewer columns."""
    results = measured["bench"]["results"]
    rows = []
    for name in ("gap", "moving"):
        for backend, title in BACKENDS.items():
            raw = _find(results, f"{name}: cycle, raw", backend)
            best = _find(results, f"{name}: cycle, best of ", backend)
            times = [_time(row[key]) for row in (raw, best) for key in ("p50_us", "p99_us", "p999_us")]
            python = _find(results, f"{name}: cycle from Python, raw", backend)
            heap = f"{raw['heap_allocations_per_cycle']:.0f}"
            rows.append((f"{name}, {title}", *times, _time(python["p50_us"]), heap))
    head = ("µs per cycle", "p50", "p99", "p99.9", "*best:* p50", "p99", "p99.9", "from Python: p50", "heap")
    return _table(head, rows)


def stage_table(measured: Measured) -> str:
    """Raw median of each stage: a line per recording and back end."""
    results = measured["bench"]["results"]
    rows = []
    for raw in (row for row in results if row["name"].endswith(": cycle, raw")):
        name, backend = raw["name"].removesuffix(": cycle, raw"), raw["backend"]
        stages = (_find(results, f"{name}: {stage}, raw", backend) for stage in STAGES)
        rows.append((f"{name}, {BACKENDS[backend]}", *(_time(stage["p50_us"]) for stage in stages)))
    return _table(("raw p50 [µs]", *STAGES), rows)


def peer_table(measured: Measured) -> str:
    """A line per peer and recording: both medians, and their ratio."""
    rows = []
    for result in measured["peers"]["results"]:
        for backend, own in result["against"].items():
            rows.append(
                (
                    f"{result['backend']}",
                    result["name"].partition(":")[0],
                    _time(result["p50_us"]),
                    f"{BACKENDS.get(backend, backend)} {_time(own['p50_us'])}",
                    _ratio(own["ratio_of_p50"]),
                    str(result.get("cycles_without_answer", "")),
                )
            )
    return _table(("p50 of a cycle", "recording", "peer [µs]", "proxgen [µs]", "ratio", "no answer"), rows)


def peer_summary(measured: Measured) -> str:
    """A line per peer: its median in each recording, and how many times that of proxgen over DAQP it is."""
    times: dict[str, list[str]] = {}
    ratios: dict[str, list[str]] = {}
    for result in measured["peers"]["results"]:
        ((_, own), *_) = result["against"].items()
        times.setdefault(result["backend"], []).append(_time(result["p50_us"]))
        ratios.setdefault(result["backend"], []).append(_ratio(own["ratio_of_p50"]))
    rows = [(peer, ", ".join(times[peer]), ", ".join(ratios[peer])) for peer in times]
    return _table(("gap, moving", "p50 [µs]", "times that of proxgen with DAQP"), rows)


def scaling_tables(measured: Measured) -> str:
    """A table per quantity that was varied, and the straight line through the distance stage."""
    scaling = measured["scaling"]
    parts = []
    for name, sweep in scaling["scaling"].items():
        lines = [
            (part, *(_time(value) for value in values)) for part, values in sweep.items() if part != "value"
        ]
        parts.append(_table((name, *(f"{value:.0f}" for value in sweep["value"])), lines))
    line, distances = scaling["distance_stage"], scaling["scaling"]["sensors"]
    by_count = dict(zip(distances["value"], distances["distances"], strict=True))
    parts.append(
        f"The distance stage takes {line['ns_per_sensor']:.1f} ns per module; a straight line explains "
        f"{100.0 * line['explained_by_a_line']:.1f} % of it, and 512 modules take "
        f"{by_count[512.0] / by_count[32.0]:.1f} times the time of 32."
    )
    return "\n\n".join(parts)


def machine_of(which: str) -> Callable[[Measured], str]:
    """A paragraph that says what one of the benchmarks ran on, and with."""

    def describe(measured: Measured) -> str:
        content = measured[which]
        machine = ", ".join(f"{key} {value}" for key, value in content["machine"].items())
        packages = {
            f"{package} {number}"
            for versions in content.get("versions", {}).values()
            for package, number in versions.items()
        }
        return f"Measured with: {machine}." + (f" Peers: {', '.join(sorted(packages))}." if packages else "")

    return describe


BLOCKS: dict[str, Callable[[Measured], str]] = {
    "summary": summary_table,
    "cycles": cycle_table,
    "stages": stage_table,
    "peer summary": peer_summary,
    "peers": peer_table,
    "scaling": scaling_tables,
    "machine": machine_of("bench"),
    "machine of peers": machine_of("peers"),
    "machine of scaling": machine_of("scaling"),
}
"""What a page can ask for."""


def _find(results: Sequence[Mapping[str, Any]], start: str, backend: str) -> Mapping[str, Any]:
    """The result of a back end whose name begins so."""
    return next(row for row in results if row["backend"] == backend and row["name"].startswith(start))


def _time(microseconds: float) -> str:
    """Three digits, and no more."""
    digits = 2 if microseconds < 10.0 else 1 if microseconds < 100.0 else 0
    return f"{microseconds:,.{digits}f}"


def _ratio(value: float) -> str:
    """A ratio of times."""
    return f"{value:,.1f}" if value < 10.0 else f"{value:,.0f}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
