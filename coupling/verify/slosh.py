"""Free-surface slosh in a sphere: the lateral eigenfrequency through the whole coupling."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import cKDTree
from scipy.special import jnp_zeros, jv

from coupling.convergence import Convergence
from coupling.coupled_step import CoupledStep
from coupling.fluids.openfoam import OpenFoamFlow
from coupling.foam.geometry import fan_volume
from coupling.foam.mesh import LiquidMesh, half_ball
from coupling.foam.process import find_openfoam
from coupling.mapping import Matching
from coupling.ports import Array, HydrostaticLoad, RunFailed
from coupling.schemes import scheme_named
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.free_surface import FreeSurface

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
    step: float = 0.01,
    resolution: int = 1300,
) -> VerifyResult:
    """Frequency of the surface released from the shape of its lowest lateral mode.

    ``level``: depth of the liquid over R, one of the tabulated; ``step`` [s]; ``resolution``: cells
    of the mesh. The quantity is ``lambda`` = omega^2 R/g. The error is second order in the grid
    and, with -2/3 (omega dt)^2, in the step.
    """
    clock = perf_counter()
    if (level, mode) not in EIGENVALUES or fluid != "openfoam":
        known = ", ".join(f"({h:g}, {m})" for h, m in EIGENVALUES)
        raise CaseError(f"verify slosh: (level, mode) must be one of {known}, fluid openfoam.")
    exact = EIGENVALUES[level, mode]
    omega = float(np.sqrt(exact * GRAVITY / RADIUS))
    with tempfile.TemporaryDirectory() as folder:
        time, signal = _release(Path(folder), level, mode, omega, step, resolution)
    found = _frequency(time, signal, omega)
    return VerifyResult(
        case="slosh",
        options={
            "level": level,
            "mode": mode,
            "fluid": fluid,
            "step": step,
            "resolution": resolution,
        },
        quantities=(quantity("lambda", found**2 * RADIUS / GRAVITY, exact),),
        wall_s=perf_counter() - clock,
    )


def _release(
    folder: Path, level: float, mode: int, omega: float, step: float, cells: int
) -> tuple[Array, Array]:
    """Times (T,) [s] and the first moment of the heights (T,) after the release from rest."""
    flow = OpenFoamFlow(
        folder, half_ball(cells), openfoam=find_openfoam(), radius=RADIUS, density=DENSITY,
        viscosity=1e-6, timeout=120.0,
    )  # fmt: skip
    level_patch, shell, path = level_shape(flow.mesh, level - 1.0)
    surface = FreeSurface(
        level_patch, flow.faces, path, mass=1e-3, density=DENSITY, gravity=GRAVITY
    )
    shape = _mode_shape(level_patch[:, :2], mode)
    surface.displace(AMPLITUDE * RADIUS * shape)
    flow.start(surface.state.position, shell, np.pi * RADIUS**3 * level**2 * (3 - level) / 3)
    scheme, added_mass = scheme_named("added-mass", relaxation=1.0, reuse=0)
    coupled = CoupledStep(
        surface, flow, Matching(), scheme, added_mass=added_mass, max_iterations=30,
        convergence=Convergence(tolerance=1e-4, floor=GRAVITY * step**2 * AMPLITUDE),
        record=lambda *_: None,
    )  # fmt: skip
    load = HydrostaticLoad(density=DENSITY, body_force=np.array([0.0, 0.0, -GRAVITY]))
    steps = int(np.ceil(PERIODS * 2 * np.pi / omega / step))
    signal = [surface.moment(shape)]
    for number in range(steps):
        outcome = coupled.advance(number * step, step, load)
        if not outcome.converged:
            raise RunFailed(f"verify slosh: step {number} left {outcome.residual:.1e}.")
        signal.append(surface.moment(shape))
    return np.linspace(0.0, step * steps, steps + 1), np.array(signal)


def level_shape(mesh: LiquidMesh, level: float) -> tuple[Array, Array, Array]:
    """Patch (p, 3), shell (s, 3) [m] and paths (p, 3) of a surface at z = ``level`` R.

    All points lie a little off the sphere, so that the polyhedron has the liquid's volume.
    """
    rim = float(np.sqrt(1 - level**2))
    patch = rim * mesh.points[mesh.patch_points]
    patch[:, 2] = level
    bottom = mesh.points[mesh.shell_points]
    across = np.linalg.norm(bottom[:, :2], axis=1)
    angle = np.arctan2(across, -bottom[:, 2]) * np.arccos(-level) / (np.pi / 2)
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


def _frequency(time: Array, signal: Array, omega: float) -> float:
    """omega [1/s] of the damped cosine, with one neighbouring mode beside it, fitted to signal."""

    def basis(parameters: Array) -> Array:
        columns = []
        for frequency, damping in parameters.reshape(-1, 2) * omega:
            decay = np.exp(-damping * time)
            columns += [decay * np.cos(frequency * time), decay * np.sin(frequency * time)]
        return np.array(columns).T

    def misfit(parameters: Array) -> Array:
        matrix = basis(parameters)
        return np.asarray(matrix @ np.linalg.lstsq(matrix, signal, rcond=None)[0] - signal)

    fit = least_squares(misfit, np.array([1.0, 0.0, 1.84, 0.0]), x_scale=0.1)
    return float(fit.x[0] * omega)
