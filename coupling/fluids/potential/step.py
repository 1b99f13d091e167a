"""One step of the diaphragm with an irrotational liquid: one system, no coupling iteration.

The liquid's inertia stands in the diaphragm's own inertia. What is iterated is the shape alone
that inertia belongs to, and only where the step moves the diaphragm far.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from cloth.kinematics import kinematics
from coupling.fluids.potential.liquid import PotentialLiquid
from coupling.fluids.potential.turning import TurnedHarmonics, in_tank
from coupling.fluids.potential.wall_layers import WallLayers
from coupling.fluids.sampled import liquid_metrics
from coupling.ports import (
    AnyArray,
    Array,
    HydrostaticLoad,
    IterativeStructure,
    LiquidSample,
    StepReport,
)
from coupling.step.stopwatch import Stopwatch

# Committed arrays: nodes now and a step ago, the potential likewise.
_NAMES = (
    "position", "velocity", "coefficient",
    "previous_position", "previous_velocity", "previous_coefficient", "previous_dt",
    "force", "energy", "removed", "layer_loss", "wall_power",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PotentialSettings:
    """Constants of the potential step.

    ``shape``: rms distance over R of a step's end from its shape above which it is taken again.
    ``gain``: share of kinetic energy and work together that time stepping may add in a step.
    ``most``: share of the kinetic energy that may be taken out after one.
    """

    shape: float = 0.01
    gain: float = 0.02
    most: float = 0.75


class PotentialStep:
    """Steps ``structure`` on ``liquid``, both in the liquid's shell.

    ``backward`` in time, as the structure: dphi/dt at fixed places is the same formula for the
    polynomial's coefficients. In a step's shape x* they follow from the nodes' velocities, c = A v,
    so that the force -A^T rho dc/dt = -M (v - v_anchor)/b - A^T rho (A v_anchor - c_anchor)/b has
    its first part in the solve; the kinetic part is that of the extrapolated potential. The drag
    of the boundary layers (``wall_layers``) is implicit likewise, but for the part of a sheet that
    slides along itself, which is that of the extrapolated velocities.

    Where the sheet snaps taut or slams, a step is too long for that, and may make energy. What the
    liquid gains beyond the sheet's work, and beyond ``settings.gain``, is taken out of its
    potential again.
    """

    solver: str | None = None
    halvable = True

    def __init__(
        self,
        structure: IterativeStructure,
        liquid: PotentialLiquid,
        *,
        settings: PotentialSettings | None = None,
    ) -> None:
        self.settings = settings or PotentialSettings()
        self.structure, self.liquid = structure, liquid
        self._turning = TurnedHarmonics(liquid.ritz.harmonics)
        self._watch = Stopwatch("structure", "fluid")
        self._shapes, self._residual = 0, 0.0
        self._samples: list[LiquidSample] = []  # of the parts since the last report
        state = structure.state
        none = np.zeros(len(liquid.ritz.harmonics.degrees))
        still = state.position, np.zeros_like(state.position), none
        rest = np.zeros(1), still[1], np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1)
        self._now: dict[str, Array] = dict(zip(_NAMES, (*still, *still, *rest), strict=True))
        self._next = self._now
        self._sample: LiquidSample | None = None  # of the last attempt

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step of ``dt`` [s]; whether the diaphragm converged. Raises ArithmeticError.

        A shape missed by more than ``settings.shape`` even the second time is no failure, since the
        first, extrapolated one is of second order; ``report`` says by how much.
        """
        try:
            self._solve(dt, load)
        except ArithmeticError:
            self._forget()
            raise
        if not self.structure.converged:
            self._forget()
        return self.structure.converged

    def _solve(self, dt: float, load: HydrostaticLoad) -> None:
        turn, was = load.turn, self._now
        now = was if turn is None else self._turning.history(was, turn)
        previous = float(now["previous_dt"][0])
        nodes = kinematics(
            dt, previous, now["position"], now["velocity"],
            now["previous_position"], now["previous_velocity"],
        )  # fmt: skip
        c, before = now["coefficient"], now["previous_coefficient"]
        anchor = kinematics(dt, previous, c, c, before, before).position_anchor
        ahead = dt / previous if previous > 0.0 else 0.0
        expected = c + (c - before) * ahead
        moving = now["velocity"] + (now["velocity"] - now["previous_velocity"]) * ahead
        points = self.liquid.shell.confine(now["position"] + dt * now["velocity"])
        for last in (False, True):
            with self._watch.timed("fluid"):
                shape = self.liquid.at(points)
                layers = self.liquid.layers(points, shape)
                along = in_tank(moving, points, turn)
                rows, carried = layers.rows(nodes.b), layers.carried(along)
                known = (shape.potential(nodes.velocity_anchor, turn) - anchor) / nodes.b
                known += layers.rate(nodes.velocity_anchor, turn) - carried
                drag = layers.force(expected, along)
                force = shape.force(shape.pressure(known, expected)) + drag
            with self._watch.timed("structure"):
                with_walls = self._with_walls(load, layers, nodes.b, known, expected)
                self.structure.begin_step(dt, with_walls, rows)
                end = self.structure.solve(force)
            self._shapes += 1
            missed = np.mean(np.sum((end - points) ** 2, axis=1))
            self._residual = float(np.sqrt(missed)) / self.liquid.shell.size
            if last or self._residual <= self.settings.shape:
                break
            points = end
        with self._watch.timed("fluid"):
            velocity = nodes.velocity(end)
            along = in_tank(velocity, end, turn)
            coefficient = shape.potential(velocity, turn)
            rate = (coefficient - anchor) / nodes.b + layers.rate(velocity, turn) - carried
            force = shape.force(shape.pressure(rate, expected)) + drag
            work = 0.5 * float(np.vdot(force + now["force"], end - now["position"]))  # on the sheet
            on_walls = self.liquid.wall_power(rate, expected, turn)
            work += 0.5 * dt * (on_walls + float(now["wall_power"][0]))
            energy = shape.kinetic_energy(velocity, turn)
            lost = dt * layers.power(coefficient, along)
            gain = energy + work + lost - float(now["energy"][0])
            excess = max(gain - self.settings.gain * (energy + abs(work)), 0.0)
            excess = min(excess, self.settings.most * energy)
            kept = math.sqrt(1.0 - excess / energy) if excess > 0.0 else 1.0
            self._sample = self.liquid.sample(
                end, shape, rate, coefficient,
                work=work, energy=energy, slip=layers.slip(coefficient, along),
            )  # fmt: skip
            self._next = {
                "position": end, "velocity": velocity, "coefficient": kept * coefficient,
                "previous_position": was["position"], "previous_velocity": was["velocity"],
                "previous_coefficient": was["coefficient"], "previous_dt": np.array([dt]),
                "force": force, "energy": np.array([energy]), "removed": now["removed"] + excess,
                "layer_loss": now["layer_loss"] + lost, "wall_power": np.array([on_walls]),
            }  # fmt: skip

    def _with_walls(
        self, load: HydrostaticLoad, layers: WallLayers, b: float, known: Array, expected: Array
    ) -> HydrostaticLoad:
        """``load`` with what a shell that is free to turn has to do with the liquid."""
        if load.recoil is None or load.recoil.rotor is None:
            return load
        rotor, on_walls = load.recoil.rotor, self.liquid.wall_moment(known, expected)
        rotor = replace(rotor, torque=rotor.torque + on_walls, walls=layers.walls(b))
        return replace(load, recoil=replace(load.recoil, rotor=rotor))

    def _forget(self) -> None:
        """Take the potentials of the history in the present shape, before a shorter attempt.

        They are of shapes that were extrapolated; over a short step the difference is a blow.
        """
        shape = self.liquid.at(self._now["position"])
        for name in ("", "previous_"):
            self._now[f"{name}coefficient"] = shape.potential(self._now[f"{name}velocity"])

    def start(self) -> None:
        """Nothing is left to do: the liquid is at rest."""

    def accept(self) -> None:
        """Commit the last attempt."""
        assert self._sample is not None, "attempt comes first"
        self.structure.accept_step()
        self._now = self._next
        self._samples.append(self._sample)

    def report(self) -> StepReport:
        """Its iterations are the shapes tried.

        The residual is the rms distance over R of the last step's end from its shape.
        """
        shapes, self._shapes = self._shapes, 0
        samples, self._samples = tuple(self._samples), []
        return StepReport(
            iterations=shapes, residual=self._residual, converged=True, samples=samples
        )

    def seconds(self) -> dict[str, float]:
        """Wall time since this was last asked, by part."""
        return self._watch.taken()

    def metrics(self, sample: LiquidSample | None) -> dict[str, float]:
        """The liquid's scalars, and two energies [J] since the start.

        What time stepping made and was removed, and what the boundary layers took.
        """
        sums = {"energy_removed": "removed", "dissipated_by_layers": "layer_loss"}
        return liquid_metrics(sample) | {key: float(self._now[n][0]) for key, n in sums.items()}

    def to_nodes(self, values: Array) -> Array:
        """Values on the diaphragm's triangles (m, k), averaged to its nodes (n, k)."""
        return self.liquid.to_nodes(self.structure.state.position, values)

    def write_fields(self) -> None:
        """There are none: the polynomial's coefficients stand in the checkpoint."""

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Everything ``restore`` needs."""
        return {"coupled": dict(self._now)}

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]]) -> None:
        """The reverse of ``save``."""
        self._now = {name: saved["coupled"][name] for name in _NAMES}

    def close(self) -> int | None:
        """No solver runs."""
        return None
