"""What the diaphragm is made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Elastomer:
    """A rubber as its maker states it.

    ``density`` [kg/m^3]; ``youngs_modulus`` [Pa] or None where no source gives it; ``elongation``
    at break [-], ``strength`` [Pa] and ``tear`` resistance [N/m] are lower bounds, None if unknown.
    Small-strain, isotropic: neither creep nor swelling in the liquid is known here.
    """

    name: str
    density: float
    youngs_modulus: float | None = None
    poisson_ratio: float = 0.5
    elongation: float | None = None
    strength: float | None = None
    tear: float | None = None


ELASTOMERS: dict[str, Elastomer] = {
    "AF-E-332": Elastomer(
        name="AF-E-332",
        density=1070.0,
        youngs_modulus=8.6e6,
        elongation=2.6,
        strength=11.4e6,
        tear=52.5e3,
    ),
    "SIFA-35": Elastomer(name="SIFA-35", density=1120.0, elongation=2.4),
}


@dataclass(frozen=True, kw_only=True)
class Diaphragm:
    """A rubber sheet, ``thickness`` [m] thick unless a mesh says otherwise, triangle by triangle.

    ``density`` [kg/m^3], ``youngs_modulus`` [Pa] (0: no bending stiffness), ``poisson_ratio`` [-].
    """

    density: float
    thickness: float
    youngs_modulus: float
    poisson_ratio: float = 0.5

    def __post_init__(self) -> None:
        for name in ("density", "thickness"):
            value = getattr(self, name)
            if not value > 0.0:
                raise ValueError(f"diaphragm.{name}: must be positive, got {value}.")
        if not self.youngs_modulus >= 0.0:
            raise ValueError(
                f"diaphragm.youngs_modulus: must not be negative, got {self.youngs_modulus}."
            )
        if not 0.0 <= self.poisson_ratio <= 0.5:
            raise ValueError(
                f"diaphragm.poisson_ratio: must lie in [0, 0.5], got {self.poisson_ratio}."
            )

    @property
    def area_density(self) -> float:
        """Mass per area rho_d t [kg/m^2]."""
        return self.density * self.thickness

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness kappa = E t^3 / (12 (1 - nu^2)) [N m], the thin plate's."""
        return float(self.bending_stiffness_at(np.array(self.thickness)))

    def bending_stiffness_at(self, thickness: Array) -> Array:
        """Return the bending stiffness [N m] of a sheet ``thickness`` [m] thick, of any shape."""
        return self.youngs_modulus * thickness**3 / (12.0 * (1.0 - self.poisson_ratio**2))

    @property
    def membrane_stiffness(self) -> float:
        """Membrane stiffness E t [N/m], tension per strain in one direction."""
        return self.youngs_modulus * self.thickness


def diaphragm(
    elastomer: str,
    thickness: float,
    *,
    youngs_modulus: float | None = None,
    poisson_ratio: float | None = None,
) -> Diaphragm:
    """Return a sheet of a built-in ``elastomer``, ``thickness`` [m]; given values replace its own.

    SIFA-35 has no modulus in its source: ``youngs_modulus`` [Pa] must be given for it. Raises
    ValueError for an unknown elastomer, and where no modulus is known.
    """
    if elastomer not in ELASTOMERS:
        known = ", ".join(sorted(ELASTOMERS))
        raise ValueError(f"diaphragm.material: unknown elastomer {elastomer!r}. Known: {known}.")
    rubber = ELASTOMERS[elastomer]
    modulus = rubber.youngs_modulus if youngs_modulus is None else youngs_modulus
    if modulus is None:
        raise ValueError(
            f"diaphragm.youngs_modulus: no source gives one for {elastomer}. State it in the scene."
        )
    return Diaphragm(
        density=rubber.density,
        thickness=thickness,
        youngs_modulus=modulus,
        poisson_ratio=rubber.poisson_ratio if poisson_ratio is None else poisson_ratio,
    )
