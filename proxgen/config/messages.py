"""Pydantic's errors as problems that a person can act on."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from proxgen.config.keys import Keys, keys_of
from proxgen.config.origin import Origin
from proxgen.config.quantities import describe_value
from proxgen.config.section import CONTRADICTION
from proxgen.errors import Problem, nearest_name, unknown_name

Parts = tuple[str | int, ...]


def problems_of(error: ValidationError, data: Any, model: type[BaseModel], origin: Origin) -> list[Problem]:
    """Every mistake that a validation found, in words.

    Args:
        error: raised by `model` for `data`.
        data: plain data, as read from the file.
        model: what the file should be.
        origin: where the data were written.
    """
    keys = keys_of(model)
    problems: dict[Problem, None] = {}
    for details in error.errors(include_url=False):
        if details["type"] == CONTRADICTION:
            found = _contradictions(details, _path(details, data), origin)
        else:
            found = _mistake(details, _path(details, data), data, keys, origin)
        problems |= dict.fromkeys(found)
    return list(problems)


def contradictions_besides(
    error: ValidationError, data: Any, origin: Origin, ignored: Sequence[str]
) -> list[Problem]:
    """The contradictions among values, without those in which one of the `ignored` keys has a part."""
    problems: list[Problem] = []
    for details in error.errors(include_url=False):
        if details["type"] == CONTRADICTION:
            problems += _contradictions(details, _path(details, data), origin, ignored)
    return problems


def mistaken_keys(error: ValidationError, data: Any) -> list[Parts]:
    """Paths of the keys whose values are wrong, or that are unknown; not of those that are missing."""
    paths = []
    for details in error.errors(include_url=False):
        path = list(_path(details, data))
        while path and isinstance(path[-1], int):
            path.pop()
        if path and details["type"] not in {CONTRADICTION, "missing"}:
            paths.append(tuple(path))
    return paths


def _path(error: ErrorDetails, data: Any) -> Parts:
    """The place of an error without the tags of unions: only what leads through the data stays."""
    path: list[str | int] = []
    current = data
    for part in error["loc"]:
        in_mapping = isinstance(current, dict) and part in current
        in_list = isinstance(current, list) and isinstance(part, int) and part < len(current)
        if in_mapping or in_list:
            current = current[part]
            path.append(part)
    if error["type"] == "missing":
        path.append(error["loc"][-1])
    return tuple(path)


def _value(path: Parts, data: Any) -> Any:
    """What the file has at a path; None where it has nothing."""
    for part in path:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def dotted(path: Sequence[str | int]) -> str:
    """A path as text."""
    return ".".join(str(part) for part in path)


def _contradictions(
    error: ErrorDetails, path: Parts, origin: Origin, ignored: Sequence[str] = ()
) -> list[Problem]:
    """A problem for each finding of a section, if none of the ignored keys has a part in it."""
    problems = []
    for finding in error["ctx"]["findings"]:
        involved = [dotted((*path, key)) for key in finding.keys]
        if not any(f"{key}.".startswith(f"{other}.") for key in involved for other in ignored):
            problems.append(origin.problem_among(involved, finding.message))
    return problems


def _mistake(error: ErrorDetails, path: Parts, data: Any, keys: Keys, origin: Origin) -> list[Problem]:
    """The problem of one value."""
    if error["type"] == "missing" and isinstance(path[-1], int):
        path = path[:-1]
        return [origin.problem(dotted(path), _wrong_length(path, data, keys))]
    if error["type"] == "too_short" and len(_value(path, data)) >= error["ctx"]["min_length"]:
        return []  # there are items enough, but wrong ones, which are reported
    return [origin.problem(dotted(path), _sentence(error, path, data, keys))]


def _sentence(error: ErrorDetails, path: Parts, data: Any, keys: Keys) -> str:
    """What was found and what is allowed."""
    kind, value = error["type"], _value(path, data)
    match kind:
        case "value_error":
            return str(error["ctx"]["error"])
        case "extra_forbidden":
            return _unknown_key(path, keys)
        case "missing":
            purpose = keys.description_at(path)
            return f"the key '{path[-1]}' is missing{f' ({purpose})' if purpose else ''}"
        case "literal_error":
            allowed = [str(name) for form in keys.at(path) for name in _literals(form)]
            if isinstance(value, str):
                return unknown_name("value", value, allowed)
            return f"found {describe_value(value)}, allowed: {', '.join(sorted(allowed))}"
        case "bool_type":
            hint = _yaml_11_bool(value)
            return f"expected true or false, found {describe_value(value)}{hint}"
        case "string_type":
            return f"expected a name or text, found {describe_value(value)}"
        case "string_pattern_mismatch":
            rule = "a name begins with a lower-case letter; then lower-case letters, digits and _ follow"
            return f"{describe_value(value)} is not allowed: {rule}"
        case "string_too_long":
            return f"{describe_value(value)} is too long: at most {error['ctx']['max_length']} characters"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"expected {_mapping_words(path, keys)}, found {describe_value(value)}"
        case "tuple_type" | "list_type" | "too_long" | "too_short":
            return _wrong_length(path, data, keys)
        case _:
            return f"{error['msg']}, found {describe_value(value)}"


def _unknown_key(path: Parts, keys: Keys) -> str:
    """The nearest key of the section; else the sections in which there is such a key."""
    name, allowed = str(path[-1]), keys.names_at(path[:-1])
    message = unknown_name("key", name, allowed)
    homes = keys.homes_of(name) if nearest_name(name, allowed) is None else []
    if homes:
        homes.sort(key=lambda home: home.count("."))
        places = " or ".join(f"'{home}'" if home else "the top of the file" for home in homes)
        return message.replace(" (allowed:", f"; it belongs into {places} (allowed:", 1)
    return message


def _literals(schema: dict[str, Any]) -> list[Any]:
    """The values of a choice."""
    return [schema["const"]] if "const" in schema else list(schema.get("enum", ()))


def _yaml_11_bool(value: Any) -> str:
    """A hint for the words that older YAML took for true and false."""
    if isinstance(value, str) and value.lower() in {"on", "yes", "y", "off", "no", "n"}:
        return f"; write {'true' if value.lower() in {'on', 'yes', 'y'} else 'false'}"
    return ""


def _mapping_words(path: Parts, keys: Keys) -> str:
    """A section and its keys, or a mapping by joint."""
    names = keys.names_at(path)
    return f"a section with the keys {', '.join(names)}" if names else "a mapping from joint names to values"


def _wrong_length(path: Parts, data: Any, keys: Keys) -> str:
    """A list that is none, or has too few or too many items."""
    value = _value(path, data)
    lists = [form for form in keys.at(path) if form.get("type") == "array"]
    least, most = (lists[0].get("minItems"), lists[0].get("maxItems")) if lists else (None, None)
    if least is not None and least == most:
        expected = f"a list of {least} values"
    else:
        expected = f"a list of at least {least} item{'s' if least != 1 else ''}" if least else "a list"
    found = describe_value(value) if not isinstance(value, list) or not value else f"{len(value)}"
    return f"expected {expected}, found {found}"
