"""The runs of a study that theory knows the answers of."""

import pytest
from small_scene import SMALL

from coupling.campaign.study import run_or_reuse
from coupling.campaign.study_plan import AS_RUN, Entry
from coupling.campaign.theory_checks import check_entries, check_rows, level_sway, small_sway
from coupling.scene.scene import load_scene, with_overrides

MODELS = ("datum", "hydrostatic", "potential", "openfoam")


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "scene.toml").write_text(SMALL + "[time]\nduration = 1.0\n")
    return load_scene(tmp_path)


def test_half_full_a_level_surface_moves_the_cg_by_three_eighths_of_the_radius(scene):
    scene = with_overrides(scene, ["liquid.fill_fraction=0.5", "motion.kind=sine"])
    frequency, radius = 6.283185307179586 * scene.motion.frequency, scene.tank.radius
    exact = 0.375 * radius * frequency**2 / 9.81
    assert level_sway(scene) == pytest.approx(exact, rel=1e-12)


def test_slow_and_small_a_sum_of_modes_is_a_level_surface(scene):
    # The modes above the sixth hold 4e-4 of the sum of m_k/lambda_k at this fill.
    slow = with_overrides(scene, ["motion.frequency=0.01"])
    assert small_sway(slow) == pytest.approx(level_sway(slow), rel=1e-3)


def test_the_checks_of_a_sine_are_three_and_a_record_at_an_angle_has_none(scene):
    entries = {e.resolution: e.scene for e in check_entries(scene, MODELS)}
    assert list(entries) == ["similar", "small_sway", "level_sway"]
    assert [one.model.fluid for one in entries.values()] == [
        "potential", "potential", "hydrostatic",
    ]  # fmt: skip
    assert entries["similar"].tank.radius == scene.tank.radius / 4
    assert entries["similar"].time.steps == scene.time.steps
    assert check_entries(with_overrides(scene, ["motion.direction=[1.0, 0.0, 1.0]"]), MODELS) == []
    assert check_entries(with_overrides(scene, ["motion.kind=rest"]), MODELS) == []


def test_a_similar_tank_moves_alike_and_slow_sway_is_level(scene, tmp_path):
    quick = with_overrides(scene, ["cloth.resolution=8", "time.duration=1.0", "time.step=0.02"])
    entries = check_entries(quick, ("hydrostatic",))
    assert [e.resolution for e in entries] == ["similar", "level_sway"]
    as_run = Entry(
        row="hydrostatic", resolution=AS_RUN,
        scene=with_overrides(quick, ["model.fluid=hydrostatic"]),
    )  # fmt: skip
    done = [
        (entry, run_or_reuse(entry.scene, tmp_path / entry.place, None))
        for entry in (as_run, *entries)
    ]
    similar, level = check_rows(done, {"hydrostatic": done[0][1]})
    assert similar["error"] < 1e-9  # rounding
    # Eight rings stand up at the rim by one edge in the way of the tilt: of second order in it.
    assert level["error"] < 0.15
    assert level["frequency_ratio"] == pytest.approx(0.25)
