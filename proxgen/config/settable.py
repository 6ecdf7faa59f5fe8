"""The run-time parameters of the additions: which a configuration has, and their values (docs/method.md)."""

from proxgen.config.schema import Config


def addition_parameters(config: Config) -> dict[str, float]:
    """Values by name, in the order of the table; a parameter of an addition that is off is not there."""
    return (
        _self_measurement(config)
        | _memory(config)
        | _circulation(config)
        | _self_collision(config)
        | _tangential(config)
    )


def _self_measurement(config: Config) -> dict[str, float]:
    """Of self-measurement removal."""
    removal = config.skin.self_measurement
    return {"self_measurement_margin": removal.margin} if removal.enabled else {}


def _memory(config: Config) -> dict[str, float]:
    """Of the memory of seen points."""
    memory = config.skin.memory
    if not memory.enabled:
        return {}
    return {
        "memory_age": memory.age,
        "memory_merge": memory.merge,
        "memory_margin": memory.margin,
        "memory_reach": memory.reach,
    }


def _circulation(config: Config) -> dict[str, float]:
    """Of circulation."""
    circulation = config.avoidance.circulation
    if not circulation.enabled:
        return {}
    x, y, z = circulation.bias
    return {
        "circulation_speed": circulation.speed,
        "stall_time": circulation.stall_time,
        "stall_fraction": circulation.stall_fraction,
        "circulation_release_time": circulation.release_time,
        "circulation_patience": circulation.patience,
        "circulation_time_limit": circulation.time_limit,
        "circulation_blend_time": circulation.blend_time,
        "circulation_bias_x": x,
        "circulation_bias_y": y,
        "circulation_bias_z": z,
    }


def _self_collision(config: Config) -> dict[str, float]:
    """Of self-collision."""
    own = config.avoidance.self_collision
    if not own.points:
        return {}
    return {"self_d_a": own.d_a, "self_d_0u": own.d_0u, "self_d_0l": own.d_0l, "self_d_r": own.d_r}


def _tangential(config: Config) -> dict[str, float]:
    """Of the tangential method."""
    avoidance = config.avoidance
    return {"tangential_speed": avoidance.tangential.speed} if avoidance.method == "tangential" else {}
