"""A run's state on disk, from which it goes on bit for bit."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import h5py
import numpy as np
from numpy.typing import NDArray

from coupling.store.atomic import H5_ERRORS, UnreadableFile, replacing

AnyArray = NDArray[Any]

# What the parts hold: raised with every change that a run cannot go on across. Files before 2 do
# not say theirs.
SCHEMA = 10
_MEND = "Run the scene again: edt run SCENE -o DIR --force."


def save_checkpoint(
    path: Path | str, parts: Mapping[str, Mapping[str, AnyArray]], attributes: Mapping[str, Any]
) -> None:
    """Write arrays of any numeric type, by part and name, and attributes that JSON can say.

    The former checkpoint stays until the new one is whole.

    Raises
    ------
    RunFailed
        The disk is full or cannot be written.
    TypeError
        An attribute is not JSON, or an array holds objects or text.
    """
    arrays = {
        f"parts/{quote(part, safe='')}/{quote(name, safe='')}": np.asarray(values)
        for part, items in parts.items()
        for name, values in items.items()
    }
    text = json.dumps(dict(attributes), default=_plain_scalar)
    with replacing(Path(path)) as beside, h5py.File(beside, "w") as file:
        for part in parts:
            file.create_group(f"parts/{quote(part, safe='')}")
        for name, values in arrays.items():
            file.create_dataset(name, data=values)
        file.create_dataset("attributes", data=np.frombuffer(text.encode(), dtype=np.uint8))
        file.attrs["schema"] = SCHEMA
        file.attrs["checksum"] = _checksum(arrays, text)


def load_checkpoint(path: Path | str) -> tuple[dict[str, dict[str, AnyArray]], dict[str, Any]]:
    """The reverse of ``save_checkpoint``: parts and attributes.

    Raises
    ------
    UnreadableFile
        There is none, it is damaged (its checksum says so), or its schema is not ``SCHEMA``.
    """
    path = Path(path)
    if not path.is_file():
        raise UnreadableFile(f"{path}: no checkpoint, so there is nothing to go on from. {_MEND}")
    try:
        with h5py.File(path, "r") as file:
            _check_schema(path, int(file.attrs.get("schema", 1)))
            arrays = {
                f"parts/{part}/{name}": values[()]
                for part, group in file.get("parts", {}).items()
                for name, values in group.items()
            }
            names = [unquote(part) for part in file.get("parts", ())]
            text = file["attributes"][()].tobytes().decode()
            if file.attrs["checksum"] != _checksum(arrays, text):
                raise OSError("its checksum does not fit")
            attributes = json.loads(text)
    except H5_ERRORS as error:
        raise UnreadableFile(f"{path}: damaged ({error}). {_MEND}") from error
    parts: dict[str, dict[str, AnyArray]] = {name: {} for name in names}
    for place, values in arrays.items():
        _, part, name = place.split("/")
        parts[unquote(part)][unquote(name)] = values
    return parts, attributes


def _check_schema(path: Path, schema: int) -> None:
    if schema != SCHEMA:
        age = "an older" if schema < SCHEMA else "a newer"
        raise UnreadableFile(
            f"{path}: {age} version of the program wrote it (schema {schema}, this one reads "
            f"{SCHEMA}). Go on with that version, or run the scene again with this one: "
            "edt run SCENE -o DIR --force."
        )


def _checksum(arrays: Mapping[str, AnyArray], text: str) -> int:
    total = zlib.crc32(text.encode())
    for name in sorted(arrays):
        values = np.ascontiguousarray(arrays[name])
        total = zlib.crc32(f"{name} {values.dtype} {values.shape}".encode(), total)
        total = zlib.crc32(values.tobytes(), total)
    return total


def _plain_scalar(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"a checkpoint's attributes must be JSON, got {type(value).__name__}")
