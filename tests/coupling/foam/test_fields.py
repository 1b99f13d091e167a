"""OpenFOAM's files: what is written reads back, what is broken is said."""

import numpy as np
import pytest

from coupling.foam.fields import (
    header,
    read_cells,
    read_points,
    write_faces,
    write_labels,
    write_points,
)
from coupling.foam.process import OpenFoamFailed

VALUES = np.random.default_rng(0).normal(size=(5, 3))


def field(kind, values, count=None):
    """A binary field as OpenFOAM writes it."""
    name = "volVectorField" if kind == "vector" else "volScalarField"
    body = np.ascontiguousarray(values, "<f8").tobytes()
    head = header(name, "x", "0.1", binary=True) + "dimensions [0 2 -2 0 0 0 0];\n\n"
    count = len(values) if count is None else count
    head += f"internalField   nonuniform List<{kind}> \n{count}\n("
    return head.encode() + body + b")\n;\n\nboundaryField\n{\n}\n"


def test_points_round_trip_bit_for_bit(tmp_path):
    values = np.concatenate([VALUES, [[np.pi, -0.0, 1e-300]]])
    write_points(tmp_path / "points", values)
    assert read_points(tmp_path / "points").tobytes() == values.tobytes()


def test_truncated_points_are_refused(tmp_path):
    path = tmp_path / "points"
    write_points(path, VALUES)
    path.write_bytes(path.read_bytes()[:-10])
    with pytest.raises(OpenFoamFailed, match="complete and binary"):
        read_points(path)
    with pytest.raises(OpenFoamFailed, match="no points here"):
        read_points(tmp_path / "none")


@pytest.mark.parametrize(("kind", "values"), [("vector", VALUES), ("scalar", VALUES[:, 0])])
def test_binary_fields(tmp_path, kind, values):
    path = tmp_path / "U"
    path.write_bytes(field(kind, values))
    assert (read_cells(path, 5) == values).all()


def test_bytes_that_look_like_text_do_not_confuse(tmp_path):
    # 8 bytes of ");\n(1 2 " as a number: the values are counted, not searched.
    values = np.frombuffer(b");\n(1 2 " * 15, "<f8").reshape(5, 3)
    (tmp_path / "U").write_bytes(field("vector", values))
    assert (read_cells(tmp_path / "U", 5) == values).all()


@pytest.mark.parametrize(
    ("text", "expected"),
    [("uniform 2.5", np.full(4, 2.5)), ("uniform (1 -2 3e-1)", np.tile([1, -2, 0.3], (4, 1)))],
)
def test_uniform_fields(tmp_path, text, expected):
    (tmp_path / "p").write_text(f"internalField   {text};\n")
    assert (read_cells(tmp_path / "p", 4) == expected).all()


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"rubbish",
        b"internalField uniform rubbish;",
        b"internalField uniform (1 2);",
        b"internalField uniform",
        b"internalField nonuniform List<scalar> ",
        field("vector", VALUES)[:-80],
        field("vector", VALUES, count=4),
        field("vector", VALUES, count=6),
        field("tensor", VALUES),
    ],
    ids=lambda content: f"{len(content)} bytes",
)
def test_broken_fields_are_refused(tmp_path, content):
    (tmp_path / "U").write_bytes(content)
    with pytest.raises(OpenFoamFailed, match=r"U: "):
        read_cells(tmp_path / "U", 5)


def test_every_cut_of_a_field_is_refused(tmp_path):
    whole, path = field("scalar", VALUES[:, 0]), tmp_path / "p"
    end = whole.index(b")\n;")
    for length in range(end):
        path.write_bytes(whole[:length])
        with pytest.raises(OpenFoamFailed):
            read_cells(path, 5)


def test_missing_field_is_refused(tmp_path):
    with pytest.raises(OpenFoamFailed, match="left no such field"):
        read_cells(tmp_path / "p", 5)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_diverged_field_is_refused(tmp_path, bad):
    values = VALUES.copy()
    values[3, 1] = bad
    (tmp_path / "U").write_bytes(field("vector", values))
    with pytest.raises(OpenFoamFailed, match="diverged"):
        read_cells(tmp_path / "U", 5)


def test_labels_and_faces_read_back_through_pyfoam(tmp_path):
    from PyFoam.RunDictionary.ParsedParameterFile import ParsedParameterFile

    faces = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
    write_faces(tmp_path / "faces", faces)
    write_labels(tmp_path / "owner", np.array([3, 1, 2]), "nCells:4")
    text = (tmp_path / "faces").read_text().split("}\n", 1)[1].split()
    assert text[:3] == ["2", "(", "4(0"]
    parsed = ParsedParameterFile(str(tmp_path / "owner"), listDictWithHeader=True)
    assert list(parsed.content) == [3, 1, 2]
    assert parsed.header["note"] == '"nCells:4"'
