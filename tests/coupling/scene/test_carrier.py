"""What a scene may say of its carrier, and what is said where that is wrong."""

from pathlib import Path

import numpy as np
import pytest
from water_tank import scene

from coupling.estimate.model_errors import choose
from coupling.mechanical.plan import conditions
from coupling.scene.force_table import read_force_table
from coupling.scene.scene import SceneError, load_scene, scene_toml, with_overrides
from coupling.scene.tables.text import TableError
from coupling.store.scene_file import write_scene

FREE = {"kind": "free", "mass": 30.0}
TABLE = "time (ms); fx (kN); fy (kN); fz (kN)\n0; 0; 0; 0\n50; 0,2; 0; -0,1\n200; 0; 0; 0\n"


@pytest.fixture
def forces(tmp_path: Path) -> Path:
    file = tmp_path / "given" / "pushes.csv"
    file.parent.mkdir()
    file.write_text(TABLE)
    return file


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        ({"carrier": {"kind": "free"}}, 'carrier.mass: is required for kind = "free". Give the'),
        ({"carrier": {"mass": 30.0}}, 'carrier.mass: is read with carrier.kind = "free" only'),
        (
            {"carrier": {"springs": [1.0, 0.0, 0.0]}},
            'carrier.springs: is read with carrier.kind = "free" only',
        ),
        ({"carrier": FREE | {"springs": [-1.0, 0.0, 0.0]}}, "carrier.springs: must not be negat"),
        ({"carrier": FREE | {"inertia": 1.0}}, "carrier.inertia"),
        ({"carrier": FREE | {"inertia": [1.0, 1.0, 2.1]}}, "none above the sum of the two others"),
        ({"carrier": FREE | {"inertia": [1.0, 0.0, 1.0]}}, "carrier.inertia: must be above 0"),
        (
            {"carrier": FREE | {"rotational_springs": [1.0, 0.0, 0.0]}},
            "carrier.rotational_springs: is read with a carrier.inertia only",
        ),
        (
            {
                "carrier": FREE | {"inertia": [1.0, 1.0, 1.0]},
                "tank": {"shape": "pill", "radius": 0.3, "cylinder_length": 0.2},
                "model": {"fluid": "openfoam"},
            },
            "a tank turns freely only if it is a sphere",
        ),
        ({"carrier": FREE, "model": {"fluid": "datum"}}, 'got "datum", which keeps no volume'),
        ({"carrier": FREE, "model": {"fluid": "auto"}}, 'got "auto", whose errors are those of'),
        ({"carrier": {"kind": "loose"}}, "carrier.kind"),
        (
            {
                "carrier": FREE,
                "motion": {"kind": "sine", "frequency": 1.0, "amplitude": 0.0, "angle": 2.0},
            },
            'carrier.kind: "free" takes a ground that does not turn',
        ),
        (
            {
                "carrier": FREE,
                "model": {"fluid": "hydrostatic"},
                "supply": {"end_fill_fraction": 0.5, "duration": 1.0},
            },
            'carrier.kind: "free" takes a tank that keeps its mass',
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_mend(sections: dict, said: str):
    with pytest.raises(SceneError) as error:
        scene(**sections)
    assert said in str(error.value)


def test_forces_are_read_in_their_units_and_go_with_the_run(forces: Path, tmp_path: Path):
    table = read_force_table(forces).forces
    assert table.time == pytest.approx([0.0, 0.05, 0.2])
    assert table.acceleration[1] == pytest.approx([200.0, 0.0, -100.0])
    given = scene(carrier=FREE | {"force_file": str(forces)})
    (tmp_path / "run").mkdir()
    write_scene(given, tmp_path / "run")
    again = load_scene(tmp_path / "run")
    assert Path(again.carrier.force_file or "").read_text() == TABLE
    assert again.carrier.forces is not None
    assert np.array_equal(again.carrier.forces.acceleration, table.acceleration)
    assert 'kind = "free"' in scene_toml(given)


def test_moments_are_read_beside_the_forces(tmp_path: Path):
    file = tmp_path / "push.csv"
    file.write_text(
        "time,fx,fy,fz,mx (kN m),my (N m),torque_z (N m)\n0,0,0,0,0,0,0\n1,1,2,3,0.4,5,6\n"
    )
    moments = read_force_table(file).moments
    assert moments is not None
    assert moments.acceleration[1] == pytest.approx([400.0, 5.0, 6.0])
    with pytest.raises(SceneError, match="names moments, and the tank is held against turning"):
        scene(carrier=FREE | {"force_file": str(file)})
    file.write_text("time,fx,fy,fz,mx\n0,0,0,0,0\n1,1,2,3,0.4\n")
    with pytest.raises(TableError, match="names mx and no my, mz"):
        read_force_table(file)


def test_forces_must_cover_the_run(forces: Path):
    with pytest.raises(SceneError, match=r"must cover 0 to 0\.5 s, covers 0 to 0\.2 s"):
        scene(carrier=FREE | {"force_file": str(forces)}, time={"duration": 0.5})


def test_forces_must_be_in_order(tmp_path: Path):
    (tmp_path / "push.csv").write_text("time,fx,fy,fz\n0,0,0,0\n1,0,0,0\n1,1,0,0\n")
    with pytest.raises(TableError, match="line 4: time must increase"):
        read_force_table(tmp_path / "push.csv")


def test_a_free_tank_is_not_identified(tmp_path: Path):
    (tmp_path / "scene.toml").write_text(scene_toml(scene(carrier=FREE)))
    with pytest.raises(SceneError, match='must be "prescribed" to identify a tank'):
        conditions(tmp_path, [], [0.5], [1e-3])


def test_no_model_s_error_is_known_of_a_free_tank():
    """It is advised a liquid that has waves, not one that needs none where the ground rests."""
    choice = choose(scene(carrier=FREE))
    assert choice.fluid == "potential"
    assert all(np.isnan(one.expected) for one in choice.estimates.values())
    assert choose(scene()).fluid == "hydrostatic"


def test_a_prescribed_tank_s_scene_is_what_it_was():
    """The section is there with its default alone."""
    given = scene()
    assert given.carrier.kind == "prescribed"
    assert with_overrides(given, {"carrier.kind": "prescribed"}) == given
