"""The diaphragm's static equilibrium, sought from a level shape by steps that forget velocity."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cloth.arrays import Array
from cloth.level import level_shape
from cloth.load import Load, Settings, pressure_scale
from cloth.residual import residual
from cloth.step import Cloth

log = logging.getLogger(__name__)

PSEUDO_STEP = 0.14  # of a step, in swings sqrt(L/b)
BENDING_DAMPING = 5.0  # swings, at least this while settling: it leaves the equilibrium as it is
TURNING, TURNED = 50, 10  # pseudo-steps of gravity through 90 degrees, and their iterations
ITERATIONS = 60  # of the others, if not given; 20 leave short waves that momentum would amplify
MOMENTUM = 0.97  # of the last step, at most
QUIET_STEPS = 5
# Pseudo-steps in which it has come no nearer to rest by a tenth, after which it finds none: a sheet
# in self-contact jitters by the stiffness times what keeps its layers apart. A slack one, half full
# on 8 rings, is near rest after 8, creeps away, and finds it 735 later.
PATIENCE = 1000


@dataclass(frozen=True, kw_only=True)
class _Turned:
    density: float
    body_force: Array
    volume: float | None
    datum: float | None
    turn: None = None  # of the tank; gravity turns here
    recoil: None = None


@dataclass(frozen=True, kw_only=True)
class Settled:
    """How settling ended: ``steps`` done, ``residual`` [-] of ``cloth.residual``, ``converged``."""

    steps: int
    residual: float
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
        """Return the share of the last change that is added to the state.

        Parameters
        ----------
        step, motion
            Change in the last step (n, 3) [m], from where momentum had put the sheet, and from the
            state before that.
        """
        moved = float(np.linalg.norm(step))
        self.best = min(self.best, moved)
        if moved > 3.0 * self.best:
            self.age, self.cap, self.best = 0, 0.5 * self.cap, moved
        elif float(np.sum(step * motion)) < 0.0:
            self.age = 0
        else:
            self.age += 1
        self.cap = min(MOMENTUM, self.cap + 0.005)
        return min(self.cap, self.age / (self.age + 3.0))


def _extrapolated(
    cloth: Cloth, new: dict[str, Array], old: dict[str, Array], factor: float
) -> dict[str, Array]:
    """``new`` with a share of its change since ``old`` added to all that the next step solves."""
    result = dict(new)
    for name in ("position", "tension", "contact_force"):
        result[name] = new[name] + factor * (new[name] - old[name])
    contact = cloth.model.self_contact
    if contact is not None:
        shell = cloth.model.shell
        further = shell.confine(result["position"])
        result["position"] = contact.resolve(new["position"], further, shell).position
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
    tolerance: float = 1e-6,
    steps_max: int = 1500,
    iterations: int = ITERATIONS,
) -> Settled:
    """Bring ``cloth`` to rest under ``load``, in place.

    A sheet in a shell, as moulded, sets out from the level shape over the liquid's volume, with
    gravity along its axis (``cloth.level``), which then turns to where the load has it; any other
    sets out from where it is. Implicit Euler steps that forget their velocity, with more
    bending damping, which does not move the equilibrium, are extrapolated until for five of them
    the ``residual``, the force left over rho b L^3 (``cloth.residual``; b the body force, L half
    the mesh's extent, the radius of a hemisphere), is within ``tolerance``.
    A wrinkled or slack sheet has many equilibria; the one found depends on the path. Where none is
    found, in ``steps_max`` steps or for ``PATIENCE`` of them, the sheet goes back to where it was
    nearest to rest, by the larger of that force and of the rms way of a step over L.
    """
    if cloth.held:
        return Settled(steps=0, residual=0.0, converged=True)
    model = cloth.model
    swing = math.sqrt(load.density * model.size**2 / pressure_scale(load, model.size))
    dt = PSEUDO_STEP * swing
    # A fixed number: pseudo-steps that stop early stop short of the equilibrium.
    seeking = replace(
        cloth.settings,
        bending_damping=max(BENDING_DAMPING * swing, cloth.settings.bending_damping),
        stretch_damping=0.0,
        shell_friction=0.0,
        self_friction=0.0,
        tolerance=0.0,
        iterations=iterations,
    )
    cloth.halt()
    moulded = np.array_equal(cloth.state.position, cloth.reference)
    if len(model.shell.profile) and load.volume is not None and moulded:
        _place(cloth, level_shape(model, load.volume))
        for body_force in _turns(load.body_force):
            part = _Turned(
                density=load.density, body_force=body_force, volume=load.volume, datum=None
            )
            _pseudo_step(cloth, dt, part, replace(seeking, iterations=TURNED))
    momentum, left, quiet = _Momentum(), np.inf, 0
    old = cloth.save()
    least, best, best_left, since = np.inf, old, np.inf, 0
    for step in range(1, steps_max + 1):
        start = cloth.state.position
        new = _pseudo_step(cloth, dt, load, seeking)
        left = residual(model, load, new["position"], float(new["datum"][0]), new["contact_force"])
        quiet = quiet + 1 if left <= tolerance else 0
        unrest = max(left, _rms(new["position"] - start) / model.size)
        if unrest < least:
            since = step if unrest < 0.9 * least else since
            least, best, best_left = unrest, new, left
        if quiet >= QUIET_STEPS:
            log.info("settled after %d steps: the force left is %.1e of rho g R^3", step, left)
            return Settled(steps=step, residual=left, converged=True)
        if step - since >= PATIENCE:
            break
        if step < steps_max:
            moved, motion = new["position"] - start, new["position"] - old["position"]
            cloth.restore(_extrapolated(cloth, new, old, momentum.factor(moved, motion)))
        old = new
    log.warning(
        "not settled after %d steps: the force left is %.1e of rho g R^3, tolerance %.1e",
        step,
        best_left,
        tolerance,
    )
    cloth.restore(best)
    return Settled(steps=step, residual=best_left, converged=False)


def _rms(ways: Array) -> float:
    """Root mean square length [m] of ``ways`` (n, 3) [m]."""
    return float(np.sqrt(np.mean(np.sum(ways**2, axis=1))))


def _place(cloth: Cloth, position: Array) -> None:
    """At rest at ``position`` (n, 3) [m], without tension or contact."""
    state = cloth.save()
    state["position"] = state["previous_position"] = position
    for name in ("tension", "contact_force"):
        state[name] = np.zeros_like(state[name])
    state["volume"] = np.array([cloth.model.volume(position)])
    cloth.restore(state)
    cloth.halt()


def _turns(body_force: Array) -> Iterator[Array]:
    """Body forces (3,) [m/s^2] on the way from -z to ``body_force``, that one left out."""
    size = float(np.linalg.norm(body_force))
    angle = math.acos(max(-1.0, min(1.0, -float(body_force[2]) / size)))
    side = body_force * np.array([1.0, 1.0, 0.0])
    length = float(np.linalg.norm(side))
    side = side / length if length > 1e-9 * size else np.array([1.0, 0.0, 0.0])
    count = math.ceil(TURNING * angle / (0.5 * math.pi))
    for step in range(1, count):
        turned = angle * step / count
        yield size * (math.sin(turned) * side - math.cos(turned) * np.array([0.0, 0.0, 1.0]))
