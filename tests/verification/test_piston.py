"""The spring piston on a column of liquid: the liquid's inertia, and which schemes bear it."""

import numpy as np
import pytest

from coupling.ports import HydrostaticLoad, RunFailed
from coupling.verify import CaseError, run_case
from coupling.verify.piston import (
    AMPLITUDE,
    DENSITY,
    LENGTH,
    OMEGA,
    WIDTH,
    Piston,
    _release,
    column_mesh,
)  # fmt: skip


def test_both_ends_of_the_column_are_its_patch():
    mesh = column_mesh(8)
    ends = mesh.points[mesh.faces[mesh.diaphragm]]
    assert mesh.cells == 2 * 2 * 8
    assert mesh.diaphragm_faces == 2 * 4
    assert (np.abs(ends[..., 2]) == 0.5).all()
    assert len(mesh.patch_points) == 2 * 9


@pytest.mark.parametrize("options", [{"scheme": "newton"}, {"mass-ratio": "0"}, {"cells": "2"}])
def test_wrong_options_are_refused(options):
    with pytest.raises(CaseError, match=next(iter(options))):
        run_case("piston", options)


@pytest.mark.openfoam
def test_piston_moves_as_with_its_liquid(tmp_path):
    # Against the same steps of a dry piston as heavy as both: what is left is the coupling's
    # tolerance of 1e-4 a step and the solver's splitting.
    step, mass = 0.05, 5.0
    liquid = DENSITY * WIDTH**2 * LENGTH
    stiffness = OMEGA**2 * (mass + liquid)
    place, *_ = _release(tmp_path / "foam", mass, stiffness, "added-mass", step, 4)
    dry = Piston(
        np.zeros((4, 3)), np.array([[0, 1, 2, 3]]), mass=mass + liquid, stiffness=stiffness
    )
    dry.stretch(AMPLITUDE)
    expected = [AMPLITUDE]
    for _ in place[1:]:
        dry.begin_step(step, HydrostaticLoad(density=0.0, body_force=np.zeros(3)))
        dry.solve(np.zeros((4, 3)))
        dry.accept_step()
        expected.append(float(dry.place[0]))
    assert np.abs(place - expected).max() < 1e-3 * AMPLITUDE


@pytest.mark.openfoam
def test_piston_needs_a_strong_scheme_above_a_mass_ratio_of_one():
    coarse = {"step": "0.1", "cells": "4"}
    light = run_case("piston", coarse | {"mass-ratio": "0.1", "scheme": "fixed-point"})
    iterations = light.quantities[1]
    # The factor that theory gives per iteration; a step may meet the tolerance one sooner or later.
    assert 3 < iterations.exact < 6
    assert abs(iterations.computed - iterations.exact) < 1
    with pytest.raises(RunFailed, match="the coupling diverges"):
        run_case("piston", coarse | {"mass-ratio": "3", "scheme": "fixed-point"})
    for scheme, most in (("added-mass", 2.0), ("iqn-ils", 3.0)):
        found = run_case("piston", coarse | {"mass-ratio": "3", "scheme": scheme})
        assert found.quantities[1].computed <= most
