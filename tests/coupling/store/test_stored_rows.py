"""Arrays that stay on the disk are those that are read at once."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import known_run as run
import numpy as np
import pytest

from coupling.ports import Array
from coupling.report.files import RunFiles, pressure_rms
from coupling.store import stored_rows
from coupling.store.results import Results, open_results, read_results
from coupling.store.stored_rows import StoredRows, blocks


@pytest.fixture
def both(tmp_path: Path) -> tuple[Results, Results]:
    """The same results, on the disk and in memory."""
    run.write_run(tmp_path, periods=1.0)
    return open_results(tmp_path), read_results(tmp_path)


def test_all_that_is_over_nodes_and_time_stays_on_the_disk(both: tuple[Results, Results]) -> None:
    stored, read = both
    kept = {
        name.name for name in fields(stored) if isinstance(getattr(stored, name.name), StoredRows)
    }
    large = {name for name, values in vars(read).items() if getattr(values, "size", 0) > 1000}
    assert large - {"triangles", "reference"} <= kept
    for name in kept:
        assert np.array_equal(getattr(stored, name), getattr(read, name)), name


@pytest.mark.parametrize("key", [0, -1, slice(1, 4), [3, 1, 1], np.array([2, 0]), (slice(None), 5)])
def test_rows_are_read_by_number_slice_and_list(both: tuple[Results, Results], key: object) -> None:
    stored, read = both
    assert np.array_equal(stored.position[key], read.position[key])


def test_blocks_are_all_rows_once(
    both: tuple[Results, Results], monkeypatch: pytest.MonkeyPatch
) -> None:
    stored, read = both
    monkeypatch.setattr(stored_rows, "BLOCK_BYTES", 3 * read.position[0].nbytes)
    found = list(blocks(stored.position))
    assert {len(part) for (part,) in found[:-1]} == {3}
    assert np.array_equal(np.concatenate([part for (part,) in found]), read.position)


def test_a_figure_over_time_does_not_depend_on_the_blocks(
    both: tuple[Results, Results], monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the last bit: every instant's sum is taken by itself."""

    def curves(results: Results) -> tuple[Array, Array]:
        return pressure_rms(
            RunFiles(
                folder=Path(), scene=run.scene(), results=results, summary={},
                iterations=np.zeros((0, 4)),
            )
        )  # fmt: skip

    whole = curves(both[1])
    assert whole[0].max() > 0.0
    monkeypatch.setattr(stored_rows, "BLOCK_BYTES", 1)
    assert np.array_equal(curves(both[0]), whole)
