"""The diaphragm of a scene: built, settled, and measured."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from cloth.energy import SheetEnergy, SheetLosses
from cloth.load import Settings
from cloth.mesh import hemisphere
from cloth.settle import settle
from cloth.step import Cloth
from cloth.thesis.grid import thesis_grid
from cloth.thesis.sheet import STEP, ThesisSheet
from coupling.ports import (
    Array,
    DiaphragmState,
    HydrostaticLoad,
    Ints,
    RunFailed,
    StepFailed,
    Structure,
)
from coupling.scene import Scene
from coupling.shaking import largest_body_force

_log = logging.getLogger(__name__)
HALVINGS = 3
# Compressive stiffness of a relaxed sheet over rho |g| R^2: 10 % bear 0.05 % R of liquid.
COMPRESSIVE = 0.005
FILLING_STEPS_PER_SECOND = 100  # of time.settle; the equilibrium itself is sought without a clock


class Diaphragm(Structure, Protocol):
    """A structure that can be held where it settled."""

    mass: Array  # (n,) [kg]
    thickness: Array  # (m,) [m]
    held: bool  # no node ever moves

    @property
    def previous_step(self) -> float:
        """Length [s] of the step that led to the committed state; 0 where the next is Euler's."""

    @property
    def iterations(self) -> int:
        """Inner iterations of the last solve."""

    @property
    def converged(self) -> bool:
        """Whether the last solve met its tolerance and kept the volume."""

    @property
    def state(self) -> DiaphragmState:
        """The committed state."""

    def energy(self) -> SheetEnergy:
        """Of the committed state."""

    def losses(self) -> SheetLosses:
        """In the step that led to it."""


def diaphragm_of(scene: Scene) -> Diaphragm:
    """The scene's diaphragm in its moulded shape.

    A map's thickness is taken at the centroid of each moulded triangle. ``TableError`` if the map
    has changed since the scene was read and is now wrong.
    The thesis' own steps are of 1 ms, or of ``time.step`` if that is shorter.
    """
    cloth, radius = scene.cloth, scene.tank.radius
    if cloth.grid == "thesis":
        return ThesisSheet(
            grid=thesis_grid(radius, cloth.resolution),
            diaphragm=scene.diaphragm.sheet,
            shell_radius=radius,
            step=min(STEP, scene.time.step),
        )
    gravity = float(np.linalg.norm(scene.gravity))
    swing = float(np.sqrt(radius / gravity))  # [s]
    area = scene.liquid.density * radius**2  # [kg/m]
    mesh, ridges = hemisphere(radius, cloth.resolution), scene.diaphragm.moulded_thickness
    return Cloth(
        mesh=mesh,
        diaphragm=scene.diaphragm.sheet,
        thickness=None if ridges is None else ridges.at(mesh.points[mesh.triangles].mean(axis=1)),
        shell_radius=radius,
        tensile_stiffness=cloth.stiffness * area * largest_body_force(scene)
        if scene.diaphragm.inextensible
        else None,
        compressive_stiffness=None
        if cloth.wrinkling == "resolved"
        else COMPRESSIVE * area * gravity,
        self_contact=True,
        clamped_rim=scene.diaphragm.rim == "clamped",
        settings=Settings(
            tolerance=cloth.tolerance,
            iterations=cloth.iterations,
            bending_damping=cloth.fold_damping * swing,
            drag=cloth.slack_drag / swing,
            stretch_damping=scene.loss_time,
            shell_friction=scene.diaphragm.friction_shell,
            self_friction=scene.diaphragm.friction_self,
        ),
    )


def settle_diaphragm(cloth: Diaphragm, scene: Scene, load: HydrostaticLoad) -> float | None:
    """Bring ``cloth`` to rest under ``load``, by way of the scene's liquid volume.

    Returns the rms motion [m] that the last pseudo-step left. Raises ``RunFailed`` where no
    equilibrium is found. The thesis' diaphragm runs ``time.settle`` from its moulded shape instead,
    1 s in the thesis, and whatever it has come to is taken for its rest, velocities included: then
    None is returned.
    """
    if isinstance(cloth, ThesisSheet):
        if scene.time.settle > 0.0:
            cloth.begin_step(scene.time.settle, load)
            cloth.solve(np.zeros_like(cloth.reference))
            cloth.accept_step()
        cloth.held = scene.diaphragm.held
        return None
    assert isinstance(cloth, Cloth)
    filled = replace(load, volume=scene.liquid_volume, datum=None)
    steps = max(10, round(FILLING_STEPS_PER_SECOND * scene.time.settle))
    tolerance = scene.time.settle_tolerance
    outcome = settle(cloth, filled, ramp_steps=steps, tolerance=tolerance)
    if load.datum is not None:
        outcome = settle(cloth, load, tolerance=tolerance)
    if not outcome.converged:
        raise RunFailed(
            f"settling: the diaphragm still moves by {outcome.change:.1e} m a step after "
            f"{outcome.steps} steps. Let it start so: time.settle_tolerance = "
            f"{2.0 * outcome.change / scene.tank.radius:.0e}; or try another cloth.resolution."
        )
    cloth.held = scene.diaphragm.held
    return outcome.change


class Step(Protocol):
    """A time step that can be tried with a shorter ``dt`` if it fails."""

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]; whether it is good enough.

        Raises ArithmeticError or ``StepFailed``.
        """

    def accept(self) -> None:
        """Commit the last attempt."""


class DryStep:
    """The step of a diaphragm under a hydrostatic load alone."""

    def __init__(self, cloth: Diaphragm) -> None:
        self.cloth = cloth

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """See ``Step``."""
        self.cloth.begin_step(dt, load)
        self.cloth.solve(np.zeros_like(self.cloth.reference))
        return self.cloth.converged

    def accept(self) -> None:
        """See ``Step``."""
        self.cloth.accept_step()


def advance(
    step: Step,
    now: float,
    dt: float,
    load: Callable[[float, float], HydrostaticLoad],
    *,
    halvings: int = HALVINGS,
    taken: Callable[[float], None] = lambda _: None,
) -> int:
    """Take ``step`` from ``now`` to ``now + dt`` [s] under ``load(start, end)``; parts it took.

    A step that does not converge is taken again as two of half its length, ``halvings`` times at
    most; the last is accepted as it is, unless it fails. Raises its ArithmeticError or
    ``StepFailed`` then. ``taken`` is told the length [s] of every part, once accepted.
    """
    try:
        good = step.attempt(now, dt, load(now, now + dt)) or halvings == 0
    except (ArithmeticError, StepFailed) as failure:
        if halvings == 0:
            raise
        _log.info("t = %.6g s: a step of %.3g s is taken as two: %s", now + dt, dt, failure)
        good = False
    if good:
        step.accept()
        taken(dt)
        return 1
    half = 0.5 * dt
    first = advance(step, now, half, load, halvings=halvings - 1, taken=taken)
    return first + advance(step, now + half, half, load, halvings=halvings - 1, taken=taken)


def liquid_cg(position: Array, triangles: Ints, radius: float, volume: float) -> Array:
    """Centre of gravity (3,) [m] of the liquid below the diaphragm at ``position`` (n, 3) [m].

    The lower half ball of ``radius`` [m] and the cone from the diaphragm to the tank's centre, of
    ``volume`` [m^3] together. Exact for the triangles.
    """
    a, b, c = (position[triangles[:, k]] for k in range(3))
    cone = np.einsum("mx,mx->m", a, np.cross(b, c)) / 6.0
    moment = cone @ (a + b + c) / 4.0
    moment[2] -= np.pi * radius**4 / 4.0
    return np.asarray(moment / volume)
