"""Program to the texts of all generated files. Templates hold structure; what they print is made here."""

import re
from typing import Any

from proxgen import __version__
from proxgen.emit import tables
from proxgen.emit.folder import MARK
from proxgen.emit.kernels import render_kernels
from proxgen.emit.layout import tidy
from proxgen.emit.manifest import MANIFEST, dimensions, render_manifest
from proxgen.emit.signatures import Function, functions
from proxgen.emit.text import WIDTH, block_comment, identifier, number, plain, shape_text, string
from proxgen.program import ADDITIONS, Argument, Program, SelfPointEntry
from proxgen.templates import environment

ABI_VERSION = 1
"""What the runtime must be for code generated here: `PG_ABI_VERSION` of `proxgen/types.h`."""

PUBLIC_FUNCTIONS = (
    "create_checked",
    "create_in_checked",
    "destroy",
    "reset",
    "step",
    "get_parameters",
    "set_parameters",
    "diagnostics",
    "counters",
    "version",
    "status_name",
)
"""Functions of `controller.h` without the robot's prefix: all that a library exports."""

_PLAIN_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*")
"""Names of files that mean the same to C, Markdown and a shell, without quotes."""

_C_TEMPLATES = ("model.h", "model.c", "binding.h", "controller.h", "controller.hpp")
_OTHER_TEMPLATES = ("README.md",)


def render(program: Program) -> dict[str, str]:
    """All generated files of a robot, text by file name; the same for the same program, always.

    Raises:
        GenerateError: if the program is not consistent, or lacks a function that the runtime calls.
    """
    identifier(program.robot)
    all_functions = functions(program)
    templates = environment("emit")
    context = template_context(program, all_functions)
    files = {name: tidy(templates.get_template(f"{name}.j2").render(context)) for name in _C_TEMPLATES}
    files |= {name: templates.get_template(f"{name}.j2").render(context) for name in _OTHER_TEMPLATES}
    files |= render_kernels(program, context["banner"])
    files[MANIFEST] = render_manifest(program, all_functions, mark(program), ABI_VERSION)
    return files


def template_context(program: Program, all_functions: tuple[Function, ...]) -> dict[str, Any]:
    """What templates may use; a name that is not here is an error.

    `robot` is the prefix of all symbols, `X` the same in upper case; `banner` the comment at the head of
    every file.
    """
    return {
        "program": program,
        "robot": program.robot,
        "X": program.robot.upper(),
        "config_hash": program.config_hash,
        "banner": banner(program),
        "mark": mark(program),
        "regenerate": regenerate(program),
        "config_file": config_file(program),
        "abi": ABI_VERSION,
        "version": __version__,
        "dimensions": dimensions(program),
        "additions": program.additions,
        "additions_mask": sum(1 << ADDITIONS.index(name) for name in program.additions),
        "functions": [_function_context(function) for function in all_functions],
        "parameter_fields": tables.parameter_fields(program),
        "kinematics_fields": tables.kinematics_struct(program),
        "parameter_values": {
            which: tables.parameter_values(program, which) for which in ("default", "lower", "upper")
        },
        "capsule_rows": tables.capsule_rows(program),
        "tof_rows": tables.sensor_rows(program, program.tof),
        "capacitive_rows": tables.sensor_rows(program, program.capacitive),
        "self_point_rows": tables.self_point_rows(program),
        "self_pair_rows": tables.self_pair_rows(program),
        "self_pairs": [_pairs(program, point) for point in program.self_points],
        "ray_rows": tables.ray_rows(program),
        "cone_rows": tables.cone_rows(program),
        "see_through_rows": tables.see_through_rows(program),
        "linear_rows": tables.linear_rows(program),
        "names_comment": block_comment(_names(program)),
        "public_functions": PUBLIC_FUNCTIONS,
        "string": string,
        "number": number,
        "plain": plain,
    }


def mark(program: Program) -> str:
    """The sentence by which a generated file is known."""
    made_with = ", ".join(
        f"{name} {version}" for name, version in sorted(program.sources.items()) if name != "proxgen"
    )
    return f"{MARK} {__version__} ({made_with}). Do not edit."


def regenerate(program: Program) -> str:
    """The command that makes the folder again."""
    return f"proxgen generate {config_file(program)} -o generated/{program.robot}"


def config_file(program: Program) -> str:
    """The file to give to a command; the robot's name stands for one that text and shells may misread."""
    plain = _PLAIN_NAME.fullmatch(program.config_file)
    return program.config_file if plain else f"{program.robot}.yaml"


def banner(program: Program) -> str:
    """The comment at the head of every generated C file: no date, no path, so that it is always the same."""
    return block_comment(
        [
            mark(program),
            f"Configuration: sha256 {program.config_hash}",
            f"Regenerate:    {regenerate(program)}",
        ]
    )


def _names(program: Program) -> list[str]:
    """What the indices stand for."""
    lists = {
        "joints": program.joint_names,
        "task rows": program.task_row_names,
        "bodies": program.body_names,
        "capsules": [capsule.name for capsule in program.capsules],
    }
    if program.self_points:
        lists["self points"] = [point.name for point in program.self_points]
    if program.additions:
        lists["rows"] = program.row_names
    listed = [
        f"  {kind}: {', '.join(f'{index} {name}' for index, name in enumerate(names))}"
        for kind, names in lists.items()
    ]
    return ["Sizes. What the indices stand for:", *listed]


def _pairs(program: Program, point: SelfPointEntry) -> str:
    """The capsules that are pairs with a point, and the rows that they give."""
    first = len(program.capsules) + program.active_row
    return ", ".join(
        f"{capsule.name} ({first + slot})"
        for slot, capsule in enumerate(program.capsules)
        if point.capsules[slot]
    )


def _function_context(function: Function) -> dict[str, Any]:
    """A function with its comment and its argument lists as lines of C."""
    return {
        "name": function.name,
        "declaration": function.declaration,
        "comment": block_comment(_description(function)),
        "choosers": function.choosers,
        "cases": function.cases,
        "arguments": _pointer_array("const double *arguments[]", function.arguments),
        "results": _pointer_array("double *results[]", function.results),
        "parameters": function.parameters,
        "operations": function.operations,
        "summary": function.summary,
        "equation": function.equation,
    }


def _description(function: Function) -> list[str]:
    """The comment above a function's declaration, by paragraphs."""
    lines = [function.summary, "", "  " + function.equation, ""]
    passed = [(argument, "in ") for argument in function.inputs]
    passed += [(argument, "out") for argument in function.outputs]
    names = [*function.choosers, *(argument.name for argument, _ in passed)]
    width = max(map(len, names), default=0)
    lines += [f"  in  {chooser.ljust(width)}  index of a body, as above" for chooser in function.choosers]
    lines += [_argument_line(argument, side, width) for argument, side in passed]
    if function.parameters:
        lines.append("Reads the parameters " + ", ".join(function.parameters) + ".")
    if function.fields_read:
        lines.append("Reads from the kinematics " + ", ".join(function.fields_read) + ".")
    if function.fields_written:
        lines.append("Writes all of the kinematics.")
    if function.choosers:
        refused = (
            "for a body that carries no capsule"
            if len(function.choosers) == 1
            else "where no capsule of the one and point of the other are a pair"
        )
        lines.append(f"Returns 0, or 1 {refused}. Operations: {function.operations} at most.")
    else:
        lines.append(f"Returns 0. Operations: {function.operations}.")
    return lines


def _argument_line(argument: Argument, side: str, width: int) -> str:
    """`in  q  7 [rad]: joint positions`."""
    unit = f" [{argument.unit}]" if argument.unit else ""
    return f"  {side} {argument.name.ljust(width)}  {shape_text(argument)}{unit}: {argument.meaning}"


def _pointer_array(declaration: str, expressions: tuple[str, ...]) -> list[str]:
    """An array of pointers, broken as clang-format does: it packs five and more into one line if they fit."""
    one_line = f"  {declaration} = {{{', '.join(expressions)}}};"
    if len(one_line) <= 100:
        return [one_line]
    packed = f"      {', '.join(expressions)},"
    if len(expressions) >= 5 and len(packed) <= WIDTH:
        return [f"  {declaration} = {{", packed, "  };"]
    return [f"  {declaration} = {{", *(f"      {expression}," for expression in expressions), "  };"]
