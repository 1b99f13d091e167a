"""Which points and cells each processor has, and values put together from them."""

import math

import numpy as np
import pytest

from coupling.foam.fields import header, read_labels
from coupling.foam.parts import Part, cuts, decomposed, gathered, whole
from coupling.foam.process import OpenFoamFailed


@pytest.mark.parametrize(
    ("processors", "expected"),
    [
        (1, (1, 1, 1)),
        (2, (2, 1, 1)),
        (4, (2, 2, 1)),
        (8, (2, 2, 2)),
        (12, (3, 2, 2)),
        (7, (7, 1, 1)),
    ],
)
def test_cuts(processors, expected):
    assert cuts(processors) == expected


def test_cuts_always_make_the_number_asked_for():
    for processors in range(1, 65):
        assert math.prod(cuts(processors)) == processors


def write_labels(path, labels, *, binary):
    head = header("labelList", path.name, "constant/polyMesh", binary=binary)
    path.parent.mkdir(parents=True, exist_ok=True)
    if binary:
        body = np.asarray(labels, "<i4").tobytes() + b")\n"
        path.write_bytes(head.encode() + f"\n{len(labels)}\n(".encode() + body)
    else:
        path.write_text(head + f"\n{len(labels)}\n(\n" + "\n".join(map(str, labels)) + "\n)\n")


@pytest.mark.parametrize("binary", [False, True])
def test_labels(tmp_path, binary):
    # 10 and 41 are the bytes of a line's end and of a bracket.
    labels = [0, 10, 41, 2**31 - 1, 2_000_000]
    write_labels(tmp_path / "labels", labels, binary=binary)
    assert read_labels(tmp_path / "labels").tolist() == labels


@pytest.mark.parametrize("binary", [False, True])
def test_broken_labels_are_named(tmp_path, binary):
    path = tmp_path / "labels"
    with pytest.raises(OpenFoamFailed, match="no labels here"):
        read_labels(path)
    write_labels(path, list(range(100)), binary=binary)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(OpenFoamFailed, match="expected a complete list"):
        read_labels(path)


def test_values_go_out_and_come_back(tmp_path):
    cells = [np.array([3, 0, 4]), np.array([1, 2])]
    for rank, own in enumerate(cells):
        for kind in ("point", "cell"):
            path = tmp_path / f"processor{rank}" / "constant" / "polyMesh"
            write_labels(path / f"{kind}ProcAddressing", own, binary=True)
        # Counted from 1, negative where turned round; of the whole mesh 3 are inner.
        faces = np.array([1, -3, 5, 8] if rank == 0 else [2, 3, 7, 4, 6])
        write_labels(path / "faceProcAddressing", faces, binary=True)
    parts = decomposed(tmp_path, 2, 3)
    assert [part.walls.tolist() for part in parts] == [[1, 4], [3, 0, 2]]
    assert [part.name for part in parts] == ["processor0", "processor1"]
    values = np.arange(15.0).reshape(5, 3)
    assert (gathered(parts, [values[part.cells] for part in parts]) == values).all()
    assert (gathered(parts, [values[part.cells, 1] for part in parts]) == values[:, 1]).all()
    with pytest.raises(OpenFoamFailed, match="processor2"):
        decomposed(tmp_path, 3, 3)


def test_case_that_is_not_decomposed_is_one_part(tmp_path):
    (part,) = whole(tmp_path)
    assert isinstance(part, Part)
    values = np.arange(4.0)
    assert gathered([part], [values]) is values
    assert (values[part.points] == values).all()
