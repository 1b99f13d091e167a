"""The sheet flat over its liquid in shells that are not the same above and below the rim."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shells import pill

from cloth.level import level_shape, volumes_held
from cloth.material import ELASTOMERS, Diaphragm
from cloth.mesh import moulded
from cloth.shell.arc_spline import ellipse
from cloth.shell.meridian import Meridian
from cloth.shell.pieces import arc, raised
from cloth.step import Cloth

R = 0.4


def sphere_clamped_at(height: float) -> Meridian:
    quarter = 0.5 * math.pi
    arcs = [arc((0.0, 0.0), R, -quarter, 0.0), arc((0.0, 0.0), R, 0.0, quarter)]
    return Meridian([raised(piece, -height) for piece in arcs])


def cap(height: float) -> float:
    """Volume [m^3] of the sphere above a plane at ``height`` [m]."""
    return math.pi * (R - height) ** 2 * (2.0 * R + height) / 3.0


def test_the_volumes_that_a_sheet_holds_off_the_equator():
    """A cap's mirror image lies in the shell and leaves the rest; a longer part reaches all.

    400 frusta miss a cap by 1/400^2 of it.
    """
    shell, whole = sphere_clamped_at(0.1), 4.0 / 3.0 * math.pi * R**3
    least, largest = volumes_held(shell, shell.upper_part(), whole)
    assert least == pytest.approx(whole - 2.0 * cap(0.1), abs=1e-5 * whole)
    assert largest == whole
    assert volumes_held(shell, shell.lower_part(), whole) == (0.0, whole)
    even = pill(R, R)
    for part in (even.upper_part(), even.lower_part()):
        assert volumes_held(even, part, even.volume) == (0.0, even.volume)


@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_level_sheet_grows_no_length_off_the_middle(below: bool, share: float):
    """In an egg clamped off its equator: the volume asked for, in the shell, nowhere longer.

    Facets err by their chords, (ds/R)^2/24 of a length, and so may a sheet of facets.
    """
    rings, material = 12, ELASTOMERS["AF-E-332"]
    shell = Meridian([raised(piece, -0.1 * R) for piece in ellipse(R, 0.7 * R)])
    part = shell.lower_part() if below else shell.upper_part()
    rubber = Diaphragm(
        thickness=0.001, density=material.density, youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
    )  # fmt: skip
    model = Cloth(mesh=moulded(part, rings), diaphragm=rubber, shell=shell).model
    least, largest = volumes_held(shell, part, shell.volume)
    volume = least + share * (largest - least)
    x = level_shape(model, volume)
    assert model.volume(x) == pytest.approx(volume, rel=1e-10)
    assert shell.gap(x).min() >= -1e-12 * R
    stretch = np.einsum("tid,tie->tde", x[model.triangles], model.gradients)
    longest = np.linalg.svd(stretch, compute_uv=False).max()
    assert longest <= 1.0 + 2.0 * (part.length / rings / R) ** 2 / 24.0 * (R / (0.49 * R)) ** 2


def test_the_nearest_point_of_an_egg_against_many_points_on_it():
    """As for the pill: a cloud of spacing s misses the nearest by s^2/8 (1/d + 1/radius)."""
    shell = Meridian([raised(piece, 0.05 * R) for piece in ellipse(R, 0.6 * R)])
    rng = np.random.default_rng(3)
    points = R * rng.normal(size=(100, 3))
    spacing = 1e-3 * R
    arcs = np.arange(shell.arc_to(shell.poles[0]), shell.arc_to(shell.poles[1]), spacing)
    r, z = shell.along(arcs)
    across = np.hypot(points[:, 0], points[:, 1])
    away = np.hypot(across[:, None] - r, points[:, 2][:, None] - z).min(axis=1)
    gap = np.abs(shell.gap(points))
    assert np.all(gap <= away + 1e-14)
    assert np.all(away <= np.hypot(gap, 0.5 * spacing) * (1.0 + spacing / (0.36 * R)))
    np.testing.assert_allclose(shell.gap(shell.project(points)), 0.0, atol=1e-13 * R)
