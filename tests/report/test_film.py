"""Films and pictures of runs: the right moments, things that move, marks where they belong."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from made_up import BALL, BOX, make_arm_log, make_log
from PIL import Image

from proxgen.errors import SimulationError
from proxgen.model import RobotModel
from proxgen.report import style, write_report
from proxgen.report.derive import zones
from proxgen.report.film import RATE, chosen_cycles, write_film
from proxgen.report.overlay import Overlay, meaningful_colours
from proxgen.report.stage import Stage, fitting_camera, zone_of
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.world import Camera, Shot

SIZE = (96, 72)


def pictures_of(film: Path) -> list[np.ndarray]:
    """Every picture of a film as RGB."""
    with Image.open(film) as image:
        found = []
        for number in range(image.n_frames):  # type: ignore[attr-defined]
            image.seek(number)
            found.append(np.asarray(image.convert("RGB")))
    return found


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_a_film_has_its_pictures_and_they_move(tmp_path: Path, planar2_model: RobotModel, kind: str) -> None:
    steps: list[tuple[int, int]] = []
    film = write_film(
        tmp_path / f"film.{kind}", make_arm_log(planar2_model), planar2_model,
        pictures=6, size=SIZE, progress=lambda done, every: steps.append((done, every)),
    )  # fmt: skip
    pictures = pictures_of(film)
    assert steps == [(number, 6) for number in range(1, 7)]
    assert len(pictures) == 6
    assert all(picture.shape == (SIZE[1], SIZE[0], 3) for picture in pictures)
    for one, other in pairwise(pictures):
        assert (np.abs(one.astype(int) - other).max(axis=2) > 30).mean() > 0.01
    with Image.open(film) as image:
        image.load()
        assert image.info["loop"] == 0
        assert image.info["duration"] == 1000 // RATE
    assert [path.name for path in tmp_path.iterdir()] == [film.name]


def test_obstacles_move_with_time(tmp_path: Path, planar2_model: RobotModel) -> None:
    """The arm stands still, so that below the words only the ball and its shadow may change."""
    motion = make_log().meta["obstacles"][1]["motion"] | {"direction": [0, 0, 1]}
    near = BALL | {"position": [0.5, 0.0, 0.2], "motion": motion}
    changed = {}
    for name, ball in (("moving", near), ("resting", near | {"motion": None})):
        log = make_arm_log(planar2_model, obstacles=[ball])
        log = replace(log, q=np.zeros_like(log.q), tool_position=np.zeros_like(log.tool_position))
        film = write_film(tmp_path / f"{name}.gif", log, planar2_model, pictures=3, size=(160, 120))
        pictures = [picture[38:].astype(int) for picture in pictures_of(film)]
        changed[name] = np.mean(np.abs(pictures[0] - pictures[-1]).max(axis=2) > 40)
    assert changed["moving"] > 0.02
    assert changed["resting"] == 0.0


def test_colours_that_mean_something_survive_a_gif(tmp_path: Path, planar2_model: RobotModel) -> None:
    film = write_film(
        tmp_path / "film.gif", make_arm_log(planar2_model), planar2_model, pictures=3, size=SIZE
    )
    with Image.open(film) as image:
        palette = np.array(image.getpalette()).reshape(-1, 3)
    for colour in meaningful_colours():
        wanted = np.array(list(bytes.fromhex(colour[1:])))
        assert np.abs(palette - wanted).max(axis=1).min() <= 12


def test_which_cycles_are_shown() -> None:
    log = make_log(cycles=500)  # 10 s at 50 Hz
    assert len(chosen_cycles(log, 0.0, None, 1000)) == 10 * RATE
    every = chosen_cycles(log, 0.0, None, 20)
    assert (every[0], every[-1], len(every)) == (0, 499, 20)
    part = chosen_cycles(log, 2.0, 4.0, 1000)
    assert (part[0], part[-1], len(part)) == (100, 199, 2 * RATE)
    assert chosen_cycles(make_log(cycles=1), 0.0, None, 5) == [0]
    with pytest.raises(SimulationError, match="no cycle to show from 12 s"):
        chosen_cycles(log, 12.0, None, 5)


def test_other_formats_are_refused(tmp_path: Path, planar2_model: RobotModel) -> None:
    with pytest.raises(SimulationError, match=r"\.gif or \.webp, not 'film.mp4'"):
        write_film(tmp_path / "film.mp4", make_arm_log(planar2_model), planar2_model)
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("coarse")
def test_a_report_shows_the_film(tmp_path: Path) -> None:
    film = tmp_path / "mine.gif"
    Image.new("RGB", (4, 3)).save(film)
    page = write_report(tmp_path / "report", [make_log(cycles=5)], film=film)
    assert (page.parent / "figures" / "run1_film.gif").read_bytes() == film.read_bytes()
    text = page.read_text(encoding="utf-8")
    assert 'src="data:image/gif;base64,' in text
    assert 'href="figures/run1_film.gif"' in text


@pytest.mark.parametrize("reference", ["axis", "surface"])
def test_gaps_are_the_true_distances(planar2_model: RobotModel, reference: str) -> None:
    box = BOX | {"half_size": [0.1, 0.1, 0.1], "position": [0.7, 0.2, 0.36]}
    log = make_arm_log(planar2_model, obstacles=[box], distance_reference=reference)
    arm = ArmGeometry(planar2_model)
    with Stage(log, planar2_model, Camera(width=8, height=6)) as stage:
        found = {cycle: stage.gaps(cycle) for cycle in range(0, log.cycles, 20)}
        field = stage._field
    for cycle, gaps in found.items():
        true = field.near_segments(0.0, *arm.axes(arm.poses(log.q[cycle]))).distance.min(axis=1)
        true = true - (arm.radius if reference == "surface" else 0.0)
        near = sorted(true[true <= 0.3], reverse=True)
        assert [gap.distance for gap in gaps] == pytest.approx(near)
        for gap in gaps:
            assert np.linalg.norm(gap.obstacle - gap.link) == pytest.approx(gap.distance)
            assert gap.zone == zone_of(log, gap.distance)
    assert any(found.values())


def test_modules_light_up_where_they_feel_something(iiwa7_model: RobotModel) -> None:
    log = make_arm_log(iiwa7_model, 2)
    log.tof_range[1, [3, 5]] = 0.29, 0.31  # d_a is 0.30 m
    log.capacitive[1, 7] = True
    with Stage(log, iiwa7_model, Camera(width=8, height=6)) as stage:
        still, felt = stage.modules(0), stage.modules(1)
    assert not still.near.any()
    assert not still.closed.any()
    assert np.flatnonzero(felt.near).tolist() == [3]
    assert np.flatnonzero(felt.closed).tolist() == [7]
    assert felt.position.shape == felt.normal.shape == (len(iiwa7_model.modules), 3)


def test_a_short_sensor_that_sees_nothing_stays_dark(iiwa7_model: RobotModel) -> None:
    modules = [
        replace(module, tof=None if module.tof is None else module.tof.model_copy(update={"range": 0.2}))
        for module in iiwa7_model.modules
    ]
    model = replace(iiwa7_model, modules=tuple(modules))
    log = make_arm_log(model, 2)
    log.tof_range[:] = 0.2
    log.tof_range[1, 4] = 0.19
    with Stage(log, model, Camera(width=8, height=6)) as stage:
        assert [np.flatnonzero(stage.modules(cycle).near).tolist() for cycle in (0, 1)] == [[], [4]]


def test_zones_by_distance() -> None:
    log = make_log()
    assert zone_of(log, 0.31) is None
    assert [zone_of(log, distance) for distance in (0.29, 0.24, 0.2, 0.1, -0.1)] == [
        *zones(log), zones(log)[-1],
    ]  # fmt: skip


def test_the_camera_sees_arm_obstacles_and_targets(planar2_model: RobotModel) -> None:
    log = make_arm_log(planar2_model)
    camera = fitting_camera(log, planar2_model, *SIZE)
    arm = ArmGeometry(planar2_model)
    ends = np.concatenate([np.concatenate(arm.axes(arm.poses(q))) for q in log.q[::20]])
    points = np.concatenate([ends, log.meta["targets"], [obstacle["position"] for obstacle in (BOX, BALL)]])
    places, depth = camera.project(points)
    assert (depth > 0.0).all()
    assert (places > 0.0).all()
    assert (places < SIZE).all()


def flat_shot(depth: float) -> Shot:
    """A grey picture of a wall."""
    camera = Camera(target=(0.0, 0.0, 0.0), distance=1.0, yaw=0.0, pitch=0.0, width=80, height=60)
    grey = np.full((60, 80, 3), 128, dtype=np.uint8)
    return Shot(grey, np.full((60, 80), depth), camera)


def test_what_is_behind_something_is_faint() -> None:
    way = np.array([[-0.3, 0.0, 0.0], [0.3, 0.0, 0.0]])  # passes the middle, 1 m from the camera
    shades = []
    for wall in (2.0, 0.5):
        overlay = Overlay(flat_shot(wall), 1.0)
        overlay.path(way, style.BLUE, width=6.0)
        shades.append(np.asarray(overlay.picture())[30, 40].astype(int))
    blue = np.array(list(bytes.fromhex(style.BLUE[1:])))
    assert np.abs(shades[0] - blue).max() <= 2
    assert 10 < np.abs(shades[1] - 128).max() < 0.5 * np.abs(blue - 128).max()
