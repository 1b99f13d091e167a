"""``edt compare``: what it writes, prints and refuses."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import meshio
import numpy as np
import pytest
import scanned_sheets as sheets
from playwright.sync_api import sync_playwright
from typer.testing import CliRunner, Result

from coupling import compare_scan
from coupling.cli.main import app
from coupling.store.results import read_results
from foam_cases.steady_shapes.made_scan import made_scan

LIFTED = np.array([0.0, 0.0, 0.01])


def compared(*words: object) -> Result:
    return CliRunner().invoke(app, ["compare", *map(str, words)])


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that is a bowl at 0 s and 10 mm higher at 0.5 s, and its scan in mm."""
    folder, sheet = tmp_path_factory.mktemp("compare"), sheets.bowl()
    sheets.write_run_of(folder / "run", sheet, LIFTED)
    scan = made_scan(sheet.nodes, sheet.triangles, 0, number=3000)
    meshio.Mesh(1e3 * scan.points, []).write(folder / "scan.ply")
    level = scan.points @ scan.rotation.T + scan.shift
    meshio.Mesh(1e3 * level, []).write(folder / "level.ply")
    return folder


def test_everything_is_written_beside_the_run_and_printed(place: Path) -> None:
    done = compared(place / "scan.ply", place / "run", "--unit", "mm")
    assert done.exit_code == 0, done.output
    for said in ("vertical difference, mean", "as given", "aligned", "does not determine the rot"):
        assert said in done.stdout
    table = json.loads((place / "run" / "compare.json").read_text())
    assert table["unit"] == "mm"
    assert table["instant_s"] == 0.0
    assert table["alignment"]["azimuth_deg"] is None
    assert table["alignment"]["explained"]["value"] > 0.9
    with (place / "run" / "compare.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    results = read_results(place / "run")
    assert len(rows) == len(results.reference)
    assert [float(row["run_z_m"]) for row in rows] == pytest.approx(results.position[0, :, 2])
    holes = [row for row in rows if not row["normal_aligned_m"]]
    assert 0 < len(holes) < 0.2 * len(rows)
    off = [float(row["normal_aligned_m"]) for row in rows if row["normal_aligned_m"]]
    assert np.abs(off).max() < 4.0 * 0.8e-3


def test_the_instant_and_the_folder_are_ones_own_to_choose(place: Path, tmp_path: Path) -> None:
    """10 mm higher half a second later: as given the scan lies that much below."""
    first = compare_scan(place / "level.ply", place / "run", "mm", out=tmp_path / "first")
    later = compare_scan(place / "level.ply", place / "run", "mm", at=0.4, out=tmp_path / "later")
    assert later.table["instant_s"] == 0.5
    heights = [
        one.table["as_given"]["figures"]["vertical_mean_m"]["value"] for one in (first, later)
    ]
    # to the points that leave the rim: a hundredth
    assert heights[1] - heights[0] == pytest.approx(-0.01, rel=0.02)
    assert {path.name for path in (tmp_path / "later").iterdir()} == {
        "compare.json", "compare.csv", "compare.html"
    }  # fmt: skip


def test_json_is_one_object(place: Path, tmp_path: Path) -> None:
    done = compared(place / "level.ply", place / "run", "--unit", "mm", "-o", tmp_path, "--json")
    assert done.exit_code == 0
    assert json.loads(done.stdout) == json.loads((tmp_path / "compare.json").read_text())


def test_what_is_wrong_is_said_before_anything_is_written(place: Path, tmp_path: Path) -> None:
    scan, run, out = place / "scan.ply", place / "run", tmp_path / "out"
    far = tmp_path / "far.ply"
    meshio.Mesh(1e3 * sheets.bowl().nodes + np.array([0.0, 0.0, 2000.0]), []).write(far)
    for words, message in (
        ([scan, run, "--unit", "m"], "Is --unit mm meant?"),
        ([scan, run, "--unit", "cm"], "unit: must be mm, m, in, got 'cm'"),
        ([scan, run], "Missing option '--unit'"),
        ([scan, run, "--unit", "mm", "--at", "7"], "has instants from 0 to 0.5 s, got 7"),
        ([far, run, "--unit", "mm"], "does not lie on the diaphragm"),
        ([scan, tmp_path / "none", "--unit", "mm"], "no such file"),
    ):
        done = compared(*words, "-o", out)
        assert done.exit_code == 2
        assert message in done.stderr
    assert not out.exists()


def test_the_page_is_whole_on_a_desk_and_on_a_telephone(place: Path, tmp_path: Path) -> None:
    compare_scan(place / "scan.ply", place / "run", "mm", out=tmp_path)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=["--no-sandbox"]
        )
        for width in (1200, 390):
            page = chromium.new_page(viewport={"width": width, "height": 900})
            page.goto(f"file://{tmp_path / 'compare.html'}")
            assert page.evaluate("document.documentElement.scrollWidth") == width
            assert page.evaluate("[...document.images].every(one => one.naturalWidth > 0)")
            assert page.evaluate("document.images.length") == 4
            text = page.inner_text("body")
            for said in ("off the run's diaphragm in the mean", "not determined", "The run's grid"):
                assert said in text
            tables = "[...document.querySelectorAll('table')]"
            wide = f"{tables}.every(one => one.getBoundingClientRect().right <= {width})"
            assert page.evaluate(wide)
        chromium.close()
