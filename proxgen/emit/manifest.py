"""manifest.json: what was generated, for programs: dimensions, names, parameters, tables, versions."""

import json
from dataclasses import asdict
from typing import Any

from proxgen.emit.signatures import Function
from proxgen.program import Argument, Program

MANIFEST = "manifest.json"

WIDTH = 240
"""Greatest number of columns of a line; a sensor, a capsule and most parameters fit into one."""


def render_manifest(program: Program, functions: tuple[Function, ...], mark: str, abi: int) -> str:
    """The manifest's text; keys in a fixed order, numbers in full precision."""
    content = {
        "generated_by": mark,
        "robot": program.robot,
        "abi": abi,
        "config_hash": program.config_hash,
        "sources": dict(program.sources),
        "dimensions": dimensions(program),
        "joint_names": program.joint_names,
        "task_row_names": program.task_row_names,
        "body_names": program.body_names,
        "relaxation": program.relaxation,
        "schedule": program.schedule,
        "active_row": program.active_row,
        "max_iterations": program.max_iterations,
        "tolerance": program.tolerance,
        "parameters": [asdict(parameter) for parameter in program.parameters],
        "capsules": [asdict(entry) for entry in program.capsules],
        "tof": [asdict(entry) for entry in program.tof],
        "capacitive": [asdict(entry) for entry in program.capacitive],
        **_additions(program),
        "functions": [_function(program, function) for function in functions],
    }
    return _laid_out(content) + "\n"


def dimensions(program: Program) -> dict[str, int]:
    """All sizes by name; in upper case they are the macros of `model.h`."""
    return {
        "joints": program.joints,
        "task_rows": program.task_rows,
        "bodies": program.bodies,
        "capsules": len(program.capsules),
        "tof": len(program.tof),
        "capacitive": len(program.capacitive),
        "max_points": program.max_points,
        "rows": len(program.row_names),
        **({"self_points": len(program.self_points)} if program.self_points else {}),
        **({"memory_capacity": program.memory.capacity} if program.memory else {}),
    }


def _additions(program: Program) -> dict[str, Any]:
    """What is there only with additions: their names, what the rows stand for, and their tables."""
    if not program.additions:
        return {}
    entries: dict[str, Any] = {"additions": program.additions, "row_names": program.row_names}
    if program.self_points:
        entries["self_points"] = [asdict(entry) for entry in program.self_points]
    if program.self_measurement:
        entries["self_measurement"] = asdict(program.self_measurement)
    if program.memory:
        entries["memory"] = asdict(program.memory)
    return entries


def _laid_out(value: Any, indent: str = "", start: str = "") -> str:
    """JSON after `start`, on one line where that is short enough for an editor, else a line for each part."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    if len(indent) + len(start) + len(text) <= WIDTH or not isinstance(value, dict | list | tuple):
        return start + text
    inner = indent + "  "
    if isinstance(value, dict):
        parts = [_laid_out(part, inner, f"{json.dumps(key)}: ") for key, part in value.items()]
    else:
        parts = [_laid_out(part, inner) for part in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{start}{opening}\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}{closing}"


def _function(program: Program, function: Function) -> dict[str, Any]:
    """A function for the manifest."""
    return {
        "name": f"{program.robot}_{function.name}",
        "summary": function.summary,
        "equation": function.equation,
        "inputs": [_argument(argument) for argument in function.inputs],
        "outputs": [_argument(argument) for argument in function.outputs],
        "parameters": function.parameters,
        "operations": function.operations,
    }


def _argument(argument: Argument) -> dict[str, Any]:
    """An argument for the manifest."""
    entry = asdict(argument)
    del entry["parameter"]
    return entry
