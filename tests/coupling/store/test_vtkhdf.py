"""The diaphragm at all instants as ParaView's own reader finds it."""

from __future__ import annotations

from pathlib import Path

import known_run as run
import numpy as np
import pytest
from typer.testing import CliRunner
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from coupling.cli.main import app
from coupling.store import stored_rows
from coupling.store.results import read_results
from coupling.store.vtkhdf import AT_NODES, AT_TRIANGLES


def test_vtk_reads_every_instant_to_the_last_bit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows written in blocks of a few, read in another order than they were written."""
    monkeypatch.setattr(stored_rows, "BLOCK_BYTES", 20000)
    run.write_run(tmp_path)
    results, path = read_results(tmp_path), tmp_path / "moving.vtkhdf"
    done = CliRunner().invoke(app, ["export", str(tmp_path), "-o", str(path)])
    assert done.exit_code == 0, done.output
    assert f"{len(results.time)} instants, 0 to {results.time[-1]:.6g} s" in done.output
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert np.array_equal(times, results.time)
    for row in (20, len(times) - 1, 0):
        reader.UpdateTimeStep(times[row])
        grid = reader.GetOutput()
        assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), results.position[row])
        corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
        assert np.array_equal(corners, results.triangles)
        for data, names in ((grid.GetPointData(), AT_NODES), (grid.GetCellData(), AT_TRIANGLES)):
            for name in names:
                read, written = vtk_to_numpy(data.GetArray(name)), getattr(results, name)[row]
                assert np.array_equal(read, written, equal_nan=True), name
