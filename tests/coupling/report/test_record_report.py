"""Runs and studies by a record, whole: what their files, pages and tables say of them."""

from __future__ import annotations

import json
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from small_scene import SMALL
from typer.testing import CliRunner

from coupling.campaign.study import run_study
from coupling.cli.main import app
from coupling.cli.study_table import print_study
from coupling.report.files import read_run
from coupling.report.picture import last_period_rows, period_rows
from coupling.report.record_figures import envelope
from coupling.report.run_report import run_page
from coupling.report.study_report import study_page
from coupling.report.window import WindowError, liveliest, window_of
from coupling.scene.scene import load_scene
from coupling.simulation.driver import run

STEPS, STEP = 160, 0.01
BAND = "frequency (Hz),x (g^2/Hz),y (g^2/Hz),z (g^2/Hz)\n2,2e-4,0,1e-4\n30,2e-4,0,1e-4\n"


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("case")
    (folder / "s.csv").write_text(BAND)
    sine = 'kind = "sine"\nfrequency = 2.0\namplitude = 0.002\n'
    assert sine in SMALL
    record = 'kind = "psd"\nfile = "s.csv"\nduration = 1.6\nseed = 2\n'
    more = f"[cloth]\nresolution = 6\n[time]\nduration = 1.6\nstep = {STEP}\noutput_every = 2\n"
    text = SMALL.replace(sine, record) + '[model]\nfluid = "hydrostatic"\n' + more
    (folder / "scene.toml").write_text(text)
    return folder


@pytest.fixture(scope="module")
def done(case: Path) -> Path:
    run(load_scene(case), case / "run")
    return case / "run"


@pytest.fixture(scope="module")
def study(case: Path) -> Path:
    run_study(load_scene(case), ["hydrostatic", "potential"], case / "study", quick=True)
    return case / "study"


def test_the_summary_has_the_record_and_no_period(done: Path) -> None:
    summary = json.loads((done / "summary.json").read_text())
    record, steps = summary["record"], read_run(done).results.steps
    for name, signal in (("force", steps.force), ("cg", steps.liquid_cg)):
        about = signal - signal.mean(axis=0)
        found = record["signals"][name]
        np.testing.assert_allclose(found["rms"], np.sqrt(np.mean(about**2, axis=0)), rtol=1e-12)
        np.testing.assert_allclose(found["peak"], np.abs(about).max(axis=0), rtol=1e-12)
    assert len(steps.time) == STEPS + 1
    assert record["bands"][-1]["to_hz"] >= 50.0
    assert summary["fitted_periods"] == 0


def test_the_page_claims_no_amplitude(done: Path) -> None:
    page = run_page(read_run(done))
    titles = [section.title for section in page.sections]
    assert "Answer to the record" in titles
    assert "By band of frequency" in titles
    assert "Centre of gravity and force" not in titles
    assert [name for name, _, _ in page.figures if "amplitude" in name] == []
    assert any(name == "CG in the tank, rms" and "peak" in more for name, _, more in page.figures)
    tables = [table for section in page.sections for table in section.tables]
    heads = {text for table in tables for text in (*table.head, *(row[0] for row in table.rows))}
    assert not any("mplitude" in text or "(f/f₁)²" in text for text in heads)
    assert "the first slosh periods hold a transient" in " ".join(table.note for table in tables)


def test_the_terminal_prints_rms_and_bands(case: Path, done: Path) -> None:
    answer = CliRunner().invoke(app, ["resume", str(done), "--no-report"])
    assert answer.exit_code == 0, answer.output
    assert "CG, rms [m]" in answer.output
    assert "rms by band of frequency" in answer.output
    assert "CG amplitude" not in answer.output


def test_no_peak_is_thinned_out() -> None:
    values = np.zeros(100_000)
    values[[31_234, 77_777]] = 1.0, -2.0
    time, drawn = envelope(np.arange(100_000) * 0.01, values)
    assert len(time) == 1500
    assert (drawn.min(), drawn.max()) == (-2.0, 1.0)
    assert np.all(np.diff(time) >= 0.0)


def test_a_study_says_which_bands_hydrostatics_holds_in(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = json.loads((study / "study.json").read_text())
    record = found["record"]
    error = record["error"]["hydrostatic"]["cg"]
    names = [f"{row['from_hz']:g} to {row['to_hz']:g} Hz" for row in record["bands"]]
    assert set(names) < set(error)
    # The scene's f1 is 1.6 Hz: from 2 Hz on a liquid without inertia moves far too much.
    assert error["all"] > 0.5
    assert record["uncertainty"]["cg"]["all"] is not None
    assert sum(row["cg_share"] for row in record["bands"]) == pytest.approx(1.0)
    assert "it was not enough" in record["verdict"]
    assert set(record["models"]) == {"hydrostatic", "potential"}
    page = study_page(study, found)
    assert page.verdict == record["verdict"]
    assert page.sections[0].title == "By band of frequency"
    assert len(page.sections[0].tables[0].rows) == len(names) + 1
    errors = next(section for section in page.sections if section.title == "Errors")
    assert "A record has no amplitude" in errors.text
    assert "amplitude" not in found["advice"] + found["verdict"] + page.explanation
    print_study(found, study)
    text = " ".join(capsys.readouterr().out.split())
    assert "errors by band of frequency" in text
    assert "Nine tenths of the power of the CG's motion lies in" in text


def test_a_record_is_shown_where_it_moves_most(done: Path) -> None:
    results = read_run(done).results
    away = np.linalg.norm(results.liquid_cg - results.liquid_cg.mean(axis=0), axis=1)
    window = liveliest(results)
    assert window is not None
    rows = last_period_rows(results, 1000)
    assert int(away.argmax()) in rows
    assert results.time[rows[-1]] - results.time[rows[0]] == pytest.approx(1.0, abs=4 * STEP)
    assert (rows[0], rows[-1]) == tuple(period_rows(results, 2))


@pytest.mark.parametrize("ending", ["png", "mp4"])
def test_a_window_is_shown_and_nothing_else(done: Path, tmp_path: Path, ending: str) -> None:
    file = tmp_path / f"part.{ending}"
    words = ["render", str(done), "-o", str(file), "--from", "0.2", "--to", "0.5"]
    answer = CliRunner().invoke(app, words)
    assert answer.exit_code == 0, answer.output
    results = read_run(done).results
    rows = last_period_rows(results, 1000, (0.2, 0.5))
    np.testing.assert_allclose(results.time[rows], np.arange(0.2, 0.51, 2 * STEP), atol=1e-9)
    np.testing.assert_allclose(
        results.time[period_rows(results, 3, (0.2, 0.5))][[0, 2]], [0.2, 0.5]
    )
    if ending == "mp4":
        assert imageio_ffmpeg.count_frames_and_secs(str(file))[0] == len(rows)
    else:
        assert file.stat().st_size > 10_000


def test_a_window_without_instants_is_refused_with_a_mend(done: Path) -> None:
    results = read_run(done).results
    assert window_of(results, None, None) is None
    assert window_of(results, 1.0, None) == (1.0, pytest.approx(1.6))
    with pytest.raises(WindowError, match=r"--from: must lie before --to, got 0\.5 and 0\.2 s"):
        window_of(results, 0.5, 0.2)
    with pytest.raises(WindowError, match=r"holds 0 of the run's instants, which lie between"):
        window_of(results, 0.601, 0.603)
    answer = CliRunner().invoke(app, ["render", str(done), "--from", "7", "--to", "9"])
    assert answer.exit_code == 2
    assert "Give a window that holds two" in answer.output
