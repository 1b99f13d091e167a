"""Free-surface slosh in a sphere: the lateral eigenfrequency of each fluid that has a flow."""

from __future__ import annotations

import tempfile
from contextlib import closing
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import jnp_zeros, jv
from threadpoolctl import threadpool_limits

from cloth.shell.sphere import Sphere
from coupling.estimate.sloshing_modes import lateral_eigenvalue
from coupling.finite_volume.geometry import fan_volume
from coupling.finite_volume.mesh import LiquidMesh, half_ball, shell_shares
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.installation import find_openfoam
from coupling.ports import Array
from coupling.verify.case import CaseError, Quantity, VerifyResult, quantity
from coupling.verify.free_surface import FreeSurface
from coupling.verify.potential_slosh import level_liquid, released
from coupling.verify.release import coupled_release, fitted_frequency
from coupling.verify.sheets import within

# omega^2 R/g of lateral (m = 1) modes, by level over R and mode: McIver, J. Fluid Mech. 201 (1989).
EIGENVALUES = {
    (0.4, 1): 1.1583, (0.6, 1): 1.2625, (1.0, 1): 1.560157, (1.0, 2): 5.2755,
    (1.4, 1): 2.1232, (1.6, 1): 2.6863, (1.8, 1): 3.9593,
}  # fmt: skip
RADIUS, GRAVITY, DENSITY = 0.4445, 9.81, 1000.0
AMPLITUDE = 2e-3  # over R: the linear theory errs by its square
PERIODS = 2.0


def slosh(
    *,
    level: float = 1.0,
    mode: int = 1,
    fluid: str = "openfoam",
    step: float = 0.0,
    resolution: int = 0,
) -> VerifyResult:
    """Frequency of a lateral mode of the surface; the quantity is ``lambda`` = omega^2 R/g.

    ``level``: depth of the liquid over R. ``fluid``:

    - ``openfoam`` releases the surface from the mode's shape and goes through the whole coupling;
      level and mode one of those tabulated. ``step`` [s], 0 for 0.01; ``resolution``: cells of the
      mesh, 0 for 1300. The error is second order in the grid and, with -2/3 (omega dt)^2, in the
      step.
    - ``potential`` solves for the modes of the surface on the liquid of harmonic polynomials, at
      any level from 0.2 to 1.8, mode 1 to 3; ``resolution``: their degree d, 0 for 16, with 4 d^2
      faces on the surface. The error is of order 2 in 1/d where the polynomials hold the mode; the
      fuller the ball and the higher the mode, the higher a degree that takes. At 16 mode 1 is
      within 0.1 % and mode 2 within 0.5 % from a level of 0.4 to 1.8, mode 3 within 1.5 % from 0.6
      to 1.6. At 0.2 the least stiffness that the liquid allows its potentials, meant for films,
      costs mode 2 3 %.
      With a ``step`` [s] it is released from its mode instead, over 20 periods and with degree 6 if
      not said; ``energy_kept`` is what is then left of its energy: ``backward`` takes
      20 pi (omega dt)^3 and its first step 1.5 (omega dt)^2; half full 1 % at 8 ms, 0.3 % at 5 ms.

    Modes that are not tabulated are computed by ``sloshing_modes``.
    """
    clock = perf_counter()
    exact = _exact(level, mode, fluid)
    omega = float(np.sqrt(exact * GRAVITY / RADIUS))
    if fluid == "openfoam":
        step, resolution = step or 0.01, resolution or 1300
        within("slosh", "step", step, 1e-4, 0.1 * np.pi / omega)  # 20 of them in a period
        within("slosh", "resolution", resolution, 176, 100_000)
        with tempfile.TemporaryDirectory() as folder:
            time, signal = _release(Path(folder), level, mode, omega, step, resolution)
        found = fitted_frequency(time, signal, omega) ** 2 * RADIUS / GRAVITY
        quantities = [quantity("lambda", found, exact)]
    else:
        resolution = resolution or (6 if step else 16)
        within("slosh", "resolution", resolution, 2, 24)
        within("slosh", "step", step, 0.0, 0.1 * np.pi / omega)
        with threadpool_limits(1):
            quantities = _potential(level, mode, exact, step, resolution)
    return VerifyResult(
        case="slosh",
        options={
            "level": level,
            "mode": mode,
            "fluid": fluid,
            "step": step,
            "resolution": resolution,
        },
        quantities=tuple(quantities),
        wall_s=perf_counter() - clock,
    )


def _exact(level: float, mode: int, fluid: str) -> float:
    if fluid not in ("openfoam", "potential"):
        raise CaseError(f"verify slosh: --fluid: must be openfoam or potential, got '{fluid}'.")
    if (level, mode) in EIGENVALUES:
        return EIGENVALUES[level, mode]
    if fluid == "openfoam":
        known = ", ".join(f"({h:g}, {m})" for h, m in EIGENVALUES)
        raise CaseError(f"verify slosh: with openfoam (level, mode) must be one of {known}.")
    if not (0.2 <= level <= 1.8 and 1 <= mode <= 3):
        raise CaseError(
            "verify slosh: --level must lie in 0.2 to 1.8 and --mode in 1 to 3, "
            f"got {level:g} and {mode}."
        )
    return lateral_eigenvalue(level, mode)


def _potential(level: float, mode: int, exact: float, step: float, degree: int) -> list[Quantity]:
    """``lambda``, from the operator alone or with a ``step`` [s] from its course in time."""
    surface, rows = level_liquid(level, degree, radius=RADIUS, density=DENSITY, gravity=GRAVITY)
    omega, shape = surface.mode(_mode_shape(surface.reference[:, :2], mode), rows)
    if not step:
        return [quantity("lambda", omega**2 * RADIUS / GRAVITY, exact)]
    time, signal, energy = released(
        surface, rows, AMPLITUDE * RADIUS * shape,
        density=DENSITY, gravity=GRAVITY, step=step, duration=20 * 2 * np.pi / omega,
    )  # fmt: skip
    found = fitted_frequency(time, signal, omega) ** 2 * RADIUS / GRAVITY
    return [quantity("lambda", found, exact), quantity("energy_kept", energy[-1] / energy[0], 1.0)]


def _release(
    folder: Path, level: float, mode: int, omega: float, step: float, cells: int
) -> tuple[Array, Array]:
    """Times (T,) [s] and the first moment of the heights (T,) after the release from rest."""
    flow = OpenFoamFlow(
        folder, half_ball(cells), openfoam=find_openfoam(keep_alive=True),
        shell=Sphere(RADIUS), density=DENSITY, viscosity=1e-6, timeout=120.0,
    )  # fmt: skip
    level_patch, shell, path = level_shape(flow.mesh, level - 1.0)
    surface = FreeSurface(
        level_patch, flow.faces, path, mass=1e-3, density=DENSITY, gravity=GRAVITY
    )
    shape = _mode_shape(level_patch[:, :2], mode)
    surface.displace(AMPLITUDE * RADIUS * shape)
    with closing(flow):
        flow.start(surface.state.position, shell, np.pi * RADIUS**3 * level**2 * (3 - level) / 3)
        return coupled_release(
            surface, flow, shape,
            step=step, duration=PERIODS * 2 * np.pi / omega, acceleration=GRAVITY * AMPLITUDE,
        )  # fmt: skip


def level_shape(mesh: LiquidMesh, level: float) -> tuple[Array, Array, Array]:
    """Patch (p, 3), shell (s, 3) [m] and paths (p, 3) of a surface at z = ``level`` R.

    All points lie a little off the sphere, so that the polyhedron has the liquid's volume.
    """
    rim = float(np.sqrt(1 - level**2))
    patch = rim * mesh.points[mesh.patch_points]
    patch[:, 2] = level
    bottom = mesh.points[mesh.shell_points]
    across = np.linalg.norm(bottom[:, :2], axis=1)
    reach, arc = np.arctan2(across, -bottom[:, 2]) / (np.pi / 2), float(np.arccos(-level))
    angle = shell_shares(reach, arc) * arc
    shell = np.zeros_like(bottom)
    shell[:, :2] = bottom[:, :2] * (np.sin(angle) / np.maximum(across, 1e-12))[:, None]
    shell[:, 2] = -np.cos(angle)
    path = np.zeros_like(patch)
    path[:, 2] = 1.0
    # The rim slides in the wall's facets, along the edge that comes up to it, and sweeps nothing.
    below = shell[cKDTree(shell).query(patch[mesh.rim])[1]]
    edge = patch[mesh.rim] - below
    path[mesh.rim] = edge / edge[:, 2:]
    points = np.zeros_like(mesh.points)
    points[mesh.patch_points], points[mesh.shell_points] = patch, shell
    volume = np.pi * (1 + level) ** 2 * (2 - level) / 3
    size = RADIUS * (volume / fan_volume(points[mesh.faces[mesh.inner_faces :]])) ** (1 / 3)
    return size * patch, size * shell, path


def _mode_shape(plan: Array, mode: int) -> Array:
    """Heights (p,) close to the lateral mode: J_1(j'_1m r) cos(phi), of largest value 1."""
    distance = np.linalg.norm(plan, axis=1)
    shape = jv(1, jnp_zeros(1, mode)[-1] * distance / distance.max())
    shape = shape * plan[:, 0] / np.maximum(distance, 1e-12)
    return np.asarray(shape / np.abs(shape).max())
