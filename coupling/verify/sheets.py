"""What the cases of flat sheets share: a film without weight or bending, brought to rest."""

from __future__ import annotations

import numpy as np

from cloth.load import Settings
from cloth.material import Diaphragm
from cloth.settle import settle
from cloth.step import Cloth
from coupling.ports import HydrostaticLoad, RunFailed
from coupling.verify.case import CaseError

# Lengths and pressures of these cases are of order 1, so that tensions are too [N/m]. A film of
# 1e-5 kg/m^2 weighs 1e-5 of the water on it; at a pseudo step of 0.14 s its inertia is 5e-4 N/m^3,
# which leaves the matrix regular and the steps long.
FILM = Diaphragm(density=1e-5, thickness=1.0, youngs_modulus=0.0, poisson_ratio=0.0)
SLACK = 1e-4  # N/m against compression, 1e-4 of the tension
TAUT = 1e4  # N/m against stretch, which leaves strains of 1e-4
TOLERANCE = 1e-3  # force left over P L^2: in a taut film, what 1e-7 of strain makes
STEPS_MAX = 400


def film_settings(penalty: float, iterations: int) -> Settings:
    """Return settings of the inner iteration, for a tension of order 1 N/m.

    ``penalty`` [N/m]: below twice the tension the iteration diverges, above 30 it is slow.
    ``iterations``: pseudo steps left unconverged are what the extrapolation amplifies.
    """
    return Settings(
        tolerance=0.0, iterations=iterations, penalty=penalty, bending_damping=0.0, drag=0.0
    )


def bring_to_rest(
    case: str,
    cloth: Cloth,
    load: HydrostaticLoad,
) -> None:
    """Bring ``cloth`` to rest under ``load``; raise ``RunFailed`` where that does not succeed."""
    done = settle(
        cloth,
        load,
        tolerance=TOLERANCE,
        steps_max=STEPS_MAX,
        iterations=cloth.settings.iterations,
    )
    if not done.converged:
        raise RunFailed(
            f"verify {case}: not at rest after {done.steps} steps: the force left is "
            f"{done.residual:.1e} of the load's. Choose another --resolution."
        )


def within(case: str, option: str, value: float, least: float, most: float) -> None:
    """Raise ``CaseError`` unless ``value`` of --``option`` lies in [``least``, ``most``]."""
    if not least <= value <= most:
        raise CaseError(
            f"verify {case}: --{option}: must lie in [{least:g}, {most:g}], got {value:g}."
        )


def water() -> HydrostaticLoad:
    """Return the load p = z of a liquid of unit weight, rho g = 1 Pa/m.

    It is upside down, so that sheets full of it bulge up.
    """
    return HydrostaticLoad(density=1.0, body_force=np.array([0.0, 0.0, 1.0]), datum=0.0)
