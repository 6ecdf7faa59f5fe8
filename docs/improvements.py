"""Measures the effect of each improvement by itself and prints the tables of docs/improvements.md.

    python docs/improvements.py [--starts 8] [--out out/improvements]

Every line of a table is one configuration in one scene, from perturbed starts (seeds 0, 1, 2 ...: 0.03 rad,
0.02 m), each for 60 s. Finished runs in the folder are used again.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from proxgen.builder import build
from proxgen.config import load
from proxgen.reproduce.plan import IIWA7, Experiment
from proxgen.reproduce.pool import carry_out_all, cores
from proxgen.reproduce.store import Numbers, Store
from proxgen.reproduce.tasks import Rollout

DENSER = """skin:
  cuffs:
    - name: upper_arm
      rings:
        - {offset: 0.14, radius: 85 mm, modules: 6, tilt: -20 deg}
        - {offset: 0.27, radius: 85 mm, modules: 6, tilt: 30 deg, stagger: 0.5}
    - name: hand
      rings:
        - {offset: 0.12, radius: 70 mm, modules: 8, tilt: -15 deg}
        - {offset: 0.17, radius: 70 mm, modules: 8, tilt: 35 deg, stagger: 0.5}
  tof: {cone: 25 deg}
  capacitive: {trigger: 12 cm, virtual_distance: 10 cm}
"""

VARIANTS = {
    "paper": "",
    "slack": "relaxation: {mode: slack, slack: {active_weight: 0.3}}",
    "damper": "avoidance: {schedule: damper}",
    "damper_without_active": "avoidance: {schedule: damper, active: {enabled: false}}",
    "damper_and_slack": (
        "avoidance: {schedule: damper}\nrelaxation: {mode: slack, slack: {active_weight: 0.3}}"
    ),
    "no_acceleration": "limits: {acceleration: null}",
    "no_joint_damper": "limits: {joint_damper: null}",
    "viability": "limits: {joint_damper: null, viability: true}",
    "circulation": "avoidance: {circulation: {enabled: true}}",
    "memory": "skin: {memory: {enabled: true}}",
    "self_measurement": "skin: {self_measurement: {enabled: true}}",
    "denser": DENSER,
}
"""What each variant adds to examples/iiwa7/iiwa7.yaml."""

LINES = (
    *(("paper", scene, "ideal") for scene in ("gap", "pillar", "facing", "moving")),
    *(("paper", scene, "skin") for scene in ("gap", "pillar", "facing", "moving")),
    *(("slack", scene, "ideal") for scene in ("gap", "pillar")),
    *(("damper", scene, "ideal") for scene in ("gap", "pillar")),
    *((name, "gap", "ideal") for name in ("damper_without_active", "damper_and_slack")),
    *(("no_acceleration", scene, "ideal") for scene in ("gap", "pillar")),
    *((name, "moving", "ideal") for name in ("no_joint_damper", "viability")),
    *(("circulation", scene, "ideal") for scene in ("facing", "gap")),
    *((name, "moving", "skin") for name in ("memory", "self_measurement", "denser")),
)  # fmt: skip
"""Variant, scene, sensing of each line."""

HEAD = (
    "| | scene | sensing | targets | least distance [m] | below d_r [%] | mean Δq̇ [mrad/s] | greatest |\n"
    "|---|---|---|---|---|---|---|---|"
)


def main() -> None:
    """Write the variants, build them, run what is missing, print the lines."""
    parser = argparse.ArgumentParser(description="The effect of each improvement by itself.")
    parser.add_argument("--starts", type=int, default=8)
    parser.add_argument("--duration", type=float, default=60.0)
    parser.add_argument("--out", type=Path, default=Path("out/improvements"))
    given = parser.parse_args()
    libraries = {name: _build(name, given.out) for name in VARIANTS}
    store = Store(given.out / "runs")
    lines = [
        [_run(line, *libraries[line[0]], start, given.duration) for start in range(given.starts)]
        for line in LINES
    ]
    missing = [run for runs in lines for run in runs if store.find(run.name, run.fingerprint()) is None]
    carry_out_all(missing, store, cores(), lambda task: print(task.name, "done", flush=True))
    print(HEAD)
    for line, runs in zip(LINES, lines, strict=True):
        print(_written(line, [store.find(run.name, run.fingerprint()) or {} for run in runs]))


def _build(name: str, out: Path) -> tuple[Path, Path]:
    """A variant's YAML file and its compiled controller."""
    path = (out / "variants" / f"{name}.yaml").resolve()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"extends: {IIWA7 / 'iiwa7.yaml'}\n{VARIANTS[name]}\n", encoding="utf-8")
    return path, build(load(path), out / "builds" / name).library_dir


def _run(line: tuple[str, str, str], path: Path, library: Path, start: int, duration: float) -> Rollout:
    """One run of a line."""
    return Rollout(Experiment("-".join(line), "", line[1], sensing=line[2]), path, library, start, duration)


def _written(line: Sequence[str], found: Sequence[Numbers]) -> str:
    """One line of the table: mean and spread over the starts; of the greatest change the greatest."""

    def spread(key: str, scale: float, digits: int) -> str:
        values = scale * np.array([float(numbers[key]) for numbers in found])
        return f"{values.mean():.{digits}f} ± {values.std():.{digits}f}"

    cells = [
        *line,
        spread("targets_reached", 1.0, 1),
        spread("min_distance_axis_m", 1.0, 3),
        spread("time_below_dr_fraction", 100.0, 1),
        spread("mean_abs_dqdot", 1000.0, 1),
        f"{max(float(numbers['max_abs_dqdot']) for numbers in found):.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    main()
