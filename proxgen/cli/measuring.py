"""The verb that measures: bench."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from proxgen.cli.arguments import seconds, whole_number
from proxgen.cli.output import columns, progress_bar, write_json

if TYPE_CHECKING:
    from proxgen.bench import Benchmark

EXAMPLE = Path("examples/iiwa7/iiwa7.yaml")
SCENES = ("gap", "pillar", "moving")


def add_verbs(verbs: Any) -> None:
    """Add the verb of this module to the parser."""
    bench = verbs.add_parser(
        "bench", help="time the compiled controller on recorded closed loops, from C and from Python"
    )
    bench.add_argument(
        "config",
        metavar="CONFIG",
        type=Path,
        nargs="?",
        default=EXAMPLE,
        help=f"the robot's YAML file (default: {EXAMPLE})",
    )
    bench.add_argument(
        "--scene",
        action="append",
        metavar="NAME|FILE",
        help=f"may be given several times (default: {', '.join(SCENES)})",
    )
    bench.add_argument(
        "--duration", type=seconds, default=60.0, metavar="S", help="simulated time per scene (default: 60)"
    )
    bench.add_argument(
        "--replays", type=whole_number, default=5, metavar="N", help="passes over each recording (default: 5)"
    )
    bench.add_argument("--json", type=Path, metavar="FILE", help="write the numbers there")
    bench.add_argument("--plot", type=Path, metavar="FILE", help="draw the distributions there (PNG)")
    bench.set_defaults(carry_out=carry_out_bench)


def carry_out_bench(arguments: argparse.Namespace) -> int:
    """Measure, print a table, write what was asked for."""
    from proxgen.bench import run_benchmark
    from proxgen.config import load
    from proxgen.config.scene import load_scene

    config = load(arguments.config)
    scenes = [load_scene(name, beside=arguments.config) for name in arguments.scene or SCENES]
    with progress_bar(f"{config.robot.name}: record and replay") as progress:
        benchmark = run_benchmark(
            config, scenes, duration=arguments.duration, replays=max(arguments.replays, 1), progress=progress
        )
    print(_table(benchmark))
    for key, value in benchmark.machine.items():
        print(f"{key}: {value}")
    if arguments.json:
        write_json(arguments.json, benchmark.to_json())
    if arguments.plot:
        from proxgen.bench.plot import draw_times

        print(f"plot: {draw_times(benchmark, arguments.plot)}")
    return 0


def _table(benchmark: "Benchmark") -> str:
    """All results, a line each."""
    rows: list[tuple[str, ...]] = [
        (
            "measurement to velocity",
            "back end",
            "p50 us",
            "p99 us",
            "p99.9 us",
            "max us",
            "cycles/s",
            "heap",
            "instr.",
        )
    ]
    for result in benchmark.results:
        times = [f"{result[key]:.2f}" for key in ("p50_us", "p99_us", "p999_us", "max_us")]
        heap, count = result.get("heap_allocations_per_cycle"), result.get("instructions_per_cycle")
        rows.append(
            (
                result["name"],
                result["backend"],
                *times,
                f"{result['cycles_per_s']:.0f}",
                "" if heap is None else f"{heap:.1f}",
                "" if count is None else f"{count:.0f}",
            )
        )
    return columns(rows)
