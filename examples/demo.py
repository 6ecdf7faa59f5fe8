"""The iiwa 7 of the paper between two boxes: generate, compile, run, compare, report. `make demo` runs it."""

import sys
import time
from pathlib import Path

import proxgen
from proxgen import builder
from proxgen.cli.output import write_json
from proxgen.compare import compare
from proxgen.config.scene import load_scene
from proxgen.model import build_model
from proxgen.report import write_report
from proxgen.simulation.rollout import run

EXAMPLES = Path(__file__).parent
SCENE = "gap"
DURATION = 60.0  # simulated [s]


def main(directory: Path) -> int:
    """Do it all, say what happened, and return 0 only if it went as it must."""
    begin = time.perf_counter()
    config = proxgen.load(EXAMPLES / "iiwa7" / "iiwa7.yaml")

    say("1/4  generating and compiling the controller ...")
    result = builder.build(config)
    controller = proxgen.build(config)

    say(f"2/4  running it in scene '{SCENE}', {DURATION:g} s, with the simulated skin ...")
    log = run(config, build_model(config), controller, load_scene(SCENE), sensing="skin", duration=DURATION)
    summary = log.summary()

    say(f"3/4  comparing it with the reference, cycle by cycle, {DURATION:g} s ...")
    comparison = compare(config, [SCENE], sensing="skin", duration=DURATION)

    say("4/4  writing log, numbers and report ...")
    log.save(directory / "log.npz")
    write_json(directory / "summary.json", summary)
    write_json(directory / "comparison.json", comparison.to_json())
    page = write_report(directory, [log], comparison, config, title="The iiwa 7 between two boxes")

    numbers, cycle = comparison.to_json()["scenes"][0], summary["cycle_us"]
    say(
        f"""
Controller  {result.library_dir}, {"compiled just now" if result.rebuilt else "up to date"}
Run         {summary["targets_reached"]} targets reached; no link's axis nearer than \
{summary["min_distance_axis_m"]:.3f} m to a box; {summary["penetration_samples"]} penetrations,
            {summary["limit_violations"]} limit violations, {summary["solver_failures"]} solver failures
            {cycle["p50"]:.0f} µs per cycle (median) from Python, with the simulation beside it; \
`make bench` times the C code alone
Comparison  {comparison.verdict}: {numbers["cycles"]} cycles, velocities agree to \
{numbers["max_abs_qdot_error"]:.1g} rad/s, {numbers["status_mismatches"]} different statuses
Report      {page}; beside it log.npz, summary.json, comparison.json
Time        {time.perf_counter() - begin:.0f} s"""
    )
    harm = summary["penetration_samples"] + summary["limit_violations"] + summary["solver_failures"]
    return 0 if comparison.verdict == "pass" and summary["targets_reached"] > 0 and harm == 0 else 1


def say(text: str) -> None:
    """Print at once, so that a pipe shows progress too."""
    print(text, flush=True)


if __name__ == "__main__":
    sys.exit(main(Path("out") / "demo"))
