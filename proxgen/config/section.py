"""Section: what all parts of a YAML file have in common, and the types that they share."""

from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple, Self

from pydantic import BaseModel, ConfigDict, Field, StrictBool, model_validator
from pydantic_core import PydanticCustomError

from proxgen.config.quantities import Length, Number

Flag = StrictBool
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]
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
        findings = list(self.contradictions())
        if findings:
            text = "; ".join(finding.message for finding in findings)
            raise PydanticCustomError(CONTRADICTION, "{text}", {"text": text, "findings": findings})
        return self


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


def repeated_names(key: str, items: tuple[Any, ...]) -> Iterator[Finding]:
    """A finding for every item of a list whose name an earlier item has."""
    seen: set[str] = set()
    for index, item in enumerate(items):
        if item.name in seen:
            yield Finding(
                (f"{key}.{index}.name",), f"the name '{item.name}' is given twice; names must differ"
            )
        seen.add(item.name)
