"""The compiled controllers against the reference with parameters at random, far from every default."""

from pathlib import Path

import numpy as np
import pytest

import proxgen
from proxgen.compare import compare_controllers_on, random_states
from proxgen.config import load
from proxgen.controllers.protocol import OFF, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

VARIANTS = {
    "paper": "",
    "damper": "avoidance: {distance_reference: surface, schedule: damper}",
    "slack": "relaxation: {mode: slack}",
}


def drawn(rng: np.random.Generator, model: RobotModel) -> dict[str, object]:
    """A value for every parameter that is there without additions."""
    n = model.n
    d_r, d_0l, d_0u, d_a = np.sort(rng.uniform(0.01, 0.5, 4))
    d_s, d_i = np.sort(rng.uniform(0.02, 0.4, 2))
    return {
        "q_lower": rng.uniform(0.7, 1.0, n) * model.q_lower,
        "q_upper": rng.uniform(0.7, 1.0, n) * model.q_upper,
        "qdot_limit": rng.uniform(0.3, 3.0, n),
        "qddot_limit": np.where(rng.random(n) < 0.2, OFF, rng.uniform(2.0, 40.0, n)),
        "joint_damper": float(rng.choice([OFF, rng.uniform(0.5, 20.0)])),
        "viability": float(rng.random() < 0.5),
        "limit_tolerance": rng.uniform(0.0, 0.9),
        "period": rng.uniform(1e-3, 0.1),
        "max_period": float(rng.choice([0.0, rng.uniform(0.02, 0.5)])),
        "sensor_timeout": rng.uniform(0.08, 0.2),
        "d_r": d_r,
        "d_0l": d_0l,
        "d_0u": float(rng.choice([d_0l, d_0u])),
        "d_a": d_a + 1e-3,
        "approach_speed": rng.uniform(0.02, 1.0),
        "repulse_speed": -rng.uniform(0.0, 1.0),
        "damper_safety": d_s,
        "damper_influence": d_i + 1e-3,
        "damper_gain": rng.uniform(0.5, 20.0),
        "damper_repulse_speed": -rng.uniform(0.0, 1.0),
        "row_speed": rng.uniform(0.05, 3.0),
        "d_active": rng.uniform(0.02, 0.6),
        "damping_gain": rng.uniform(0.0, 0.5),
        "damping_threshold": float(rng.choice([0.0, rng.uniform(1e-4, 0.3)])),
        "damping_floor": 10.0 ** rng.uniform(-4.0, -1.0),
        "slack_weight": 10.0 ** rng.uniform(0.0, 4.0),
        "slack_minimum": rng.uniform(0.01, 1.0),
        "slack_maximum": rng.uniform(1.0, 5.0),
        "slack_active_weight": 10.0 ** rng.uniform(0.0, 4.0),
        "posture_weight": np.where(rng.random(n) < 0.5, 0.0, rng.uniform(0.0, 0.2, n)),
        "posture_gain": rng.uniform(0.0, 3.0),
        "posture": rng.uniform(-1.0, 1.0, n),
    }


@pytest.mark.parametrize("name", VARIANTS)
def test_random_parameters(name: str, tmp_path: Path) -> None:
    path = tmp_path / "variant.yaml"
    path.write_text(f"extends: {EXAMPLES}/planar2/planar2.yaml\n{VARIANTS[name]}\n", encoding="utf-8")
    config = load(path)
    model, rng, seen = build_model(config), np.random.default_rng(52), set[Status]()
    compiled = proxgen.build(config, tmp_path / "built", backend="daqp")
    reference = ReferenceController(config, model)
    for seed in range(30):
        values = drawn(rng, model)
        assert set(values) == set(compiled.parameters)
        for controller in (compiled, reference):
            controller.set_parameters(**values)
        states = random_states(config, model, 50, seed=seed)
        result = compare_controllers_on(config, states, compiled, reference)
        assert result.verdict == "pass", (values, result.failures)
        seen |= {Status(number) for number in result.scenes[0].status.tolist()}
    assert {Status.SOLVED, Status.FAULT_JOINT_LIMIT, Status.FAULT_DEADLINE, Status.FAULT_STALE} <= seen
    assert name == "slack" or {Status.REDUCED_ACTIVE, Status.REDUCED_REPULSION} <= seen
