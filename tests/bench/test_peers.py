"""Peers side by side: what needs nothing installed. Their own programs run in `proxgen bench --peers`."""

import ast
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from proxgen.bench.inputs import Inputs, record
from proxgen.bench.peers import measure, run_peer
from proxgen.bench.peers.environment import make_environment
from proxgen.bench.peers.kinematics import _input
from proxgen.bench.peers.measure import PeerBenchmark, relate, run_peers
from proxgen.bench.peers.problem import describe_arm, pose_problem
from proxgen.bench.peers.roster import CONTROLLERS, KINEMATICS, REFERENCE
from proxgen.bench.plot import draw
from proxgen.cli import main
from proxgen.config import load
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import BuildError, GenerateError
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import tool_pose

ROOT = Path(__file__).resolve().parents[2]
PEERS = ROOT / "proxgen" / "bench" / "peers"

ECHO = """
import numpy as np

def open_solver(arm):
    def solve(q, xdot, points, target):
        if np.isnan(points).all():
            raise ValueError("nothing near")
        return q * arm["period"]
    return solve
"""


@pytest.fixture(scope="module")
def inputs(iiwa7_config: Config, iiwa7_model: RobotModel) -> Inputs:
    """Some cycles in the gap, with obstacles near."""
    controller = ReferenceController(iiwa7_config, iiwa7_model)
    return record(iiwa7_config, iiwa7_model, controller, load_scene("gap"), 1.2)


def test_ratios_are_those_of_the_same_cycles() -> None:
    ours, theirs = np.array([1e-6, 2e-6, 4e-6]), np.array([100e-6, 400e-6, 400e-6])
    row = relate("peer", "gap", theirs, {"daqp": ours}, cycles_without_answer=1)
    against = row["against"]["daqp"]
    assert row["p50_us"] == pytest.approx(400.0)
    assert against["p50_us"] == pytest.approx(2.0)
    assert against["ratio_of_p50"] == pytest.approx(200.0)
    assert against["ratio_of_cycles"] == pytest.approx([100.0, 100.0, 150.0])
    assert (row["name"], row["backend"], row["cycles_without_answer"]) == ("gap: cycle, raw", "peer", 1)


def test_problem_holds_what_the_reference_saw(
    iiwa7_config: Config, iiwa7_model: RobotModel, inputs: Inputs
) -> None:
    problem = pose_problem(iiwa7_config, iiwa7_model, inputs)
    assert problem.points.shape == (inputs.cycles, 3, 3)
    assert problem.reference_qdot.shape == (inputs.cycles, 7)
    assert np.isfinite(problem.points).any()
    assert np.all(problem.reference_times > 0.0)
    step = problem.target[3] - tool_pose(iiwa7_model, inputs.q[3])[:3, 3]
    assert step == pytest.approx(inputs.xdot[3] / iiwa7_config.control.rate, abs=1e-12)


def test_described_arm_is_the_same_arm(iiwa7_config: Config, iiwa7_model: RobotModel, inputs: Inputs) -> None:
    """Its joints, multiplied out by Rodrigues' formula, lead to the tool."""
    arm = json.loads(json.dumps(describe_arm(iiwa7_config, iiwa7_model)))
    for q in inputs.q[::20]:
        pose = np.eye(4)
        for joint, angle in zip(arm["joints"], q, strict=True):
            x, y, z = joint["axis"]
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turn = np.eye(4)
            turn[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            pose = pose @ np.array(joint["placement"]) @ turn
        assert pose @ arm["tool"]["placement"] == pytest.approx(tool_pose(iiwa7_model, q), abs=1e-12)
    numbers = _input(arm, inputs.q)
    assert len(numbers) == 1 + 7 * 16 + 1 + 12 + inputs.q.size
    assert numbers[0] == inputs.cycles


def test_a_pose_task_is_refused(tmp_path: Path) -> None:
    text = (ROOT / "examples" / "iiwa7" / "iiwa7.yaml").read_text()
    (tmp_path / "iiwa7.yaml").write_text(text.replace("kind: position", "kind: pose"))
    (tmp_path / "iiwa7.urdf").write_bytes((ROOT / "examples" / "iiwa7" / "iiwa7.urdf").read_bytes())
    config = load(tmp_path / "iiwa7.yaml")
    with pytest.raises(GenerateError, match="position task"):
        describe_arm(config, build_model(config))


def test_peer_program_times_every_cycle(
    iiwa7_config: Config,
    iiwa7_model: RobotModel,
    inputs: Inputs,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a peer made for this test: answers are kept, and cycles without one are nan."""
    (tmp_path / "with_echo.py").write_text(ECHO)
    monkeypatch.syspath_prepend(tmp_path)
    problem = pose_problem(iiwa7_config, iiwa7_model, inputs)
    problem.save(tmp_path / "problem.npz", describe_arm(iiwa7_config, iiwa7_model))
    run_peer.main("with_echo", tmp_path / "problem.npz", tmp_path / "result.npz")
    result = np.load(tmp_path / "result.npz")
    unseen = np.isnan(problem.points).all(axis=(1, 2))
    assert 0 < unseen.sum() < inputs.cycles
    assert np.array_equal(np.isnan(result["qdot"][:, 0]), unseen)
    assert result["qdot"][~unseen] == pytest.approx(inputs.q[~unseen] * 0.02)
    assert result["times"].shape == (inputs.cycles,)
    assert "numpy" in json.loads(str(result["versions"]))


def test_all_requirements_are_exact_and_their_versions_are_shown() -> None:
    for peer in (*CONTROLLERS, KINEMATICS):
        assert all(requirement.count("==") == 1 for requirement in peer.requirements)
        assert {requirement.partition("==")[0] for requirement in peer.requirements} >= set(peer.shown)
    for peer in (REFERENCE, *CONTROLLERS, KINEMATICS):
        assert peer.not_alike


@pytest.mark.parametrize("name", ["run_peer", *(peer.module for peer in CONTROLLERS)])
def test_programs_for_other_environments_do_not_need_proxgen(name: str) -> None:
    tree = ast.parse((PEERS / f"{name}.py").read_text())
    modules = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    assert modules
    assert not [module for module in modules if module.startswith("proxgen")]


def test_environment_is_made_once(tmp_path: Path) -> None:
    """One without packages needs no network; its marker is what says that it is complete."""
    (tmp_path / "peer").mkdir()
    (tmp_path / "peer" / "requirements.txt").write_text(f"# {sys.version.split()[0]}\na==1\n")
    python = make_environment(tmp_path / "peer", ["a==1"])
    assert python == tmp_path / "peer" / "bin" / "python"


def refuse(directory: Path, requirements: object) -> Path:
    """An installation that fails."""
    raise BuildError("cannot install", ["pip"], "no matching distribution")


def test_peers_that_cannot_be_installed_are_named(
    iiwa7_config: Config,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The reference, which needs none, is measured all the same; the command says who is missing."""
    monkeypatch.setattr(measure, "make_environment", refuse)
    steps: list[tuple[int, int]] = []
    benchmark = run_peers(
        iiwa7_config,
        [load_scene("gap")],
        tmp_path,
        duration=0.5,
        progress=lambda done, total: steps.append((done, total)),
    )
    assert set(benchmark.failures) == {peer.title for peer in (*CONTROLLERS, KINEMATICS)}
    assert all("no matching distribution" in reason for reason in benchmark.failures.values())
    (row,) = benchmark.results
    assert row["backend"] == REFERENCE.title
    assert set(row["against"]) == {"daqp", "qpoases"}
    assert steps[-1] == (len(CONTROLLERS) + 2, len(CONTROLLERS) + 2)
    assert draw(benchmark, tmp_path / "peers.png").read_bytes().startswith(b"\x89PNG")
    check_command(benchmark, tmp_path, monkeypatch, capsys)


def check_command(
    benchmark: PeerBenchmark,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What `proxgen bench --peers` prints and writes of a benchmark."""
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr("proxgen.bench.peers.run_peers", lambda *_, **__: benchmark)
    target = folder / "peers.json"
    assert main(["bench", "--peers", "--scene", "gap", "--json", str(target)]) == 0
    printed = capsys.readouterr().out
    assert f"NOT MEASURED: {CONTROLLERS[0].title}" in printed
    assert REFERENCE.not_alike[0] in printed
    assert json.loads(target.read_text())["results"][0]["backend"] == REFERENCE.title
