"""The verb that measures: bench."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from proxgen.cli.arguments import count, new_file, seconds
from proxgen.cli.output import columns, progress_bar, write_json
from proxgen.config.examples import examples_directory

if TYPE_CHECKING:
    from proxgen.bench import Benchmark
    from proxgen.bench.peers import PeerBenchmark
    from proxgen.bench.scaling import Scaling
    from proxgen.config.scene import Scene
    from proxgen.config.schema import Config

SCENES = ("gap", "pillar", "moving")
PEERS = Path("build/bench")
"""Where the peers' environments are made, and kept."""


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
        default=_example("iiwa7.yaml"),
        help="the robot's YAML file (default: examples/iiwa7/iiwa7.yaml)",
    )
    bench.add_argument(
        "--scene",
        action="append",
        metavar="NAME|FILE",
        help=f"may be given several times (default: {', '.join(SCENES)})",
    )
    bench.add_argument(
        "--also",
        action="append",
        metavar="CONFIG",
        type=Path,
        help="another configuration of the same robot, timed on the same inputs: what additions cost "
        "(default: with the default CONFIG, examples/iiwa7/iiwa7_improved.yaml)",
    )
    bench.add_argument(
        "--duration", type=seconds, default=60.0, metavar="S", help="simulated time per scene (default: 60)"
    )
    bench.add_argument(
        "--replays", type=count, default=5, metavar="N", help="passes over each recording (default: 5)"
    )
    kind = bench.add_mutually_exclusive_group()
    kind.add_argument(
        "--scaling",
        action="store_true",
        help="instead: made-up arms with more and more joints, sensors and capsules",
    )
    kind.add_argument(
        "--peers",
        action="store_true",
        help="instead: the same cycles through other controllers, each installed into build/bench",
    )
    bench.add_argument("--json", type=new_file, metavar="FILE", help="write the numbers there")
    bench.add_argument(
        "--plot", type=new_file, metavar="FILE", help="draw the times there (PNG, or SVG if it ends so)"
    )
    bench.set_defaults(carry_out=carry_out_bench)


def _example(name: str) -> Path:
    """A file of the iiwa 7."""
    return examples_directory() / "iiwa7" / name


def carry_out_bench(arguments: argparse.Namespace) -> int:
    """Measure, print a table, write what was asked for."""
    if arguments.scaling:
        return _bench_scaling(arguments)
    from proxgen.config import load
    from proxgen.config.scene import load_scene

    config = load(arguments.config)
    improved = [_example("iiwa7_improved.yaml")] if arguments.config == _example("iiwa7.yaml") else []
    scenes = [load_scene(name, beside=arguments.config) for name in arguments.scene or SCENES]
    if arguments.peers:
        return _bench_peers(arguments, config, scenes)
    return _bench_controller(arguments, config, scenes, [load(path) for path in arguments.also or improved])


def _bench_controller(
    arguments: argparse.Namespace, config: "Config", scenes: "list[Scene]", also: "list[Config]"
) -> int:
    """The compiled controller alone, stage by stage."""
    from proxgen.bench import run_benchmark

    with progress_bar(f"{config.robot.name}: record and replay") as progress:
        benchmark = run_benchmark(
            config,
            scenes,
            also=also,
            duration=arguments.duration,
            replays=arguments.replays,
            progress=progress,
        )
    print(_table(benchmark))
    return _finish(arguments, benchmark)


def _bench_peers(arguments: argparse.Namespace, config: "Config", scenes: "list[Scene]") -> int:
    """The compiled controller beside its peers; a peer that is missing is said so, and is no failure."""
    from proxgen.bench.peers import run_peers

    with progress_bar(f"{config.robot.name}: peers") as progress:
        benchmark = run_peers(config, scenes, PEERS, duration=arguments.duration, progress=progress)
    print(_peer_table(benchmark))
    for name, reason in benchmark.failures.items():
        print(f"NOT MEASURED: {name}: {reason}")
    print("not alike:")
    for name, differences in benchmark.not_alike.items():
        for difference in differences:
            print(f"  {name}: {difference}")
    for name, versions in benchmark.versions.items():
        print(f"{name}: " + ", ".join(f"{package} {version}" for package, version in versions.items()))
    return _finish(arguments, benchmark)


def _bench_scaling(arguments: argparse.Namespace) -> int:
    """Times over the size of the arm."""
    from proxgen.bench.scaling import PARTS, run_scaling

    with progress_bar("arms of all sizes") as progress:
        scaling = run_scaling(replays=arguments.replays, progress=progress)
    for name, sweep in scaling.sweeps.items():
        rows: list[tuple[str, ...]] = [(name, *(f"{part} us" for part in PARTS))]
        for index, value in enumerate(sweep["value"]):
            rows.append((f"{value:.0f}", *(f"{sweep[part][index]:.3f}" for part in PARTS)))
        print(columns(rows), end="\n\n")
    slope, explained = scaling.per_sensor
    print(f"distance stage: {slope:.1f} ns per sensor; a straight line explains {100.0 * explained:.2f} %")
    return _finish(arguments, scaling)


def _finish(arguments: argparse.Namespace, measured: "Benchmark | PeerBenchmark | Scaling") -> int:
    """What it was measured on, and with; the files that were asked for."""
    for key, value in measured.machine.items():
        print(f"{key}: {value}")
    if arguments.json:
        write_json(arguments.json, measured.to_json())
    if arguments.plot:
        from proxgen.bench.plot import draw

        print(f"plot: {draw(measured, arguments.plot)}")
    return 0


def _peer_table(benchmark: "PeerBenchmark") -> str:
    """A line per peer, scene and back end: both medians, their ratio, and that of the single cycles."""
    rows: list[tuple[str, ...]] = [
        (
            "peer",
            "cycles of",
            "p50 us",
            "against",
            "p50 us",
            "ratio",
            "quartiles of cycles",
            "no answer",
            "links near",
        )
    ]
    for result in benchmark.results:
        for name, own in result["against"].items():
            low, _, high = own["ratio_of_cycles"]
            rows.append(
                (
                    result["backend"],
                    result["name"].partition(":")[0],
                    f"{result['p50_us']:.2f}",
                    name,
                    f"{own['p50_us']:.2f}",
                    f"{own['ratio_of_p50']:.1f}",
                    f"{low:.1f} to {high:.1f}",
                    str(result.get("cycles_without_answer", "")),
                    f"{result['mean_links_near']:.1f}" if "mean_links_near" in result else "",
                )
            )
    return columns(rows)


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
