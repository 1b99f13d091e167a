"""summary.json of a run whose figures are known."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import known_run as run
import numpy as np
import pytest

from coupling.estimate.strength import stress_estimate
from coupling.metrics.summary import summarise
from coupling.scene.scene import scene_from
from coupling.store.atomic import write_json
from coupling.store.results import Results, read_results
from coupling.store.results_layout import FIELDS
from coupling.store.run_record import RunStatistics

LOSS = {
    "tank_work": lambda t: 5.0 * t,
    "datum_work": lambda t: 0.0,
    "mechanical_energy": lambda t: 4.0,
    "dissipated": lambda t: 3.0 * t,
    "dissipated_by_liquid": lambda t: 3.0 * t,
    "dissipated_by_bending": lambda t: 0.0,
    "dissipated_by_drag": lambda t: 0.0,
    "layer_estimate": lambda t: 0.0,
}


def cut(results: Results, count: int) -> Results:
    names = {name for name, _ in FIELDS.values()}
    assert names <= {item.name for item in fields(results)}
    shorter: dict[str, Any] = {name: getattr(results, name)[:count] for name in names}
    return replace(results, every_step=None, **shorter)


def strict(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Written and read back, refusing what is not JSON."""
    write_json(folder / "summary.json", content)

    def refuse(name: str) -> None:
        raise AssertionError(name)

    text = (folder / "summary.json").read_text()
    read: dict[str, Any] = json.loads(text, parse_constant=refuse)
    assert read == content
    return read


def test_the_known_run_gives_its_own_figures(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    summary = strict(
        summarise(read_results(tmp_path), run.statistics(), run.scene(), "completed", None),
        tmp_path,
    )
    assert summary["cg"]["amplitude_m"] == pytest.approx([run.CG_AMPLITUDE, 0.0, 0.0])
    assert summary["cg"]["phase_deg"][0] == pytest.approx(-30.0)
    assert summary["cg"]["phase_deg"][1] is None
    assert summary["cg"]["drift"] == pytest.approx(0.0, abs=1e-9)
    assert summary["force"]["drift"] == pytest.approx(0.0, abs=1e-9)
    assert summary["cg"]["transient"] is False
    assert summary["force"]["transient"] is False
    assert summary["cg"]["mean_m"] == pytest.approx([0.0, 0.0, -0.1], abs=1e-12)
    assert summary["force"]["amplitude_N"][0] == pytest.approx(run.FORCE_AMPLITUDE)
    assert summary["force"]["phase_deg"][0] == pytest.approx(0.0, abs=1e-9)
    figures = summary["bernoulli"]
    body_force = np.hypot(9.81, run.OMEGA**2 * run.AMPLITUDE)
    assert figures["neglected_momentum"] == pytest.approx(run.CG_AMPLITUDE / run.AMPLITUDE)
    # the largest acceleration lies between two instants: cos(omega dt/2) = 0.997
    assert figures["kinetic_ratio"] == pytest.approx(body_force * run.RADIUS / 0.32, rel=4e-3)
    assert figures["unsteady_ratio"] == pytest.approx(body_force * run.RADIUS / 2.5, rel=4e-3)
    assert 0.01 < figures["dynamic_fraction"] < 1.0
    assert summary["coupling"]["iterations_mean"] == 4.0


def test_figures_are_of_the_steps_between_the_instants_too(tmp_path: Path) -> None:
    """Every third step is written out; a blow, a fast one and a jump in energy lie between."""
    run.write_run(tmp_path, every=3, metrics=LOSS)
    results = read_results(tmp_path)
    assert len(results.steps.time) > 2 * len(results.time)
    row = 100
    assert results.steps.time[row] not in results.time
    steps = results.steps
    force, peaks = steps.force.copy(), dict(steps.metrics)
    force[row, 0] = 4e3
    peaks["mechanical_energy"] = peaks["mechanical_energy"].copy()
    peaks["mechanical_energy"][row] = 77.0
    blow = replace(results, every_step=replace(steps, force=force, metrics=peaks))
    found = summarise(blow, run.statistics(), run.scene(), "completed", None)
    assert found["force"]["peak_N"][0] == 4e3
    assert found["energy"]["peak_J"] == 77.0
    every = tmp_path / "every"
    run.write_run(every, metrics=LOSS)
    one = summarise(results, run.statistics(), run.scene(), "completed", None)
    assert one == summarise(read_results(every), run.statistics(), run.scene(), "completed", None)


def test_a_phasor_is_called_transient_where_it_changes_or_two_periods_are_missing(
    tmp_path: Path,
) -> None:
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    steps = results.steps

    def parts(**changes: Any) -> list[Any]:
        changed = replace(results, every_step=replace(steps, **changes))
        found = summarise(changed, run.statistics(), run.scene(), "completed", None)
        return [found[name][what] for name in ("cg", "force") for what in ("drift", "transient")]

    growing = steps.liquid_cg * np.exp(0.04 * run.FREQUENCY * steps.time)[:, None]
    assert parts(liquid_cg=growing)[1] is False
    growing = steps.liquid_cg * np.exp(0.06 * run.FREQUENCY * steps.time)[:, None]
    assert parts(liquid_cg=growing)[1] is True
    assert parts(force=0.0 * steps.force)[2:] == [None, None]  # nothing moves
    short = cut(results, int(1.5 / run.FREQUENCY / 0.02))
    found = summarise(short, run.statistics(), run.scene(), "completed", None)
    assert found["fitted_periods"] == 1
    assert (found["cg"]["drift"], found["cg"]["transient"]) == (None, True)
    rest = run.scene().model_dump(exclude_unset=True) | {"motion": {"kind": "rest"}}
    still = scene_from(rest)
    found = summarise(results, run.statistics(), still, "completed", None)
    assert (found["cg"]["drift"], found["cg"]["transient"]) == (None, None)


def test_a_tank_that_is_hardly_shaken_has_no_figures_of_what_settling_left(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    shaken = results.steps.tank_acceleration
    size = np.linalg.norm(shaken, axis=1).max()
    for largest, known in ((1.1e-5, True), (0.9e-5, False)):  # a millionth of gravity: 0.98e-5
        steps = replace(results.steps, tank_acceleration=shaken * largest / size)
        one = replace(results, every_step=steps)
        found = summarise(one, run.statistics(), run.scene(), "completed", None)
        said = found["cg"]["drift"], found["force"]["momentum_imbalance"], found["impacts"]
        assert all((part is not None) == known for part in said)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10])
def test_a_run_cut_short_is_valid_json_with_null_for_what_it_cannot_say(
    tmp_path: Path, count: int
) -> None:
    run.write_run(tmp_path)
    results = cut(read_results(tmp_path), count)
    summary = strict(
        summarise(results, RunStatistics(), run.scene(), "failed", "t = 0 s: why"), tmp_path
    )
    assert summary["error"] == "t = 0 s: why"
    assert summary["cg"]["phase_deg"] == [None] * 3
    assert (summary["cg"]["amplitude_m"][0] is None) == (count < 2)
    assert (summary["cg"]["mean_m"][0] is None) == (count == 0)
    assert summary["bernoulli"]["kinetic_ratio"] is None


def test_a_motion_beyond_the_strength_is_said_and_an_unknown_one_is_not_judged(
    tmp_path: Path,
) -> None:
    run.write_run(tmp_path)
    results, scene = read_results(tmp_path), run.scene()
    assert summarise(results, run.statistics(), scene, "completed", None)["would_burst"] is None
    estimate = stress_estimate(scene)
    for strength, bursts in ((0.9 * estimate, True), (1.1 * estimate, False)):
        rubber = scene.diaphragm.model_copy(update={"strength": strength})
        judged = scene.model_copy(update={"diaphragm": rubber})
        found = summarise(results, run.statistics(), judged, "completed", None)
        assert found["would_burst"] is bursts
