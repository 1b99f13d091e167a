"""A spring-held piston at both ends of a closed column of liquid, through the whole coupling."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cloth.shell.sphere import Sphere
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.installation import find_openfoam
from coupling.interface.mapping import Matching
from coupling.ports import Array, HydrostaticLoad, Ints, RunFailed
from coupling.scene.numerics import Coupling
from coupling.schemes import SCHEMES
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledStep
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.column import LENGTH, WIDTH, column_mesh

DENSITY = 1000.0  # of the liquid [kg/m^3]
OMEGA = 10.0  # 1/s: the spring is chosen for it
AMPLITUDE = 1e-3  # m: the case is linear but for its square
PERIODS = 1.0
TOLERANCE = 1e-4
RELAXATION = 0.1  # first one of aitken and iqn-ils


def piston(
    *, mass_ratio: float = 10.0, scheme: str = "added-mass", step: float = 0.02, cells: int = 8
) -> VerifyResult:
    """Frequency of a piston of mass m on a spring k with the column's liquid: k/(m + rho A L).

    The piston closes both ends of a straight column, whose liquid has to move with it as a plug.
    ``mass_ratio``: rho A L over m; ``scheme``: as ``coupling.scheme``; ``step`` [s]; ``cells``
    along the column. Quantities:

    - ``omega`` [1/s]. ``backward`` lowers it by (omega dt)^2/3.
    - ``iterations``, mean of a step, beside what theory gives for one degree of freedom: 1 where
      the structure carries the liquid's inertia, 3 for a secant, and for the fixed point as many
      as the factor (rho A L/b^2)/(m/b^2 + k) needs from the first residual met.

    ``RunFailed`` where the scheme diverges: the fixed point above a mass ratio of 1 (and a little,
    for the spring).
    """
    clock = perf_counter()
    if scheme not in SCHEMES:
        raise CaseError(f"verify piston: --scheme: must be one of {', '.join(SCHEMES)}.")
    if not (mass_ratio > 0 and step > 0 and cells >= 4):
        raise CaseError("verify piston: --mass-ratio, --step: positive; --cells: 4 or more.")
    liquid = DENSITY * WIDTH**2 * LENGTH
    mass = liquid / mass_ratio
    stiffness = OMEGA**2 * (mass + liquid)
    with tempfile.TemporaryDirectory() as folder:
        place, iterations, first = _release(Path(folder), mass, stiffness, scheme, step, cells)
    factor = liquid / (mass + stiffness * (2 * step / 3) ** 2)
    expected = {"added-mass": 1.0, "iqn-ils": 3.0, "aitken": 3.0}.get(
        scheme, 1.0 + float(np.ceil(np.log(TOLERANCE / first) / np.log(factor)).clip(0).mean())
    )
    return VerifyResult(
        case="piston",
        options={"mass_ratio": mass_ratio, "scheme": scheme, "step": step, "cells": cells},
        quantities=(
            quantity("omega", _frequency(place, step), OMEGA, "1/s"),
            quantity("iterations", float(np.mean(iterations)), expected),
        ),
        wall_s=perf_counter() - clock,
    )


def _release(
    folder: Path, mass: float, stiffness: float, scheme: str, step: float, cells: int
) -> tuple[Array, Array, Array]:
    """Places (T,) [m] after the release from rest; iterations and first residual of each step."""
    mesh = column_mesh(cells)
    flow = OpenFoamFlow(
        folder, mesh, openfoam=find_openfoam(), shell=Sphere(LENGTH), density=DENSITY,
        viscosity=1e-12, timeout=60.0,
    )  # fmt: skip
    points = LENGTH * mesh.points
    flow.start(points[mesh.patch_points], points[mesh.shell_points], WIDTH**2 * LENGTH)
    body = Piston(flow.points, flow.faces, mass=mass, stiffness=stiffness)
    body.stretch(AMPLITUDE)
    kind = SCHEMES[scheme]
    first: list[float] = []

    def record(_time: float, iteration: int, residual: float, _seconds: float) -> None:
        if iteration == 1:
            first.append(residual)

    coupled = CoupledStep(
        body, flow, Matching(), kind.of(Coupling(relaxation=RELAXATION, reuse=0)),
        max_iterations=200, record=record,
        convergence=Convergence(tolerance=TOLERANCE, acceleration=OMEGA**2 * AMPLITUDE),
        takes_inertia=kind.takes_inertia,
    )  # fmt: skip
    load = HydrostaticLoad(density=DENSITY, body_force=np.zeros(3))
    steps = int(np.ceil(PERIODS * 2 * np.pi / OMEGA / step))
    place, iterations = [AMPLITUDE], []
    for number in range(steps):
        outcome = coupled.advance(number * step, step, load)
        if not outcome.converged:
            raise RunFailed(f"verify piston: step {number} left {outcome.residual:.1e}.")
        iterations.append(outcome.iterations)
        place.append(float(body.place[0]))
    return np.array(place), np.array(iterations, dtype=float), np.array(first)


@dataclass(frozen=True, kw_only=True)
class PistonState:
    """A ``StructureState``; the spring's place is in ``Piston.place``."""

    position: Array
    velocity: Array
    datum_pressure: float
    volume: float
    strain: Array


@dataclass(frozen=True, kw_only=True)
class PistonStep:
    """A step in hand, with ``b`` [s] of its formula and the ``inertia`` [N/m] over b^2.

    ``anchor`` and ``ahead`` [m]: where the place would be without speed, and without forces.
    """

    b: float
    anchor: float
    ahead: float
    inertia: float


class Piston:
    """One degree of freedom: both ends, ``points`` (p, 3), move along z by the same way.

    ``place`` (2,) [m]: of the spring, now and a step ago; ``mass`` [kg]; ``stiffness`` [N/m].
    Steps are ``backward``, the first one Euler.
    """

    def __init__(self, points: Array, faces: Ints, *, mass: float, stiffness: float) -> None:
        self.reference = points
        self.triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        self.fixed: NDArray[np.bool_] = np.zeros(len(points), dtype=bool)
        self.mass, self.stiffness = mass, stiffness
        self.place, self.speed = np.zeros(2), np.zeros(2)
        self.origin = 0.0  # the place in which the points are ``reference``
        self.steps = 0
        self._step = PistonStep(b=0.0, anchor=0.0, ahead=0.0, inertia=0.0)  # before the first
        self._now = 0.0  # the place that the last solve has found

    def stretch(self, way: float) -> None:
        """Stretch the spring by ``way`` [m]; the ends are where they are, at rest."""
        self.place = np.full(2, way)
        self.origin = way

    def begin_step(
        self, dt: float, load: HydrostaticLoad, liquid_inertia: Array | None = None
    ) -> None:
        """Start a step of ``dt`` [s]; a uniform body force has no part along a closed column."""
        weights = (1.0, 0.0) if self.steps == 0 else (4 / 3, -1 / 3)
        b = dt if self.steps == 0 else 2 * dt / 3
        anchor = float(np.dot(weights, self.place))
        rows = np.zeros(0) if liquid_inertia is None else liquid_inertia[:, :, 2].sum(axis=1)
        ahead = anchor + b * float(np.dot(weights, self.speed))
        inertia = (self.mass + float(rows @ rows)) / b**2
        self._step = PistonStep(b=b, anchor=anchor, ahead=ahead, inertia=inertia)

    @property
    def acceleration_scale(self) -> float:
        """b^2 [s^2] of this step's implicit formula."""
        return self._step.b**2

    def still_position(self) -> Array:
        """Where the ends (p, 3) [m] would have no velocity."""
        return self._points(self._step.anchor)

    def inertial_prediction(self) -> Array:
        """Where the ends (p, 3) [m] would go without forces."""
        return self._points(self._step.ahead)

    def solve(self, force: Array) -> Array:
        """The ends (p, 3) [m] under nodal ``force`` (p, 3) [N]."""
        pushed = float(force[:, 2].sum()) + self._step.inertia * self._step.ahead
        self._now = pushed / (self._step.inertia + self.stiffness)
        return self._points(self._now)

    def _points(self, place: float) -> Array:
        return np.asarray(self.reference + np.array([0.0, 0.0, place - self.origin]))

    def accept_step(self) -> None:
        """Commit the last solve."""
        self.speed = np.array([(self._now - self._step.anchor) / self._step.b, self.speed[0]])
        self.place = np.array([self._now, self.place[0]])
        self.steps += 1

    @property
    def state(self) -> PistonState:
        """The committed state."""
        velocity = np.zeros_like(self.reference)
        velocity[:, 2] = self.speed[0]
        return PistonState(
            position=self._points(float(self.place[0])),
            velocity=velocity,
            datum_pressure=0.0,
            volume=0.0,
            strain=np.zeros(len(self.triangles)),
        )

    def save(self) -> dict[str, Array]:
        """Places and speeds of two steps."""
        at = np.array([self.origin, self.steps])
        return {"place": self.place, "speed": self.speed, "at": at}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self.place, self.speed = saved["place"].copy(), saved["speed"].copy()
        self.origin, self.steps = float(saved["at"][0]), int(saved["at"][1])


def _frequency(place: Array, step: float) -> float:
    """omega [1/s] of the damped cosine fitted to the ``place`` (T,)."""
    time = step * np.arange(len(place))

    def misfit(parameters: Array) -> Array:
        frequency, damping = parameters * OMEGA
        decay = np.exp(-damping * time)
        basis = np.array([decay * np.cos(frequency * time), decay * np.sin(frequency * time)]).T
        return np.asarray(basis @ np.linalg.lstsq(basis, place, rcond=None)[0] - place) / AMPLITUDE

    return float(least_squares(misfit, np.array([1.0, 0.0])).x[0] * OMEGA)
