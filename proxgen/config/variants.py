"""Variants of a configuration that was loaded: some values replaced, everything checked anew."""

from collections.abc import Mapping
from typing import Any

from proxgen.config.loader import validate
from proxgen.config.schema import Config
from proxgen.errors import ConfigError

PROPOSED_ONLY: dict[str, Any] = {
    "avoidance.circulation.enabled": False,
    "avoidance.self_collision.points": [],
    "avoidance.self_collision.exclude": [],
    "relaxation.mode": "staged",
}
"""What the methods that the paper compares with cannot have."""


def override(config: Config, changes: Mapping[str, Any]) -> Config:
    """A configuration with some values replaced.

    Args:
        config: as loaded; it is not changed.
        changes: new values by dotted path, such as `{"avoidance.d_r": 0.15}`; in SI units, or texts with a
            unit, as in the file.

    Returns:
        The variant; what is not replaced keeps its place in the file for messages.

    Raises:
        ConfigError: values that are refused, alone or together.
    """
    data = config.model_dump(mode="json")
    for path, value in changes.items():
        *sections, key = path.split(".")
        target = data
        for section in sections:
            if target.get(section) is None:
                target[section] = {}
            target = target[section]
        target[key] = value
    variant, problems = validate(data, Config, config.origin)
    if variant is None:
        raise ConfigError(problems)
    variant._origin = config.origin
    return variant


def with_method(config: Config, method: str) -> Config:
    """The configuration with another `avoidance.method`, without what only the proposed one has."""
    if method == config.avoidance.method:
        return config
    changes = {} if method == "proposed" else PROPOSED_ONLY
    return override(config, {"avoidance.method": method} | changes)


def variant_name(config: Config) -> str:
    """Robot and method, as the name of a build folder: switching methods compiles nothing."""
    method = config.avoidance.method
    return config.robot.name if method == "proposed" else f"{config.robot.name}-{method}"


def with_noise(config: Config, noise: float | None, dropout: float | None) -> Config:
    """The configuration with sensors that are less good, those of every cuff, in simulation.

    Args:
        config: as loaded.
        noise: standard deviation of every range reading [m]; None: as configured.
        dropout: probability that a sample of a range sensor or a switch is lost; None: as configured.
    """
    data = config.model_dump(mode="json")["skin"]
    worse = {"noise": noise, "dropout": dropout}
    given = {key: value for key, value in worse.items() if value is not None}
    for part in (data, *data["cuffs"]):
        if part["tof"] is not None:
            part["tof"] |= given
        if part["capacitive"] is not None:
            part["capacitive"] |= {key: value for key, value in given.items() if key == "dropout"}
    return override(config, {"skin": data})
