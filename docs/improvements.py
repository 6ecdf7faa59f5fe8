"""Measures the effect of each improvement by itself and prints the tables of docs/improvements.md.

    python docs/improvements.py [--starts 8] [--workers 2] [--out out/improvements]

Every line of a table is one configuration in one scene, from perturbed starts (seeds 0, 1, 2 ...: 0.03 rad,
0.02 m), each for 60 s. Finished runs in the folder are used again.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxgen.builder import build
from proxgen.config import load
from proxgen.reproduce.plan import IIWA7, SCENES, Experiment
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
    "paper": ("iiwa7", ""),
    "slack": ("iiwa7", "relaxation: {mode: slack, slack: {active_weight: 0.3}}"),
    "damper": ("iiwa7", "avoidance: {schedule: damper}"),
    "damper, no active row": ("iiwa7", "avoidance: {schedule: damper, active: {enabled: false}}"),
    "damper and slack": (
        "iiwa7",
        "avoidance: {schedule: damper}\nrelaxation: {mode: slack, slack: {active_weight: 0.3}}",
    ),
    "no acceleration bound": ("iiwa7", "limits: {acceleration: null}"),
    "switch (11) alone": ("iiwa7", "limits: {joint_damper: null}"),
    "viability, no joint damper": ("iiwa7", "limits: {joint_damper: null, viability: true}"),
    "joint damper and viability": ("iiwa7", "limits: {viability: true}"),
    "circulation": ("iiwa7", "avoidance: {circulation: {enabled: true}}"),
    "memory": ("iiwa7", "skin: {memory: {enabled: true}}"),
    "self-measurement removal": ("iiwa7", "skin: {self_measurement: {enabled: true}}"),
    "denser cuffs": ("iiwa7", DENSER),
    "improved": ("iiwa7_improved", ""),
    "dense": ("iiwa7_dense", ""),
    "dense, switches at 0.15 m": ("iiwa7_dense", "skin: {capacitive: {trigger: 15 cm}}"),
}
"""The example that each variant extends, and what it adds to it."""

OTHER_SEEDS = 100
"""The first seed of the last table."""


@dataclass(frozen=True)
class Line:
    """A configuration in a scene.

    Attributes:
        variant: name in `VARIANTS`.
        scene: name of the scene.
        sensing: `ideal` or `skin`.
        first_seed: of its starts.
    """

    variant: str
    scene: str
    sensing: str = "ideal"
    first_seed: int = 0


BEST = (*(("improved", scene, "ideal") for scene in SCENES), ("dense", "moving", "skin"))

TABLES = {
    "The paper configuration": [
        Line("paper", scene, sensing) for sensing in ("ideal", "skin") for scene in SCENES
    ],
    "Slack rows": [Line("slack", scene) for scene in ("gap", "pillar")],
    "Damper schedule": [
        *(Line("damper", scene) for scene in ("gap", "pillar")),
        *(Line(name, "gap") for name in ("damper, no active row", "damper and slack")),
    ],
    "Acceleration bound": [Line("no acceleration bound", scene) for scene in ("gap", "pillar")],
    "Joint damper and viability": [
        Line(name, "moving")
        for name in ("paper", "switch (11) alone", "viability, no joint damper", "joint damper and viability")
    ],
    "Circulation": [Line("circulation", scene) for scene in ("facing", "gap")],
    "Memory, self-measurement removal, denser cuffs": [
        *(Line(name, "moving", "skin") for name in ("paper", "memory", "self-measurement removal")),
        *(Line(name, "moving", "skin") for name in ("denser cuffs", "dense, switches at 0.15 m")),
    ],
    "All together": [Line(*line) for line in BEST],
    "All together, other seeds": [Line(*line, OTHER_SEEDS) for line in (*BEST, ("paper", "moving", "skin"))],
}
"""The lines of each table of the page."""

HEAD = (
    "| configuration | scene | sensing | targets | least distance [m] | below d_r [%] | mean Δq̇ [mrad/s] | "
    "greatest [rad/s] |\n|---|---|---|---|---|---|---|---|"
)


def main() -> None:
    """Write the variants, build them, run what is missing, print the tables."""
    parser = argparse.ArgumentParser(description="The effect of each improvement by itself.")
    parser.add_argument("--starts", type=int, default=8)
    parser.add_argument("--duration", type=float, default=60.0)
    parser.add_argument("--workers", type=int, default=cores(), help="processes")
    parser.add_argument("--out", type=Path, default=Path("out/improvements"))
    given = parser.parse_args()
    libraries = {name: _build(name, given.out) for name in VARIANTS}
    store = Store(given.out / "runs")
    runs = {
        line: [
            _run(line, *libraries[line.variant], line.first_seed + start, given.duration)
            for start in range(given.starts)
        ]
        for lines in TABLES.values()
        for line in lines
    }
    by_start = [run for of_start in zip(*runs.values(), strict=True) for run in of_start]
    missing = [run for run in by_start if _found(store, run) is None]  # fewer starts are whole tables, too
    carry_out_all(missing, store, given.workers, lambda task: print(task.name, "done", flush=True))
    for title, lines in TABLES.items():
        print(f"\n## {title}\n\n{HEAD}")
        for line in lines:
            print(_written(line, [_found(store, run) or {} for run in runs[line]]))
        for line in lines:
            print(_besides(line, runs[line], store))


def _build(name: str, out: Path) -> tuple[Path, Path]:
    """A variant's YAML file and its compiled controller."""
    base, added = VARIANTS[name]
    word = name.replace(" ", "_").replace(",", "")
    path = (out / "variants" / f"{word}.yaml").resolve()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"extends: {IIWA7 / base}.yaml\n{added}\n", encoding="utf-8")
    return path, build(load(path), out / "builds" / word).library_dir


def _run(line: Line, path: Path, library: Path, seed: int, duration: float) -> Rollout:
    """One run of a line."""
    name = f"{path.stem}-{line.scene}-{line.sensing}"
    return Rollout(Experiment(name, "", line.scene, sensing=line.sensing), path, library, seed, duration)


def _found(store: Store, run: Rollout) -> Numbers | None:
    """What is kept of a run."""
    return store.find(run.name, run.fingerprint())


def _written(line: Line, found: Sequence[Numbers]) -> str:
    """One line of the table: mean and spread over the starts; of the greatest change the greatest."""

    def spread(key: str, scale: float, digits: int) -> str:
        values = scale * np.array([float(numbers[key]) for numbers in found])
        return f"{values.mean():.{digits}f} ± {values.std():.{digits}f}"

    cells = [
        line.variant,
        line.scene,
        line.sensing,
        spread("targets_reached", 1.0, 1),
        spread("min_distance_axis_m", 1.0, 3),
        spread("time_below_dr_fraction", 100.0, 1),
        spread("mean_abs_dqdot", 1000.0, 1),
        f"{max(float(numbers['max_abs_dqdot']) for numbers in found):.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def _besides(line: Line, runs: Sequence[Rollout], store: Store) -> str:
    """What else the page says of a line: over all starts."""
    found = [_found(store, run) or {} for run in runs]

    def total(key: str) -> int:
        return sum(int(numbers[key]) for numbers in found)

    beyond = 0.0
    for run in runs:
        log = store.log(run.name)
        outside = np.maximum(log.meta["q_lower"] - log.q, log.q - log.meta["q_upper"])
        beyond = max(beyond, float(outside.max()))
    touched = sum(int(numbers["penetration_samples"]) > 0 for numbers in found)
    least = min(float(numbers["min_distance_axis_m"]) for numbers in found)
    return (
        f"{line.variant}, {line.scene}, {line.sensing}: least distance of all {least:.3f} m; "
        f"{total('limit_violations')} cycles beyond a limit, by up to {beyond:.4f} rad; "
        f"{touched} starts touched something; {total('solver_failures')} QPs failed"
    )


if __name__ == "__main__":
    main()
