"""OpenFOAM's binary files: points and fields in, cell values out.

Only what the coupler exchanges: ``polyMesh`` in ASCII or binary, and the internal values of
``volScalarField`` and ``volVectorField`` as a solver of 64-bit reals and 32-bit labels writes them.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from coupling.foam.process import OpenFoamFailed
from coupling.ports import Array, Cause, Ints

_INTERNAL = re.compile(rb"internalField\s+(uniform|nonuniform)\s*")
_COUNT = re.compile(rb"List<(scalar|vector)>\s*\n?(\d+)\s*\n?\(")

_LIST = re.compile(rb"\n(\d+)\s*\n?\(")


def header(kind: str, name: str, location: str, *, binary: bool) -> str:
    """The FoamFile header of a ``kind`` called ``name``."""
    arch = '    arch        "LSB;label=32;scalar=64";\n' if binary else ""
    form = "binary" if binary else "ascii"
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      {form};\n{arch}"
        f'    class       {kind};\n    location    "{location}";\n    object      {name};\n}}\n\n'
    )


def write_points(path: Path, points: Array) -> None:
    """``points`` (P, 3) [m] as a binary ``vectorField``."""
    head = header("vectorField", path.name, path.parent.name, binary=True)
    body = np.ascontiguousarray(points, dtype="<f8").tobytes()
    path.write_bytes(head.encode() + f"\n{len(points)}\n(".encode() + body + b")\n")


def read_points(path: Path) -> Array:
    """Points (P, 3) [m] of a binary ``vectorField``, bit for bit as they were written.

    Raises ``OpenFoamFailed`` where the file is missing or shorter than it says.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise OpenFoamFailed(f"{path}: no points here ({error.strerror}).") from error
    start = _LIST.search(data)
    if start is None or len(data) < start.end() + 24 * int(start[1]):
        raise OpenFoamFailed(f"{path}: expected points, complete and binary.")
    values = np.frombuffer(data, "<f8", 3 * int(start[1]), start.end())
    return values.astype(float).reshape(-1, 3)


def read_cells(path: Path, cells: int) -> Array:
    """Internal values of a field: (cells,) of a scalar, (cells, 3) of a vector.

    Raises ``OpenFoamFailed`` where the file is missing, broken or holds what is not finite.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        reason = f"the solver left no such field ({error.strerror})"
        raise OpenFoamFailed(f"{path}: {reason}.") from error
    found = _INTERNAL.search(data)
    if found is None:
        raise OpenFoamFailed(f"{path}: no internalField in this file.")
    values = _uniform(data, found, cells) if found[1] == b"uniform" else _list(data, found, cells)
    if values is None:
        raise OpenFoamFailed(f"{path}: expected the values of {cells} cells.")
    if not np.isfinite(values).all():
        raise OpenFoamFailed(f"{path}: the flow diverged, it is not finite.", cause=Cause.FLOW)
    return values


def _uniform(data: bytes, found: re.Match[bytes], cells: int) -> Array | None:
    text = data[found.end() :].split(b";", 1)[0].strip(b"() \n")
    try:
        value = np.array([float(part) for part in text.split()])
    except ValueError:
        return None
    if len(value) not in (1, 3):
        return None
    return np.tile(value, (cells, 1)) if len(value) == 3 else np.full(cells, value[0])


def _list(data: bytes, found: re.Match[bytes], cells: int) -> Array | None:
    start = _COUNT.match(data, found.end())
    if start is None or int(start[2]) != cells:
        return None
    width = 3 if start[1] == b"vector" else 1
    if len(data) < start.end() + 8 * cells * width:
        return None
    values = np.frombuffer(data, "<f8", cells * width, start.end()).astype(float)
    return values.reshape(cells, 3) if width == 3 else values


def read_labels(path: Path) -> Ints:
    """Labels (k,) of a ``labelList``, ASCII or binary with 32 bits each.

    Raises ``OpenFoamFailed`` where the file is missing or broken.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise OpenFoamFailed(f"{path}: no labels here ({error.strerror}).") from error
    start = _LIST.search(data)
    if start is not None and b"binary" in data[: start.start()]:
        if len(data) >= start.end() + 4 * int(start[1]):
            return np.frombuffer(data, "<i4", int(start[1]), start.end()).astype(np.int64)
    elif start is not None:
        words = data[start.end() :].split(b")", 1)[0].split()
        if len(words) == int(start[1]):
            return np.array(words, dtype=np.int64)
    raise OpenFoamFailed(f"{path}: expected a complete list of labels.")


def write_faces(path: Path, faces: Ints) -> None:
    """``faces`` (F, 4) as an ASCII ``faceList``."""
    lines = "\n".join(f"4({a} {b} {c} {d})" for a, b, c, d in faces.tolist())
    path.write_text(
        header("faceList", path.name, "constant/polyMesh", binary=False)
        + f"{len(faces)}\n(\n{lines}\n)\n"
    )


def write_labels(path: Path, labels: Ints, note: str) -> None:
    """``labels`` (k,) as an ASCII ``labelList`` whose header carries ``note``."""
    head = header("labelList", path.name, "constant/polyMesh", binary=False)
    head = head.replace("    object", f'    note        "{note}";\n    object')
    lines = "\n".join(map(str, labels.tolist()))
    path.write_text(head + f"{len(labels)}\n(\n{lines}\n)\n", encoding="utf-8")
