"""All kernels, tables and parameters of one robot, put together into a Program."""

from importlib.metadata import version

from proxgen import __version__
from proxgen.config.hashing import config_hash
from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.model.robot_model import Array, SensorModule
from proxgen.program import CapsuleEntry, Program, SelfPointEntry, SensorEntry
from proxgen.symbolic import kernels
from proxgen.symbolic.additions import memory, self_measurement
from proxgen.symbolic.parameters import parameters
from proxgen.symbolic.self_collision import self_kernels


def build_program(config: Config, model: RobotModel) -> Program:
    """What is to be generated for a robot.

    Args:
        config: its configuration.
        model: the arm built from it.

    Returns:
        Kernels in the order of the cycle, tables and parameters; plain data.

    Raises:
        GenerateError: CasADi refuses an expression.
    """
    bodies = carrying_bodies(model)
    settable = parameters(config, model)
    by_name = {parameter.name: parameter for parameter in settable}
    capsule_bodies = {bodies.index(capsule.body) for capsule in model.capsules}
    return Program(
        robot=model.name,
        config_hash=config_hash(config),
        joints=model.n,
        task_rows=model.m,
        bodies=len(bodies),
        joint_names=model.joint_names,
        task_row_names=model.task_rows,
        body_names=tuple(str(model.pin_model.names[body]) for body in bodies),
        kernels=(
            kernels.kinematics_kernel(model, bodies),
            kernels.sensor_point_kernel(),
            kernels.closest_point_kernel(),
            *[kernels.row_kernel(model, index, bodies[index]) for index in sorted(capsule_bodies)],
            kernels.approach_kernel(config, by_name),
            kernels.slack_kernel(by_name),
            kernels.objective_kernel(model, by_name),
            kernels.bounds_kernel(model, by_name),
            *self_kernels(config, model, bodies, by_name),
        ),
        parameters=settable,
        capsules=_capsule_table(model, bodies),
        tof=_sensor_table(model.tof_modules, bodies, virtual=False),
        capacitive=_sensor_table(model.capacitive_modules, bodies, virtual=True),
        max_points=config.skin.max_points,
        relaxation=config.relaxation.mode,
        active_row=config.avoidance.active.enabled and config.avoidance.method == "proposed",
        schedule=config.avoidance.schedule,
        max_iterations=config.solver.max_iterations,
        tolerance=config.solver.tolerance,
        sources={"proxgen": __version__, "casadi": version("casadi")},
        method=config.avoidance.method,
        self_points=_self_point_table(model, bodies),
        self_measurement=self_measurement(config, model),
        memory=memory(config, model),
        circulation=config.avoidance.circulation.enabled,
        config_file=config.source.name,
    )


def carrying_bodies(model: RobotModel) -> list[int]:
    """Pinocchio joints that carry a capsule, a sensor or a self point, in order: rows of `body_to_world`."""
    capsules, modules, points = model.capsules, model.modules, model.self_points
    return sorted({c.body for c in capsules} | {m.body for m in modules} | {p.body for p in points})


def _self_point_table(model: RobotModel, bodies: list[int]) -> tuple[SelfPointEntry, ...]:
    """The points of self-collision with their pairs."""
    return tuple(
        SelfPointEntry(
            point.name, bodies.index(point.body), _triple(point.position), point.radius, point.capsules
        )
        for point in model.self_points
    )


def _triple(vector: Array) -> tuple[float, float, float]:
    """A vector as numbers; -0 becomes 0 so that generated text does not depend on it."""
    x, y, z = (float(value) + 0.0 for value in vector)
    return x, y, z


def _capsule_table(model: RobotModel, bodies: list[int]) -> tuple[CapsuleEntry, ...]:
    """The capsules, one row slot each."""
    return tuple(
        CapsuleEntry(
            name=capsule.name,
            body=bodies.index(capsule.body),
            start=_triple(capsule.start),
            end=_triple(capsule.end),
            radius=capsule.radius,
            reference_radius=capsule.reference_radius,
        )
        for capsule in model.capsules
    )


def _sensor_table(
    modules: tuple[SensorModule, ...], bodies: list[int], virtual: bool
) -> tuple[SensorEntry, ...]:
    """The range sensors with their range, or the switches with their virtual distance."""
    entries = []
    for module in modules:
        distance = module.capacitive.virtual_distance if virtual and module.capacitive else 0.0
        distance = module.tof.range if not virtual and module.tof else distance
        entries.append(
            SensorEntry(
                module.name,
                bodies.index(module.body),
                _triple(module.position),
                _triple(module.normal),
                distance,
            )
        )
    return tuple(entries)
