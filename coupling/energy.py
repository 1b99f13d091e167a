"""Where the energy of a run goes: summed over every step, not only those that are written out.

In the tank's frame the tank's acceleration a is a body force -a, on liquid and sheet alike. With
p* left to the flow, the liquid's pressure does on the sheet the work p0 dV + rho b . d(V c), c the
liquid's centre of gravity, exactly. So

    d(kinetic + gravity + bending + stretch) = -a . d(m c + sum m_i x_i) + p0 dV - dissipated

holds for liquid and sheet together whatever they do to each other, and the flow's share of what is
dissipated is -(work of p* on the sheet) - d(kinetic energy of the liquid). Works are integrated by
the trapezoidal rule: where nothing dissipates, what is found is the time step's error, of second
order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from cloth.energy import SheetEnergy
from coupling.ports import Array, DiaphragmState, HydrostaticLoad, LiquidSample
from coupling.scene import Scene
from coupling.structure import Diaphragm, liquid_cg


@dataclass(frozen=True, kw_only=True)
class Instant:
    """What the balance needs to know of an instant.

    ``acceleration`` (3,) [m/s^2] of the tank; ``moment`` (2, 3) [kg m], mass times place of liquid
    and sheet; ``volume`` [m^3] and ``datum`` [Pa] of the liquid; energies [J] ``liquid_kinetic``,
    ``sheet_kinetic``, ``bending``, ``stretch``; powers [W] that are taken from the sheet by
    ``bending_damping`` and ``drag``, means over the step that ends here, and ``layer``, what
    laminar boundary layers would take.
    """

    acceleration: Array
    moment: Array
    volume: float
    datum: float
    liquid_kinetic: float
    sheet_kinetic: float
    bending: float
    stretch: float
    bending_damping: float
    drag: float
    layer: float


_SUMS = ("tank_work", "datum_work", "pressure_work", "bending_damping", "drag", "layer")


class EnergyBalance:
    """Energies and works since the start, in a field of ``gravity`` (3,) [m/s^2]."""

    def __init__(self, gravity: Array) -> None:
        self.gravity = gravity
        self._sums = dict.fromkeys(_SUMS, 0.0)

    def start(self, instant: Instant) -> None:
        """Count from here."""
        self._first = self._now = instant

    def add(self, dt: float, instant: Instant, pressure_work: float) -> None:
        """A step of ``dt`` [s] up to ``instant``, with ``pressure_work`` [J] of p* on the sheet."""
        before, self._now, sums = self._now, instant, self._sums
        sums["pressure_work"] += pressure_work
        moved = (instant.moment - before.moment).sum(axis=0)
        sums["tank_work"] -= 0.5 * float((before.acceleration + instant.acceleration) @ moved)
        swept = instant.volume - before.volume
        sums["datum_work"] += 0.5 * (before.datum + instant.datum) * swept
        sums["layer"] += 0.5 * dt * (before.layer + instant.layer)
        for name in ("bending_damping", "drag"):  # means over the step already
            sums[name] += dt * getattr(instant, name)

    def metrics(self) -> dict[str, float]:
        """Energies [J] by name: what is stored, above the start, and what went in and out since.

        ``mechanical_energy`` is all that is stored, ``kinetic_energy`` of the liquid apart, which
        the flow tells. ``dissipated`` closes the balance; ``dissipated_by_liquid`` is the flow's
        share, ``dissipated_by_bending`` and ``dissipated_by_drag`` what the sheet's damping takes.
        What is left of ``dissipated`` is lost where the sheet snaps taut, meets the shell or itself
        and comes to rest against it, and in the time stepping. ``layer_estimate`` is an estimate
        beside the balance, see ``layer_factor``.
        """
        first, now, sums = self._first, self._now, self._sums
        lifted = -(now.moment - first.moment) @ self.gravity
        stored = {
            "liquid_potential_energy": float(lifted[0]),
            "sheet_potential_energy": float(lifted[1]),
            "sheet_kinetic_energy": now.sheet_kinetic,
            "bending_energy": now.bending - first.bending,
            "stretch_energy": now.stretch - first.stretch,
        }
        mechanical = sum(stored.values()) + now.liquid_kinetic
        mechanical -= first.sheet_kinetic + first.liquid_kinetic
        work = sums["tank_work"] + sums["datum_work"]
        flowed = first.liquid_kinetic - now.liquid_kinetic - sums["pressure_work"]
        return stored | {
            "mechanical_energy": mechanical,
            "tank_work": sums["tank_work"],
            "datum_work": sums["datum_work"],
            "pressure_work": sums["pressure_work"],
            "dissipated": work - mechanical,
            "dissipated_by_liquid": flowed,
            "dissipated_by_bending": sums["bending_damping"],
            "dissipated_by_drag": sums["drag"],
            "layer_estimate": sums["layer"],
        }

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""
        saved = {"sums": np.array([self._sums[name] for name in _SUMS])}
        for part, instant in (("first", self._first), ("now", self._now)):
            saved |= {f"{part}.{f.name}": np.array(getattr(instant, f.name)) for f in _FIELDS}
        return saved

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._sums = dict(zip(_SUMS, saved["sums"].tolist(), strict=True))
        self._first, self._now = (
            Instant(**{f.name: _value(saved[f"{part}.{f.name}"]) for f in _FIELDS})
            for part in ("first", "now")
        )


_FIELDS = fields(Instant)


def _value(array: Array) -> Any:
    return array if array.ndim else float(array)


def instant_of(
    cloth: Diaphragm,
    state: DiaphragmState,
    load: HydrostaticLoad,
    liquid: LiquidSample | None,
    scene: Scene,
) -> Instant:
    """The instant of a ``cloth`` in ``state`` under ``load``, with a ``liquid`` that flows."""
    energy: SheetEnergy = cloth.energy()
    cg = liquid_cg(state.position, cloth.triangles, scene.tank.radius, state.volume)
    return Instant(
        acceleration=np.array(scene.gravity) - load.body_force,
        moment=np.array([load.density * state.volume * cg, cloth.mass @ state.position]),
        volume=state.volume,
        datum=state.datum_pressure,
        liquid_kinetic=0.0 if liquid is None else liquid.kinetic_energy,
        sheet_kinetic=energy.kinetic,
        bending=energy.bending,
        stretch=energy.stretch,
        bending_damping=energy.bending_damping,
        drag=energy.drag,
        layer=0.0 if liquid is None else layer_factor(scene) * liquid.wall_slip,
    )


def layer_factor(scene: Scene) -> float:
    """rho sqrt(pi f nu) [kg/(m^2 s)], times int u^2 dS the power that wall layers dissipate.

    Stokes's laminar layer beside an oscillating flow, of the thickness sqrt(nu/(pi f)) (Landau and
    Lifshitz, Fluid Mechanics, section 24): rho u^2 sqrt(omega nu/2)/2 per area of a speed u cos
    omega t, which is this factor times the mean square. Turbulent or separated layers take more.
    0 where the motion has no single frequency.
    """
    motion, liquid = scene.motion, scene.liquid
    if motion.kind != "sine" or not motion.frequency:
        return 0.0
    return liquid.density * math.sqrt(math.pi * motion.frequency * liquid.viscosity)
