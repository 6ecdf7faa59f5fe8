"""Additions to the method in the YAML file, each off unless it is switched on (docs/method.md, Additions)."""

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field

from proxgen.config.quantities import Count, Length, Number, Speed, Time
from proxgen.config.section import (
    Finding,
    Flag,
    Name,
    Section,
    Vector3,
    must_be_less,
    unique_names,
)
from proxgen.errors import unknown_name

Bias = tuple[
    Annotated[float, Number(ge=-10.0, le=10.0)],
    Annotated[float, Number(ge=-10.0, le=10.0)],
    Annotated[float, Number(ge=-10.0, le=10.0)],
]


class SelfMeasurement(Section):
    """Self-measurement removal: what a sensor reads of the arm itself gives no obstacle point."""

    enabled: Flag = Field(False, description="whether readings that the arm explains are discarded")
    margin: Annotated[float, Length(ge=0.0, le=1.0)] = Field(
        0.03, description="capsules of other bodies explain readings up to this distance from their surface"
    )


class Memory(Section):
    """Memory of seen points: what a range sensor saw stays an obstacle after it has left the cone."""

    enabled: Flag = Field(False, description="whether there is a memory")
    capacity: Annotated[int, Count(ge=1, le=1024)] = Field(32, description="number of points that it holds")
    age: Annotated[float, Time(ge=1e-3, le=1e4)] = Field(
        10.0, description="a point that is older is forgotten"
    )
    merge: Annotated[float, Length(ge=0.0, le=1.0)] = Field(
        0.04, description="a new point takes the place of the nearest one that is no further away"
    )
    margin: Annotated[float, Length(ge=0.0, le=1.0)] = Field(
        0.10, description="a point nearer than the reading by more than this is seen through, and forgotten"
    )
    reach: Annotated[float, Length(ge=1e-3, le=10.0)] = Field(
        0.5, description="only points that are as near to some capsule's axis are stored"
    )
    cone: Annotated[float, Number(ge=0.0, le=1.0)] = Field(
        0.5, description="part of a sensor's opening angle in which it is believed to see through"
    )


class Circulation(Section):
    """Circulation: where an obstacle blocks the way for good, the tool is sent along it."""

    enabled: Flag = Field(False, description="whether the task velocity is changed where the tool is stuck")
    speed: Annotated[float, Speed(ge=1e-3, le=10.0)] = Field(0.2, description="speed along the obstacle")
    stall_time: Annotated[float, Time(ge=0.0, le=100.0)] = Field(
        0.5, description="blocked for so long, the tool counts as stuck"
    )
    stall_fraction: Annotated[float, Number(ge=0.0, le=1.0)] = Field(
        0.2, description="progress below this part of what is wanted counts as blocked"
    )
    release_time: Annotated[float, Time(ge=0.0, le=100.0)] = Field(
        0.2, description="clear for so long, the way counts as free again"
    )
    patience: Annotated[float, Time(ge=0.0, le=100.0)] = Field(
        1.0, description="without progress along the obstacle for so long, another way round is tried"
    )
    time_limit: Annotated[float, Time(ge=0.1, le=1e4)] = Field(
        12.0, description="the task is tried again after at most this time"
    )
    blend_time: Annotated[float, Time(ge=1e-3, le=10.0)] = Field(
        0.1, description="the task velocity changes over to circulation and back in this time"
    )
    bias: Bias = Field(
        (0.0, 0.0, 0.5), description="preferred way round, world frame; its length is its weight against 1"
    )


class Tangential(Section):
    """The tangential method, for comparison."""

    speed: Annotated[float, Speed(ge=1e-6, le=10.0)] = Field(
        0.1, description="least speed of the nearest point along the tangent (method: tangential)"
    )


class SelfPoint(Section):
    """A point, or a ball, that the arm carries and that its other links must not touch."""

    name: Name = Field(description="for messages and `exclude`; must differ from the other points' names")
    frame: str = Field(description="URDF frame that carries it")
    position: Vector3 = Field((0.0, 0.0, 0.0), description="in that frame")
    radius: Annotated[float, Length(ge=0.0, le=10.0)] = Field(0.0, description="of the ball; 0: a point")


class Exclusion(Section):
    """A pair that may come close, such as neighbours that share a joint."""

    capsule: str = Field(description="name of a capsule")
    point: str = Field(description="name of a self-collision point")


class SelfCollision(Section):
    """Self-collision: points that the arm carries are obstacles for its other links."""

    points: Annotated[tuple[SelfPoint, ...], AfterValidator(unique_names)] = Field(
        (), description="the points; none: no self-collision rows"
    )
    exclude: tuple[Exclusion, ...] = Field(
        (), description="pairs without a row, besides those that move with the same body"
    )
    d_a: Annotated[float, Length(ge=1e-6, le=5.0)] = Field(
        0.10, description="pairs beyond give no row; distances are those of the surfaces"
    )
    d_0u: Annotated[float, Length(ge=0.0, le=5.0)] = Field(0.07, description="upper end of the dead zone")
    d_0l: Annotated[float, Length(ge=0.0, le=5.0)] = Field(0.05, description="lower end of the dead zone")
    d_r: Annotated[float, Length(ge=0.0, le=5.0)] = Field(0.03, description="full repulsion at and below")

    def contradictions(self) -> Iterator[Finding]:
        """Thresholds out of order; exclusions of points that do not exist."""
        names = [point.name for point in self.points]
        for index, pair in enumerate(self.exclude):
            if pair.point not in names:
                message = unknown_name("self-collision point", pair.point, names)
                yield Finding((f"exclude.{index}.point",), message)
        yield from ordered_thresholds(self.d_a, self.d_0u, self.d_0l, self.d_r)


def ordered_thresholds(d_a: float, d_0u: float, d_0l: float, d_r: float) -> Iterator[Finding]:
    """Findings for thresholds of the law (13) that are out of order."""
    order = "order: d_a > d_0u >= d_0l > d_r"
    yield from must_be_less(("d_0u", "d_a"), (d_0u, d_a), "m", order)
    if d_0l > d_0u:
        message = f"d_0l = {d_0l:.6g} m must be at most d_0u = {d_0u:.6g} m ({order})"
        yield Finding(("d_0l", "d_0u"), message)
    yield from must_be_less(("d_r", "d_0l"), (d_r, d_0l), "m", order)
