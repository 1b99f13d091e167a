"""What a run is made of: the values of its scene and the contents of the files that it names."""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coupling.scene.errors import SceneError
from coupling.scene.scene import TABLE_FILES, Scene, plain_values, tables_of
from coupling.scene.source import SCENE_FILE, read_toml

# They say how a run is done, written and named, not what is computed.
FREE_KEYS = frozenset(
    {
        "title", "time.output_every", "time.checkpoint_every", "openfoam.keep_alive",
        "openfoam.timeout", "openfoam.write_fields", "report.lead", "diaphragm.wear_coefficient",
    }
)  # fmt: skip
DURATION = "time.duration"


@dataclass(frozen=True, kw_only=True)
class Content:
    """``values`` by dotted key, but for names of files; ``tables``: the files' bytes by key."""

    values: dict[str, Any]
    tables: dict[str, bytes]

    def digest(self) -> str:
        """A hash of all that a run depends on but its duration."""
        kept = {k: v for k, v in self.values.items() if k not in FREE_KEYS | {DURATION}}
        tables = {key: hashlib.sha256(data).hexdigest() for key, data in self.tables.items()}
        text = json.dumps([kept, tables], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def packed_tables(self) -> dict[str, NDArray[np.uint8]]:
        """The tables as arrays of compressed bytes."""
        return {
            key: np.frombuffer(zlib.compress(data, 1), np.uint8)
            for key, data in self.tables.items()
        }


def unpacked_tables(packed: Mapping[str, NDArray[np.uint8]]) -> dict[str, bytes]:
    """The reverse of ``Content.packed_tables``."""
    return {key: zlib.decompress(data.tobytes()) for key, data in packed.items()}


def content_of(scene: Scene) -> Content:
    """Content of a scene. ``OSError`` where a file that it names cannot be read."""
    tables = {".".join(place): path for place, path in tables_of(scene).items()}
    return _content(plain_values(scene), tables)


def content_in(folder: Path) -> Content:
    """Content of the scene in a run's folder, as it stands there: whether it is valid is not asked.

    Raises ``SceneError`` where it cannot be read.
    """
    data = read_toml(folder / SCENE_FILE)
    tables = {}
    for (section, key), copy in TABLE_FILES.items():
        values = data.get(section)
        if isinstance(values, dict) and values.get(key) == copy:
            tables[f"{section}.{key}"] = folder / copy
    try:
        return _content(data, tables)
    except OSError as error:
        raise SceneError([f"{error.filename}: cannot be read: {error.strerror}."]) from error


def _content(data: Mapping[str, Any], tables: Mapping[str, Path]) -> Content:
    values = json.loads(json.dumps(dict(_flat(data, "")), default=str))
    return Content(
        values={key: value for key, value in values.items() if key not in tables},
        tables={key: path.read_bytes() for key, path in tables.items()},
    )


def _flat(data: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def differences(former: Content, now: Content, *, free: Collection[str] = ()) -> list[str]:
    """One line ``key: former -> now`` for each difference but those in the ``free`` keys."""
    keys = dict.fromkeys([*former.values, *now.values])
    lines = [
        f"{key}: {_shown(former.values, key)} -> {_shown(now.values, key)}"
        for key in keys
        if key not in free and former.values.get(key) != now.values.get(key)
    ]
    for key in dict.fromkeys([*former.tables, *now.tables]):
        if former.tables.get(key) != now.tables.get(key):
            lines.append(f"{key}: {_table_change(former.tables.get(key), now.tables.get(key))}")
    return lines


def _shown(values: Mapping[str, Any], key: str) -> str:
    return json.dumps(values[key]) if key in values else "absent"


def _table_change(former: bytes | None, now: bytes | None) -> str:
    if former is None or now is None:
        return "absent -> a table" if former is None else "a table -> absent"
    old, new = (data.decode("utf-8", "replace").splitlines() for data in (former, now))
    for number, (one, other) in enumerate(zip(old, new, strict=False), start=1):
        if one != other:
            return f"the table differs, first in line {number}: '{one[:60]}' -> '{other[:60]}'"
    return f"the table differs: {len(old)} -> {len(new)} lines"
