"""How the check of `auto` counts: true errors and verdicts by hand."""

import pytest

from coupling.estimate.model_errors import ladder
from foam_cases.auto_check.check import scenes, true_errors, verdict

VERDICT = ("keeps", "cheaper_suffices", "cheaper_picked")


def run(x, status="completed"):
    return {"status": status, "cg": {"amplitude_m": [x, 0.0, 0.0], "phase_deg": [0.0] * 3}}


def test_errors_are_against_the_top_rung_and_its_own_is_its_grids():
    runs = {"hydrostatic": run(0.03), "potential": run(0.021), "openfoam": run(0.02)}
    runs["half"] = run(0.022)
    errors = true_errors(runs)
    assert errors["hydrostatic"] == pytest.approx(0.5)
    assert errors["potential"] == pytest.approx(0.05)
    # 540 cells against 1216: Richardson's factor is (1216/540)^(1.5/3) - 1
    assert errors["openfoam"] == pytest.approx(0.1 / ((1216 / 540) ** 0.5 - 1.0))
    assert true_errors(runs | {"half": run(0.022, "failed")})["openfoam"] is None
    failed = runs | {"openfoam": {"status": "failed"}}
    assert set(true_errors(failed).values()) == {None}


def test_what_is_not_known_keeps_no_tolerance():
    errors = {"hydrostatic": 0.5, "potential": 0.05, "openfoam": None}
    taken = verdict("potential", errors, 0.1)
    assert taken == {
        "pick": "potential",
        "cheapest": "potential",
        "keeps": True,
        "cheaper_suffices": True,
        "cheaper_picked": True,
    }
    dear = verdict("openfoam", errors, 0.1)
    assert [dear[name] for name in VERDICT] == [False, True, False]
    wrong = verdict("hydrostatic", errors, 0.1)
    assert [wrong[name] for name in VERDICT] == [False, True, False]
    none = verdict("openfoam", dict.fromkeys(ladder()), 0.9)
    assert [none[name] for name in VERDICT] == [False, False, False]
    assert none["cheapest"] == "none"


def test_every_scene_is_valid_and_left_to_choose():
    assert len(scenes()) == 20
    assert {scene.model.fluid for scene in scenes().values()} == {"auto"}
