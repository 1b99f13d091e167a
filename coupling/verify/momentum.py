"""Newton's law for the whole liquid: what it pushes with is what its centre of gravity does."""

from __future__ import annotations

import tempfile
from contextlib import closing
from pathlib import Path
from time import perf_counter

import numpy as np

from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.mesh import half_ball
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.fields import read_cells, read_points
from coupling.foam.installation import find_openfoam
from coupling.interface.mapping import Matching
from coupling.motion.sine import SineMotion
from coupling.ports import Array, FlowSample, HydrostaticLoad, RunFailed
from coupling.schemes.added_mass import AddedMass
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledStep
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.free_surface import FreeSurface
from coupling.verify.level_tank import DENSITY, GRAVITY, level_shape, level_tank
from coupling.verify.sheets import within
from coupling.verify.whole_run import whole_run

FREQUENCY = 1.25  # Hz, above the first slosh frequency of 0.93 Hz
TILT = 2e-3  # largest acceleration of the tank over gravity's: the surface stays linear
AMPLITUDE, DIRECTION = TILT * GRAVITY / (2 * np.pi * FREQUENCY) ** 2, (1.0, 0.0, 0.0)
RAMP, MEASURED = 0.5, 0.5  # periods


def momentum(*, fluid: str = "openfoam", step: float = 0.01, resolution: int = 0) -> VerifyResult:
    """A tank shaken sideways by a sine that sets in smoothly; ``step`` [s].

    The force on the walls beyond rho b V, which is exact, must be -m c''. c is the liquid's centre
    of gravity, c'' its ``backward`` difference taken twice, as both liquids difference in time.
    ``imbalance`` is the largest error after the ramp, over the largest m |c''|. ``fluid``:

    - ``openfoam``: half full with a free surface; ``resolution``: cells of the mesh, 0 for 1300.
      The imbalance of the wall pressure's force is the grid's error, of second order: 4.7, 2.2,
      1.3, 0.5 % with 176, 540, 1216, 4320 cells. The flux through the surface enters at the centres
      of the cells, which do not stand below those of their faces. ``imbalance_of_cells``: with the
      cells' own momentum, sum rho V U, in the place of m c'. It leaves out the grid's error, and
      what is left (1e-4) falls with the amplitude.
    - ``potential``: a whole run below a diaphragm of ``resolution`` rings, 0 for 16, at a fill
      fraction of 0.8. Its triangles are the grid of the liquid too: the imbalance is their error,
      of second order, 0.1 % on 16 rings. On 8 rings and in steps below 10 ms the sheet chatters,
      with any liquid, and that is then seen instead.
    """
    clock = perf_counter()
    if fluid not in ("openfoam", "potential"):
        raise CaseError(f"verify momentum: --fluid: must be openfoam or potential, got '{fluid}'.")
    resolution = resolution or {"openfoam": 1300, "potential": 16}[fluid]
    within("momentum", "step", step, 1e-4, 0.05 / FREQUENCY)  # 20 of them in a period
    least, most = {"openfoam": (176, 100_000), "potential": (4, 200)}[fluid]
    within("momentum", "resolution", resolution, least, most)
    if fluid == "openfoam":
        with tempfile.TemporaryDirectory() as folder:
            found = _shaken(Path(folder), step, resolution)
    else:
        found = _below_diaphragm(step, resolution)
    return VerifyResult(
        case="momentum",
        options={"fluid": fluid, "step": step, "resolution": resolution},
        quantities=tuple(quantity(name, value, 0.0) for name, value in found.items()),
        wall_s=perf_counter() - clock,
    )


def _below_diaphragm(step: float, rings: int) -> dict[str, float]:
    """``imbalance`` of a run with the inviscid liquid."""
    scene, results = whole_run(
        "momentum",
        model={"fluid": "potential"},
        liquid={"viscosity": 1e-14},  # the forces are those of the pressure alone
        cloth={"resolution": rings},
        motion={
            "kind": "sine", "frequency": FREQUENCY, "amplitude": AMPLITUDE,
            "direction": DIRECTION, "ramp": RAMP,
        },
        time={"duration": (RAMP + MEASURED) / FREQUENCY, "step": step},
    )  # fmt: skip
    mass = scene.liquid.density * scene.liquid_volume
    beyond = results.force - mass * (np.asarray(scene.gravity) - results.tank_acceleration)
    rate = mass * _difference(_difference(results.liquid_cg, step), step)
    return {"imbalance": _relative(beyond + rate, rate, step)}


def _shaken(folder: Path, step: float, cells: int) -> dict[str, float]:
    """``imbalance`` and ``imbalance_of_cells`` of a free surface on OpenFOAM's liquid."""
    flow = OpenFoamFlow(
        folder, half_ball(cells), openfoam=find_openfoam(keep_alive=True),
        shell=level_tank("sphere"), density=DENSITY, viscosity=1e-6, timeout=120.0,
    )  # fmt: skip
    with closing(flow):
        force, centre, flow_momentum, mass = _recorded(flow, step)
    rate = mass * _difference(_difference(centre, step), step)
    errors = (force + rate, force + _difference(flow_momentum, step))
    names = ("imbalance", "imbalance_of_cells")
    return {name: _relative(error, rate, step) for name, error in zip(names, errors, strict=True)}


def _recorded(flow: OpenFoamFlow, step: float) -> tuple[Array, Array, Array, float]:
    """Force of p* [N], centre of gravity [m] and sum rho V U [N s], (T, 3) each; mass [kg]."""
    patch, shell, path, content = level_shape(flow.mesh, level_tank("sphere"), 0.0)
    surface = FreeSurface(patch, flow.faces, path, mass=1e-3, density=DENSITY, gravity=GRAVITY)
    flow.start(patch, shell, content)
    coupled = CoupledStep(
        surface, flow, Matching(), AddedMass(), takes_inertia=True, max_iterations=30,
        convergence=Convergence(tolerance=1e-4, acceleration=GRAVITY * TILT),
        record=lambda *_: None,
    )  # fmt: skip
    motion = SineMotion(
        frequency=FREQUENCY, amplitude=AMPLITUDE, direction=np.array(DIRECTION), ramp=RAMP
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
        assert isinstance(sample, FlowSample)
        samples.append((sample.wall_pressure_force, sample.liquid_cg, momentum))
    force, centre, flow_momentum = (np.array(column) for column in zip(*samples, strict=True))
    return force, centre, flow_momentum, DENSITY * flow.volume


def _difference(values: Array, step: float) -> Array:
    """Derivative (T, k) of ``values`` (T, k) that stood still before: ``backward``."""
    before = np.concatenate([values[:1], values[:1], values])
    return np.asarray((1.5 * before[2:] - 2 * before[1:-1] + 0.5 * before[:-2]) / step)


def _relative(error: Array, rate: Array, step: float) -> float:
    """Largest ``error`` (T, 3) after the ramp over the largest ``rate`` (T, 3)."""
    late = slice(round(RAMP / FREQUENCY / step), None)
    return _largest(error[late]) / _largest(rate[late])


def _largest(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())
