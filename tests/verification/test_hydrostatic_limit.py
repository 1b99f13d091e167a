"""The low-frequency limit of the two reduced fluids."""

import pytest

from coupling.verify import CaseError, run_case


def test_hydrostatics_errs_by_the_square_of_the_frequency():
    """Order 2 within 0.2; at 0.1 Hz (f/f1)^2 within a fifth, so below 2 %.

    f/f1 is that of a free surface: the clamped rim, on ten rings, shifts f1 by some per cent.
    """
    result = run_case("hydrostatic-limit")
    found = {quantity.name: quantity for quantity in result.quantities}
    assert found["exponent"].computed == pytest.approx(2.0, abs=0.2)
    assert found["error"].error < 0.2
    assert found["error"].computed < 0.02


def test_the_limit_names_what_it_takes():
    with pytest.raises(CaseError, match="--fill-fraction: must lie in"):
        run_case("hydrostatic-limit", {"fill-fraction": "1.4"})
