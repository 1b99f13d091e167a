"""Turns what pydantic says of a wrong scene into key, allowed range, value and mend."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text in quotes",
    "tuple_type": "three numbers in brackets",
    "finite_number": "a finite number",
}
# Keys of former versions, and what to do now.
_RETIRED = {
    "cloth.strain_limit": "A sheet that is inextensible is now stiff: leave it out.",
    "cloth.bending_damping": "Give cloth.fold_damping, the same time over sqrt(R/g).",
    "cloth.drag": "Give cloth.slack_drag, the same rate over sqrt(g/R).",
}
_RANGES = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}


class SceneError(ValueError):
    """A scene that cannot be used; one line a problem, each with its mend.

    ``problems``: the lines.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)


def problems_of(error: ValidationError, root: type[BaseModel]) -> list[str]:
    """One line ``key: what is wrong, got value. Mend.`` for each distinct problem."""
    lines: list[str] = []
    for details in error.errors(include_url=False):
        if details["type"] == "cross_check":
            lines += details["ctx"]["problems"].splitlines()
        else:
            lines.append(_problem(details, root))
    return list(dict.fromkeys(lines))


def _problem(details: ErrorDetails, root: type[BaseModel]) -> str:
    kind, loc = details["type"], [str(part) for part in details["loc"]]
    names = [part for part in details["loc"] if isinstance(part, str)]
    if len(names) < len(loc):  # inside a vector
        kind, loc = ("tuple_type" if kind in {"missing", "too_long"} else kind), names
    key = ".".join(loc)
    owner, field = _find(root, names)
    got = _shown(details["input"])
    if key in _RETIRED:
        return f"{key}: is no longer known. {_RETIRED[key]}"
    if kind == "extra_forbidden":
        noun = _noun(details)
        elsewhere = _of_other_sections(names, root) if noun == "key" else ""
        return f"{key}: unknown {noun}. {elsewhere or _nearest(names[-1], owner.model_fields)}"
    if kind == "missing":
        return f"{key}: is required. {_mend(field, names)}"
    if kind == "unknown_name":
        name = details["ctx"]["key"]
        return f"{key}.{name}: {_shown(details['input'][name])} {details['msg']}."
    if kind == "literal_error":
        assert field is not None
        return f"{key}: {_choice(get_args(field.annotation), details['input'])}"
    if kind == "unknown_choice":
        return f"{key}: {_choice(details['ctx']['choices'], details['input'])}"
    if kind in _RANGES:
        return f"{key}: {_range(field)}, got {got}. {_mend(field, names)}"
    if kind in {"model_type", "model_attributes_type", "dict_type"}:
        return f"{key}: must be a section [{key}], got {got}."
    if kind in {"too_long", "too_short"}:
        kind = "tuple_type"
    wanted = _TYPES.get(kind)
    what = f"must be {wanted}" if wanted else details["msg"]
    return f"{key}: {what}, got {got}. {_mend(field, names)}"


def _find(root: type[BaseModel], names: Sequence[str]) -> tuple[type[BaseModel], FieldInfo | None]:
    """The model that owns the last of ``names``, and the field of that name."""
    owner = root
    for name in names[:-1]:
        annotation = owner.model_fields[name].annotation
        assert isinstance(annotation, type)
        assert issubclass(annotation, BaseModel)
        owner = annotation
    return owner, owner.model_fields.get(names[-1]) if names else None


def _noun(details: ErrorDetails) -> str:
    top = len(details["loc"]) == 1
    return "section" if top and isinstance(details["input"], dict) else "key"


def _of_other_sections(names: Sequence[str], root: type[BaseModel]) -> str:
    """Ask for a key by its section where it stands in the wrong one, or above all; else ""."""
    known = [
        f"{section}.{names[-1]}"
        for section, field in root.model_fields.items()
        if isinstance(field.annotation, type)
        and issubclass(field.annotation, BaseModel)
        and names[-1] in field.annotation.model_fields
    ]
    if len(names) > 1 and names[-1] in root.model_fields:
        return f"{names[-1]} stands above all sections."
    return f"Did you mean {' or '.join(known)}?" if known else ""


def _nearest(name: str, known: Iterable[str]) -> str:
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    return f"Did you mean {near[0]}?" if near else f"Known here: {', '.join(known)}."


def _mend(field: FieldInfo | None, names: Sequence[str]) -> str:
    if field is None or field.description is None:
        return f"Add the section [{names[-1]}]." if names else ""
    extra = field.json_schema_extra
    instead = f", or {extra['instead']}" if isinstance(extra, dict) and "instead" in extra else ""
    return f"Give the {field.description}{instead}."


def _choice(choices: Sequence[Any], value: Any) -> str:
    listed = ", ".join(_shown(choice) for choice in choices)
    near = difflib.get_close_matches(str(value), [str(choice) for choice in choices], n=1)
    mend = f"Did you mean {near[0]}?" if near else "This version offers nothing else."
    only = "must be" if len(choices) == 1 else "must be one of"
    return f"{only} {listed}, got {_shown(value)}. {mend}"


def _range(field: FieldInfo | None) -> str:
    assert field is not None
    bounds = {
        name: getattr(item, name)
        for item in field.metadata
        for name in ("gt", "ge", "lt", "le")
        if getattr(item, name, None) is not None
    }
    low = bounds.get("gt", bounds.get("ge"))
    high = bounds.get("lt", bounds.get("le"))
    if low is not None and high is not None:
        left, right = "(" if "gt" in bounds else "[", ")" if "lt" in bounds else "]"
        return f"must lie in {left}{low:g}, {high:g}{right}"
    if high is not None:
        return f"must be {'below' if 'lt' in bounds else 'at most'} {high:g}"
    if low == 0:
        return "must be positive" if "gt" in bounds else "must not be negative"
    return f"must be {'above' if 'gt' in bounds else 'at least'} {low:g}"


def _shown(value: Any) -> str:
    """As it would stand in a TOML file, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    value = list(value) if isinstance(value, tuple) else value
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
