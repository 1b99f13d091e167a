"""Every number of a scene at its extremes: refused with its key and a mend, or all is finite."""

import math
import types
from typing import Any, get_args

import pytest

from coupling.cli.tables import model_estimates
from coupling.estimate.model_errors import choose
from coupling.estimate.numbers import numbers_of
from coupling.finite_volume.mesh_sizes import cells_made
from coupling.scene.scene import Scene, SceneError, scene_from

SCENE: dict[str, Any] = {
    "tank": {"radius": 0.4445},
    "diaphragm": {
        "thickness": 0.001778,
        "density": 1070.0,
        "youngs_modulus": 8.6e6,
        "poisson_ratio": 0.5,
        "strength": 1e7,
    },
    "liquid": {"density": 1e3, "viscosity": 1e-6, "surface_tension": 0.07, "fill_fraction": 0.8},
    "motion": {"kind": "sine", "frequency": 1.25, "amplitude": 0.25},
    "model": {"fluid": "openfoam"},
    "time": {"duration": 1.0},
}


def keys_of(kind: type) -> list[tuple[str, ...]]:
    """Section and key of every number of this type."""
    found: list[tuple[str, ...]] = []
    for section, field in Scene.model_fields.items():
        inner = getattr(field.annotation, "model_fields", {})
        for key, value in inner.items():
            union = isinstance(value.annotation, types.UnionType)
            if kind in (get_args(value.annotation) if union else (value.annotation,)):
                found.append((section, key))
    return found


EXTREMES = [0.0, *(s * v for v in (5e-324, 1e-300, 1e-15, 1e15, 1e300) for s in (1.0, -1.0))]
EXTREMES += [math.nan, math.inf, -math.inf, 10**400]


def shown(value: Any) -> str:
    """A name for a test."""
    return str(value) if len(str(value)) < 20 else f"{len(str(value))} digits"


def changed(path: tuple[str, ...], value: Any) -> dict[str, Any]:
    """The scene with another value; a sine's two ways of saying the same do not stand together."""
    data = {section: dict(values) for section, values in SCENE.items()}
    if path == ("motion", "acceleration"):
        del data["motion"]["amplitude"]
    if path == ("time", "periods"):
        del data["time"]["duration"]
    if len(path) == 1:
        return data | {path[0]: value}
    data.setdefault(path[0], {})[path[1]] = value
    return data


def refused_or_finite(path: tuple[str, ...], value: Any) -> None:
    try:
        scene = scene_from(changed(path, value))
    except SceneError as error:
        others = {"radius": "thickness", "frequency": "step", "step": "duration"}
        others |= {"periods": "duration", "steps_per_period": "step"}
        stated = str(error)
        assert path[-1] in stated or others.get(path[-1], "?") in stated, stated
        for line in stated.splitlines():
            assert len(line.rstrip(".").split(". ")) >= 2, f"no mend: {line}"
        return
    figures = [*numbers_of(scene).to_dict().values()]
    figures += [figure for row in model_estimates(scene).values() for figure in row.values()]
    figures += [one.upper for one in choose(scene).estimates.values()]
    assert all(math.isfinite(figure) for figure in figures if isinstance(figure, float))


@pytest.mark.parametrize("path", keys_of(float), ids=".".join)
@pytest.mark.parametrize("value", EXTREMES, ids=shown)
def test_extreme_number_is_refused_or_all_is_finite(path: tuple[str, ...], value: float):
    refused_or_finite(path, value)


@pytest.mark.parametrize("path", keys_of(int), ids=".".join)
@pytest.mark.parametrize("value", [-(10**30), -1, 0, 10**6, 10**30, 10**400], ids=shown)
def test_extreme_count_is_refused_or_all_is_finite(path: tuple[str, ...], value: int):
    refused_or_finite(path, value)


@pytest.mark.parametrize("value", EXTREMES, ids=shown)
@pytest.mark.parametrize("path", [("gravity",), ("motion", "direction")], ids=".".join)
def test_extreme_vector_is_refused_or_all_is_finite(path: tuple[str, ...], value: float):
    for vector in ([0.0, 0.0, value], [value, 0.0, -9.81], [value, value, value]):
        refused_or_finite(path, vector)


def test_tiny_direction_is_refused():
    """It was taken, and everything along it was not a number."""
    with pytest.raises(SceneError, match=r"motion\.direction: must be 0 or have a size from 1e-15"):
        scene_from(changed(("motion", "direction"), [1e-300, 0.0, 0.0]))


def test_rounding_in_a_component_of_a_vector_is_taken():
    scene = scene_from(changed(("motion", "direction"), [1.0, 6e-17, 1e-200]))
    assert scene.motion.unit_direction == pytest.approx([1.0, 6e-17, 1e-200], rel=1e-12)


def test_gravity_may_point_anywhere_but_must_be_there():
    with pytest.raises(SceneError, match=r"^scene: gravity: .* give the steady acceleration"):
        scene_from(changed(("gravity",), [0.0, 0.0, 0.0]))
    assert scene_from(changed(("gravity",), [-9.81, 0.0, 0.0])).gravity == (-9.81, 0.0, 0.0)


@pytest.mark.parametrize(
    ("cells", "mend"),
    [(64, "176"), (175, "176"), (300, "Give 176 or 540"), (2000, "Give 1216 or 2300")],
)
def test_number_of_cells_that_no_mesh_comes_near_is_refused(cells: int, mend: str):
    """It gave a mesh of 16 where 64 to 175 were asked for."""
    with pytest.raises(SceneError, match=rf"openfoam\.cells: .*{mend}"):
        scene_from(changed(("openfoam", "cells"), cells))


@pytest.mark.parametrize(
    ("spacing", "cells", "why"),
    [
        (1e-7, 5000, r"openfoam\.wall_spacing: must be 0 or lie in .*Give a fraction"),
        (0.3, 5000, r"openfoam\.wall_spacing: must be 0 or lie in"),
        (1e-3, 1300, r"openfoam\.cells: with wall_spacing = 0\.001 .* Give \d+ or more"),
    ],
)
def test_wall_spacing_that_no_mesh_has_is_refused(spacing: float, cells: int, why: str):
    data = changed(("openfoam", "wall_spacing"), spacing)
    data["openfoam"]["cells"] = cells
    with pytest.raises(SceneError, match=why):
        scene_from(data)


@pytest.mark.parametrize("cells", [176, 200, 540, 650, 1300, 5000, 30000])
def test_mesh_has_about_as_many_cells_as_were_asked_for(cells: int):
    scene = scene_from(changed(("openfoam", "cells"), cells))
    assert cells / 1.5 <= cells_made(scene.openfoam.cells) <= cells


def test_acceleration_without_an_amplitude_is_named_itself():
    with pytest.raises(SceneError, match=r"motion\.acceleration: at 1.25 Hz gives an amplitude"):
        scene_from(changed(("motion", "acceleration"), 1e-15))
