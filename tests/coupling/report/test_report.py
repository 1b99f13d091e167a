"""Reports: built from the files alone, self-contained, of whole and of broken runs."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import known_run as run
import numpy as np
import pytest
from matplotlib.image import imread

from coupling.metrics.summary import summarise
from coupling.ports import Array
from coupling.report import render_picture, write_report
from coupling.report.bernoulli_tables import bernoulli_table, split_table
from coupling.report.energy_section import energy_section
from coupling.report.files import RunFiles, read_run
from coupling.report.page import number, percent
from coupling.report.picture import period_rows
from coupling.report.rub_maps import rub_maps
from coupling.report.rub_section import rub_table
from coupling.report.run_report import run_page
from coupling.report.run_tables import quality_table, rubber_table
from coupling.report.section_cut import cut
from coupling.scene.report import Report
from coupling.scene.scene import Scene, scene_toml
from coupling.store.atomic import write_json
from coupling.store.results import read_results
from coupling.store.results_writer import ResultsWriter
from coupling.store.run_record import RunStatistics


class Page(HTMLParser):
    """Counts images and addresses, and checks that tags close."""

    def __init__(self) -> None:
        super().__init__()
        self.images: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag == "img":
            assert values["alt"] is not None
            self.images.append(str(values["src"]))
        assert "href" not in values
        if tag not in {"img", "input", "meta"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


# 20 J dissipated a period, 16 J of them by name, and rms of pressures
ENERGIES: dict[str, Callable[[float], float]] = {
    "tank_work": lambda t: 25.0 * t * run.FREQUENCY,
    "mechanical_energy": lambda t: 4.0,
    "liquid_potential_energy": lambda t: 2.0,
    "datum_work": lambda t: 0.0,
    "dissipated": lambda t: 20.0 * t * run.FREQUENCY,
    "dissipated_by_liquid": lambda t: 5.0 * t * run.FREQUENCY,
    "dissipated_by_bending": lambda t: 10.0 * t * run.FREQUENCY,
    "dissipated_by_drag": lambda t: t * run.FREQUENCY,
    "layer_estimate": lambda t: 0.1 * t * run.FREQUENCY,
    "hydrostatic_pressure_rms": lambda t: 300.0,
    "dynamic_pressure_rms": lambda t: 100.0,
    "unsteady_pressure_rms": lambda t: 90.0,
    "kinetic_pressure_rms": lambda t: 30.0,
    "viscous_traction_rms": lambda t: 0.01,
}


def whole_run(folder: Path, model: str = "openfoam", **known: Any) -> None:
    scene = run.scene()
    scene = scene.model_copy(update={"model": scene.model.model_copy(update={"fluid": model})})
    run.write_run(folder, scene=scene_toml(scene), model=model, **known)
    (folder / "scene.toml").write_text(scene_toml(scene))
    results = read_results(folder)
    content = summarise(results, run.statistics(), scene, "completed", None)
    write_json(folder / "summary.json", content)


def parsed(path: Path) -> tuple[str, Page]:
    text = path.read_text(encoding="utf-8")
    page = Page()
    page.feed(text)
    assert page.open == []
    assert all(source.startswith("data:image/") for source in page.images)
    assert not re.search(r"(src|href|url)\s*[=(]\s*[\"']?(https?:)?//", text)
    written = re.sub(r"data:image[^\"]*|<script>.*?</script>", "", text, flags=re.DOTALL)
    assert not re.search(r"\bnan\b|\bNone\b", written)
    return text, page


def test_a_run_is_reported_with_its_verdict_and_figures(tmp_path: Path) -> None:
    whole_run(tmp_path)
    (tmp_path / "coupling.csv").write_text(
        "time,iteration,residual,seconds\n0.02,1,0.1,0.1\n0.02,2,1e-5,0.1\n0.04,1,1e-5,0.1\n"
    )
    text, page = parsed(write_report(tmp_path))
    assert "it leaves out 20\u202f% of the liquid&#39;s momentum" in text
    # instants, scale, pressures, motions, slip and work on the shell, on which part, quality
    assert len(page.images) == 8 + 1 + 2 + 2 + 3 + 4
    assert "−30.0" in text  # the lag of the CG
    assert "Known run" in text


def test_thesis_estimate_stands_beside_the_measured_ratios(tmp_path: Path) -> None:
    whole_run(tmp_path)
    read = read_run(tmp_path)
    rows = bernoulli_table(read).rows
    figures = read.summary["bernoulli"]
    assert [row[1] for row in rows] == [
        number(figures["eq46_as_printed"], digits=4),
        number(figures["eq46_as_worded"], digits=4),
        number(figures["kinetic_ratio"]),
        number(figures["unsteady_ratio"]),
    ]
    assert figures["eq46_as_printed"] == pytest.approx(4.0 * figures["eq46_as_worded"])
    assert all(row[2] for row in rows)


def test_results_without_a_balance_are_reported_without_one(tmp_path: Path) -> None:
    """As an older version left them: the known run's results hold no energies."""
    whole_run(tmp_path)
    content = json.loads((tmp_path / "summary.json").read_text())
    for name in ("energy", "pressure", "boundary_layer", "moment"):
        del content[name]
    del content["cg"]["transfer"], content["force"]["transfer"]
    write_json(tmp_path / "summary.json", content)
    text, _ = parsed(write_report(tmp_path))
    assert "Where the energy goes" not in text
    assert "CG over tank" not in text


@pytest.mark.parametrize("model", ["potential", "openfoam", "hydrostatic"])
def test_energy_and_parts_of_the_pressure_are_told_where_the_results_hold_them(
    tmp_path: Path, model: str
) -> None:
    whole_run(tmp_path, model=model, metrics=ENERGIES)
    read = read_run(tmp_path)
    section = energy_section(read)
    assert section is not None
    table = {row[0]: row[1:] for row in section.tables[0].rows}
    assert table["Dissipated"] == ["20\u202fJ", "5 times the largest stored"]
    assert table["… by the liquid"] == ["5\u202fJ", "25\u202f%"]
    assert table["… by impacts, snapping taut and the time step"] == ["4\u202fJ", "20\u202f%"]
    split = split_table(read)
    assert split is not None
    assert split.rows[3][1:] == ["30\u202fPa", "10\u202f%", "10\u202f%"]
    parsed(write_report(tmp_path))


def test_a_broken_run_says_why(tmp_path: Path) -> None:
    reference, triangles = run.disc()
    scene = run.scene()
    ResultsWriter.create(
        tmp_path,
        scene_toml=scene_toml(scene),
        model="openfoam",
        reference=reference,
        triangles=triangles,
    ).append(run.sample(0.0, reference, triangles))
    (tmp_path / "scene.toml").write_text(scene_toml(scene))
    content = summarise(
        read_results(tmp_path), RunStatistics(), scene, "failed", "t = 0.1 s: <mesh> folded."
    )
    write_json(tmp_path / "summary.json", content)
    text, _ = parsed(write_report(tmp_path))
    assert "&lt;mesh&gt; folded." in text


@pytest.mark.parametrize("instants", [0, 1, 2, 5])
def test_a_run_still_going_is_reported_without_a_summary(tmp_path: Path, instants: int) -> None:
    reference, triangles = run.disc()
    text = scene_toml(run.scene())
    writer = ResultsWriter.create(
        tmp_path, scene_toml=text, model="datum", reference=reference, triangles=triangles
    )
    for k in range(instants):
        writer.append(run.sample(0.02 * k, reference, triangles))
    writer.close()
    (tmp_path / "scene.toml").write_text(text)
    page, _ = parsed(write_report(tmp_path))
    assert "unfinished" in page


def test_the_picture_is_not_empty(tmp_path: Path) -> None:
    whole_run(tmp_path)
    image = imread(render_picture(read_results(tmp_path), tmp_path / "tank.png"))
    assert image.shape[1] > 1000
    coloured = np.ptp(image[:, :, :3], axis=2) > 0.3
    assert 0.02 < coloured.mean() < 0.5


def test_the_instants_are_a_quarter_period_apart_and_begin_at_the_largest_displacement(
    tmp_path: Path,
) -> None:
    whole_run(tmp_path)
    results = read_results(tmp_path)
    moved = results.tank_displacement[period_rows(results, 4), 0] / run.AMPLITUDE
    # an instant is at most half an output step off: omega h/2 = 0.08
    assert moved == pytest.approx([1.0, 0.0, -1.0, 0.0], abs=0.09)


def test_a_cut_through_a_hemisphere_is_a_half_circle() -> None:
    points, triangles = run.disc(16)
    for direction in ([1.0, 0.0, 0.0], [1.0, 2.0, 5.0], [0.0, 0.0, 1.0]):
        curves = cut(points, triangles, np.array(direction))
        assert len(curves) == 1
        radius = np.linalg.norm(curves[0], axis=1) / run.RADIUS
        # chords of two mesh widths lie h^2/8 inside the circle
        assert radius == pytest.approx(np.ones(len(radius)), abs=(np.pi / 16) ** 2 / 8)
        assert np.all(np.diff(curves[0][:, 0]) > 0.0)


def test_numbers_are_written_for_readers() -> None:
    assert number(None) == "–"
    assert number(-0.00123456, "m") == "−0.00123\u202fm"
    assert number(1.5e-7) == "1.5 × 10⁻⁷"
    assert number(1e-6) == "10⁻⁶"
    assert number(1118.4, digits=4) == "1118"
    assert percent(0.2334) == "23\u202f%"
    assert percent(0.0123) == "1.2\u202f%"
    assert percent(0.00042) == "0.042\u202f%"
    assert percent(0.0) == "0\u202f%"


def rubbed(folder: Path, *, on_shell: Array | float, on_itself: Array | float) -> RunFiles:
    """The known run with the slips (n,) [m] at its end."""
    whole_run(folder)
    files = read_run(folder)
    slid = np.zeros_like(files.results.shell_slip)
    shell, itself = slid.copy(), slid.copy()
    shell[-1], itself[-1] = on_shell, on_itself
    results = replace(
        files.results, shell_slip=shell, self_slip=itself, shell_work=1e3 * shell,
        self_work=1e4 * itself,
    )  # fmt: skip
    content = summarise(results, run.statistics(), files.scene, "completed", None)
    return replace(files, results=results, summary=content)


def with_rubber(scene: Scene, **stated: object) -> Scene:
    return scene.model_copy(update={"diaphragm": scene.diaphragm.model_copy(update=stated)})


@pytest.mark.parametrize(
    ("on_shell", "on_itself", "stated"),
    [(0.0, 0.0, []), (0.01, 0.0, ["shell"]), (0.0, 0.01, ["itself"]), (1, 1, ["shell", "itself"])],
)
def test_what_has_not_slid_is_not_drawn(
    tmp_path: Path, on_shell: float, on_itself: float, stated: list[str]
) -> None:
    maps = rub_maps(rubbed(tmp_path, on_shell=on_shell, on_itself=on_itself))
    named = [re.match(r"Where it rubs on (the )?(\w+): (\w+)", item.caption) for item in maps]
    whats = [(match[2], match[3]) for match in named if match]
    assert whats == [(name, what) for name in stated for what in ("way", "pressure")]


def test_a_map_is_an_image_under_its_lines(tmp_path: Path) -> None:
    """Drawn as triangles, it would grow with the sheet."""
    files = rubbed(tmp_path, on_shell=0.01, on_itself=0.0)
    text = base64.b64decode(rub_maps(files)[0].source.partition(",")[2]).decode()
    assert text.count("<image") == 2  # the map and its scale
    assert text.count("<path") < len(files.results.triangles) / 2


def test_the_rubber_is_told_beside_its_strength(tmp_path: Path) -> None:
    slip = np.zeros(len(run.disc()[0]))
    slip[2] = 0.0123  # of the first ring, of eight: 90/8 degrees from the pole, and at 60 of 360
    files = rubbed(tmp_path, on_shell=slip, on_itself=0.002)
    rows = dict(rubber_table(files).rows)
    assert rows["Largest tension"] == "320\u202fN/m"
    assert rows["Largest stress"] == "0.2\u202fMPa"
    assert "Strength of the rubber" not in rows
    strong = dict(
        rubber_table(replace(files, scene=with_rubber(files.scene, strength=11.4e6))).rows
    )
    assert strong["Strength of the rubber"] == "11.4\u202fMPa"


def test_rubs_are_told_with_their_places_and_what_they_wear_off(tmp_path: Path) -> None:
    slip = np.zeros(len(run.disc()[0]))
    slip[2] = 0.0123  # as above; on the shell's lower half, where the known run's sheet lies
    files = rubbed(tmp_path, on_shell=slip, on_itself=0.0)
    rows = rub_table(files).rows
    angles = ["… from the moulded pole, azimuth", "11°, 60°"]
    assert rows == [
        ["Largest slip on the shell", "12.3\u202fmm"],
        angles,
        ["Mean slip on the shell", number(1e3 * files.summary["rubs"]["shell_slip_mean_m"], "mm")],
        ["Largest slip work on the shell", "12.3\u202fJ/m²"],
        angles,
        ["… from the shell’s lower pole, azimuth", "11°, 60°"],
        ["… mean pressure there while sliding", "1000\u202fPa"],
        ["Mean slip work on the shell", rows[7][1]],
        ["Largest slip on itself", "none"],
    ]
    worn = with_rubber(files.scene, wear_coefficient=(1e-9, 4e-9))
    content = summarise(files.results, run.statistics(), worn, "completed", None)
    stated = dict(rub_table(replace(files, scene=worn, summary=content)).rows)
    assert stated["Worn off at the most"] == "0.0123 to 0.0492\u202fµm"


def test_rubs_come_first_where_the_scene_says_so(tmp_path: Path) -> None:
    whole_run(tmp_path)
    files = read_run(tmp_path)
    first = files.scene.model_copy(update={"report": Report(lead="rubs")})
    assert run_page(files).sections[0].title == "Diaphragm"
    assert run_page(replace(files, scene=first)).sections[0].title == "Where the rubber rubs"


def test_rubber_that_has_not_slid_is_said_to(tmp_path: Path) -> None:
    rows = rub_table(rubbed(tmp_path, on_shell=0.0, on_itself=0.0)).rows
    assert rows == [["Largest slip on the shell", "none"], ["Largest slip on itself", "none"]]


def test_halved_steps_are_told_only_where_there_are_any(tmp_path: Path) -> None:
    whole_run(tmp_path)
    files = read_run(tmp_path)
    assert "Steps that had to be halved" not in dict(quality_table(files).rows)
    halved = replace(files, summary=files.summary | {"halved_steps": 3})
    assert dict(quality_table(halved).rows)["Steps that had to be halved"] == "3"


def test_the_tension_of_a_run_still_going_is_that_of_its_instants(tmp_path: Path) -> None:
    whole_run(tmp_path)
    (tmp_path / "summary.json").unlink()
    stated = read_run(tmp_path).summary
    assert stated["tension_max_N_per_m"] == 300.0
    assert stated["stress_max_Pa"] == pytest.approx(300.0 / 0.0018)


def test_a_sheet_that_knows_no_tension_has_none_in_its_report(tmp_path: Path) -> None:
    whole_run(tmp_path)
    files = read_run(tmp_path)
    cloth = files.scene.cloth.model_copy(update={"grid": "thesis"})
    thesis = replace(files, scene=files.scene.model_copy(update={"cloth": cloth}))
    stated = [[item.title for item in run_page(one).sections] for one in (files, thesis)]
    assert set(stated[0]) - set(stated[1]) == {
        "How hard the rubber is pulled",
        "Where the rubber rubs",
    }
