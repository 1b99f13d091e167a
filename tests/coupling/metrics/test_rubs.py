"""Slips against values by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import known_run as run
import numpy as np
import pytest

from coupling.metrics.rubs import rub, rub_summary
from coupling.metrics.summary import summarise
from coupling.store.results import read_results

# two equal triangles between x, y, -x and the pole, which share the edge from y to the pole
REFERENCE = np.array([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
TRIANGLES = np.array([[0, 1, 3], [1, 2, 3]])


def test_the_mean_is_that_of_the_moulded_area() -> None:
    """The pole and y count for two sixths of the area each, x and -x for one."""
    found = rub(np.array([0.0, 0.0, 0.003, 0.012]), REFERENCE, TRIANGLES, 0.0)
    assert found is not None
    assert found.largest == 0.012
    assert found.mean == pytest.approx((0.003 + 2.0 * 0.012) / 6.0)


def test_a_larger_triangle_counts_for_more() -> None:
    """Areas 2 and 6: a corner counts for a third of its own triangle, over the whole of 8."""
    flat = np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0], [-6.0, 0.0, 1.0]])
    pair = np.array([[0, 1, 2], [0, 2, 3]])
    small = rub(np.array([0.0, 0.1, 0.0, 0.0]), flat, pair, 0.0)
    large = rub(np.array([0.0, 0.0, 0.0, 0.1]), flat, pair, 0.0)
    assert small is not None
    assert large is not None
    assert small.mean == pytest.approx(0.1 * (2.0 / 3.0) / 8.0)
    assert large.mean == pytest.approx(0.1 * (6.0 / 3.0) / 8.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("direction", "place"),
    [
        ([0.0, 0.0, 1.0], (0.0, 0.0)),
        ([1.0, 0.0, 0.0], (90.0, 0.0)),
        ([1.0, -1e-16, 0.0], (90.0, 0.0)),  # not 360
        ([0.0, -1.0, 1.0], (45.0, 270.0)),
        ([-np.sqrt(0.375), np.sqrt(0.375), 0.5], (60.0, 135.0)),
    ],
)
def test_the_place_is_told_from_the_moulded_pole(
    direction: list[float], place: tuple[float, float], side: float
) -> None:
    points = np.array([*REFERENCE, 2.0 * np.array(direction)]) * [1.0, 1.0, side]
    found = rub(np.array([0.0, 0.0, 0.0, 0.001, 0.002]), points, TRIANGLES, 0.0)
    assert found is not None
    assert found.place == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize("slip", [0.0, 0.9e-6, np.nan])
def test_what_has_not_slid_has_no_figures(slip: float) -> None:
    assert rub(np.full(4, slip), REFERENCE, TRIANGLES, 1e-6) is None
    assert rub(np.full(4, 1.1e-6), REFERENCE, TRIANGLES, 1e-6) is not None


def test_the_summary_tells_what_has_gathered_at_the_end(tmp_path: Path) -> None:
    """The known run slips 10 mm a second everywhere for 2.4 s, and nowhere on itself."""
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    stated = summarise(results, run.statistics(), run.scene(), "completed", None)["rubbing"]
    assert stated["shell_slip_max_m"] == pytest.approx(0.024)
    assert stated["shell_slip_mean_m"] == pytest.approx(0.024)
    assert stated["self_slip_max_m"] is None
    slid = results.self_slip.copy()
    slid[-1, 5], slid[0, 7] = 0.004, 0.1
    swapped = replace(results, self_slip=results.shell_slip * 0.0 + slid, shell_slip=slid)
    stated = summarise(swapped, run.statistics(), run.scene(), "completed", None)["rubbing"]
    x, y, _ = results.reference[5]
    assert stated["self_slip_max_m"] == 0.004
    assert stated["shell_slip_place_deg"] == pytest.approx(
        [np.degrees(np.arcsin(np.hypot(x, y) / run.RADIUS)), np.degrees(np.arctan2(y, x)) % 360]
    )


def test_nothing_slid_and_nothing_computed_are_null(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    still = replace(results, shell_slip=0.0 * results.shell_slip)
    names = {"shell_slip_max_m", "shell_slip_mean_m", "shell_slip_place_deg", "self_slip_max_m"}
    stated = summarise(still, run.statistics(), run.scene(), "completed", None)["rubbing"]
    assert stated == dict.fromkeys(names)


def test_works_tell_their_place_on_the_shell_and_what_they_wear_off(tmp_path: Path) -> None:
    """800 Pa over 24 mm; one node has rubbed twice as much, 60 degrees above the rim, at y."""
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    work, place = results.shell_work.copy(), results.rub_place.copy()
    work[-1, 7] *= 2.0
    place[-1, 7] = run.RADIUS * np.array([0.0, 0.5, np.sqrt(0.75)])
    found = rub_summary(replace(results, shell_work=work, rub_place=place), (1e-9, 4e-9))
    most = 2.0 * run.PRESSURE * 0.024
    assert found["shell_work_max_J_per_m2"] == pytest.approx(most)
    assert found["shell_rubbing_pressure_Pa"] == pytest.approx(2.0 * run.PRESSURE)
    assert found["shell_work_on_shell_deg"] == pytest.approx([150.0, 90.0])
    assert found["shell_work_place_deg"] != found["shell_slip_place_deg"]
    assert found["shell_wear_max_m"] == pytest.approx([1e-9 * most, 4e-9 * most])
    assert {value for name, value in found.items() if name.startswith("self")} == {None}


def test_works_that_an_older_file_does_not_hold_are_null(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    with h5py.File(tmp_path / "results.h5", "a") as file:
        for dataset in ("shell_work", "self_work", "rub_place", "velocity"):
            del file[f"diaphragm/{dataset}"]
    results = read_results(tmp_path)
    assert np.isnan(results.velocity).all()
    assert results.velocity.shape == results.position.shape
    found = rub_summary(results, (1e-9, 4e-9))
    assert found["shell_slip_max_m"] == pytest.approx(0.024)
    assert found["shell_work_max_J_per_m2"] is found["shell_wear_max_m"] is None
