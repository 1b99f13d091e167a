"""Estimated errors of the fluid models: the fit, and what the data that come with it say."""

from dataclasses import replace

import numpy as np
import pytest

from coupling.estimate.model_errors import (
    SHARE,
    Measured,
    choose,
    coordinates,
    estimates,
    fit_errors,
    ladder,
)
from coupling.fluids.model import DAMPING, inertia_left_out, inertia_wrong
from coupling.fluids.openfoam.model import ORDER
from coupling.scene.scene import scene_from


def measured(error, *, noise=0.0, count=60):
    """Rows on random places with the errors ``error(f/f1, a/g, FF)``, log-normally disturbed."""
    random = np.random.default_rng(1)
    rows = []
    for _ in range(count):
        ratio, acceleration = 10.0 ** random.uniform(-1.0, 0.6), 10.0 ** random.uniform(-2.0, 0.0)
        fill = random.uniform(0.2, 0.9)
        place = coordinates(
            frequency_ratio=ratio, acceleration_ratio=acceleration, fill_fraction=fill
        )
        value = error(ratio, acceleration, fill) * 10.0 ** (noise * random.standard_normal())
        rows.append(Measured(model="m", reference="r", coordinates=place, error=value))
    return rows


def test_a_power_law_is_found_exactly():
    law = inertia_wrong
    rows = measured(lambda r, a, f: 0.3 * law(r) * r**0.5 / (1.0 + a) * 10.0 ** (0.2 * f))
    fit = fit_errors(rows, law)
    place = coordinates(frequency_ratio=0.5, acceleration_ratio=0.1, fill_fraction=0.6)
    one = fit.at(place)
    # a least squares solution of a well-conditioned system: rounding alone
    found = 0.3 * law(0.5) * 0.5**0.5 / 1.1 * 10.0**0.12
    assert one.expected == pytest.approx(found, rel=1e-9)
    assert one.upper == pytest.approx(one.expected, rel=1e-9)
    assert one.outside == ()


def test_nine_in_ten_lie_below_the_upper_bound():
    rows = measured(lambda r, a, f: r**2, noise=0.1, count=400)
    fit = fit_errors(rows[:200], inertia_left_out)
    below = sum(row.error <= fit.at(row.coordinates).upper for row in rows[200:])
    # binomial: 180 expected of 200, four standard deviations are 17
    assert abs(below - 180) <= 17
    # the normal distribution's nine in ten: 1.2816 of its deviations. Of 200 samples that quantile
    # deviates by sqrt(0.9 0.1/200)/0.1755 = 0.12 deviations
    assert pytest.approx(0.9) == SHARE
    assert np.quantile(fit.missed, SHARE) == pytest.approx(0.12816, abs=4 * 0.012)


def test_the_degree_is_the_one_that_the_data_ask_for():
    def degree(error, count):
        return fit_errors(measured(error, noise=0.1, count=count), inertia_left_out).powers.max()

    # a power that is off by one misses by 0.46, the deviation of log10 r here: 4.6 times the noise
    assert degree(lambda r, a, f: r**3, 60) == 1
    assert degree(lambda r, a, f: r**2 * 10.0 ** np.log10(r) ** 2, 60) == 2
    assert degree(lambda r, a, f: r**2, 8) == 0


def test_a_row_that_no_other_supports_chooses_no_fit():
    rows = measured(lambda r, a, f: r**2, noise=0.1, count=8)
    gentle = [replace(row, coordinates=row.coordinates * [1, 0, 1] - [0, 1, 0]) for row in rows]
    hard = replace(gentle[0], coordinates=gentle[0].coordinates + np.array([0, 1, 0]), error=0.5)
    fit = fit_errors([*gentle, hard], inertia_left_out)
    # the only row at another acceleration: a slope through it would never miss it
    assert fit.powers.max() == 0
    assert np.isfinite(fit.missed).all()


def test_beyond_the_data_their_edge_speaks():
    fit = fit_errors(measured(lambda r, a, f: r**2), inertia_left_out)
    far = fit.at(coordinates(frequency_ratio=1e-3, acceleration_ratio=0.1, fill_fraction=0.5))
    edge = fit.low.copy()
    edge[1:] = np.log10(1.1), 0.5
    assert far.outside == ("f/f1",)
    assert far.expected == fit.at(edge).expected


def test_too_few_rows_are_refused():
    with pytest.raises(ValueError, match=r"six rows or more, got 5"):
        fit_errors(measured(lambda r, a, f: r**2, count=5), inertia_left_out)


def scene(**sections):
    base = {
        "tank": {"radius": 0.4445},
        "diaphragm": {"thickness": 0.001778, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.5},
        "motion": {"kind": "sine", "frequency": 0.1, "acceleration": 0.981},
        "model": {"fluid": "auto"},
        "time": {"periods": 3.0, "steps_per_period": 60},
    }
    return scene_from(base | sections)


def test_slow_shaking_is_hydrostatic_and_fast_shaking_is_not():
    slow = choose(scene())
    assert slow.fluid == "hydrostatic"
    # (f/f1)^2 is 0.012 there, and 1.3 at 1.05 Hz
    assert 0.003 < slow.estimates["hydrostatic"].expected < 0.05
    fast = choose(scene(motion={"kind": "sine", "frequency": 1.05, "acceleration": 0.981}))
    assert fast.estimates["hydrostatic"].expected > 0.3
    assert fast.fluid != "hydrostatic"


def test_a_tank_at_rest_is_hydrostatic():
    still = choose(scene(motion={"kind": "rest"}, time={"duration": 1.0}))
    assert still.fluid == "hydrostatic"
    assert all(one.upper == 0.0 for one in still.estimates.values())


@pytest.mark.parametrize("cells", [1300, 10**6])
def test_where_none_is_good_enough_the_best_without_a_mesh_is_taken_and_said_so(cells):
    choice = choose(scene(model={"fluid": "auto", "tolerance": 1e-5}, openfoam={"cells": cells}))
    assert choice.fluid == "potential"
    assert choice.estimates["potential"].upper < choice.estimates["hydrostatic"].upper
    assert choice.reason.startswith(
        "no model without a mesh keeps 1e-05 in nine scenes of ten; potential errs least: "
    )
    assert "taken" not in choice.reason  # a check takes none


def test_finer_cells_lower_the_error_of_openfoam():
    coarse, fine = (estimates(scene(openfoam={"cells": n}))["openfoam"] for n in (1300, 10400))
    # the meshes have 1216 and 9728 cells, eight times as many of half the width
    assert fine.expected == pytest.approx(coarse.expected / 2.0**ORDER, rel=1e-12)
    assert set(ladder()) == set(estimates(scene()))


def test_laws_are_those_of_a_mass_on_a_spring():
    ratio = np.array([0.01, 0.5, 1.0, 100.0])
    motion = 1.0 / (1.0 - ratio**2 + 1j * DAMPING * ratio)
    heavier = 1.0 / (1.0 - 1.001 * ratio**2 + 1j * DAMPING * ratio)
    # one thousandth more mass: a difference quotient, whose own error is of that order
    change = np.abs(heavier - motion) / np.abs(motion) / 1e-3
    assert inertia_wrong(ratio) == pytest.approx(change, rel=2e-3)
    undamped = 1.0 / (1.0 - ratio[:2] ** 2)
    assert inertia_left_out(ratio[:2]) == pytest.approx(np.abs(1.0 - undamped) / undamped)
