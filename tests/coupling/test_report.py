"""Reports: built from the files alone, self-contained, of whole and of broken runs."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import known_run as run
import numpy as np
import pytest
from matplotlib.image import imread

from coupling.atomic import write_json
from coupling.metrics.summary import summarise
from coupling.ports import RunStatistics
from coupling.report import render_picture, write_report
from coupling.report.page import number, percent
from coupling.report.picture import period_rows
from coupling.report.section_cut import cut
from coupling.results import ResultsWriter, read_results
from coupling.scene import scene_toml


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
        if tag not in {"img", "meta"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def whole_run(folder: Path, model: str = "openfoam", **known: float) -> None:
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
    assert not re.search(r"\bnan\b|\bNone\b", re.sub(r"data:image[^\"]*", "", text))
    return text, page


def test_a_run_is_reported_with_its_verdict_and_figures(tmp_path: Path) -> None:
    whole_run(tmp_path)
    (tmp_path / "coupling.csv").write_text(
        "time,iteration,residual,seconds\n0.02,1,0.1,0.1\n0.02,2,1e-5,0.1\n0.04,1,1e-5,0.1\n"
    )
    text, page = parsed(write_report(tmp_path))
    assert "it leaves out 20\u202f% of the liquid&#39;s momentum" in text
    assert len(page.images) == 8 + 1 + 2 + 2 + 4  # instants, scale, pressures, motions, quality
    assert "−30.0" in text  # the lag of the CG
    assert "Known run" in text


def test_a_broken_run_says_why(tmp_path: Path) -> None:
    reference, triangles = run.disc()
    scene = run.scene()
    ResultsWriter(
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
    writer = ResultsWriter(
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
