"""Surfaces as other programs read them."""

from __future__ import annotations

from pathlib import Path

import known_run as run
import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.store.results import open_results, read_results
from coupling.store.surface import NoInstantError, write_surface


def exported(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["export", *words])
    return done.exit_code, done.output


def test_a_ply_has_the_nodes_and_what_they_carry(tmp_path: Path) -> None:
    """To the last bit, at the nearest instant of 0.02 s."""
    run.write_run(tmp_path)
    results, path = read_results(tmp_path), tmp_path / "shape.ply"
    assert write_surface(open_results(tmp_path), path, 0.407) == results.time[20]
    read = meshio.read(path)
    assert np.array_equal(read.points, results.position[20])
    assert np.array_equal(read.cells_dict["triangle"], results.triangles)
    assert np.array_equal(read.point_data["shell_work"], results.shell_work[20])
    assert set(read.point_data) >= {"pressure", "self_slip"}


def test_an_stl_has_the_triangles_in_single_precision(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    results, path = read_results(tmp_path), tmp_path / "shape.stl"
    code, said = exported(str(tmp_path), "-o", str(path))
    assert code == 0
    assert f"at {results.time[-1]:.6g} s" in said
    read = meshio.read(path)
    corners = read.points[read.cells_dict["triangle"]]
    wanted = results.position[-1][results.triangles]
    assert corners == pytest.approx(wanted, abs=1e-7 * run.RADIUS)


def test_what_cannot_be_exported_is_said_and_leaves_nothing(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    for words, message in (
        (["-o", str(tmp_path / "a.obj")], "must end in .ply, .stl, .vtkhdf"),
        (["-o", str(tmp_path / "a.ply"), "--time", "9"], "has instants from 0 to 2.4 s, got 9"),
        (["-o", str(tmp_path / "a.ply"), "--time", "nan"], "got nan"),
        (["-o", str(tmp_path / "a.vtkhdf"), "--time", "1"], "holds all instants. Leave it out"),
    ):
        code, said = exported(str(tmp_path), *words)
        assert code == 2
        assert message in said
    assert not list(tmp_path.glob("*a.*"))
    assert exported(str(tmp_path / "none"), "-o", str(tmp_path / "a.ply"))[0] == 2
    with pytest.raises(NoInstantError, match="no instant was written"):
        write_surface(_empty(tmp_path / "empty"), tmp_path / "a.ply")


def _empty(folder: Path):
    folder.mkdir()
    reference, triangles = run.disc()
    run.ResultsWriter.create(
        folder, scene_toml="", model="m", reference=reference, triangles=triangles
    ).close()
    return read_results(folder)
