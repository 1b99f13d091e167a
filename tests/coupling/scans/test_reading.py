"""Scans as scanners write them: points of a PLY, an STL, an OBJ, with faces or without."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
import scanned_sheets as sheets

from coupling.scans.errors import ScanError
from coupling.scans.reading import check_size, read_scan


def ordered(points: np.ndarray) -> np.ndarray:
    return np.unique(points, axis=0)


@pytest.mark.parametrize("name", ["cloud.ply", "cloud.obj", "faces.ply", "faces.obj", "faces.STL"])
def test_every_format_gives_each_point_once_in_metres(tmp_path: Path, name: str) -> None:
    """To single precision, which an STL has; ``meshio`` writes what is read here."""
    sheet, path = sheets.bowl(), tmp_path / name
    faces = [("triangle", sheet.triangles.astype(np.int32))] if "faces" in name else []
    meshio.Mesh(sheet.nodes / 0.0254, faces).write(path, file_format=path.suffix[1:].lower())
    found = read_scan(path, "in")
    assert len(found) == len(sheet.nodes)
    assert ordered(found.round(6)) == pytest.approx(ordered(sheet.nodes.round(6)), abs=2e-6)


def test_a_ply_with_colours_and_no_faces_and_a_textured_obj_are_read(tmp_path: Path) -> None:
    """The second is no input of ``meshio``: it has more points than texture coordinates."""
    places = np.random.default_rng(0).random((120, 3)).round(6)
    rows = "".join(f"{x} {y} {z} 255 0 0\n" for x, y, z in places)
    head = "ply\nformat ascii 1.0\nelement vertex 120\n"
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    colours = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
    none = "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "a.ply").write_text(head + axes + colours + none + rows)
    points = "".join(f"v {x} {y} {z} 1 0 0\n" for x, y, z in places)
    (tmp_path / "a.obj").write_text(
        f"mtllib a.mtl\n{points}vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
    )
    for name in ("a.ply", "a.obj"):
        assert ordered(read_scan(tmp_path / name, "m")) == pytest.approx(ordered(places), abs=1e-7)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.xyz", b"1 2 3", "must end in .ply, .stl, .obj"),
        ("a.ply", b"hello", "cannot be read as PLY: Expected ply"),
        ("a.ply", b"", "cannot be read as PLY"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 9\n", "cannot be read as PLY"),
        ("a.stl", b"no scan\n" * 40, "cannot be read as STL"),
        ("a.stl", b"solid a\nendsolid a\n", "has 0 different points, and 100 are needed"),
        ("a.obj", b"", "has 0 different points"),
        ("a.obj", b"v 1 2\n" * 9, "cannot be read as OBJ"),
        ("a.obj", b"v 1 2 x\n", "cannot be read as OBJ"),
        ("a.obj", b"v 1 2 nan\n" * 200, "points that are not finite: 200"),
        ("a.obj", b"v 1 2 3\n" * 200, "has 1 different points"),
    ],
)
def test_what_is_no_scan_is_said(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ScanError) as caught:
        read_scan(tmp_path / name, "mm")
    assert message in str(caught.value)
    assert str(tmp_path / name) in str(caught.value)


def test_a_scan_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(ScanError, match="no such file"):
        read_scan(tmp_path / "a.ply", "mm")


def test_a_wrong_unit_is_pointed_at() -> None:
    """Millimetres as metres, metres as millimetres, inches as millimetres; a tenth is a part."""
    nodes, name = sheets.bowl().nodes, Path("a.ply")
    for factor, unit, better in ((1e3, "m", "mm"), (1e-3, "mm", "m"), (1 / 25.4, "mm", "in")):
        with pytest.raises(ScanError, match=f"Is --unit {better} meant"):
            check_size(factor * nodes, nodes, name, unit)
    check_size(0.1 * nodes, nodes, name, "m")
    check_size(nodes, nodes, name, "mm")
    with pytest.raises(ScanError, match="Look at the scan's unit"):
        check_size(4.0 * nodes, nodes, name, "m")
