"""The mend that a failed run prints is one that its scene does not have already."""

from pathlib import Path

import pytest
from known_run import scene as known_scene

from coupling.foam.process import ended
from coupling.ports import Cause, RunFailed, StepFailed
from coupling.scene.scene import Scene, with_overrides
from coupling.simulation.mends import with_mend
from coupling.step.divergence import diverged_at


def scene(*changes: str) -> Scene:
    return with_overrides(known_scene(), ["model.fluid=openfoam", *changes])


def test_added_mass_that_diverges_is_not_told_to_take_added_mass():
    said = with_mend(diverged_at(0.1, [2.0, 5e3]), scene(), "keep-alive")
    assert "the coupling diverges" in said
    assert "added-mass" not in said
    assert "Halve time.step (it is 0.02 s), or take model.fluid = 'potential'" in said


def test_another_scheme_that_diverges_is_told_to_take_added_mass():
    said = with_mend(diverged_at(0.1, [2.0]), scene("coupling.scheme=aitken"), "keep-alive")
    assert "Take coupling.scheme = 'added-mass', or halve time.step" in said


def test_a_restarted_solver_is_told_what_takes_steps_in_parts():
    assert "edt build-solver" in with_mend(diverged_at(0.1, [2.0]), scene(), "restart")
    assert "edt build-solver" not in with_mend(diverged_at(0.1, [2.0]), scene(), "keep-alive")


def test_a_table_has_no_amplitude_to_lower():
    failure = StepFailed("no valid mesh", cause=Cause.MESH)
    table = known_scene().motion.model_copy(update={"kind": "table", "amplitude": None})
    shaken = scene().model_copy(update={"motion": table})
    assert "motion.amplitude" in with_mend(failure, scene(), "keep-alive")
    said = with_mend(failure, shaken, "keep-alive")
    assert said == (
        "no valid mesh Take model.fluid = 'potential', which needs no mesh and no coupling "
        "iteration."
    )


def test_without_a_flow_no_model_without_a_mesh_is_offered():
    said = with_mend(ArithmeticError("cloth: diverged."), scene("model.fluid=hydrostatic"), None)
    assert said == "cloth: diverged. Halve time.step (it is 0.02 s)."


def test_a_failure_that_names_its_own_mend_keeps_to_it():
    assert with_mend(RunFailed("No room. Make room."), scene(), None) == "No room. Make room."


@pytest.mark.parametrize(
    ("status", "output", "said", "halve"),
    [
        (127, "solver: error while loading shared libraries: libx.so", "LD_LIBRARY_PATH", False),
        (-9, "Time = 1", "It was killed", False),
        (137, "Time = 1", "It was killed", False),
        (1, "--> FOAM FATAL ERROR: cannot find file", "Read ", False),
        (-8, "Foam::sigFpe::sigHandler(int)", "the flow diverged", True),
        (136, "Time = 1", "the flow diverged", True),
    ],
)
def test_only_a_flow_that_diverged_is_helped_by_a_shorter_step(
    tmp_path: Path, status: int, output: str, said: str, halve: bool
):
    log = tmp_path / "log"
    log.write_text(output)
    message = with_mend(ended(Path("solver"), status, log, "t = 1 s"), scene(), "keep-alive")
    assert said in message
    assert ("Halve time.step" in message) == halve
    assert message.endswith(f"\n    {output}")  # what helps stands before the log
