"""The search for a least thickness, on criteria that are known functions of it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from coupling.campaign.bracket import (
    SCAN,
    WIDTH,
    Trial,
    bracket_of,
    next_thicknesses,
    scan,
    trials_left,
)

ENDS = (0.0005, 0.008)
LIMIT = 0.5
Known = Callable[[float], float | None]


def searched(value: Known, tried: dict[float, Trial] | None = None) -> dict[float, Trial]:
    """All trials of a search with a criterion of this ``value``, which fails where that is None."""
    tried = {} if tried is None else tried
    while new := next_thicknesses(tried, ENDS, LIMIT):
        for thickness in new:
            assert thickness not in tried  # none is tried twice
            found = value(thickness)
            tried[thickness] = Trial(value=found, failure=None if found is not None else "broke")
    assert trials_left(tried, ENDS, LIMIT) == 0
    return tried


@pytest.mark.parametrize("least", [0.00051, 0.0007, 0.001, 0.0023, 0.0079])
def test_the_bracket_holds_the_least_thickness(least: float) -> None:
    """Of a criterion that falls with the cube of the thickness, and is at its limit there."""
    tried = searched(lambda t: LIMIT * (least / t) ** 3)
    found = bracket_of(tried, LIMIT)
    assert found.too_thin is not None
    assert found.enough is not None
    assert found.too_thin <= least < found.enough <= (1.0 + WIDTH) * found.too_thin
    assert found.closed
    assert not found.thin_keepers
    assert not found.rises
    # neighbours of the scan are a factor of 2 apart: ln 2/ln 1.05 = 14.2 is halved four times
    assert len(tried) == SCAN + 4


def test_the_number_of_trials_is_foreseen() -> None:
    tried: dict[float, Trial] = {}
    assert trials_left(tried, ENDS, LIMIT) == SCAN + 4
    for thickness in scan(*ENDS):
        tried[thickness] = Trial(value=0.001 / thickness)
    assert trials_left(tried, ENDS, LIMIT) == 4


def test_where_all_keep_or_none_does_there_is_one_end() -> None:
    kept, missed = searched(lambda _: 0.1), searched(lambda _: 0.9)
    assert list(kept) == list(missed) == scan(*ENDS)
    found = bracket_of(kept, LIMIT)
    assert (found.too_thin, found.enough) == (None, ENDS[0])
    found = bracket_of(missed, LIMIT)
    assert (found.too_thin, found.enough) == (ENDS[1], None)
    assert bracket_of(searched(lambda _: LIMIT), LIMIT).enough is None  # the limit itself is missed


def test_a_criterion_that_is_kept_twice_is_seen_and_the_thicker_bracket_taken() -> None:
    """It is missed between 1.5 and 3 mm alone: what is thin keeps it too."""
    tried = searched(lambda t: 0.9 if 0.0015 < t < 0.003 else 0.1)
    found = bracket_of(tried, LIMIT)
    assert found.too_thin is not None
    assert found.enough is not None
    assert found.too_thin < 0.003 <= found.enough
    assert found.closed
    assert found.thin_keepers == (0.0005, 0.001)
    assert len(found.rises) == 1


def test_a_rise_on_one_side_of_the_limit_is_seen() -> None:
    found = bracket_of(searched(lambda t: 0.9 if t < 0.003 else 0.1 + t), LIMIT)
    assert not found.thin_keepers
    assert found.rises[-1] == (0.004, 0.008)


def test_a_failure_outside_the_bracket_does_not_matter_one_inside_ends_it() -> None:
    tried = searched(lambda t: None if t < 0.0008 else 0.001 / t)
    assert bracket_of(tried, LIMIT).closed
    tried = searched(lambda t: None if 0.0021 < t < 0.0039 else 0.0014 / t)
    found = bracket_of(tried, LIMIT)
    assert (found.too_thin, found.enough) == (0.002, 0.004)
    assert not found.closed


def test_a_search_goes_on_from_what_was_tried() -> None:
    def value(t: float) -> float:
        return 0.0011 / t

    whole = searched(value)
    first = dict(list(whole.items())[: SCAN + 2])
    assert searched(value, first) == whole
