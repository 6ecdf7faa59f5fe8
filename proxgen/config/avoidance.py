"""Collision avoidance in the YAML file: thresholds and laws, damping, what happens to conflicting rows."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from proxgen.config.additions import Circulation, SelfCollision, Tangential, ordered_thresholds
from proxgen.config.quantities import AngularSpeed, Length, Number, Rate, Speed
from proxgen.config.section import Finding, Flag, Section, must_be_less


class Damper(Section):
    """The damper schedule: one line through the safety distance, in place of the law (13)."""

    influence_distance: Annotated[float, Length(ge=1e-6, le=5.0)] = Field(
        0.32, description="d_i: rows begin here"
    )
    safety_distance: Annotated[float, Length(ge=0.0, le=5.0)] = Field(
        0.22, description="d_s: no approach below"
    )
    gain: Annotated[float, Rate(ge=1e-6, le=100.0)] = Field(
        6.0, description="repulsive speed per distance below d_s"
    )
    repulse_speed: Annotated[float, Speed(ge=-5.0, le=0.0)] = Field(
        -0.4, description="v_r: bound of the repulsive speed, not positive"
    )

    def contradictions(self) -> Iterator[Finding]:
        """Distances out of order."""
        yield from must_be_less(
            ("safety_distance", "influence_distance"),
            (self.safety_distance, self.influence_distance),
            "m",
            "the damper acts between them",
        )


class Active(Section):
    """Active avoidance (6)(7): the weighted sum of distances must not fall."""

    enabled: Flag = Field(True, description="whether the row (7) exists")
    distance: Annotated[float, Length(ge=1e-6, le=5.0)] = Field(
        0.30, description="d_active: links nearer than this take part (6)"
    )


class Avoidance(Section):
    """From distances to rows: thresholds (17), law (13), active row (7)."""

    method: Literal["proposed", "repulsive", "tangential"] = Field(
        "proposed", description="the paper's method, or one of the two that it is compared with"
    )
    distance_reference: Literal["axis", "surface"] = Field(
        "axis", description="distances are measured to the capsule's axis, or to its surface"
    )
    schedule: Literal["paper", "damper"] = Field("paper", description="law (13), or the damper schedule")
    d_a: Annotated[float, Length(ge=1e-6, le=5.0)] = Field(
        0.30, description="obstacles beyond give no row (17)"
    )
    d_0u: Annotated[float, Length(ge=0.0, le=5.0)] = Field(
        0.25, description="upper end of the dead zone (17)"
    )
    d_0l: Annotated[float, Length(ge=0.0, le=5.0)] = Field(
        0.22, description="lower end of the dead zone (17)"
    )
    d_r: Annotated[float, Length(ge=0.0, le=5.0)] = Field(
        0.17, description="full repulsion at and below this distance (17)"
    )
    approach_speed: Annotated[float, Speed(ge=1e-6, le=5.0)] = Field(
        0.2, description="greatest approach speed, at d_a (16)"
    )
    repulse_speed: Annotated[float, Speed(ge=-5.0, le=0.0)] = Field(
        -0.2, description="approach speed at d_r, not positive (16)"
    )
    row_speed: Annotated[float, AngularSpeed(ge=1e-6, le=100.0)] = Field(
        1.0, description="a row never demands more joint speed than this: b >= -row_speed |A|"
    )
    active: Active = Active()
    damper: Damper = Damper()
    tangential: Tangential = Tangential()
    circulation: Circulation = Circulation()
    self_collision: SelfCollision = SelfCollision()

    def contradictions(self) -> Iterator[Finding]:
        """Thresholds out of order; additions to the proposed method beside another one."""
        yield from ordered_thresholds(self.d_a, self.d_0u, self.d_0l, self.d_r)
        for key, given in (
            ("circulation.enabled", self.circulation.enabled),
            ("self_collision.points", bool(self.self_collision.points)),
        ):
            if given and self.method != "proposed":
                name = key.partition(".")[0]
                yield Finding((key, "method"), f"{name} needs method: proposed, not {self.method}")


class Damping(Section):
    """Damping near singular configurations (14)(15)."""

    gain: Annotated[float, Number(ge=0.0, le=100.0)] = Field(0.1, description="g_lambda (15)")
    threshold: Annotated[float, Number(ge=0.0, le=100.0)] = Field(
        0.001, description="w_0: manipulability below which it acts (15)"
    )
    floor: Annotated[float, Number(ge=1e-6, le=1.0)] = Field(
        1e-3, description="lambda_min: keeps H positive definite"
    )


class Slack(Section):
    """Weights of the soft rows (relaxation: slack)."""

    weight: Annotated[float, Number(ge=1e-3, le=1e6)] = Field(
        100.0, description="rho of a row, multiplied by the square of the clipped ramp (d_a - d)/(d_a - d_r)"
    )
    minimum: Annotated[float, Number(ge=1e-3, le=10.0)] = Field(0.1, description="lower clip of the ramp")
    maximum: Annotated[float, Number(ge=1e-3, le=10.0)] = Field(2.0, description="upper clip of the ramp")
    active_weight: Annotated[float, Number(ge=1e-3, le=1e6)] = Field(
        10.0, description="rho of the active row (7)"
    )

    def contradictions(self) -> Iterator[Finding]:
        """Clips out of order."""
        yield from must_be_less(
            ("minimum", "maximum"), (self.minimum, self.maximum), "", "the ramp lies between them"
        )


class Relaxation(Section):
    """What happens when not all rows can be met (section IV.C)."""

    mode: Literal["staged", "slack"] = Field(
        "staged", description="staged: drop rows step by step; slack: soften all rows, weighted by distance"
    )
    slack: Slack = Slack()
