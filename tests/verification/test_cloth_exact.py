"""The cloth against exact shapes: errors bounded, orders fitted, at values beyond the listed too.

Bounds are those of the default grids, scaled by the order to the coarser ones used here.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from cloth.flat import disc, strip
from coupling.verify import CaseError, run_case
from coupling.verify.mirrored import MirroredCloth
from coupling.verify.profiles import (
    chain_root,
    hammock_bag,
    lintearia_sheet,
    mylar_balloon,
    natural_balloon,
)
from coupling.verify.sheets import FILM
from coupling.verify.static_level import level_height


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    with threadpool_limits(1):
        yield


def errors(case: str, **options: float) -> dict[str, float]:
    text = {name.replace("_", "-"): str(value) for name, value in options.items()}
    return {quantity.name: quantity.error for quantity in run_case(case, text).quantities}


def order(sizes: list[float], found: list[float]) -> float:
    """Slope of log(error) over log(size)."""
    return float(np.polyfit(np.log(sizes), np.log(found), 1)[0])


def test_formulas_give_the_tabulated_digits():
    """Computed elsewhere, to the digits shown."""
    found = mylar_balloon()
    np.testing.assert_allclose(
        [found.radius, found.thickness, found.volume], [0.762760, 0.913893, 1.218524], atol=6e-7
    )
    bag = {b: (hammock_bag(b).depth, hammock_bag(b).volume) for b in (0.8, 0.6, 0.9)}
    np.testing.assert_allclose(bag[0.8], [0.464506, 0.593111], atol=6e-7)
    np.testing.assert_allclose(bag[0.6], [0.599914, 0.532718], atol=6e-7)
    np.testing.assert_allclose(bag[0.9], [0.342065, 0.513801], atol=6e-7)
    sheet = lintearia_sheet(1.5)
    np.testing.assert_allclose(
        [sheet.sag, sheet.tension, sheet.area], [0.981128, 0.756450, 1.409273], atol=6e-7
    )
    roots = [chain_root(mode) / 2 for mode in (1, 2, 3)]
    np.testing.assert_allclose(roots, [1.202413, 2.760039, 4.326864], atol=6e-7)
    pear = natural_balloon()
    np.testing.assert_allclose(
        [pear.radius, pear.height, pear.volume], [0.327006, 0.643904, 0.126054], atol=6e-7
    )
    assert level_height(0.5) == pytest.approx(0.0, abs=1e-12)
    assert level_height(0.8) == pytest.approx(-level_height(0.2), abs=1e-12)


@pytest.mark.parametrize("case", ["mylar", "balloon"])
def test_inflated_discs(case: str):
    grids = [6, 8, 12]
    found = [errors(case, resolution=n) for n in grids]
    # 0.5 % at 24 rings; the volume is of second order, with its polygons.
    assert max(found[-1].values()) <= 0.005 * (24 / 12) ** 2
    assert max(error for name, error in found[-1].items() if name != "volume") <= 0.003
    assert order([1 / n for n in grids], [e["volume"] for e in found]) >= 1.8


@pytest.mark.parametrize("case", ["mylar", "balloon", "hammock"])
def test_default_grid_of_wrinkled_sheets(case: str):
    assert max(errors(case).values()) <= 0.005


@pytest.mark.parametrize("ratio", [0.3, 0.5, 0.65, 0.8, 0.95])
def test_hammock_at_any_ratio(ratio: float):
    found = errors("hammock", ratio=ratio, resolution=12)
    assert found["depth"] <= 0.005
    assert found["volume"] <= 0.005 * (24 / 12) ** 2


def test_hammock_converges():
    grids = [6, 8, 12, 16]
    found = [errors("hammock", resolution=n) for n in grids]
    sizes = [1 / n for n in grids]
    assert order(sizes, [e["volume"] for e in found]) >= 1.8
    assert order(sizes, [e["depth"] for e in found]) >= 0.8  # of first order, with the penalty's


@pytest.mark.parametrize("length_ratio", [1.02, 1.1, 1.5, 2.0, 4.0])
def test_lintearia_at_any_length(length_ratio: float):
    assert max(errors("lintearia", length_ratio=length_ratio).values()) <= 0.005


def test_lintearia_converges():
    grids = [8, 12, 24, 48]
    found = [errors("lintearia", resolution=n) for n in grids]
    for name, least in (("sag", 1.9), ("area", 1.9), ("tension", 1.5)):
        assert order([1 / n for n in grids], [e[name] for e in found]) >= least
    assert max(found[-1].values()) <= 0.001


@pytest.mark.parametrize(("mode", "step"), [(1, 0.01), (2, 0.005), (3, 0.005)])
def test_chain_frequencies(mode: int, step: float):
    assert errors("chain", mode=mode, step=step)["frequency"] <= 0.01


def test_chain_is_of_second_order_in_time_and_grid():
    """Differences against the finest: either error is what the other leaves."""

    def frequency(step: float, segments: int) -> float:
        options = {"step": str(step), "resolution": str(segments)}
        return run_case("chain", options).quantities[0].computed

    steps = [0.04, 0.02, 0.01]
    coarse, middle, fine = (frequency(step, 24) for step in steps)
    assert 1.7 <= np.log2((middle - coarse) / (fine - middle)) <= 2.3
    omega = 1.2024 * np.sqrt(9.81)
    # backward lowers omega by (omega dt)^2/3.
    assert (fine - middle) / fine == pytest.approx(omega**2 * (0.02**2 - 0.01**2) / 3, rel=0.15)
    # The third mode's error at 12, 24 and 48 segments, whose step errs by (omega dt)^2/3 at each.
    third = [errors("chain", mode=3, step=0.005, resolution=n)["frequency"] for n in (12, 24, 48)]
    in_time = (4.326864 * np.sqrt(9.81) * 0.005) ** 2 / 3
    assert order([1 / 12, 1 / 24, 1 / 48], [e - in_time for e in third]) >= 1.5


@pytest.mark.parametrize("fill_fraction", [0.1, 0.3, 0.5, 0.8, 0.9])
def test_static_level(fill_fraction: float):
    found = run_case("static-level", {"fill-fraction": str(fill_fraction), "resolution": "12"})
    cg, datum, roundness = found.quantities
    assert abs(cg.computed - cg.exact) <= 0.002
    assert abs(datum.computed - datum.exact) <= 0.005
    assert roundness.computed <= 1.01


def test_static_level_at_the_default_grid():
    cg, datum, roundness = run_case("static-level").quantities
    assert abs(cg.computed - cg.exact) <= 1e-4
    assert abs(datum.computed - datum.exact) <= 1e-3
    assert 1.0 < roundness.computed <= 1.002


def test_a_mesh_that_is_no_mirror_image_is_refused():
    mesh = disc(1.0, 3, 7)
    turned = mesh.points[:, [1, 0, 2]]
    with pytest.raises(ValueError, match="mirror image"):
        MirroredCloth(mesh=type(mesh)(**{**vars(mesh), "points": turned}), diaphragm=FILM)
    MirroredCloth(mesh=strip(1.0, 0.2, 6), diaphragm=FILM)


@pytest.mark.parametrize(
    ("case", "option", "value"),
    [
        ("hammock", "ratio", "1.2"),
        ("lintearia", "length-ratio", "0.9"),
        ("chain", "step", "1"),
        ("chain", "mode", "0"),
        ("static-level", "fill-fraction", "1"),
        ("mylar", "resolution", "1"),
    ],
)
def test_values_out_of_range_are_refused(case: str, option: str, value: str):
    with pytest.raises(CaseError, match=f"verify {case}: --{option}: must lie in"):
        run_case(case, {option: value})
