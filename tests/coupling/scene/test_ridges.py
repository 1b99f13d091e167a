"""Ridges: where they lie, what they weigh, and what a grid cannot show."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cloth.mesh import lumped, moulded
from coupling.estimate.numbers import numbers_of
from coupling.scene.errors import SceneError
from coupling.scene.scene import Scene, load_scene
from coupling.structure.diaphragm import diaphragm_of

RADIUS = 0.2
SCENE = """\
[tank]
radius = 0.2
[diaphragm]
material = "AF-E-332"
thickness = 0.0012
ridge_number = 3
ridge_width = 0.08
ridge_height = 0.0008
[liquid]
name = "water"
fill_fraction = 0.8
[model]
fluid = "hydrostatic"
[cloth]
resolution = 16
[time]
duration = 0.1
"""
RADIAL = {"diaphragm.ridge_direction": "radial", "diaphragm.ridge_number": 8}


def scene(folder: Path, changes: dict[str, Any] | None = None) -> Scene:
    (folder / "scene.toml").write_text(SCENE)
    return load_scene(folder, changes or {})


def place(polar: float, azimuth: float = 0.0) -> np.ndarray:
    p, a = np.radians([polar, azimuth])
    return RADIUS * np.array([[np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)]])


@pytest.mark.parametrize(
    ("polar", "azimuth", "share"),
    [
        (15.0, 70.0, 1.0),  # a crest, at 1/6 of the meridian
        (45.0, 0.0, 1.0),
        (30.0, 200.0, 0.0),  # between two
        (45.0 + math.degrees(0.02 / RADIUS), 10.0, 0.5),  # a quarter of the width from a crest
        (45.0 + math.degrees(0.04 / RADIUS), 10.0, 0.0),  # its foot
        (0.0, 0.0, 0.0),
        (90.0, 0.0, 0.0),
    ],
)
def test_circumferential_ridges(tmp_path: Path, polar: float, azimuth: float, share: float):
    found = scene(tmp_path).thickness_at(place(polar, azimuth))
    assert found == pytest.approx([0.0012 + 0.0008 * share], abs=1e-9)


@pytest.mark.parametrize(
    ("polar", "azimuth", "share"),
    [
        (90.0, 0.0, 1.0),
        (40.0, 315.0, 1.0),
        (90.0, 22.5, 0.0),  # between two of eight
        (60.0, -math.degrees(0.02 / (RADIUS * math.sin(math.radians(60.0)))), 0.5),
        (0.0, 0.0, 1.0),  # all meet at the pole
    ],
)
def test_radial_ridges(tmp_path: Path, polar: float, azimuth: float, share: float):
    found = scene(tmp_path, RADIAL).thickness_at(place(polar, azimuth))
    assert found == pytest.approx([0.0012 + 0.0008 * share], abs=1e-9)


@pytest.mark.parametrize("changes", [{}, RADIAL], ids=["circumferential", "radial"])
def test_mean_and_mass(tmp_path: Path, changes: dict[str, Any]):
    """The mean by a quadrature of its own, to 1e-5; the cloth's mass as its triangles have it.

    The flat triangles of 16 rings lack 0.6 % of the moulded area.
    """
    chosen = scene(tmp_path, changes)
    polar, azimuth = np.meshgrid((np.arange(900) + 0.5) / 10.0, np.arange(0.0, 360.0, 0.5))
    points = np.concatenate([place(0.0)[:0], _all(polar.ravel(), azimuth.ravel())])
    thickness = chosen.thickness_at(points)
    assert thickness is not None
    weight = np.sin(np.radians(polar.ravel()))
    mean = float(thickness @ weight / weight.sum())
    assert chosen.mean_thickness == pytest.approx(mean, rel=1e-5)
    assert numbers_of(chosen).membrane_parameter == pytest.approx(
        998.0 * 9.81 * RADIUS**2 / (8.6e6 * mean), rel=2e-3
    )
    cloth, mesh = diaphragm_of(chosen), moulded(chosen.mould, 16)
    assert cloth.thickness == pytest.approx(
        chosen.thickness_at(mesh.points[mesh.triangles].mean(axis=1))
    )
    even = 1070.0 * mean * lumped(mesh).sum()
    assert cloth.mass.sum() == pytest.approx(even, rel=0.012 * (mean - 0.0012) / mean)


def _all(polar: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    p, a = np.radians(polar), np.radians(azimuth)
    return RADIUS * np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=1)


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        (
            {"cloth.resolution": 11},
            "diaphragm.ridge_width: must be at least 3 spacings of the cloth's grid, 0.08568 m, "
            "got 0.08: narrower ridges fall between its triangles. Give cloth.resolution = 12",
        ),
        ({"diaphragm.ridge_number": 4}, "4 ridges have room for 0.07854 m each along the meridian"),
        ({**RADIAL, "diaphragm.ridge_number": 16}, "room for 0.07854 m each along the rim"),
        ({"diaphragm.ridge_height": 0.009}, "must be below 0.05 radii (0.01 m), got 0.0102"),
        (
            {"cloth.grid": "thesis", "model.fluid": "datum", "cloth.resolution": 26},
            'diaphragm.ridge_number: does not apply to cloth.grid = "thesis"',
        ),
    ],
)
def test_ridges_that_cannot_be_shown_are_refused(
    tmp_path: Path, changes: dict[str, Any], problem: str
):
    with pytest.raises(SceneError) as refused:
        scene(tmp_path, changes)
    assert problem in str(refused.value)


def test_grid_that_just_shows_them_is_taken(tmp_path: Path):
    assert scene(tmp_path, {"cloth.resolution": 12}).cloth.resolution == 12


@pytest.mark.parametrize("key", ["ridge_number", "ridge_width", "ridge_height"])
def test_every_key_is_required(tmp_path: Path, key: str):
    text = "\n".join(line for line in SCENE.splitlines() if not line.startswith(key))
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match=rf"diaphragm.{key}: is required beside ridge_"):
        load_scene(tmp_path)
