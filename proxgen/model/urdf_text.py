"""URDF text to a Pinocchio model, even if limits are missing; the parser's own words if it fails."""

import copy
import math
import os
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

import pinocchio as pin

from proxgen.errors import ModelError

_LIMITED = ("revolute", "prismatic")
_NEEDED = ("lower", "upper", "velocity", "effort")


def pinocchio_model(root: ElementTree.Element) -> Any:
    """The whole robot.

    The parser refuses joints without limits. They get some here, which nothing reads: limits are taken from
    the URDF itself, and what is missing there is asked for.

    Args:
        root: the <robot> element.

    Raises:
        ModelError: it is not a URDF; the message says what the parser said.
    """
    _refuse_axes_without_direction(root)
    text = ElementTree.tostring(_with_limits(root), encoding="unicode")
    with _stderr_to_file() as said:
        try:
            return pin.buildModelFromXML(text)
        except (ValueError, RuntimeError) as error:
            said.seek(0)
            reasons = [
                line.strip() for line in said if line.strip() and not line.strip().startswith("at line")
            ]
            raise ModelError(" ".join(reasons) or str(error)) from error


def _refuse_axes_without_direction(root: ElementTree.Element) -> None:
    """Raise where a moving joint's axis has no direction: the parser would make it not-a-number."""
    for joint in root.findall("joint"):
        axis = joint.find("axis")
        if axis is None or joint.get("type") == "fixed":
            continue
        shown = axis.get("xyz", "1 0 0")
        try:
            values = [float(word) for word in shown.split()]
        except ValueError:
            continue  # the parser says what it thinks of it
        if not any(values) or not all(map(math.isfinite, values)):
            raise ModelError(
                f"joint '{joint.get('name', '')}' has the axis \"{shown}\", which is no direction"
            )


def finite_number(element: ElementTree.Element | None, name: str) -> float | None:
    """A finite attribute; None where element or attribute is missing, or it says infinity or nan.

    Raises:
        ValueError: it is not a number.
    """
    text = element.get(name) if element is not None else None
    try:
        value = float(text) if text is not None else None
    except ValueError:
        tag = element.tag if element is not None else ""
        raise ValueError(f'<{tag} {name}="{text}">: a number is needed') from None
    return value if value is not None and math.isfinite(value) else None


def _with_limits(root: ElementTree.Element) -> ElementTree.Element:
    """A copy in which every joint that must have limits has all of them."""
    root = copy.deepcopy(root)
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        if limit is None and joint.get("type") in _LIMITED:
            limit = ElementTree.SubElement(joint, "limit")
        if limit is not None:
            for name in _NEEDED:
                if finite_number(limit, name) is None:
                    limit.set(name, "0")
    return root


@contextmanager
def _stderr_to_file() -> Iterator[IO[str]]:
    """Let what C++ code writes to standard error go to a file; it says there why it refuses a URDF."""
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as file:
        os.dup2(file.fileno(), 2)
        try:
            yield file
        finally:
            os.dup2(kept, 2)
            os.close(kept)
