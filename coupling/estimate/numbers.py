"""Dimensionless numbers of a tank, and what they say of the fluid models before anything is run.

Nothing here is a result: estimates from formulas and from the slosh frequency of a free surface.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from cloth.shell.sphere import Sphere, level_of_fill_fraction
from coupling.estimate.sloshing_modes import covered_eigenvalue, slosh_eigenvalue
from coupling.motion.shaking import driving_frequency, largest_acceleration, largest_body_force
from coupling.scene.scene import Scene
from coupling.scene.sections import Vector
from coupling.scene.tank import Tank
from coupling.scene.wrinkles import grid_spacing, rings_to_resolve, shortest_wavelength


def slosh_frequency(
    *, eigenvalue: float, radius: float, gravity: float, cover: float = 0.0
) -> float:
    """First slosh frequency f1 [Hz] under ``gravity`` [m/s^2], of ``eigenvalue`` omega^2 R/g.

    ``radius`` R [m] of the rim. Of a free surface, or below a limp sheet of mass ``cover`` per
    area, over rho R.
    """
    eigenvalue = covered_eigenvalue(eigenvalue, cover)
    return float(np.sqrt(eigenvalue * gravity / radius) / (2.0 * np.pi))


def free_surface(scene: Scene) -> tuple[float, float]:
    """Return the level of a free surface and its lowest mode, in the scene's tank as it lies.

    Returns
    -------
    level : float
        Depth of the liquid over the rim's radius R [-].
    eigenvalue : float
        omega^2 R/g of the lowest mode [-].
    """
    shell = scene.tank.shell
    if isinstance(shell, Sphere):
        level = level_of_fill_fraction(scene.liquid.fill_fraction)
        return level, slosh_eigenvalue(level)
    return _free_surface_in(scene.tank, scene.liquid_volume, scene.gravity)


@lru_cache(maxsize=64)
def _free_surface_in(tank: Tank, volume: float, gravity: Vector) -> tuple[float, float]:
    """``free_surface`` of any tank, which takes half a second where its meridian has 100 arcs."""
    from coupling.estimate.tank_modes import depth, lowest_eigenvalue  # a sphere does without SciPy

    shell, up = tank.shell, -np.array(gravity)
    return depth(shell, volume, up) / shell.size, lowest_eigenvalue(shell, volume, up)


def bond_number(*, density: float, gravity: float, radius: float, surface_tension: float) -> float:
    """Bo = rho g R^2/sigma (thesis, section 3.2)."""
    return density * gravity * radius**2 / surface_tension


def weber_number(
    *, density: float, frequency: float, radius: float, surface_tension: float
) -> float:
    """We = f^2 rho R^3/sigma (thesis, section 3.2)."""
    return frequency**2 * density * radius**3 / surface_tension


def froude_number(*, frequency: float, radius: float, gravity: float) -> float:
    """We/Bo = f^2 R/g: inertia over gravity, whatever the surface tension."""
    return frequency**2 * radius / gravity


def membrane_parameter(
    *, density: float, body_force: float, radius: float, youngs_modulus: float, thickness: float
) -> float:
    """rho b R^2/(E t): the strain of a diaphragm that carries the liquid by tension.

    ``body_force`` b [m/s^2], the largest of the motion: 0.13 at rest and 0.24 in the thesis' pad
    sway (its Table 5). It estimates what inextensibility leaves out where the diaphragm is taut;
    where the shell carries the liquid the strain is far less.
    """
    return density * body_force * radius**2 / (youngs_modulus * thickness)


def added_mass_ratio(
    *, density: float, radius: float, area_density: float, eigenvalue: float
) -> float:
    """Liquid's over diaphragm's mass in the first slosh mode: rho R/(lambda rho_d t).

    From rho g = omega^2 m_a per area. Far above 1 a loosely coupled scheme diverges.
    """
    return density * radius / (eigenvalue * area_density)


def potential_to_kinetic(
    *, body_force: float, radius: float, frequency: float, travel: float
) -> float:
    """Thesis Eq. 4.6: g R over (travel f)^2/2, with ``travel`` [m] the liquid's way in a period.

    The thesis prints R/4 for the travel where its text says a quarter of the diameter, R/2.
    """
    return body_force * radius / (0.5 * (travel * frequency) ** 2)


def hydrostatic_error(frequency: float, slosh_frequency: float) -> float:
    """(f/f1)^2: the unsteady pressure that hydrostatics leaves out, over what it keeps."""
    return (frequency / slosh_frequency) ** 2


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """What can be said of a scene without running it.

    Frequencies [Hz], body force [m/s^2], wavelength and spacing [m], the rest dimensionless; None
    without a surface tension. ``frequency``: see ``driving_frequency``; ``acceleration_ratio``:
    largest of the tank over gravity; ``hydrostatic_error``: by the rule (f/f1)^2.
    ``level``: depth over the rim's radius. ``slosh_frequency``: of the lowest mode of the tank as
    it lies, below a limp sheet of the diaphragm's mass, flat on the level; its
    stiffness raises it (by 3 % in ``foam_cases/slosh``), its folds lower it. Of a thickness map
    the mean counts, for the wrinkles the least. ``wrinkling_allowed``: "resolved" from
    ``rings_to_resolve`` on.
    """

    fill_fraction: float
    level: float
    slosh_frequency: float
    frequency: float
    frequency_ratio: float
    acceleration_ratio: float
    bond: float | None
    weber: float | None
    froude: float
    largest_body_force: float
    membrane_parameter: float
    elasto_gravity_wavelength: float
    folds_round_the_rim: float
    grid_spacing: float
    rings_to_resolve: int
    wrinkling_allowed: str
    added_mass_ratio: float
    hydrostatic_error: float

    def to_dict(self) -> dict[str, float | str | None]:
        """Plain values by name."""
        return asdict(self)


def _similarity(scene: Scene, gravity: float, frequency: float) -> dict[str, Any]:
    """Bond, Weber and Froude numbers, the first two None where sigma is not known."""
    radius, density = scene.tank.shell.size, scene.liquid.density
    bond = weber = None
    sigma = scene.liquid.surface_tension
    if sigma is not None:
        bond = bond_number(density=density, gravity=gravity, radius=radius, surface_tension=sigma)
        weber = weber_number(
            density=density, frequency=frequency, radius=radius, surface_tension=sigma
        )
    froude = froude_number(frequency=frequency, radius=radius, gravity=gravity)
    return {"bond": bond, "weber": weber, "froude": froude}


def _wrinkles(scene: Scene) -> dict[str, Any]:
    """How long the wrinkles are, and whether the cloth's grid can show them."""
    radius, length = scene.tank.shell.size, scene.mould.length
    wavelength = shortest_wavelength(scene.diaphragm, scene.liquid, np.array(scene.gravity))
    rings = rings_to_resolve(length, wavelength)
    fine = scene.cloth.grid == "rings" and scene.cloth.rings >= rings
    return {
        "elasto_gravity_wavelength": wavelength,
        "folds_round_the_rim": 2.0 * float(np.pi) * radius / wavelength,
        "grid_spacing": grid_spacing(length, scene.cloth),
        "rings_to_resolve": rings,
        "wrinkling_allowed": "resolved" if fine else "relaxed",
    }


def numbers_of(scene: Scene) -> Numbers:
    """Dimensionless numbers of ``scene``."""
    shell, density, rubber = scene.tank.shell, scene.liquid.density, scene.sheet
    radius = shell.size
    gravity = float(np.linalg.norm(scene.gravity))
    body_force = largest_body_force(scene)
    level, eigenvalue = free_surface(scene)
    f1 = slosh_frequency(
        eigenvalue=eigenvalue,
        radius=radius,
        gravity=gravity,
        cover=rubber.area_density / (density * radius),
    )
    f = driving_frequency(scene)
    return Numbers(
        fill_fraction=scene.liquid.fill_fraction,
        level=level,
        slosh_frequency=f1,
        frequency=f,
        frequency_ratio=f / f1,
        acceleration_ratio=largest_acceleration(scene) / gravity,
        largest_body_force=body_force,
        membrane_parameter=membrane_parameter(
            density=density,
            body_force=body_force,
            radius=radius,
            youngs_modulus=rubber.youngs_modulus,
            thickness=rubber.thickness,
        ),
        added_mass_ratio=added_mass_ratio(
            density=density,
            radius=radius,
            area_density=rubber.area_density,
            eigenvalue=eigenvalue,
        ),
        hydrostatic_error=hydrostatic_error(f, f1),
        **_similarity(scene, gravity, f),
        **_wrinkles(scene),
    )
