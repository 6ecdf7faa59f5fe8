"""What a measurement was made on, and with."""

import os
import platform
from importlib import metadata
from pathlib import Path

from proxgen.builder.toolchain import find_toolchain, run
from proxgen.model import RobotModel


def describe_machine(model: RobotModel) -> dict[str, str]:
    """Processor, system, load, versions, and the robot.

    Args:
        model: of the robot that is measured.
    """
    compiler = find_toolchain(cxx=False).cc
    return {
        "processor": f"{_processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.release()}",
        # What else ran shows in every figure but the least ones.
        "load": f"{os.getloadavg()[0]:.1f} processes were running or waiting in the minute before the end",
        "python": platform.python_version(),
        "compiler": run([*compiler, "--version"], f"cannot run {compiler[0]}").splitlines()[0],
        "robot": f"{model.name}: {model.n} joints, {len(model.capsules)} capsules, "
        f"{len(model.tof_modules)} range sensors, {len(model.capacitive_modules)} switches",
        **{name: metadata.version(name) for name in ("proxgen", "casadi", "cmeel-qpoases")},
    }


def _processor() -> str:
    """Its name as Linux has it."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor())
