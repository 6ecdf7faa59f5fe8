"""Section: what all parts of a YAML file have in common, and the types that they share."""

from collections.abc import Iterator
from typing import Annotated, NamedTuple, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, StrictBool, model_validator
from pydantic_core import PydanticCustomError

from proxgen.config.quantities import Length, Number

Flag = StrictBool
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$", max_length=40)]
Vector3 = tuple[Annotated[float, Length()], Annotated[float, Length()], Annotated[float, Length()]]
Direction = tuple[Annotated[float, Number()], Annotated[float, Number()], Annotated[float, Number()]]

CONTRADICTION = "contradiction"
"""Type of the pydantic error that carries the findings of `Section.contradictions`."""


class Finding(NamedTuple):
    """Values that are right by themselves, but not together.

    Attributes:
        keys: dotted paths of the values, relative to the section; it is reported at the first one that the
            user wrote, as the others are defaults.
        message: what was found, and what is allowed.
    """

    keys: tuple[str, ...]
    message: str


class Section(BaseModel):
    """Base of all sections: frozen, and strict about keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def contradictions(self) -> Iterator[Finding]:
        """Values of this section that do not go together; none unless a section says so."""
        yield from ()

    @model_validator(mode="after")
    def _has_no_contradictions(self) -> Self:
        """Refuse the section if it contradicts itself, with all findings."""
        refuse(list(self.contradictions()))
        return self


Named = TypeVar("Named", bound=Section)
"""A section with a `name`."""


def refuse(findings: list[Finding]) -> None:
    """Raise the error that carries the findings, if there are any."""
    if findings:
        text = "; ".join(finding.message for finding in findings)
        raise PydanticCustomError(CONTRADICTION, "{text}", {"text": text, "findings": findings})


def must_be_less(
    keys: tuple[str, str], values: tuple[float, float], unit: str, why: str
) -> Iterator[Finding]:
    """Nothing if the first value is less than the second, else the finding."""
    if not values[0] < values[1]:
        low, high = (f"{key} = {value:.6g} {unit}".rstrip() for key, value in zip(keys, values, strict=True))
        yield Finding(keys, f"{low} must be less than {high} ({why})")


def zero_vector(key: str, vector: tuple[float, float, float]) -> Iterator[Finding]:
    """The finding for a direction that has no direction."""
    if not any(vector):
        yield Finding((key,), "a direction cannot be [0, 0, 0]")


def unique_names(items: tuple[Named, ...]) -> tuple[Named, ...]:
    """The items of a list, refused if two have the same name; for use as a validator of the list."""
    seen: set[str] = set()
    findings = []
    for index, item in enumerate(items):
        name: str = item.name  # type: ignore[attr-defined]
        if name in seen:
            message = f"the name '{name}' is given twice; names must differ"
            findings.append(Finding((f"{index}.name",), message))
        seen.add(name)
    refuse(findings)
    return items
