"""Energies of the sheet against closed forms, and what its damping takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cloth.bending import carried_areas
from cloth.energy import sheet_energy, sheet_losses, stretch_energy
from cloth.flat import strip
from cloth.load import Settings
from cloth.material import Diaphragm
from cloth.mesh import hemisphere
from cloth.model import ClothModel
from cloth.shell.shell import NO_SHELL
from cloth.state import Memory
from cloth.triangle_kernels import limited

RUBBER = Diaphragm(density=1070.0, thickness=0.002, youngs_modulus=8.6e6, poisson_ratio=0.45)
STIFFNESS = 8.6e6 * 0.002
DRAG = Settings().drag


def model(mesh, *, tensile: float | None = None, compressive: float | None = 10.0) -> ClothModel:
    return ClothModel(
        mesh=mesh, diaphragm=RUBBER, thickness=None, clamped=mesh.points, shell=NO_SHELL,
        tensile_stiffness=tensile, compressive_stiffness=compressive, self_contact=False,
    )  # fmt: skip


def memory(sheet: ClothModel, position, velocity=None, dt: float = 0.0) -> Memory:
    still = Memory.at_rest(position, len(sheet.triangles), 1.0)
    if velocity is None:
        return still
    return replace(
        still, velocity=velocity, previous_position=position - dt * velocity,
        previous_dt=np.array([dt]),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("along", "across", "density"),
    [
        # plane stress: E t/(1 - nu^2) (e^2 + f^2 + 2 nu e f)/2
        (0.02, 0.01, STIFFNESS / (1 - 0.45**2) * (4e-4 + 1e-4 + 2 * 0.45 * 2e-4) / 2),
        (0.02, -0.009, STIFFNESS * 4e-4 / 2),  # free to contract: uniaxial stress
        (0.02, -0.05, STIFFNESS * 4e-4 / 2 + 10.0 * (-0.05 + 0.009) ** 2 / 2),  # wrinkled
        (-0.03, -0.05, 10.0 * (9e-4 + 25e-4) / 2),  # slack
    ],
)
def test_evenly_stretched_strip(along: float, across: float, density: float):
    sheet = model(strip(1.0, 0.3, 6))
    stretched = sheet.mesh.points * [1.0 + along, 1.0 + across, 1.0]
    assert stretch_energy(sheet, stretched) == pytest.approx(density * sheet.areas.sum(), rel=1e-9)


def test_a_stiff_sheet_stores_each_direction_by_itself():
    sheet = model(strip(1.0, 0.3, 6), tensile=1e6)
    taut = sheet.mesh.points * [1.01, 0.98, 1.0]
    density = 0.5 * (1e6 * 1e-4 + 10.0 * 4e-4)
    assert stretch_energy(sheet, taut) == pytest.approx(density * sheet.areas.sum(), rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_iteration_takes_proximal_points_of_this_energy(seed: int):
    """``limited`` minimises the energy plus k/2 of the squared distance, in stretches.

    But for what slack across adds to the stress along, C nu f beside E t: squared over twice the
    stiffness is how far from the least the energy is.
    """
    sheet, k = model(strip(1.0, 0.3, 6)), 3000.0
    area = sheet.areas.sum()
    first, second = np.sort(1.0 + 0.1 * np.random.default_rng(seed).standard_normal(2))[::-1]

    def total(a: float, b: float) -> float:
        held = stretch_energy(sheet, sheet.mesh.points * [a, b, 1.0]) / area
        return held + 0.5 * k * ((a - first) ** 2 + (b - second) ** 2)

    a, b = limited(first, second, k, STIFFNESS, 10.0, 0.45)
    best = total(a, b) - 0.5 * (10.0 * 0.45 * 0.5) ** 2 / (k + STIFFNESS)
    for turn in np.linspace(0.0, 2.0 * np.pi, 9):
        assert total(a + 1e-4 * np.cos(turn), b + 1e-4 * np.sin(turn)) > best


def test_flat_strip_rolled_up_holds_the_cylinder_s_energy():
    """kappa/(2 r^2) per area that the nodes stand for; O(h^2)."""
    mesh, radius = strip(1.0, 0.4, 40), 0.5
    sheet = model(mesh)
    x, y = mesh.points[:, 0], mesh.points[:, 1]
    rolled = np.stack([radius * np.sin(x / radius), y, radius * np.cos(x / radius)], axis=1)
    area = carried_areas(mesh, np.zeros(len(x), dtype=bool)).sum()
    exact = 0.5 * RUBBER.bending_stiffness / radius**2 * area
    found = sheet_energy(sheet, memory(sheet, rolled)).bending
    assert found == pytest.approx(exact, rel=(1.0 / 40 / radius) ** 2)


def test_moulded_shape_holds_the_least_bending_energy():
    mesh = hemisphere(0.4, 8)
    sheet = model(mesh)
    moulded = sheet_energy(sheet, memory(sheet, mesh.points)).bending
    quadratic = 0.5 * float(np.vdot(mesh.points, sheet.bending.matrix @ mesh.points))
    assert moulded == pytest.approx(-quadratic, rel=1e-9)  # Kx = c n there
    for seed in range(3):
        moved = 1e-3 * np.random.default_rng(seed).standard_normal(mesh.points.shape)
        assert sheet_energy(sheet, memory(sheet, mesh.points + moved)).bending > moulded


def test_turning_is_dragged_and_does_not_bend():
    """A hemisphere that turns about its axis slides along itself everywhere but at its pole."""
    mesh, dt = hemisphere(0.4, 12), 1e-4
    sheet = model(mesh)
    turning = np.stack([-mesh.points[:, 1], mesh.points[:, 0], 0 * mesh.points[:, 2]], axis=1)
    swelling = mesh.points.copy()
    of_turn = sheet_losses(sheet, Settings(), memory(sheet, mesh.points, turning, dt), dt)
    of_swell = sheet_losses(sheet, Settings(), memory(sheet, mesh.points, swelling, dt), dt)
    speed, swell = np.sum(turning**2, axis=1), np.sum(swelling**2, axis=1)
    leaning = (np.pi / 24) ** 2  # of the facets' normals
    assert of_turn.drag == pytest.approx(DRAG * float(sheet.mass @ speed), rel=leaning)
    rim = DRAG * float(sheet.mass[~sheet.free] @ swell[~sheet.free])  # which has no normal
    assert of_swell.drag - rim < leaning * DRAG * float(sheet.mass @ swell)
    assert of_swell.bending > 0.0
    assert abs(of_turn.bending) < 1e-3 * of_swell.bending


def test_at_rest_nothing_moves_and_nothing_is_taken():
    sheet = model(hemisphere(0.4, 6))
    still = memory(sheet, sheet.mesh.points)
    losses = sheet_losses(sheet, Settings(), still, 0.0)
    assert sheet_energy(sheet, still).kinetic == losses.drag == losses.bending == 0.0
