"""Scenes: read, checked, changed, written."""

import math
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from coupling.scene.content import content_of
from coupling.scene.numerics import Time
from coupling.scene.scene import (
    Scene,
    SceneError,
    load_scene,
    scene_from,
    scene_toml,
    with_overrides,
)
from coupling.store.scene_file import write_scene

PAD_SWAY = """\
title = "Pad sway"

[tank]
radius = 0.4445

[diaphragm]
thickness = 0.001778
material = "AF-E-332"

[liquid]
density = 1000
viscosity = 1.0e-6
fill_fraction = 0.8

[motion]
kind = "sine"
frequency = 1.25
amplitude = 0.25

[time]
duration = 10.0
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    case = tmp_path / "pad_sway"
    case.mkdir()
    (case / "scene.toml").write_text(PAD_SWAY)
    return case


def test_a_folder_and_its_file_give_the_same_scene(folder: Path):
    scene = load_scene(folder)
    assert scene == load_scene(folder / "scene.toml")
    assert scene.tank.radius == 0.4445
    assert scene.liquid.density == 1000.0
    assert scene.gravity == (0.0, 0.0, -9.81)
    assert scene.period == 0.8
    assert scene.time.steps == 2000


def test_volumes_and_stiffness(folder: Path):
    scene = load_scene(folder)
    assert scene.liquid_volume == pytest.approx(0.8 * 4 / 3 * math.pi * 0.4445**3, rel=1e-14)
    assert scene.diaphragm.sheet.area_density == pytest.approx(1070 * 0.001778, rel=1e-14)
    expected = 8.6e6 * 0.001778**3 / 9.0  # 12 (1 - 1/4) = 9
    assert scene.diaphragm.sheet.bending_stiffness == pytest.approx(expected, rel=1e-14)


def test_a_material_gives_its_numbers_and_a_number_overrides_it(folder: Path):
    assert load_scene(folder).diaphragm.youngs_modulus == 8.6e6
    softer = load_scene(folder, ["diaphragm.youngs_modulus=4.3e6"])
    assert softer.diaphragm.youngs_modulus == 4.3e6
    assert softer.diaphragm.density == 1070.0
    with pytest.raises(SceneError, match=r"diaphragm\.youngs_modulus: is required"):
        load_scene(folder, ["diaphragm.material=SIFA-35"])


def test_a_name_on_the_command_line_replaces_the_numbers_of_the_file(folder: Path):
    scene = load_scene(folder, ["liquid.name=fc-72"])
    assert (scene.liquid.density, scene.liquid.surface_tension) == (1680.0, 0.010)
    heavier = load_scene(folder, ["liquid.name=water", "liquid.density=1100"])
    assert heavier.liquid.density == 1100.0


def test_the_strength_is_the_materials_unless_it_is_given(folder: Path):
    assert load_scene(folder).diaphragm.strength == 11.4e6
    aged = ["diaphragm.strength=5e6"]
    assert load_scene(folder, aged).diaphragm.strength == 5e6
    # Another material takes the old strength with it, whether it has one of its own or not.
    sifa = ["diaphragm.material=SIFA-35", "diaphragm.youngs_modulus=8e6"]
    assert load_scene(folder, [*aged, *sifa]).diaphragm.strength is None
    assert with_overrides(load_scene(folder), sifa).diaphragm.strength is None
    (line,) = problems(folder, "diaphragm.strength=0")
    assert "must be positive, got 0. Give the tensile strength of the rubber [Pa]." in line


def test_overrides_are_toml_or_text(folder: Path):
    scene = load_scene(
        folder, ["model.fluid=datum", "motion.direction=[0, 1, 0]", 'title = "a = b"']
    )
    assert scene.model.fluid == "datum"
    assert scene.motion.direction == (0.0, 1.0, 0.0)
    assert scene.title == "a = b"
    assert with_overrides(scene, ["tank.radius=0.5"]).tank.radius == 0.5
    for text, value in ((".5", 0.5), ("5.", 5.0), ("+.5e1", 5.0)):
        assert with_overrides(scene, [f"tank.radius={text}"]).tank.radius == value
    assert scene.tank.radius == 0.4445


def test_a_scene_cannot_be_changed(folder: Path):
    with pytest.raises(ValidationError):
        load_scene(folder).tank.radius = 1.0


def test_every_default_is_written_out(folder: Path):
    written = tomllib.loads(scene_toml(load_scene(folder)))
    for name, field in Scene.model_fields.items():
        assert name in written
        section = getattr(field.annotation, "model_fields", {})
        for key, item in section.items():
            assert key in written[name] or item.default is None, f"{name}.{key}"


positive = st.floats(1e-3, 1e3)


@settings(max_examples=60, deadline=None)
@given(
    radius=st.floats(1e-2, 10.0),
    fill_fraction=st.floats(0.001, 0.999),
    density=positive,
    frequency=st.floats(0.01, 5.0),
    direction=st.tuples(*[st.floats(-2.0, 2.0)] * 3).filter(lambda v: max(map(abs, v)) > 1e-9),
    title=st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=20),
    scheme=st.sampled_from(["added-mass", "iqn-ils", "aitken", "fixed-point"]),
    rings=st.integers(4, 200),
)
def test_toml_round_trip_gives_an_equal_scene(
    radius, fill_fraction, density, frequency, direction, title, scheme, rings
):
    scene = scene_from(
        {
            "title": title,
            "tank": {"radius": radius},
            "diaphragm": {"thickness": radius / 100, "material": "AF-E-332", "density": density},
            "liquid": {"name": "water", "fill_fraction": fill_fraction},
            "motion": {
                "kind": "sine",
                "frequency": frequency,
                "amplitude": 0.1,
                "direction": list(direction),
            },
            "coupling": {"scheme": scheme},
            "cloth": {"resolution": rings},
            "time": {"duration": 1.0},
        }
    )
    assert scene_from(tomllib.loads(scene_toml(scene))) == scene


def test_a_run_can_be_run_again_from_its_folder(folder: Path, tmp_path: Path):
    (folder / "truck.csv").write_text("time,ax,ay,az\n0,0,0,0\n12,1,0,0\n")
    scene = load_scene(folder, ["motion.kind=table", "motion.file=truck.csv"])
    run = tmp_path / "run"
    run.mkdir()
    assert write_scene(scene, run) == run / "scene.toml"
    moved = run.rename(tmp_path / "moved")
    (folder / "truck.csv").unlink()
    again = load_scene(moved)
    assert again.motion.file == str((moved / "motion.csv").resolve())
    unfiled = {"motion": scene.motion.model_copy(update={"file": None})}
    assert again.model_copy(update=unfiled) == scene.model_copy(update=unfiled)
    write_scene(again, moved)  # over itself: the table stays
    assert load_scene(moved) == again


def problems(folder: Path, *overrides: str) -> tuple[str, ...]:
    with pytest.raises(SceneError) as caught:
        load_scene(folder, overrides)
    return caught.value.problems


def test_an_error_says_where_what_and_the_mend(folder: Path):
    file = folder / "scene.toml"
    file.write_text(PAD_SWAY.replace("fill_fraction = 0.8", "fill_fraction = 1.4"))
    assert problems(folder) == (
        f"{file}: liquid.fill_fraction: must lie in (0, 1), got 1.4. "
        "Give the liquid volume over the tank volume.",
    )


def test_all_problems_are_listed_at_once(folder: Path):
    found = problems(folder, "tank.radius=-1", "liquid.fill_fraction=0", "cloth.resolution=many")
    assert [line.split(": ")[1] for line in found] == [
        "tank.radius",
        "liquid.fill_fraction",
        "cloth.resolution",
    ]
    crossed = problems(folder, "time.step=1.0", "gravity=[0,0,0]", "motion.direction=[0,0,0]")
    assert len(crossed) == 3


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("liquid.fill_fracton=0.5", "unknown key. Did you mean fill_fraction?"),
        ("tnak.radius=0.5", "unknown section. Did you mean tank?"),
        ("tank.colour=3", "unknown key. Known here: radius, shape, "),
        ("cloth.rim=clamped", "cloth.rim: unknown key. Did you mean diaphragm.rim?"),
        ("radius=0.4", "radius: unknown key. Did you mean tank.radius?"),
        ("tank.gravity=[0,0,-9.81]", "unknown key. gravity stands above all sections."),
        (
            "diaphragm.tolerance=1e-4",
            "Did you mean model.tolerance or cloth.tolerance or coupling.tolerance?",
        ),
        ("tank=3", "must be a section [tank], got 3"),
        ("tank.radius=true", "must be a number, got true"),
        ("tank.radius=nan", "must be a finite number, got nan"),
        ("tank.radius=0", "must be positive, got 0"),
        ("cloth.resolution=3.5", "must be a whole number, got 3.5"),
        ("cloth.resolution=2", "must lie in [4, 200], got 2"),
        ("gravity=[0,0]", "must be three numbers in brackets, got [0, 0]"),
        ("gravity=[0,0,0,1]", "must be three numbers in brackets, got [0, 0, 0, 1]"),
        ("gravity=[0,0,'x']", 'must be a number, got "x"'),
        ("gravity=[0,0,0]", "A weightless liquid has no level"),
        ("diaphragm.held=1", "must be true or false, got 1"),
        ("diaphragm.inextensible=no", 'must be true or false, got "no"'),
        ("diaphragm.loss_factor=0.1", "inextensible = true, whose stretch is numerical"),
        ("diaphragm.friction_shell=-0.1", "must lie in [0, 5], got -0.1"),
        ("diaphragm.poisson_ratio=0.7", "must lie in [0, 0.5], got 0.7"),
        ("diaphragm.thickness=0.03", "must be below 0.05 radii (0.02223 m), got 0.03"),
        ("diaphragm.material=teflon", '"teflon" is not a built-in elastomer'),
        ("liquid.name=mercury", '"mercury" is not a built-in liquid. Use one of water, hydrazine'),
        (
            "model.fluid=potentiel",
            'one of "datum", "hydrostatic", "potential", "openfoam", "auto", got "potentiel"',
        ),
        ("model.fluid=openfom", "Did you mean openfoam?"),
        ("openfoam.processors=0", "must lie in [1, 256], got 0"),
        ("openfoam.keep_alive=1", "must be true or false, got 1"),
        ("diaphragm.rim=glued", 'must be one of "hinged", "clamped", got "glued"'),
        ("cloth.wrinkling=sharp", 'must be one of "relaxed", "resolved", got "sharp"'),
        ("cloth.grid=square", 'one of "rings", "thesis", got "square"'),
        ("cloth.grid=thesis", 'needs model.fluid = "datum", got "openfoam"'),
        ("motion.ramp=-1", "must not be negative, got -1"),
        ("motion.file=3", "must be text in quotes, got 3"),
        ("time.duration=0.001", "must be at least time.step (0.005 s), got 0.001"),
        ("time.step=0.05", "must be at most 1/20 of the motion's period (0.04 s), got 0.05"),
    ],
)
def test_a_wrong_value_is_refused_with_its_range(folder: Path, override: str, says: str):
    (line,) = problems(folder, override)
    assert line.startswith("--set: " + override.partition("=")[0].split(".")[0])
    assert says in line


def test_missing_keys_and_sections_are_named(folder: Path):
    (folder / "scene.toml").write_text('[motion]\nkind = "sine"\n[tank]\n')
    found = "\n".join(problems(folder))
    assert (
        'tank.radius: is required for shape = "sphere". Give the tank\'s inner radius [m].' in found
    )
    assert "diaphragm: is required. Add the section [diaphragm]." in found


def test_what_a_motion_needs_is_asked_for(folder: Path):
    (line,) = problems(folder, "motion.kind=table")
    assert 'motion.file: is required for kind = "table"' in line
    text = PAD_SWAY.replace("frequency = 1.25\n", "")
    (folder / "scene.toml").write_text(text)
    (line,) = problems(folder)
    assert 'motion.frequency: is required for kind = "sine"' in line


def test_the_thesis_grid_is_even_and_by_default_that_of_the_thesis(folder: Path):
    wanted = ["cloth.grid=thesis", "model.fluid=datum"]
    assert load_scene(folder, wanted).cloth.resolution == 26
    assert load_scene(folder, [*wanted, "cloth.resolution=14"]).cloth.resolution == 14
    (line,) = problems(folder, *wanted, "cloth.resolution=25")
    assert 'cloth.resolution: must be even for cloth.grid = "thesis", got 25.' in line


def test_the_thesis_grid_is_moulded_above_the_rim(folder: Path):
    """It was taken for the upper part without a word."""
    (line,) = problems(folder, "cloth.grid=thesis", "model.fluid=datum", "diaphragm.mould=lower")
    assert 'diaphragm.mould: must be "upper" for cloth.grid = "thesis", got "lower".' in line


def test_the_thesis_grid_has_a_hinged_rim(folder: Path):
    assert load_scene(folder, ["diaphragm.rim=clamped"]).diaphragm.rim == "clamped"
    (line,) = problems(folder, "cloth.grid=thesis", "model.fluid=datum", "diaphragm.rim=clamped")
    assert 'diaphragm.rim: must be "hinged" for cloth.grid = "thesis", got "clamped".' in line


def test_the_thesis_grid_does_not_stretch(folder: Path):
    (line,) = problems(
        folder, "cloth.grid=thesis", "model.fluid=datum", "diaphragm.inextensible=false"
    )
    assert 'diaphragm.inextensible: must be true for cloth.grid = "thesis", got false.' in line


def test_a_loss_factor_without_a_sine_needs_its_frequency(folder: Path):
    lossy = ["diaphragm.inextensible=false", "diaphragm.loss_factor=0.15", "motion.kind=rest"]
    (line,) = problems(folder, *lossy)
    assert "diaphragm.loss_frequency: is required" in line
    assert "Give the frequency [Hz] of loss_factor" in line
    assert load_scene(folder, [*lossy, "diaphragm.loss_frequency=2"]).loss_time > 0.0


def test_the_thesis_grid_knows_no_friction(folder: Path):
    thesis = ["cloth.grid=thesis", "model.fluid=datum", "diaphragm.friction_shell=0.3"]
    (line,) = problems(folder, *thesis)
    assert 'diaphragm.friction_shell: does not apply to cloth.grid = "thesis", got 0.3.' in line


def test_wrinkles_are_resolved_by_ten_cells_a_wavelength(folder: Path):
    fine = load_scene(folder, ["cloth.wrinkling=resolved", "cloth.resolution=41"])
    assert fine.cloth.wrinkling == "resolved"
    (line,) = problems(folder, "cloth.wrinkling=resolved", "cloth.resolution=40")
    assert line.startswith('--set: cloth.wrinkling: "resolved" needs 10 spacings to the elasto-')
    # 2 pi (kappa/(rho g))^(1/4) with kappa = E t^3/9, and pi R/2/40
    assert "wavelength of 0.1709 m, so 41 rings; got 40 rings, 0.01746 m apart." in line
    assert 'Give cloth.resolution = 41 or more, or take cloth.wrinkling = "relaxed".' in line
    (line,) = problems(folder, "cloth.wrinkling=resolved", "diaphragm.thickness=0.0001")
    assert 'A grid has at most 200 rings: take cloth.wrinkling = "relaxed".' in line
    (line,) = problems(folder, "cloth.wrinkling=resolved", "cloth.grid=thesis", "model.fluid=datum")
    assert 'cloth.wrinkling: does not apply to cloth.grid = "thesis", got "resolved".' in line


def test_a_record_beside_a_sine_is_not_passed_over(folder):
    (line,) = problems(folder, "motion.file=truck.csv")
    assert line.startswith('--set: motion.file: is read with motion.kind = "table" or "psd" only')


def test_a_table_must_cover_the_run(folder: Path):
    (folder / "truck.csv").write_text("0,0,0,0\n9.9,0,0,0\n")
    (line,) = problems(folder, "motion.kind=table", "motion.file=truck.csv")
    assert "must cover 0 to 10 s, covers 0 to 9.9 s" in line
    load_scene(folder, ["motion.kind=table", "motion.file=truck.csv", "time.duration=9.9"])


def test_files_that_cannot_be_read(folder: Path, tmp_path: Path):
    assert "does not exist" in problems(tmp_path / "nowhere")[0]
    assert "the folder holds no scene.toml" in problems(tmp_path)[0]
    (line,) = problems(folder, "motion.kind=table", f"motion.file={tmp_path}")
    assert line.endswith("Is a directory. Give a file that is there and may be read.")
    file = folder / "scene.toml"
    file.write_text("title = 'a'\n[tank\nradius = 1\n")
    assert "line 2" in problems(folder)[0]
    file.write_text(PAD_SWAY.replace("0.4445", "0,4445", 1))
    assert "numbers with a decimal point" in problems(folder)[0]
    file.write_bytes(b"\xff\xfe\x00")
    assert "is not UTF-8 text. Save the scene as text in UTF-8." in problems(folder)[0]
    for text in ("radius", "=3", ".a=3", "title.a=3"):
        file.write_text(PAD_SWAY)
        assert problems(folder, text)[0].startswith(f"--set {text}:")


def test_a_peak_acceleration_stands_for_the_amplitude(folder: Path):
    text = (folder / "scene.toml").read_text()
    by_amplitude = load_scene(folder)
    omega = 2.0 * math.pi * by_amplitude.motion.frequency
    line = f"amplitude = {by_amplitude.motion.amplitude}"
    assert line in text
    peak = by_amplitude.motion.amplitude * omega**2
    (folder / "scene.toml").write_text(text.replace(line, f"acceleration = {peak!r}"))
    by_acceleration = load_scene(folder)
    # one division and one product more: two roundings
    assert by_acceleration.motion.amplitude == pytest.approx(
        by_amplitude.motion.amplitude, rel=4e-16
    )
    assert scene_from(tomllib.loads(scene_toml(by_acceleration))) == by_acceleration
    faster = load_scene(folder, ["motion.frequency=5.0"])
    assert faster.motion.amplitude == pytest.approx(peak / (10.0 * math.pi) ** 2, rel=1e-15)


def test_an_acceleration_that_cannot_be_taken_is_told(folder: Path):
    both = PAD_SWAY.replace("amplitude", "acceleration = 1.0\namplitude")
    (folder / "scene.toml").write_text(both)
    assert "motion.acceleration: got 1.0 beside an amplitude" in problems(folder)[0]
    (line,) = problems(folder, "motion.acceleration=1.0", "motion.kind=rest")
    assert "motion.acceleration: got 1.0 without a sine" in line


IN_PERIODS = PAD_SWAY.replace("duration = 10.0", "periods = 6\nsteps_per_period = 60")


def test_periods_and_steps_per_period_follow_the_frequency(folder: Path, tmp_path: Path):
    (folder / "scene.toml").write_text(IN_PERIODS)
    for frequency in (1.25, 0.1, 0.7):
        scene = load_scene(folder, [f"motion.frequency={frequency}"])
        assert scene.time.duration == pytest.approx(6.0 / frequency, rel=1e-15)
        assert scene.time.step == pytest.approx(1.0 / (60.0 * frequency), rel=1e-15)
        assert scene.time.steps == 360
        assert (scene.time.periods, scene.time.steps_per_period) == (None, None)
        assert scene_from(tomllib.loads(scene_toml(scene))) == scene
        write_scene(scene, tmp_path)
        assert content_of(load_scene(tmp_path)) == content_of(scene)


def test_seconds_on_the_command_line_replace_periods(folder: Path):
    (folder / "scene.toml").write_text(IN_PERIODS)
    time = load_scene(folder, ["time.duration=2.0", "time.step=0.01"]).time
    assert (time.duration, time.step) == (2.0, 0.01)
    (folder / "scene.toml").write_text(PAD_SWAY)
    assert load_scene(folder, ["time.periods=2.5"]).time.duration == 2.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("periods = 6", "periods = 6\nduration = 1.0"), "Leave one of the two out."),
        (("periods = 6", "periods = 6\nstep = 0.01"), "time.steps_per_period: stands in place of"),
        (('"sine"', '"rest"'), 'time.periods: needs motion.kind = "sine". Give time.duration'),
        (("frequency = 1.25\n", ""), "time.periods: needs a positive motion.frequency."),
        (("= 60", "= 19"), "time.steps_per_period: must lie in [20, 1e+06], got 19."),
        (("= 60", "= 60.5"), "time.steps_per_period: must be a whole number, got 60.5."),
        (("= 6\n", "= -1\n"), "time.periods: must be positive, got -1."),
        (("periods = 6", "period = 6"), "time.period: unknown key. Did you mean periods?"),
    ],
)
def test_periods_that_cannot_be_used_are_refused(folder: Path, change: tuple[str, str], says: str):
    (folder / "scene.toml").write_text(IN_PERIODS.replace(*change))
    assert says in "\n".join(problems(folder))


@pytest.mark.parametrize(
    ("duration", "step", "steps"),
    [(0.025, 0.01, 3), (0.3, 0.1, 3), (0.021, 0.01, 3), (1.0, 0.0333333, 30), (0.7, 0.1, 7)],
)
def test_a_duration_is_reached_in_whole_steps(duration: float, step: float, steps: int):
    """Of 0.025 s at 0.01 s, 0.02 s were computed, and called completed."""
    time = Time(duration=duration, step=step)
    assert time.steps == steps
    assert time.end >= duration * (1.0 - 1e-5)
    assert bool(time.beyond) == (steps == 3 and duration != 0.3)


@pytest.mark.parametrize("frequency", [0.3, 0.7, 1.1, 1.3, 2.9, 3.7])
@pytest.mark.parametrize("per_period", [20, 33, 70])
def test_whole_periods_are_whole_steps(frequency: float, per_period: int):
    time = Time(duration=7 / frequency, step=1.0 / per_period / frequency)
    assert (time.steps, time.beyond) == (7 * per_period, "")


@pytest.mark.parametrize(
    "value", ["[1e-9]", "[2e-9, 1e-9]", "[0.0, 1e-9]", "[true, 1.0]", "1e-9", "[1e-9, inf]", '"k"']
)
def test_a_wear_coefficient_is_a_range(folder: Path, value: str) -> None:
    with pytest.raises(SceneError, match=r"wear_coefficient: must be two numbers .* rigs differ"):
        load_scene(folder, [f"diaphragm.wear_coefficient={value}"])


def test_neither_wear_nor_the_report_change_what_is_computed(folder: Path) -> None:
    changes = ["diaphragm.wear_coefficient=[1e-16, 4e-14]", 'report.lead="rubs"']
    plain = load_scene(folder)
    assert plain.diaphragm.wear_coefficient is None
    changed = load_scene(folder, changes)
    assert changed.diaphragm.wear_coefficient == (1e-16, 4e-14)
    assert content_of(changed).digest() == content_of(plain).digest()
    assert scene_from(tomllib.loads(scene_toml(changed))) == changed
