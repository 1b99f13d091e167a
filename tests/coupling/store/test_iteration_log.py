"""coupling.csv: on the disk at once, cut at the checkpoint, torn lines survive nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from coupling.store.iteration_log import IterationLog, read_iterations


def test_lines_are_on_the_disk_before_the_log_is_closed(tmp_path: Path) -> None:
    log = IterationLog(tmp_path)
    log.write(0.005, 1, 0.5, 0.01)
    log.write(0.005, 2, 1.25e-5, 0.02)
    text = (tmp_path / "coupling.csv").read_text()
    assert text.splitlines()[0] == "time,iteration,residual,seconds"
    rows = read_iterations(tmp_path)
    assert np.array_equal(rows, [[0.005, 1, 0.5, 0.01], [0.005, 2, 1.25e-5, 0.02]])
    log.close()


def test_resume_drops_later_and_torn_lines_and_keeps_one_header(tmp_path: Path) -> None:
    log = IterationLog(tmp_path)
    for step in range(1, 5):
        log.write(0.1 * step, 1, 0.1, 0.0)
    log.close()
    with (tmp_path / "coupling.csv").open("a") as file:
        file.write("0.1,2,0.")
        file.write("\n0.1,2")
    again = IterationLog.resume(tmp_path, until=0.1 * 3)
    again.write(0.4, 1, 0.2, 0.0)
    again.close()
    assert (tmp_path / "coupling.csv").read_text().count("time") == 1
    assert read_iterations(tmp_path)[:, 0].tolist() == [0.1, 0.2, 0.3, 0.4]


def test_no_file_gives_no_rows(tmp_path: Path) -> None:
    assert read_iterations(tmp_path).shape == (0, 4)
