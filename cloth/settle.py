"""The diaphragm's static equilibrium, from the moulded shape."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace

import numpy as np

from cloth.arrays import Array
from cloth.contact import clamp_to_shell
from cloth.load import Load, Settings
from cloth.step import Cloth

log = logging.getLogger(__name__)

BENDING_DAMPING = 1.0  # s, at least this while settling: it leaves the equilibrium as it is
RAMPING = 10  # iterations of a pseudo-step while the volume changes
ITERATIONS = 60  # of the others, if not given; 20 leave short waves that momentum would amplify
# Of the shell's penalty over the stretch's, if not given: the penalty also holds nodes on the shell
# back from sliding. With a time step's 0.15, half-full sheets of 18 and 24 rings still move after
# 1500 steps; with 0.002 and 0.02 they come to rest.
SHELL_WEIGHT = 0.02
MOMENTUM = 0.97  # of the last step, at most
COASTING = 0.2  # momentum multiplies a slow motion by up to 1 / (1 - MOMENTUM) = 33
SLIDING = 0.5  # weight of tangential motion: slack cloth slides on where hardly a force holds it
QUIET_STEPS = 10
PATIENCE = 500  # steps; from there on the tolerance grows in proportion to the steps done


@dataclass(frozen=True, kw_only=True)
class _Ramped:
    density: float
    body_force: Array
    volume: float | None
    datum: float | None


@dataclass(frozen=True, kw_only=True)
class Settled:
    """``steps`` done; ``change`` [m], see ``settle``; ``converged``."""

    steps: int
    change: float
    converged: bool


class _Momentum:
    """Nesterov's extrapolation of a converging sequence, with restarts.

    Takes the state where it was going, positions and duals alike: slack cloth creeps along one
    smooth direction, for hundreds of steps without this. It starts again when the step turns
    against the motion (O'Donoghue and Candes 2015), and more gently after the residual has grown.
    """

    def __init__(self) -> None:
        self.cap, self.age, self.best = MOMENTUM, 0, np.inf

    def factor(self, step: Array, motion: Array) -> float:
        """Share of the last change to add; ``step``, ``motion`` (n, 3) [m] without and with it."""
        residual = _rms(step)
        self.best = min(self.best, residual)
        if residual > 3.0 * self.best:
            self.age, self.cap, self.best = 0, 0.5 * self.cap, residual
        elif float(np.sum(step * motion)) < 0.0:
            self.age = 0
        else:
            self.age += 1
        self.cap = min(MOMENTUM, self.cap + 0.005)
        return min(self.cap, self.age / (self.age + 3.0))


def _rms(moved: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(moved**2, axis=1))))


def _weighted(moved: Array, normals: Array) -> float:
    """Rms of ``moved`` (n, 3) [m] with its part across ``normals`` (any length) times SLIDING."""
    length = np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
    along = np.sum(moved * normals / length, axis=1)[:, None] * normals / length
    return _rms(along + SLIDING * (moved - along))


def _extrapolated(
    cloth: Cloth, new: dict[str, Array], old: dict[str, Array], factor: float
) -> dict[str, Array]:
    """``new`` with a share of its change since ``old`` added to all that the next step solves."""
    result = dict(new)
    for name in ("position", "tension", "contact_force"):
        result[name] = new[name] + factor * (new[name] - old[name])
    contact = cloth.model.self_contact
    if contact is not None:
        limit = cloth.model.limit
        further = clamp_to_shell(result["position"], limit)
        result["position"] = contact.resolve(new["position"], further, limit).position
    return result


def _pseudo_step(cloth: Cloth, dt: float, load: Load, settings: Settings) -> dict[str, Array]:
    """An implicit Euler step from rest, its end brought to rest; the state reached."""
    cloth.begin_step(dt, load, settings=settings)
    cloth.solve(np.zeros_like(cloth.reference))
    cloth.accept_step()
    cloth.halt()
    return cloth.save()


def settle(
    cloth: Cloth,
    load: Load,
    *,
    dt: float = 0.03,
    ramp_steps: int = 100,
    tolerance: float = 4e-7,
    steps_max: int = 1500,
    iterations: int = ITERATIONS,
    shell_weight: float = SHELL_WEIGHT,
) -> Settled:
    """Bring ``cloth`` to rest under ``load``, in place.

    Implicit Euler steps of ``dt`` [s] that forget their velocity, with more bending
    damping, which does not move the equilibrium. The volume goes from where it
    is to ``load.volume`` as a smooth ramp over ``ramp_steps`` (none with a given datum). Then
    steps are extrapolated, until for ten of them the ``change`` stays below ``tolerance`` times
    half the mesh's extent (the radius, of a hemisphere): the rms displacement of a step alone, or
    a fifth of it with the extrapolation if that is more, motion along the surface counted half. So
    slack cloth may still creep tangentially by two tolerances a step. After 500 steps the
    tolerance grows with the steps, threefold at 1500: what is left is the slow creep of a slack
    coarse sheet.
    A wrinkled or slack sheet has many equilibria; the one found depends on the path.
    """
    if cloth.held:
        return Settled(steps=0, change=0.0, converged=True)
    begin = cloth.state.volume
    damping = max(BENDING_DAMPING, cloth.settings.bending_damping)
    # A fixed number: pseudo-steps that stop early stop short of the equilibrium.
    ramping = replace(
        cloth.settings,
        bending_damping=damping,
        stretch_damping=0.0,
        shell_friction=0.0,
        self_friction=0.0,
        tolerance=0.0,
        iterations=RAMPING,
        shell_weight=shell_weight,
    )
    seeking = replace(ramping, iterations=iterations)
    limit = tolerance * cloth.model.size
    momentum, change, quiet = _Momentum(), np.inf, 0
    cloth.halt()
    old = cloth.save()
    for step in range(1, steps_max + 1):
        s, volume = min(1.0, step / ramp_steps), load.volume
        if volume is None:
            s = 1.0
        else:
            volume = begin + (volume - begin) * s * s * (3.0 - 2.0 * s)
        part = _Ramped(
            density=load.density, body_force=load.body_force, volume=volume, datum=load.datum
        )
        start = cloth.state.position
        new = _pseudo_step(cloth, dt, part, ramping if s < 1.0 else seeking)
        moved, motion = new["position"] - start, new["position"] - old["position"]
        normals = cloth.model.volume_and_gradient(start)[1]
        change = max(_weighted(moved, normals), COASTING * _weighted(motion, normals))
        quiet = quiet + 1 if s >= 1.0 and change <= limit * max(1.0, step / PATIENCE) else 0
        if quiet >= QUIET_STEPS:
            log.info("settled after %d steps, rms change %.1e m", step, change)
            return Settled(steps=step, change=change, converged=True)
        if s >= 1.0 and step < steps_max:
            cloth.restore(_extrapolated(cloth, new, old, momentum.factor(moved, motion)))
        old = new
    log.warning(
        "not settled after %d steps: rms change %.1e m a step, tolerance %.1e m",
        steps_max,
        change,
        limit,
    )
    return Settled(steps=steps_max, change=change, converged=False)
