"""The diaphragm of a scene: built, settled, and measured."""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from typing import Protocol

import numpy as np

from cloth.energy import SheetEnergy, SheetLosses
from cloth.load import Settings
from cloth.mesh import moulded
from cloth.settle import settle
from cloth.shell.sphere import Sphere
from cloth.step import Cloth
from cloth.thesis.grid import thesis_grid
from cloth.thesis.sheet import STEP, ThesisSheet
from coupling.motion.shaking import largest_body_force
from coupling.ports import (
    Array,
    DiaphragmState,
    HydrostaticLoad,
    IterativeStructure,
    RunFailed,
)
from coupling.scene.scene import Scene
from coupling.scene.wrinkles import grid_spacing

_log = logging.getLogger(__name__)
# Compressive stiffness of a relaxed sheet over rho |g| R^2, at most: 10 % bear 0.03 % R of liquid;
COMPRESSIVE = 0.003
# and over the load per width that buckles it on the liquid, so that compressed by half it pushes
# with an eighth of that. It would fold to a depth of several tenths of R in place of shrinking.
BUCKLING = 0.25
CREEP = 1e-4  # force over rho g R^3, below which a sheet that finds no rest starts all the same
# The same of a sheet that is longer than a hemisphere, so that it cannot lie flat: slack creeps
# into pleats for long, and what keeps its layers apart moves nodes by some 10 um, which an
# inextensible sheet answers with forces that no equilibrium has.
FOLDED = 2e-2
ROUNDING = 1e-9  # of a length
HEMISPHERE = 0.5 * math.pi  # length of its meridian over its rim's radius


class Diaphragm(IterativeStructure, Protocol):
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
    def turned(self) -> Array:
        """Rotation vector (3,) [rad] by which the last solve ends beyond the attitude presumed.

        Of a free tank that turns, in the axes of that attitude; 0 of any other.
        """

    @property
    def attitude_found(self) -> bool:
        """Whether that is within the tolerance of a solve."""

    @property
    def state(self) -> DiaphragmState:
        """The committed state."""

    def energy(self) -> SheetEnergy:
        """Of the committed state."""

    def losses(self) -> SheetLosses:
        """In the step that led to it."""


def diaphragm_of(scene: Scene) -> Diaphragm:
    """The scene's diaphragm in its moulded shape.

    The thickness of a map or of ridges is taken at the centroid of each moulded triangle.
    ``TableError`` if the map has changed since the scene was read and is now wrong.
    The thesis' own steps are of 1 ms, or of ``time.step`` if that is shorter.
    """
    cloth, shell = scene.cloth, scene.tank.shell
    if cloth.grid == "thesis":
        assert isinstance(shell, Sphere), "the scene's checks see to it"
        return ThesisSheet(
            grid=thesis_grid(shell.radius, cloth.resolution),
            diaphragm=scene.diaphragm.sheet,
            shell=shell,
            step=min(STEP, scene.time.step),
        )
    gravity = float(np.linalg.norm(scene.gravity))
    swing = float(np.sqrt(shell.size / gravity))  # [s]
    area = scene.liquid.density * shell.size**2  # [kg/m]
    mesh = moulded(scene.mould, cloth.resolution)
    thickness = scene.thickness_at(mesh.points[mesh.triangles].mean(axis=1))
    return Cloth(
        mesh=mesh,
        diaphragm=scene.sheet,
        thickness=thickness,
        shell=shell,
        tensile_stiffness=cloth.stiffness * area * largest_body_force(scene)
        if scene.diaphragm.inextensible
        else None,
        compressive_stiffness=None if cloth.wrinkling == "resolved" else _relaxed(scene),
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


def _relaxed(scene: Scene) -> float:
    """Compressive stiffness [N/m] of a sheet that is not to wrinkle.

    A strip on a liquid buckles under kappa q^2 + rho g/q^2 [N/m], least for the wave number of the
    elasto-gravity wavelength (Pocivavsek et al. 2008), or the largest one that the grid has.
    """
    weight = scene.liquid.density * float(np.linalg.norm(scene.gravity))  # [N/m^3]
    bending = scene.sheet.bending_stiffness
    shortest = math.pi / grid_spacing(scene.mould.length, scene.cloth)
    square = min(math.sqrt(weight / bending), shortest**2)
    buckling = bending * square + weight / square
    # A sheet that lies flat is compressed to a share s of its length, of a hemisphere 2/pi. Its
    # waves then buckle under s^2 of that load, and it pushes with 1 - s of the stiffness.
    longest = _slackness(scene)
    room = HEMISPHERE * (HEMISPHERE - 1.0) / (longest * (longest - 1.0))
    size = scene.tank.shell.size
    return min(COMPRESSIVE * weight * size**2, BUCKLING * room * buckling)


def _slackness(scene: Scene) -> float:
    """Length of the mould's meridian over the rim's radius, a hemisphere's for all shorter ones."""
    longest = scene.mould.length / scene.tank.shell.size
    return longest if longest > HEMISPHERE * (1.0 + ROUNDING) else HEMISPHERE


def settle_diaphragm(cloth: Diaphragm, scene: Scene, load: HydrostaticLoad) -> float | None:
    """Bring ``cloth`` to rest under ``load``, by way of the scene's liquid volume.

    Returns the force left over rho g R^3 (``cloth.residual``). Raises ``RunFailed`` where that is
    more than ``time.settle_tolerance`` and ``CREEP``, of a long sheet ``FOLDED``. The thesis'
    diaphragm runs ``time.settle`` from its moulded shape instead, 1 s in the thesis, and whatever
    it has come to is taken for its rest, velocities included: then None is returned.
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
    tolerance = scene.time.settle_tolerance
    outcome = settle(cloth, filled, tolerance=tolerance)
    if load.datum is not None:
        outcome = settle(cloth, load, tolerance=tolerance)
    if not outcome.converged:
        allowed = FOLDED if _slackness(scene) > HEMISPHERE else CREEP
        if outcome.residual > max(allowed, tolerance):
            raise RunFailed(
                f"settling: the diaphragm finds no rest in {outcome.steps} steps: the force left "
                f"is {outcome.residual:.1e} rho g R^3, time.settle_tolerance {tolerance:.0e}. Let "
                f"it start so: time.settle_tolerance = {2.0 * outcome.residual:.0e}; or try "
                "another cloth.resolution."
            )
        _log.warning(
            "settling: the diaphragm still creeps in its folds, under a force of %.1e rho g R^3; "
            "it starts so.",
            outcome.residual,
        )
    cloth.held = scene.diaphragm.held
    return outcome.residual
