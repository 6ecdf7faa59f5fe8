"""Names that a configuration accepts, made from whatever a URDF calls its parts."""

import re
import unicodedata
from collections.abc import Iterable

from proxgen.config.reserved import RESERVED_NAMES

MAX_LENGTH = 40


def identifier(text: str, prefix: str = "part") -> str:
    """A lower-case identifier: letters, digits and underscores, a letter first.

    Accents are dropped, every other character becomes an underscore; what would not begin with a letter gets
    the prefix; the result has at most 40 characters.
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")
    if not name or not name[0].isalpha():
        name = f"{prefix}_{name}".rstrip("_")
    return name[:MAX_LENGTH].rstrip("_")


def shortened(name: str, ending: str) -> str:
    """An identifier with an ending, cut before it where it would be too long."""
    return name[: MAX_LENGTH - len(ending)].rstrip("_") + ending


def robot_name(text: str) -> str:
    """An identifier that can be the prefix of C symbols."""
    name = identifier(text, "robot")
    return shortened(name, "_robot") if name in RESERVED_NAMES else name


def distinct(texts: Iterable[str]) -> list[str]:
    """Identifiers that differ from each other, in the same order; numbers tell equal ones apart."""
    names: list[str] = []
    for text in texts:
        name, number = identifier(text), 2
        while name in names:
            ending = f"_{number}"
            name = shortened(identifier(text), ending)
            number += 1
        names.append(name)
    return names
