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
from coupling.store.atomic import write_json
from coupling.store.results import Results, read_results
from coupling.store.results_layout import FIELDS
from coupling.store.run_record import RunStatistics


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
