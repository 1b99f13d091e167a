"""Where the energy of a run goes: summed over every step, not only those that are written out.

In the tank's frame the tank's acceleration a is a body force -a, on liquid and sheet alike. With
p* left to the flow, the liquid's pressure does on the sheet the work p0 dV + rho b . d(V c), c the
liquid's centre of gravity, exactly. So

    d(kinetic + gravity + bending + stretch) = -a . d(m c + sum m_i x_i) + p0 dV - dissipated

holds for liquid and sheet together whatever they do to each other, and the flow's share of what is
dissipated is -(work of p* on the sheet) - d(kinetic energy of the liquid). Works are integrated by
the trapezoidal rule, a record's by its mean acceleration over each step: where nothing dissipates,
what is found is the time step's error, of second order.

A tank that turns adds its torque's work (``turning_work``). All is in axes that do not turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from cloth.energy import SheetEnergy, SheetLosses
from coupling.fluids.potential.wall_layers import layer_speed
from coupling.interface.liquid_shape import liquid_cg
from coupling.ports import Array, DiaphragmState, HydrostaticLoad, LiquidSample, RunFailed
from coupling.scene.scene import Scene
from coupling.simulation.turning_work import turning_at, work_of_turning
from coupling.structure.diaphragm import Diaphragm


@dataclass(frozen=True, kw_only=True)
class Instant:
    """What the sums need to know of an instant.

    ``acceleration`` (3,) [m/s^2] of the tank, which works over the step that ends here (a motion's
    ``working_acceleration``); ``moment`` (2, 3) [kg m], mass times place of liquid
    and sheet; ``volume`` [m^3] and ``datum`` [Pa] of the liquid; powers [W] that the sheet loses
    by ``bending_damping``, ``drag``, the rubber's ``stretch``, ``shell_friction`` and
    ``self_friction``, means over the step that ends here, and ``layer``, what laminar boundary
    layers would take. Of a tank that turns its ``rate`` (3,) [rad/s], the sheet's angular momentum
    ``spin`` (3,) [kg m^2/s], and the ``torque`` (3,) [N m] of liquid and weight on shell and sheet,
    about the origin. All vectors in axes that do not turn.
    """

    acceleration: Array
    moment: Array
    volume: float
    datum: float
    bending_damping: float = 0.0
    drag: float = 0.0
    stretch: float = 0.0
    shell_friction: float = 0.0
    self_friction: float = 0.0
    layer: float = 0.0
    rate: Array = field(default_factory=lambda: np.zeros(3))
    spin: Array = field(default_factory=lambda: np.zeros(3))
    torque: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True, kw_only=True)
class Stored:
    """Energies [J] of an instant: of the ``flow``, and of the sheet."""

    flow: float
    sheet: SheetEnergy

    @property
    def inner(self) -> float:
        """All energies but that of gravity [J]."""
        return self.flow + self.sheet.kinetic + self.sheet.bending + self.sheet.stretch


# Of an instant: means over the step before.
_LOSSES = ("bending_damping", "drag", "stretch", "shell_friction", "self_friction")
_SUMS = ("tank_work", "datum_work", "pressure_work", *_LOSSES, "layer")


@dataclass(frozen=True, kw_only=True)
class Start:
    """Where the sums set out: the ``moment`` (2, 3) [kg m], and what was ``stored``."""

    moment: Array
    stored: Stored


class EnergyBalance:
    """Energies and works since the start, in a field of ``gravity`` (3,) [m/s^2]."""

    def __init__(self, gravity: Array) -> None:
        self.gravity = gravity
        self._sums = dict.fromkeys(_SUMS, 0.0)
        self._start: Start | None = None
        self._now: Instant | None = None

    def start(self, instant: Instant, stored: Stored) -> None:
        """Count from here."""
        self._now = instant
        self._start = Start(moment=instant.moment, stored=stored)

    def _known(self) -> tuple[Start, Instant]:
        """The start, and the last instant. Raises RuntimeError before the first."""
        if self._start is None or self._now is None:
            raise RuntimeError("energy balance: start or restore comes first.")
        return self._start, self._now

    def add(self, dt: float, instant: Instant, pressure_work: float) -> None:
        """A step of ``dt`` [s] up to ``instant``, with ``pressure_work`` [J] of p* on the sheet."""
        before, sums = self._known()[1], self._sums
        self._now = instant
        sums["pressure_work"] += pressure_work
        moved = (instant.moment - before.moment).sum(axis=0)
        sums["tank_work"] -= float(instant.acceleration @ moved)
        sums["tank_work"] += work_of_turning(dt, before, instant)
        swept = instant.volume - before.volume
        sums["datum_work"] += 0.5 * (before.datum + instant.datum) * swept
        sums["layer"] += 0.5 * dt * (before.layer + instant.layer)
        for name in _LOSSES:
            sums[name] += dt * getattr(instant, name)

    def metrics(self, stored: Stored) -> dict[str, float]:
        """Energies [J] by name: what is ``stored`` now, above the start; what came and went since.

        ``mechanical_energy`` is all that is stored. ``dissipated`` closes the balance;
        ``dissipated_by_liquid`` is the flow's share, ``dissipated_by_bending`` and
        ``dissipated_by_drag`` what the sheet's regularisations take, ``dissipated_by_stretch``
        what its rubber loses, ``dissipated_by_shell_friction`` and ``dissipated_by_self_friction``
        what it loses as it slides. What is left of it is lost where the sheet snaps taut, meets the
        shell or itself and comes to rest against it, and in the time stepping. ``layer_estimate``
        is an estimate beside the balance, see ``layer_factor``.
        """
        (start, now), sheet, sums = self._known(), stored.sheet, self._sums
        first = start.stored
        lifted = -(now.moment - start.moment) @ self.gravity
        mechanical = float(lifted.sum()) + stored.inner - first.inner
        return {
            "liquid_potential_energy": float(lifted[0]),
            "sheet_potential_energy": float(lifted[1]),
            "sheet_kinetic_energy": sheet.kinetic,
            "bending_energy": sheet.bending - first.sheet.bending,
            "stretch_energy": sheet.stretch - first.sheet.stretch,
            "mechanical_energy": mechanical,
            "tank_work": sums["tank_work"],
            "datum_work": sums["datum_work"],
            "pressure_work": sums["pressure_work"],
            "dissipated": sums["tank_work"] + sums["datum_work"] - mechanical,
            "dissipated_by_liquid": first.flow - stored.flow - sums["pressure_work"],
            "dissipated_by_bending": sums["bending_damping"],
            "dissipated_by_drag": sums["drag"],
            "dissipated_by_stretch": sums["stretch"],
            "dissipated_by_shell_friction": sums["shell_friction"],
            "dissipated_by_self_friction": sums["self_friction"],
            "layer_estimate": sums["layer"],
        }

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""
        start, now = self._known()
        first = start.stored
        sheet = [getattr(first.sheet, f.name) for f in fields(SheetEnergy)]
        return {
            "sums": np.array([self._sums[name] for name in _SUMS]),
            "first_moment": start.moment,
            "first_stored": np.array([first.flow, *sheet]),
        } | {f.name: np.array(getattr(now, f.name)) for f in fields(Instant)}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``. Raises ``RunFailed`` for what an older version has saved."""
        if len(saved.get("sums", ())) != len(_SUMS) or "torque" not in saved:
            raise RunFailed(
                "checkpoint.h5 holds no such energy balance: an older version wrote it. Run the "
                "scene again with this one."
            )
        self._sums = dict(zip(_SUMS, saved["sums"].tolist(), strict=True))
        flow, *sheet = saved["first_stored"].tolist()
        names = [f.name for f in fields(SheetEnergy)]
        energy = SheetEnergy(**dict(zip(names, sheet, strict=True)))
        stored = Stored(flow=flow, sheet=energy)
        self._start = Start(moment=saved["first_moment"], stored=stored)
        self._now = Instant(**{f.name: _value(saved[f.name]) for f in fields(Instant)})


def _value(array: Array) -> Any:
    return array if array.ndim else float(array)


def instant_of(
    cloth: Diaphragm,
    state: DiaphragmState,
    liquid: LiquidSample | None,
    scene: Scene,
    losses: SheetLosses,
    *,
    acceleration: Array,
    load: HydrostaticLoad,
    turned: tuple[Array, Array] | None,
) -> Instant:
    """The instant of a ``cloth`` in ``state``, with a ``liquid`` that flows.

    ``losses``: the cloth's, means over the step that ends here; ``acceleration`` (3,) [m/s^2] of
    the tank, as ``Instant`` has it; ``load`` of that step; ``turned``: attitude (3, 3) of a tank
    that turns and its rate (3,) [rad/s] in its own axes, None of any other.
    """
    cg = liquid_cg(state.position, cloth.triangles, scene.tank.shell, state.volume)
    moment = np.array([scene.liquid.density * state.volume * cg, cloth.mass @ state.position])
    turning: dict[str, Array] = {}
    if turned is not None:
        moment = moment @ turned[0].T
        turning = turning_at(cloth, state, liquid, load, moment, turned)
    return Instant(
        acceleration=acceleration,
        moment=moment,
        **turning,
        volume=state.volume,
        datum=state.datum_pressure,
        bending_damping=losses.bending,
        drag=losses.drag,
        stretch=losses.stretch,
        shell_friction=losses.shell_friction,
        self_friction=losses.self_friction,
        layer=0.0 if liquid is None else layer_factor(scene) * liquid.wall_slip,
    )


def stored_in(cloth: Diaphragm, liquid: LiquidSample | None) -> Stored:
    """Return the energies of a ``cloth``, and of a ``liquid`` that flows or None."""
    return Stored(flow=0.0 if liquid is None else liquid.kinetic_energy, sheet=cloth.energy())


def layer_factor(scene: Scene) -> float:
    """Return rho sqrt(pi f nu) [kg/(m^2 s)]: times int u^2 dS it is the power lost in wall layers.

    Stokes's laminar layer beside an oscillating flow, of the thickness sqrt(nu/(pi f)) (Landau and
    Lifshitz, Fluid Mechanics, section 24): rho u^2 sqrt(omega nu/2)/2 per area of a speed u cos
    omega t, which is this factor times the mean square. Turbulent or separated layers take more.
    0 where the motion has no single frequency.
    """
    liquid = scene.liquid
    if scene.frequency is None:
        return 0.0
    return liquid.density * layer_speed(liquid.viscosity, scene.frequency)
