"""Newton's law for the whole liquid: what it pushes with is what its centre of gravity does."""

from __future__ import annotations

import tempfile
from contextlib import closing
from pathlib import Path
from time import perf_counter

import numpy as np

from coupling.convergence import Convergence
from coupling.coupled_step import CoupledStep
from coupling.fluids.openfoam import OpenFoamFlow
from coupling.foam.fields import read_cells, read_points
from coupling.foam.geometry import cell_geometry
from coupling.foam.mesh import half_ball
from coupling.foam.process import find_openfoam
from coupling.mapping import Matching
from coupling.motion import SineMotion
from coupling.ports import Array, HydrostaticLoad, RunFailed
from coupling.schemes import scheme_named
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.free_surface import FreeSurface
from coupling.verify.slosh import DENSITY, GRAVITY, RADIUS, level_shape

FREQUENCY = 1.25  # Hz, above the first slosh frequency of 0.93 Hz
TILT = 2e-3  # largest acceleration of the tank over gravity's: the surface stays linear
RAMP, MEASURED = 0.5, 0.5  # periods


def momentum(
    *, fluid: str = "openfoam", step: float = 0.01, resolution: int = 1300
) -> VerifyResult:
    """A half-full tank with a free surface, shaken sideways by a sine that sets in smoothly.

    ``step`` [s]; ``resolution``: cells of the mesh. The force on the walls beyond rho b V, which is
    exact, must be -m c''. c is the centre of gravity of the mesh, c'' its ``backward`` difference
    taken twice, as the flow solver differs its fluxes. The largest error after the ramp, over the
    largest m |c''|, is

    - ``imbalance``: of the wall pressure's force. It is the grid's error, of second order but for a
      remainder of 0.6 % (the solver's gradients next to a wall): 4.8, 2.6, 1.7 % with 176, 540,
      1216 cells. The flux through the surface enters at the centres of the cells, which do not
      stand below those of their faces.
    - ``imbalance_of_cells``: with the cells' own momentum, sum rho V U, in the place of m c'. It
      leaves out the grid's error, and what is left (1e-4) falls with the amplitude.
    """
    clock = perf_counter()
    if fluid != "openfoam":
        raise CaseError(f"verify momentum: fluid must be openfoam, got {fluid}.")
    with tempfile.TemporaryDirectory() as folder:
        force, centre, flow_momentum, mass = _shaken(Path(folder), step, resolution)
    rate = mass * _difference(_difference(centre, step), step)
    late = slice(round(RAMP / FREQUENCY / step), None)
    largest = _largest(rate[late])
    errors = (force + rate, force + _difference(flow_momentum, step))
    return VerifyResult(
        case="momentum",
        options={"fluid": fluid, "step": step, "resolution": resolution},
        quantities=tuple(
            quantity(name, _largest(error[late]) / largest, 0.0)
            for name, error in zip(("imbalance", "imbalance_of_cells"), errors, strict=True)
        ),
        wall_s=perf_counter() - clock,
    )


def _shaken(folder: Path, step: float, cells: int) -> tuple[Array, Array, Array, float]:
    """Force of p* [N], centre of gravity [m] and sum rho V U [N s], (T, 3) each; mass [kg]."""
    flow = OpenFoamFlow(
        folder, half_ball(cells), openfoam=find_openfoam(keep_alive=True),
        radius=RADIUS, density=DENSITY, viscosity=1e-6, timeout=120.0,
    )  # fmt: skip
    with closing(flow):
        return _recorded(flow, step)


def _recorded(flow: OpenFoamFlow, step: float) -> tuple[Array, Array, Array, float]:
    patch, shell, path = level_shape(flow.mesh, 0.0)
    surface = FreeSurface(patch, flow.faces, path, mass=1e-3, density=DENSITY, gravity=GRAVITY)
    flow.start(patch, shell, 2 * np.pi * RADIUS**3 / 3)
    scheme, added_mass = scheme_named("added-mass", relaxation=1.0, reuse=0)
    coupled = CoupledStep(
        surface, flow, Matching(), scheme, added_mass=added_mass, max_iterations=30,
        convergence=Convergence(tolerance=1e-4, floor=GRAVITY * step**2 * TILT),
        record=lambda *_: None,
    )  # fmt: skip
    motion = SineMotion(
        frequency=FREQUENCY,
        amplitude=TILT * GRAVITY / (2 * np.pi * FREQUENCY) ** 2,
        direction=np.array([1.0, 0.0, 0.0]),
        ramp=RAMP,
    )
    points = read_points(flow.case.folder / "constant" / "polyMesh" / "points")
    geometry = cell_geometry(flow.mesh, points)
    samples = [
        (np.zeros(3), geometry.volume @ geometry.centre / geometry.volume.sum(), np.zeros(3))
    ]
    gravity = np.array([0.0, 0.0, -GRAVITY])
    for number in range(round((RAMP + MEASURED) / FREQUENCY / step)):
        acceleration = motion.acceleration((number + 1) * step)
        load = HydrostaticLoad(density=DENSITY, body_force=gravity - acceleration)
        outcome = coupled.advance(number * step, step, load)
        if not outcome.converged:
            raise RunFailed(f"verify momentum: step {number} left {outcome.residual:.1e}.")
        flow.case.flush(flow.time)
        time = flow.case.time_folder(flow.time)
        volume = cell_geometry(flow.mesh, read_points(time / "polyMesh" / "points")).volume
        momentum = DENSITY * volume @ read_cells(time / "U", flow.mesh.cells)
        sample = outcome.sample
        samples.append((sample.wall_pressure_force, sample.liquid_cg, momentum))
    force, centre, flow_momentum = (np.array(column) for column in zip(*samples, strict=True))
    return force, centre, flow_momentum, DENSITY * flow.volume


def _difference(values: Array, step: float) -> Array:
    """Derivative (T, k) of ``values`` (T, k) that stood still before: ``backward``."""
    before = np.concatenate([values[:1], values[:1], values])
    return np.asarray((1.5 * before[2:] - 2 * before[1:-1] + 0.5 * before[:-2]) / step)


def _largest(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())
