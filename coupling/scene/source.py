"""Plain values of a scene: from its file, changed from the command line."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.scene.errors import SceneError

SCENE_FILE = "scene.toml"

# A key given on the command line replaces those that the file gives in its place.
_REPLACED_BY: dict[tuple[str, ...], tuple[str, ...]] = {
    ("liquid", "name"): ("density", "viscosity", "surface_tension"),
    ("diaphragm", "material"): ("density", "youngs_modulus", "poisson_ratio", "strength"),
    ("diaphragm", "thickness"): ("thickness_map",),
    ("diaphragm", "thickness_map"): ("thickness",),
    ("motion", "amplitude"): ("acceleration",),
    ("motion", "acceleration"): ("amplitude",),
    ("time", "duration"): ("periods",),
    ("time", "periods"): ("duration",),
    ("time", "step"): ("steps_per_period",),
    ("time", "steps_per_period"): ("step",),
}


def scene_file(path: Path) -> Path:
    """``path`` itself, or the scene file in it where it is a folder.

    ``SceneError`` where there is none.
    """
    file = path / SCENE_FILE if path.is_dir() else path
    if not file.exists():
        what = f"the folder holds no {SCENE_FILE}" if path.is_dir() else "does not exist"
        raise SceneError([f"{path}: {what}. Give a folder with {SCENE_FILE}, or a scene file."])
    return file


def read_toml(file: Path) -> dict[str, Any]:
    """Contents of a TOML file; ``SceneError`` with line and column where it is not valid."""
    try:
        return tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except OSError as error:
        mend = "Give a scene file that may be read."
        raise SceneError([f"{file}: cannot be read: {error.strerror}. {mend}"]) from error
    except UnicodeDecodeError as error:
        mend = "Save the scene as text in UTF-8."
        raise SceneError([f"{file}: is not UTF-8 text. {mend}"]) from error
    except tomllib.TOMLDecodeError as error:
        mend = "Write key = value, numbers with a decimal point, text in quotes, each section once."
        raise SceneError([f"{file}: is not valid TOML: {error}. {mend}"]) from error


_DECIMAL = re.compile(r"[+-]?(\d+\.\d*|\.\d+)([eE][+-]?\d+)?")  # TOML wants digits on both sides


def apply_override(data: dict[str, Any], text: str) -> str:
    """Change ``data`` in place by ``key=value`` and return the dotted key.

    The value is TOML where it parses as such, else a number such as .5, else text. ``SceneError``
    for anything else than a key and a value; whether the key is known is not checked.
    """
    dotted, equals, value = (part.strip() for part in text.partition("="))
    keys = dotted.split(".")
    if not equals or not all(keys):
        raise SceneError(
            [f"--set {text}: must be key=value, such as --set liquid.fill_fraction=0.5."]
        )
    try:
        parsed: Any = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        parsed = float(value) if _DECIMAL.fullmatch(value) else value
    table: Any = data
    for key in keys[:-1]:
        table = table.setdefault(key, {})
        if not isinstance(table, dict):
            raise SceneError([f"--set {text}: {key} is a value, not a section."])
    for replaced in _REPLACED_BY.get(tuple(keys), ()):
        table.pop(replaced, None)
    table[keys[-1]] = parsed
    return dotted


def as_texts(changes: Sequence[str] | Mapping[str, Any]) -> list[str]:
    """Changes of a scene as ``key=value``, also where they are values by dotted key."""
    if not isinstance(changes, Mapping):
        return list(changes)
    return [f"{key}={json.dumps(value, default=_plain)}" for key, value in changes.items()]


def _plain(value: Any) -> Any:
    """A path as text, an array or a number of NumPy's as Python has it."""
    return str(value) if isinstance(value, Path) else value.tolist()
