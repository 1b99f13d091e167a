"""The turnable view: what is packed for it, and how it behaves in a real browser."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import known_run
import numpy as np
import pytest
from matplotlib.image import imread
from playwright.sync_api import Browser, Locator, Page, sync_playwright

import coupling.report
import foam_cases
from coupling.campaign.study import run_study
from coupling.report import viewer, write_report
from coupling.report.files import RunFiles, read_run
from coupling.report.picture import last_period_rows
from coupling.scene.scene import load_scene, scene_toml
from coupling.store.results import read_results

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",  # WebGL without a graphics card
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
CHANGES = [
    "time.duration=0.4",
    "time.step=0.02",
    "time.output_every=1",
    "cloth.resolution=6",
]
SAME = 2 / 24  # two lines of full contrast, a pixel wide, shifted out of a block of 24 pixels
Open = Callable[..., Page]


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A real study's folder, its runs with their own reports."""
    folder = tmp_path_factory.mktemp("study")
    scene = load_scene(Path(foam_cases.__file__).parent / "pad_sway_coarse", CHANGES)
    run_study(scene, ("hydrostatic", "potential"), folder)
    for model in ("hydrostatic", "potential"):
        write_report(folder / model)
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def look(browser: Browser) -> Iterator[Open]:
    """Open a folder's report; afterwards nothing may have been complained of or fetched."""
    complaints: list[str] = []
    fetched: list[str] = []
    pages: set[str] = set()

    def opened(folder: Path, width: int = 1200, **context: Any) -> Page:
        page = browser.new_context(viewport={"width": width, "height": 1400}, **context).new_page()
        page.set_default_timeout(30_000)
        page.on("console", lambda stated: stated.type == "error" and complaints.append(stated.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: fetched.append(request.url))
        pages.add((folder / "report.html").as_uri())
        page.goto((folder / "report.html").as_uri())
        return page

    yield opened
    for context in browser.contexts:
        context.close()
    assert complaints == []
    assert {url for url in fetched if not url.startswith("data:")} == pages


def canvases(page: Page) -> list[Locator]:
    return page.locator(".viewer canvas").all()


def pictures(page: Page) -> list[bytes]:
    return [canvas.screenshot() for canvas in canvases(page)]


def unlike(one: bytes, other: bytes, block: int = 24) -> float:
    """Largest difference of the two pictures' colours, each the mean of ``block`` pixels square.

    Two panels stand at different fractions of a pixel, so even the same scene differs by pixels.
    """
    images = [imread(BytesIO(picture)) for picture in (one, other)]
    sides = images[0].shape[0] // block
    cut = [image[: sides * block, : sides * block, :3] for image in images]
    means = [part.reshape(sides, block, sides, block, 3).mean(axis=(1, 3)) for part in cut]
    return float(np.abs(means[0] - means[1]).max())


def test_a_drag_turns_both_views_and_reset_turns_them_back(study: Path, look: Open) -> None:
    page = look(study)
    before = pictures(page)
    box = canvases(page)[0].bounding_box()
    assert box
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 280, box["y"] + 240, steps=4)
    page.mouse.up()
    after = pictures(page)
    assert all(new != old for new, old in zip(after, before, strict=True))
    page.get_by_role("button", name="Reset view").click()
    assert pictures(page) == before


def test_arrow_keys_turn_the_view_that_has_the_focus(study: Path, look: Open) -> None:
    page = look(study / "potential")
    before = pictures(page)
    for key in ("ArrowLeft", "ArrowUp"):
        canvases(page)[0].press(key)
    assert all(new != old for new, old in zip(pictures(page), before, strict=True))


def test_play_advances_the_slider_and_pause_stops_it(study: Path, look: Open) -> None:
    page = look(study)
    slider = page.get_by_label("Instant")
    before, stated = pictures(page), page.locator(".viewer output").text_content()
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("document.querySelector('.viewer input').value > 1")
    page.get_by_role("button", name="Pause").click()
    stopped = slider.input_value()
    page.wait_for_timeout(600)  # an instant takes 400 ms: a period of 10 takes 4 s
    assert slider.input_value() == stopped
    assert pictures(page) != before
    assert page.locator(".viewer output").text_content() != stated


def test_the_slider_tells_the_instants_of_the_results(study: Path, look: Open) -> None:
    page = look(study)
    results = read_results(study / "potential")
    times = results.time[last_period_rows(results, viewer.INSTANTS)]
    slider = page.get_by_label("Instant")
    stated = []
    for _ in times:
        stated.append(float((slider.get_attribute("aria-valuetext") or "").split()[2]))
        slider.press("ArrowRight")
    assert stated == pytest.approx(times.tolist(), abs=5e-4)  # stated to a millisecond


def test_the_chosen_models_are_shown(study: Path, look: Open) -> None:
    page = look(study)
    models = page.get_by_label("Model")
    assert [models.nth(k).input_value() for k in (0, 1)] == ["hydrostatic", "potential"]
    assert unlike(*pictures(page)) > 2 * SAME
    models.first.select_option("potential")
    assert unlike(*pictures(page)) < SAME
    page.get_by_label("Shown", exact=True).first.select_option("dynamic")
    assert unlike(*pictures(page)) > 2 * SAME


def test_a_scale_of_its_own_is_that_of_the_panel(study: Path, look: Open) -> None:
    page = look(study / "potential")  # hydrostatic pressure beside p*
    ends = page.locator(".viewer-scale span:last-child")
    assert ends.first.text_content() == ends.last.text_content()
    page.get_by_label("one scale for both").uncheck()
    assert ends.first.text_content() != ends.last.text_content()


def test_a_run_without_a_flow_says_that_it_has_no_dynamic_pressure(study: Path, look: Open) -> None:
    page = look(study / "hydrostatic")
    assert len(canvases(page)) == 1
    assert "its p* is zero" in (page.locator(".viewer figcaption").text_content() or "")


def test_a_telephone_shows_it_stacked_without_scrolling_aside(study: Path, look: Open) -> None:
    page = look(study, width=390, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    upper, lower = (canvas.bounding_box() for canvas in canvases(page))
    assert upper
    assert lower
    assert lower["x"] == upper["x"]
    assert lower["y"] > upper["y"] + upper["height"]


def swipe(page: Page, begin: tuple[float, float], way: tuple[float, float]) -> None:
    """One finger, from ``begin`` by ``way`` [pixels]."""
    finger = page.context.new_cdp_session(page)
    for kind, share in (
        ("touchStart", 0.0),
        *(("touchMove", 0.2 * k) for k in range(1, 6)),
        ("touchEnd", 1.0),
    ):
        at = {"x": begin[0] + share * way[0], "y": begin[1] + share * way[1]}
        points = [] if kind == "touchEnd" else [at]
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_a_finger_turns_sideways_and_scrolls_up_and_down(study: Path, look: Open) -> None:
    page = look(study, width=390, has_touch=True)
    before = pictures(page)
    canvas = canvases(page)[0]
    canvas.scroll_into_view_if_needed()
    box, scrolled = canvas.bounding_box(), page.evaluate("scrollY")
    assert box
    middle = (box["x"] + 150, box["y"] + 150)
    swipe(page, middle, (100, 0))
    assert all(new != old for new, old in zip(pictures(page), before, strict=True))
    assert page.evaluate("scrollY") == scrolled
    swipe(page, middle, (0, -120))
    page.wait_for_function(f"scrollY > {scrolled + 50}")


def test_print_and_a_browser_without_scripts_have_the_pictures(study: Path, look: Open) -> None:
    printed = look(study)
    printed.emulate_media(media="print")
    bare = look(study, java_script_enabled=False)
    for page in (printed, bare):
        assert not page.locator(".viewer").is_visible()
        assert page.get_by_alt_text("Diaphragm in the tank at").first.is_visible()
    assert not printed.locator(".viewer-missing").is_visible()
    assert bare.locator(".viewer-missing").is_visible()


def test_the_bundle_is_of_the_version_that_its_recipe_names(study: Path, look: Open) -> None:
    recipe = Path(coupling.report.__file__).parent / "webgl" / "package.json"
    named = json.loads(recipe.read_text())["devDependencies"]["three"]
    assert look(study).evaluate("THREE.REVISION") == named.split(".")[1]


@pytest.fixture
def known(tmp_path: Path) -> RunFiles:
    scene = scene_toml(known_run.scene())
    known_run.write_run(tmp_path, scene=scene)
    (tmp_path / "scene.toml").write_text(scene)
    return read_run(tmp_path)


def unpacked(packed: dict[str, Any]) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(packed["values"]), "<i2")
    return packed["unit"] * values.astype(float)


def test_what_is_packed_is_the_results_to_half_a_unit(known: RunFiles) -> None:
    packed = json.loads(viewer.run_viewer(known))
    rows = last_period_rows(known.results, viewer.INSTANTS)
    # a period of 0.8 s by instants 0.02 s apart
    assert packed["time"] == pytest.approx(known.results.time[rows].tolist())
    assert len(rows) == 40
    run = packed["runs"][0]
    for stated, meant in (
        (run["position"], known.results.position[rows]),
        (run["pressure"], known.results.pressure[rows] / 1e3),
        (run["dynamic"], known.results.dynamic_pressure[rows] / 1e3),
    ):
        # half of a 16 bit integer's worth, and the rounding of its product
        most = 0.5 * np.abs(meant).max() / 32767 * (1.0 + 1e-9)
        assert np.abs(unpacked(stated) - meant.ravel()).max() <= most


def test_many_nodes_are_shown_at_fewer_instants(
    known: RunFiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    a_node = 2 * (3 + 1 + 1)
    fixed = 2 * known.results.triangles.size
    monkeypatch.setattr(viewer, "BYTES", fixed + 12 * a_node * len(known.results.reference))
    times = json.loads(viewer.run_viewer(known))["time"]
    assert len(times) == 10  # of 40, every fourth: the most even choice of 12 at most
    assert times[-1] == pytest.approx(known.results.time[-1])
    assert np.ptp(np.diff(times)) < 2e-5  # stated to 1e-5 s
