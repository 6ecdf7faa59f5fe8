"""The sensor skin in the YAML file: cuffs, rings of modules, and what each module senses."""

import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Discriminator, Field, Tag

from proxgen.config.additions import Memory, SelfMeasurement
from proxgen.config.quantities import Angle, Count, Frequency, Length, Number, Time
from proxgen.config.section import Direction, Finding, Name, Section, Vector3, unique_names, zero_vector

HALF_TURN = math.pi
QUARTER_TURN = math.pi / 2
Tilt = Annotated[float, Angle(ge=-QUARTER_TURN, le=QUARTER_TURN)]


def scalar_or_list(value: object) -> str:
    """Which form of a value was written where one number or a list is allowed."""
    return "list" if isinstance(value, list | tuple) else "scalar"


class TimeOfFlight(Section):
    """A time-of-flight range sensor: far and narrow."""

    range: Annotated[float, Length(gt=0.0, le=10.0)] = Field(
        1.0, description="the greatest distance that is measured"
    )
    cone: Annotated[float, Angle(ge=0.0, lt=QUARTER_TURN)] = Field(
        math.radians(20.0), description="full opening angle; the nearest thing inside is what is measured"
    )
    rate: Annotated[float, Frequency(gt=0.0, le=1e5)] = Field(100.0, description="new readings per second")
    latency: Annotated[float, Time(ge=0.0, le=1.0)] = Field(0.0, description="age of a new reading")
    noise: Annotated[float, Length(ge=0.0, le=0.5)] = Field(
        0.0, description="standard deviation of a reading (simulation)"
    )
    dropout: Annotated[float, Number(ge=0.0, lt=1.0)] = Field(
        0.0, description="probability that a reading is lost (simulation)"
    )


class Capacitive(Section):
    """A capacitive proximity switch: near, wide and binary; it stands for a virtual obstacle point."""

    trigger: Annotated[float, Length(gt=0.0, le=1.0)] = Field(
        0.10, description="distance below which the switch closes"
    )
    cone: Annotated[float, Angle(gt=0.0, lt=HALF_TURN)] = Field(
        math.radians(150.0), description="full opening angle"
    )
    virtual_distance: Annotated[float, Length(ge=0.0, le=1.0)] = Field(
        0.08, description="where along the normal the virtual obstacle point lies; at most `trigger`"
    )
    rate: Annotated[float, Frequency(gt=0.0, le=1e6)] = Field(1000.0, description="new samples per second")
    latency: Annotated[float, Time(ge=0.0, le=1.0)] = Field(0.0, description="age of a new sample")
    dropout: Annotated[float, Number(ge=0.0, lt=1.0)] = Field(
        0.0, description="probability that a sample is lost (simulation)"
    )

    def contradictions(self) -> Iterator[Finding]:
        """A virtual point beyond the trigger would place the obstacle further away than it is."""
        if self.virtual_distance > self.trigger:
            yield Finding(
                ("virtual_distance", "trigger"),
                f"virtual_distance = {self.virtual_distance:.6g} m must be at most "
                f"trigger = {self.trigger:.6g} m (a closed switch stands for a point no further "
                "than what closed it)",
            )


class Ring(Section):
    """Sensor modules, evenly spread on a circle around the cuff's axis."""

    offset: Annotated[float, Length()] = Field(
        description="distance of the ring's centre from the cuff's origin, along its axis"
    )
    radius: Annotated[float, Length(ge=0.0, le=1.0)] = Field(
        description="distance of the modules from the axis"
    )
    modules: Annotated[int, Count(ge=1, le=512)] = Field(description="number of modules")
    tilt: Annotated[
        Annotated[Tilt, Tag("scalar")] | Annotated[tuple[Tilt, ...], Field(min_length=1), Tag("list")],
        Discriminator(scalar_or_list),
    ] = Field(
        0.0,
        description="angle of the normals out of the ring's plane towards the axis; "
        "a list alternates over the modules",
    )
    stagger: Annotated[float, Number(ge=0.0, lt=1.0)] = Field(
        0.0, description="turns the ring by this fraction of a module's spacing"
    )

    def contradictions(self) -> Iterator[Finding]:
        """A list of tilts that is longer than the ring has modules."""
        if isinstance(self.tilt, tuple) and len(self.tilt) > self.modules:
            message = f"{len(self.tilt)} tilts for {self.modules} modules; give at most one per module"
            yield Finding(("tilt", "modules"), message)


class Cuff(Section):
    """A cuff of proximity sensors around a link."""

    name: Name = Field(description="for messages and plots; must differ from the other cuffs' names")
    frame: str = Field(description="URDF frame that carries the cuff")
    origin: Vector3 = Field((0.0, 0.0, 0.0), description="a point on the cuff's axis, in the frame")
    axis: Direction = Field((0.0, 0.0, 1.0), description="the cuff's axis, in the frame")
    rings: tuple[Ring, ...] = Field(min_length=1, description="rings of modules along the axis")
    tof: TimeOfFlight | None = Field(None, description="in place of skin.tof for this cuff")
    capacitive: Capacitive | None = Field(None, description="in place of skin.capacitive for this cuff")

    def contradictions(self) -> Iterator[Finding]:
        """An axis without direction."""
        yield from zero_vector("axis", self.axis)


class Skin(Section):
    """The proximity sensors: cuffs of modules, each with a range sensor and a switch."""

    tof: TimeOfFlight | None = Field(TimeOfFlight(), description="of every module; null: no range sensors")
    capacitive: Capacitive | None = Field(Capacitive(), description="of every module; null: no switches")
    cuffs: Annotated[tuple[Cuff, ...], AfterValidator(unique_names)] = Field(
        (), description="the cuffs; none: all obstacle points come from outside"
    )
    timeout: Annotated[float, Time(ge=1e-6, le=10.0)] = Field(
        0.1, description="a reading older than this is a fault"
    )
    max_points: Annotated[int, Count(ge=0, le=4096)] = Field(
        64, description="capacity for obstacle points from other sources, per cycle"
    )
    self_measurement: SelfMeasurement = SelfMeasurement()
    memory: Memory = Memory()

    def contradictions(self) -> Iterator[Finding]:
        """Sensors too slow for the timeout; cuffs that sense nothing; additions that have no readings."""
        places: list[tuple[str, TimeOfFlight | Capacitive | None]] = [
            ("tof", self.tof),
            ("capacitive", self.capacitive),
        ]
        for index, cuff in enumerate(self.cuffs):
            places += [(f"cuffs.{index}.tof", cuff.tof), (f"cuffs.{index}.capacitive", cuff.capacitive)]
            if not any((cuff.tof, cuff.capacitive, self.tof, self.capacitive)):
                message = (
                    f"cuff '{cuff.name}' senses nothing: neither it nor the skin has a 'tof' or 'capacitive'"
                )
                yield Finding((f"cuffs.{index}", "tof", "capacitive"), message)
        for key, sensor in places:
            if sensor is not None and (age := 1.0 / sensor.rate + sensor.latency) > self.timeout:
                message = (
                    f"readings get as old as {age:.6g} s (1/rate + latency), more than timeout = "
                    f"{self.timeout:.6g} s: every cycle would be a fault"
                )
                yield Finding((f"{key}.rate", f"{key}.latency", "timeout"), message)
        yield from self._idle_additions()

    def _idle_additions(self) -> Iterator[Finding]:
        """Additions that are switched on where no sensor gives them anything."""
        if self.memory.enabled and not (self.cuffs and (self.tof or any(cuff.tof for cuff in self.cuffs))):
            message = (
                "there is no range sensor whose points it could keep; switch it off, or describe the cuffs"
            )
            yield Finding(("memory.enabled",), f"{message} and their 'tof'")
        if self.self_measurement.enabled and not self.cuffs:
            message = (
                "there is no sensor whose readings it could discard; switch it off, or describe the cuffs"
            )
            yield Finding(("self_measurement.enabled",), message)
