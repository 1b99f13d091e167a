"""A report's sentences give the figure that failed as their reason, shares only of a whole."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import known_run as run
import numpy as np
import pytest
from test_report import ENERGIES, whole_run

from coupling.estimate.strength import strength_verdict, stress_estimate
from coupling.report import write_report
from coupling.report.energy_section import energy_section
from coupling.report.files import RunFiles, read_run
from coupling.report.run_report import run_page
from coupling.report.run_tables import motion_table, rubber_table
from coupling.report.scene_tables import scene_tables
from coupling.report.style import thinned
from coupling.report.verdict import bernoulli_keys
from coupling.scene.scene import Scene, load_scene, with_overrides
from coupling.simulation.driver import run as run_scene
from coupling.store.atomic import write_json


def changed(folder: Path, **sections: dict[str, Any]) -> RunFiles:
    """The known run, with figures of its summary changed by section."""
    whole_run(folder)
    content = json.loads((folder / "summary.json").read_text())
    for section, figures in sections.items():
        content[section].update(figures)
    write_json(folder / "summary.json", content)
    return read_run(folder)


@pytest.mark.parametrize(
    ("momentum", "dynamic", "headline"),
    [
        (0.016, 0.3, "fails here: it leaves out 30\u202f% (rms) of the pressure's variation."),
        (0.2, 0.01, "fails here: it leaves out 20\u202f% of the liquid's momentum."),
        (0.2, 0.3, "20\u202f% of the liquid's momentum and 30\u202f% (rms) of the pressure"),
        (0.01, 0.02, "holds here: it leaves out 2.0\u202f% at the most."),
    ],
)
def test_hydrostatics_fails_by_the_figure_that_failed(
    tmp_path: Path, momentum: float, dynamic: float, headline: str
) -> None:
    figures = {"neglected_momentum": momentum, "dynamic_fraction": dynamic}
    assert headline in run_page(changed(tmp_path, bernoulli=figures)).verdict


def test_parts_that_cancel_are_no_shares_of_what_is_dissipated(tmp_path: Path) -> None:
    """Damping takes 500 times what is dissipated, and time stepping makes it again."""
    stirred = ENERGIES | {
        "dissipated": lambda t: 0.02 * t * run.FREQUENCY,
        "dissipated_by_bending": lambda t: 10.0 * t * run.FREQUENCY,
    }
    whole_run(tmp_path, metrics=stirred)
    section = energy_section(read_run(tmp_path))
    assert section is not None
    table = section.tables[0]
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["… by fold_damping, a regularisation of the sheet’s bending"] == ["10\u202fJ", ""]
    assert rows["… by impacts, snapping taut and the time step"] == ["−16\u202fJ", ""]
    assert "no shares" in table.note
    assert not any("%" in row[2] for row in table.rows[3:])


def test_the_rubber_s_own_losses_stand_by_name_beside_the_regularisations(tmp_path: Path) -> None:
    """Of 20 J a period, 11 of them by fold_damping and slack_drag."""
    own = ENERGIES | {
        "dissipated_by_stretch": lambda t: 2.0 * t * run.FREQUENCY,
        "dissipated_by_shell_friction": lambda t: 1.0 * t * run.FREQUENCY,
    }
    whole_run(tmp_path, metrics=own)
    files = read_run(tmp_path)
    period = files.summary["energy"]["per_period"]
    assert period["regularised_fraction"] == pytest.approx(11.0 / 20.0)
    assert period["rest_J"] == pytest.approx(1.0)
    section = energy_section(files)
    assert section is not None
    rows = {row[0]: row[1:] for row in section.tables[0].rows}
    assert rows["… by the rubber’s own loss as it stretches (loss_factor)"][0] == "2\u202fJ"
    assert rows["… by friction on the shell (friction_shell)"] == ["1\u202fJ", "5.0\u202f%"]
    assert rows["… by slack_drag, a regularisation of its sliding"][0] == "1\u202fJ"


def test_a_run_without_a_step_does_not_claim_simulated_time(tmp_path: Path) -> None:
    files = changed(tmp_path)
    files.summary.update(steps=0, simulated_s=0.0, wall_s=411.0)
    assert "no step was completed in 411\u202fs" in run_page(files).subtitle


def test_one_period_is_not_one_periods(tmp_path: Path) -> None:
    files = changed(tmp_path)
    for periods, said in ((1, "the last whole period;"), (3, "the last 3 whole periods;")):
        files.summary["fitted_periods"] = periods
        assert said in motion_table(files).note


def test_a_phasor_that_has_not_settled_is_called_transient(tmp_path: Path) -> None:
    steady = {"drift": 0.01, "transient": False}
    moving = {"drift": 0.2, "transient": True}
    for cg, force, marked in ((steady, moving, 1), (moving, moving, 2), (steady, steady, 0)):
        files = changed(tmp_path, cg=cg, force=force)
        table = motion_table(files)
        assert sum("‡" in head for head in table.head) == 2 * marked  # amplitude, phase
        assert ("transient:" in table.note) == (marked > 0)
        remarks = {name: remark for name, _, remark in bernoulli_keys(files)}
        assert remarks["CG amplitude in the tank"] == ("transient" if cg is moving else "")


def test_curves_are_of_every_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A blow between two instants that were written out is drawn."""
    whole_run(tmp_path)
    files = read_run(tmp_path)
    steps = files.results.steps
    force = steps.force.copy()
    force[7, 0] = 1e4
    blow = replace(files.results, every_step=replace(steps, force=force))
    drawn: list[Any] = []
    monkeypatch.setattr(
        "coupling.report.figures.thinned", lambda x, y: drawn.append((x, y)) or thinned(x, y)
    )
    run_page(replace(files, results=blow))
    curves = [y for x, y in drawn if len(x) == len(y) == len(steps.time)]
    assert any(np.max(y) == 1e4 for y in curves)


def with_strength(scene: Scene, strength: float | None) -> Scene:
    rubber = scene.diaphragm.model_copy(update={"strength": strength})
    return scene.model_copy(update={"diaphragm": rubber})


def test_a_stress_beyond_the_strength_has_a_verdict(tmp_path: Path) -> None:
    load = stress_estimate(run.scene())
    strong, weak = with_strength(run.scene(), 2.0 * load), with_strength(run.scene(), 0.5 * load)
    said = strength_verdict(strong, 6.0 * load)
    assert said is not None
    assert said.startswith("Not decided")
    assert "3 times the strength" in said
    assert str(strength_verdict(weak, 0.1 * load)).startswith("No: ")
    assert str(strength_verdict(strong, load)).startswith("Yes: ")
    assert strength_verdict(with_strength(run.scene(), None), load) is None
    files = changed(tmp_path)
    files.summary["stress_max_Pa"] = 6.0 * load
    files = RunFiles(**{**vars(files), "scene": strong})
    assert ["Would it hold?", said] in rubber_table(files).rows


def test_a_report_holds_no_path_of_the_machine_that_ran_it(tmp_path: Path) -> None:
    """The scene's tables are named as in the run's folder, which can be moved."""
    scene = tmp_path / "scene.toml"
    time = np.linspace(0.0, 0.1, 11)
    rows = [f"{t:g},{np.sin(60 * t):g},0,0" for t in time]
    (tmp_path / "shake.csv").write_text("\n".join(["time,ax,ay,az", *rows]) + "\n")
    scene.write_text(
        '[tank]\nradius = 0.4445\n[diaphragm]\nmaterial = "AF-E-332"\nthickness = 0.001778\n'
        '[liquid]\nname = "water"\nfill_fraction = 0.8\n'
        '[motion]\nkind = "table"\nfile = "shake.csv"\n[model]\nfluid = "hydrostatic"\n'
        "[cloth]\nresolution = 6\n[time]\nduration = 0.1\nstep = 0.01\n"
    )
    folder = tmp_path / "run"
    run_scene(load_scene(scene), folder)
    text = write_report(folder).read_text()
    assert str(tmp_path) not in text
    assert "motion.csv" in text


@pytest.mark.parametrize(("mould", "said"), [("upper", None), ("lower", "the shell below the rim")])
def test_a_mould_below_the_rim_is_in_the_table_of_the_scene(mould: str, said: str | None) -> None:
    scene = with_overrides(
        load_scene(Path(__file__).parents[3] / "foam_cases" / "pad_sway_coarse"),
        {"diaphragm.mould": mould},
    )
    rows = dict(row[:2] for row in scene_tables(SimpleNamespace(scene=scene, summary={}))[0].rows)
    assert rows.get("Moulded to") == said
