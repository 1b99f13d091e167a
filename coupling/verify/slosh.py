"""Free-surface slosh in a tank: the lateral eigenfrequency of each fluid that has a flow."""

from __future__ import annotations

import tempfile
from contextlib import closing
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.special import jnp_zeros, jv
from threadpoolctl import threadpool_limits

from coupling.estimate.sloshing_modes import lateral_eigenvalue
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.mesh_sizes import length_for
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.installation import find_openfoam
from coupling.ports import Array
from coupling.verify.case import CaseError, Quantity, VerifyResult, quantity
from coupling.verify.free_surface import FreeSurface
from coupling.verify.level_tank import (
    DENSITY,
    GRAVITY,
    LYING,
    RADIUS,
    LevelTank,
    level_shape,
    level_tank,
)
from coupling.verify.potential_slosh import level_liquid, released
from coupling.verify.release import coupled_release, fitted_frequency
from coupling.verify.sheets import within

# omega^2 R/g of lateral (m = 1) modes, by level over R and mode: of a sphere McIver's, J. Fluid
# Mech. 201 (1989); of a pill those of finite elements, tests/verification/quadratic_elements.py,
# to 1e-4. Of a lying one mode 1 is the first along its axis and mode 2 the first across it.
EIGENVALUES: dict[str, dict[tuple[float, int], float]] = {
    "sphere": {
        (0.4, 1): 1.1583, (0.6, 1): 1.2625, (1.0, 1): 1.560157, (1.0, 2): 5.2755,
        (1.4, 1): 2.1232, (1.6, 1): 2.6863, (1.8, 1): 3.9593,
    },
    "pill": {(1.5, 1): 1.7937, (2.0, 1): 1.8336, (3.0, 1): 1.8410},
    "lying-pill": {
        (0.5, 1): 0.2891, (0.5, 2): 1.1533, (1.0, 1): 0.5088, (1.0, 2): 1.4241,
        (1.5, 1): 0.8634, (1.5, 2): 2.0319,
    },
}  # fmt: skip
AMPLITUDE = 2e-3  # over R: the linear theory errs by its square
PERIODS = 2.0


def slosh(
    *,
    level: float = 1.0,
    mode: int = 1,
    tank: str = "sphere",
    fluid: str = "openfoam",
    step: float = 0.0,
    resolution: int = 0,
) -> VerifyResult:
    """Frequency of a lateral mode of the surface; the quantity is ``lambda`` = omega^2 R/g.

    ``level``: depth of the liquid over R. ``tank``: ``sphere``; ``pill``, 2:1 and upright, or
    ``lying-pill``, its mode 1 along the axis and 2 across, level and mode one of those tabulated.
    ``fluid``:

    - ``openfoam`` releases the surface from the mode's shape and goes through the whole coupling;
      level and mode one of those tabulated. ``step`` [s], 0 for 0.01; ``resolution``: cells of the
      mesh, at most, 0 for 1300. The error is second order in the grid and, with
      -2/3 (omega dt)^2, in the step.
    - ``potential`` solves for the modes of the surface on the liquid of harmonic polynomials, at
      any level from 0.2 to 1.8, mode 1 to 3; ``resolution``: their degree d, 0 for 16, with 4 d^2
      faces on the surface. The error is of order 2 in 1/d where the polynomials hold the mode; the
      fuller the ball and the higher the mode, the higher a degree that takes. At 16 mode 1 is
      within 0.1 % and mode 2 within 0.5 % from a level of 0.4 to 1.8, mode 3 within 1.5 % from 0.6
      to 1.6. At 0.2 the least stiffness that the liquid allows its potentials, meant for films,
      costs mode 2 3 %. In the pills it errs by 0.2 % at most, with degree 8 by 0.7 %.
      With a ``step`` [s] it is released from its mode instead, over 20 periods and with degree 6 if
      not said; ``energy_kept`` is what is then left of its energy: ``backward`` takes
      20 pi (omega dt)^3 and its first step 1.5 (omega dt)^2; half full 1 % at 8 ms, 0.3 % at 5 ms.

    Modes that are not tabulated are computed by ``sloshing_modes``.
    """
    clock = perf_counter()
    exact, lies = _exact(tank, level, mode, fluid), level_tank(tank)
    height = level * RADIUS + lies.lowest
    omega = float(np.sqrt(exact * GRAVITY / RADIUS))
    if fluid == "openfoam":
        step, resolution = step or 0.01, resolution or 1300
        within("slosh", "step", step, 1e-4, 0.1 * np.pi / omega)  # 20 of them in a period
        within("slosh", "resolution", resolution, 176, 100_000)
        with tempfile.TemporaryDirectory() as folder:
            time, signal = _release(Path(folder), lies, height, mode, omega, step, resolution)
        found = fitted_frequency(time, signal, omega) ** 2 * RADIUS / GRAVITY
        quantities = [quantity("lambda", found, exact)]
    else:
        resolution = resolution or (6 if step else 16)
        within("slosh", "resolution", resolution, 2, 24)
        within("slosh", "step", step, 0.0, 0.1 * np.pi / omega)
        with threadpool_limits(1):
            quantities = _potential(lies, height, mode, exact, step, resolution)
    return VerifyResult(
        case="slosh",
        options={
            "level": level,
            "mode": mode,
            "tank": tank,
            "fluid": fluid,
            "step": step,
            "resolution": resolution,
        },
        quantities=tuple(quantities),
        wall_s=perf_counter() - clock,
    )


def _exact(tank: str, level: float, mode: int, fluid: str) -> float:
    if fluid not in ("openfoam", "potential"):
        raise CaseError(f"verify slosh: --fluid: must be openfoam or potential, got '{fluid}'.")
    if tank not in EIGENVALUES:
        known = ", ".join(EIGENVALUES)
        raise CaseError(f"verify slosh: --tank: must be one of {known}, got '{tank}'.")
    if (level, mode) in EIGENVALUES[tank]:
        return EIGENVALUES[tank][level, mode]
    if fluid == "openfoam" or tank != "sphere":
        known = ", ".join(f"({h:g}, {m})" for h, m in EIGENVALUES[tank])
        raise CaseError(
            f"verify slosh: with {fluid} in a {tank} (level, mode) must be one of {known}."
        )
    if not (0.2 <= level <= 1.8 and 1 <= mode <= 3):
        raise CaseError(
            "verify slosh: --level must lie in 0.2 to 1.8 and --mode in 1 to 3, "
            f"got {level:g} and {mode}."
        )
    return lateral_eigenvalue(level, mode)


def _potential(
    tank: LevelTank, height: float, mode: int, exact: float, step: float, degree: int
) -> list[Quantity]:
    """``lambda``, from the operator alone or with a ``step`` [s] from its course in time."""
    surface, rows = level_liquid(tank, height, degree)
    omega, shape = surface.mode(_mode_shape(tank, surface.reference[:, :2], mode), rows)
    if not step:
        return [quantity("lambda", omega**2 * RADIUS / GRAVITY, exact)]
    time, signal, energy = released(
        surface, rows, AMPLITUDE * RADIUS * shape, step=step, duration=20 * 2 * np.pi / omega
    )
    found = fitted_frequency(time, signal, omega) ** 2 * RADIUS / GRAVITY
    return [quantity("lambda", found, exact), quantity("energy_kept", energy[-1] / energy[0], 1.0)]


def _release(
    folder: Path, tank: LevelTank, height: float, mode: int, omega: float, step: float, cells: int
) -> tuple[Array, Array]:
    """Times (T,) [s] and the first moment of the heights (T,) after the release from rest."""
    fill_fraction = tank.volume_below(height) / tank.shell.volume
    length = length_for(tank.shell, tank.frame[:, 2], fill_fraction)
    flow = OpenFoamFlow(
        folder, half_ball(cells, 0.0, length), openfoam=find_openfoam(keep_alive=True),
        shell=tank, density=DENSITY, viscosity=1e-6, timeout=120.0,
    )  # fmt: skip
    level_patch, shell, path, volume = level_shape(flow.mesh, tank, height)
    surface = FreeSurface(
        level_patch, flow.faces, path, mass=1e-3, density=DENSITY, gravity=GRAVITY
    )
    shape = _mode_shape(tank, level_patch[:, :2], mode)
    surface.displace(AMPLITUDE * RADIUS * shape)
    with closing(flow):
        flow.start(surface.state.position, shell, volume)
        return coupled_release(
            surface, flow, shape,
            step=step, duration=PERIODS * 2 * np.pi / omega, acceleration=GRAVITY * AMPLITUDE,
        )  # fmt: skip


def _mode_shape(tank: LevelTank, plan: Array, mode: int) -> Array:
    """Heights (p,) close to the mode, of largest value 1.

    J_1(j'_1m r) cos(phi) of a round surface; of another half a sine wave along its axis or across.
    """
    if tank.frame is LYING:
        along = plan[:, mode - 1]
        return np.asarray(np.sin(0.5 * np.pi * along / along.max()))
    distance = np.linalg.norm(plan, axis=1)
    shape = jv(1, jnp_zeros(1, mode)[-1] * distance / distance.max())
    shape = shape * plan[:, 0] / np.maximum(distance, 1e-12)
    return np.asarray(shape / np.abs(shape).max())
