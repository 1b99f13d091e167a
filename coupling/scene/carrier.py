"""What carries the tank: the section ``[carrier]`` of a scene."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from coupling.scene.choices import AUTO, fluid_models, keeps_volume, motion_kind
from coupling.scene.force_table import ForceTable, read_force_table
from coupling.scene.motion_table import MotionTable
from coupling.scene.sections import OptionalVector, Section, Vector
from coupling.scene.tables.text import TableError

if TYPE_CHECKING:
    from coupling.scene.scene import Scene

_ROTATION = ("rotational_springs", "rotational_dampers")  # read with an inertia only


class Carrier(Section):
    """What carries the tank.

    ``prescribed``: it moves as ``[motion]`` says. ``free``: it moves as it is pushed, by its
    contents, by springs and dampers from the ground, which moves as ``[motion]`` says, and by the
    forces of a table. With an ``inertia`` it turns likewise. It starts at rest in equilibrium: what
    holds it up there, at its origin, stays as it is, so that along an axis without a spring it is
    as if weightless.
    """

    kind: Literal["prescribed", "free"] = Field(
        default="prescribed", description='kind of carrier: "prescribed" or "free"'
    )
    mass: float | None = Field(
        default=None, gt=0, description="mass of a free tank without liquid and diaphragm [kg]"
    )
    springs: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="springs of a free tank to the ground along x, y, z [N/m]",
    )
    dampers: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="dampers of a free tank to the ground along x, y, z [N s/m]",
    )
    inertia: OptionalVector = Field(
        default=None,
        description="moments of inertia of a free tank without liquid and diaphragm about its own "
        "x, y, z through its origin, where its centre of mass is [kg m^2]; without, it is held "
        "against turning",
    )
    rotational_springs: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="springs of a free tank against turning about x, y, z [N m/rad]",
    )
    rotational_dampers: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="dampers of a free tank against turning about x, y, z [N m s/rad]",
    )
    force_file: str | None = Field(
        default=None,
        description="CSV file with columns time, fx, fy, fz and, of a tank that turns, mx, my, mz "
        "(s, N, N m, or as its header says): forces at a free tank's origin, and moments, linear "
        "in between",
    )

    @property
    def free(self) -> bool:
        """Whether the tank moves as it is pushed."""
        return self.kind == "free"

    @cached_property
    def _table(self) -> ForceTable | None:
        return None if self.force_file is None else read_force_table(Path(self.force_file))

    @property
    def forces(self) -> MotionTable | None:
        """The table's forces [N] in place of accelerations, read once. Raises ``TableError``."""
        return None if self._table is None else self._table.forces

    @property
    def moments(self) -> MotionTable | None:
        """Its moments [N m] likewise, None where it has none."""
        return None if self._table is None else self._table.moments

    def problems(self, end: float) -> list[str]:
        """One line ``key: what is wrong. Mend.`` each, of a run to ``end`` [s]."""
        if not self.free:
            default = type(self)()
            return [
                f'carrier.{key}: is read with carrier.kind = "free" only, got kind = '
                f'"{self.kind}". Set carrier.kind = "free", or leave {key} out.'
                for key in type(self).model_fields
                if getattr(self, key) != getattr(default, key)
            ]
        problems = []
        if self.mass is None:
            problems.append(
                'carrier.mass: is required for kind = "free". '
                f"Give the {type(self).model_fields['mass'].description}."
            )
        for key in ("springs", "dampers", *_ROTATION):
            if min(getattr(self, key)) < 0.0:
                problems.append(
                    f"carrier.{key}: must not be negative, got {list(getattr(self, key))}. "
                    f"Give the {type(self).model_fields[key].description}."
                )
        return [*problems, *self._inertia_problems(), *self._force_problems(end)]

    def _inertia_problems(self) -> list[str]:
        if self.inertia is None:
            default = type(self)()
            return [
                f"carrier.{key}: is read with a carrier.inertia only, got none. Give the "
                f"{type(self).model_fields['inertia'].description}; or leave {key} out."
                for key in _ROTATION
                if getattr(self, key) != getattr(default, key)
            ]
        largest, total = max(self.inertia), sum(self.inertia)
        if min(self.inertia) <= 0.0 or largest > (total - largest) * (1.0 + 1e-9):
            return [
                "carrier.inertia: must be above 0, none above the sum of the two others, got "
                f"{list(self.inertia)}: no body has these. Give the principal moments of the tank."
            ]
        return []

    def _force_problems(self, end: float) -> list[str]:
        try:
            table = self.forces
        except TableError as error:
            return [f"carrier.force_file: {error}"]
        if table is None:
            return []
        if self.moments is not None and self.inertia is None:
            return [
                f"carrier.force_file: {self.force_file}: names moments, and the tank is held "
                "against turning. Give carrier.inertia, or leave the columns mx, my, mz out."
            ]
        first, last = float(table.time[0]), float(table.time[-1])
        if first > 0.0 or last < end * (1.0 - 1e-9):
            return [
                f"carrier.force_file: {self.force_file}: must cover 0 to {end:g} s, covers "
                f"{first:g} to {last:g} s. Shorten time.duration, or give a longer table that "
                "starts at 0."
            ]
        return []


def carrier_problems(scene: Scene) -> list[str]:
    """One line each, as ``Carrier.problems``; and the liquids that have no law of motion for it."""
    carrier, fluid, time = scene.carrier, scene.model.fluid, scene.time
    problems = carrier.problems(time.step * time.steps)
    if not carrier.free:
        return problems
    if motion_kind(scene.motion.kind).turns(scene.motion):
        problems.append(
            'carrier.kind: "free" takes a ground that does not turn, got a motion with rotation. '
            "Leave the rotation out of [motion]; a free tank turns by what pushes it, with "
            "carrier.inertia."
        )
    if scene.supply.drawn:
        problems.append(
            'carrier.kind: "free" takes a tank that keeps its mass, got a supply. Leave one of the '
            "two out."
        )
    if fluid != AUTO and keeps_volume(fluid):
        return problems
    names = " or ".join(f'"{name}"' for name in fluid_models() if keeps_volume(name))
    why = "which keeps no volume, and so no mass"
    if fluid == AUTO:
        why = "whose errors are those of a tank with a prescribed motion"
    return [*problems, f'carrier.kind: "free" needs model.fluid = {names}, got "{fluid}", {why}.']
