"""Every key of a scene with its unit, default and meaning, from the sections themselves."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

import annotated_types
from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError, PydanticUndefined

from coupling.scene.scene import Scene

_UNIT = re.compile(r" \[([^\]]+)\]")
_KINDS = {
    float: "number", int: "whole number", bool: "true or false", str: "text",
    tuple[float, float, float]: "three numbers", tuple[float, float]: "two numbers",
}  # fmt: skip
_BOUNDS = {
    annotated_types.Gt: ("gt", "> {}"),
    annotated_types.Ge: ("ge", ">= {}"),
    annotated_types.Lt: ("lt", "< {}"),
    annotated_types.Le: ("le", "<= {}"),
}


@dataclass(frozen=True, kw_only=True)
class Key:
    """A key of a scene.

    ``section`` is empty for those above all sections; ``unit`` is empty where there is none;
    ``values``: what it may be; ``default`` as TOML has it, empty where there is none;
    ``instead``: what may be given in its place.
    """

    section: str
    name: str
    unit: str
    values: str
    default: str
    required: bool
    instead: str
    meaning: str

    @property
    def dotted(self) -> str:
        """As ``--set`` names it."""
        return f"{self.section}.{self.name}" if self.section else self.name


def keys() -> Iterator[Key]:
    """Every key of a scene, in the order of the sections."""
    for name, field in Scene.model_fields.items():
        section = _section(field)
        if section is None:
            yield _key("", name, field)
        else:
            for inner, found in section.model_fields.items():
                yield _key(name, inner, found)


def section_of(name: str) -> type[BaseModel]:
    """The class of a section; its docstring says what it is."""
    found = _section(Scene.model_fields[name])
    assert found is not None
    return found


def unit_of_key(dotted: str) -> str:
    """Return the unit of a key as ``--set`` names it, empty where it has none or is unknown."""
    return next((key.unit for key in keys() if key.dotted == dotted), "")


def _section(field: FieldInfo) -> type[BaseModel] | None:
    kind = field.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _key(section: str, name: str, field: FieldInfo) -> Key:
    said = field.description or ""
    units = _UNIT.findall(said)
    one = len(units) == 1
    value, extra = field.get_default(call_default_factory=True), field.json_schema_extra
    instead = extra.get("instead", "") if isinstance(extra, dict) else ""
    return Key(
        section=section,
        name=name,
        unit=units[0] if one else "",
        values=_values(field),
        default="" if value is None or value is PydanticUndefined else _toml(value),
        required=field.is_required(),
        instead=str(instead),
        meaning=_UNIT.sub("", said) if one else said,
    )


def _values(field: FieldInfo) -> str:
    kind: Any = field.annotation
    if get_origin(kind) in (Union, UnionType):  # with None: it may be left out
        kind = next(part for part in get_args(kind) if part is not type(None))
    if get_origin(kind) is Literal:
        return ", ".join(_toml(value) for value in get_args(kind))
    listed = [name for data in field.metadata for name in _choices(data)]
    if listed:
        return ", ".join(map(_toml, listed))
    bounds = [
        text.format(_toml(getattr(bound, name)))
        for bound in field.metadata
        for family, (name, text) in _BOUNDS.items()
        if isinstance(bound, family)
    ]
    return " ".join([_KINDS.get(kind, str(kind)), *([", ".join(bounds)] if bounds else [])])


def _choices(check: Any) -> tuple[str, ...]:
    """The names that ``choices.one_of`` takes, as its refusal lists them."""
    if not isinstance(check, BeforeValidator):
        return ()
    refuse: Any = check.func
    try:
        refuse("")
    except PydanticCustomError as error:
        return tuple((error.context or {}).get("choices", ()))
    return ()


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)
