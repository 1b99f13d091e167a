"""What carries the tank: the section ``[carrier]`` of a scene, and its table of forces."""

from __future__ import annotations

from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from coupling.scene.choices import AUTO, fluid_models, keeps_volume, motion_kind
from coupling.scene.motion_file import COLUMNS as MOTION_COLUMNS
from coupling.scene.motion_file import increasing
from coupling.scene.motion_table import MotionTable
from coupling.scene.sections import Section, Vector
from coupling.scene.tables.columns import FORCE, Column
from coupling.scene.tables.file import table_of
from coupling.scene.tables.text import TableError, read_content

if TYPE_CHECKING:
    from coupling.scene.scene import Scene

COLUMNS = (
    MOTION_COLUMNS[0],
    *(
        Column(name=f"f{axis}", pattern=rf"(f|force|kraft){axis}", unit="N", units=FORCE)
        for axis in "xyz"
    ),
)


class Carrier(Section):
    """What carries the tank.

    ``prescribed``: it moves as ``[motion]`` says. ``free``: it moves as it is pushed, by its
    contents, by springs and dampers from the ground, which moves as ``[motion]`` says, and by the
    forces of a table. It does not turn. It starts at rest in equilibrium: what holds it up there
    stays as it is, so that along an axis without a spring it is as if weightless.
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
    force_file: str | None = Field(
        default=None,
        description="CSV file with columns time, fx, fy, fz (s, N, or as its header says): forces "
        "on a free tank, linear in between",
    )

    @property
    def free(self) -> bool:
        """Whether the tank moves as it is pushed."""
        return self.kind == "free"

    @cached_property
    def forces(self) -> MotionTable | None:
        """The table's forces [N] in place of accelerations, read once. Raises ``TableError``."""
        return None if self.force_file is None else read_force_table(Path(self.force_file))

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
        for key in ("springs", "dampers"):
            if min(getattr(self, key)) < 0.0:
                problems.append(
                    f"carrier.{key}: must not be negative, got {list(getattr(self, key))}. "
                    f"Give the {type(self).model_fields[key].description}."
                )
        return [*problems, *self._force_problems(end)]

    def _force_problems(self, end: float) -> list[str]:
        try:
            table = self.forces
        except TableError as error:
            return [f"carrier.force_file: {error}"]
        if table is None:
            return []
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
            "Leave the rotation out: a free tank is held against turning."
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


def read_force_table(path: Path) -> MotionTable:
    """Forces [N] in place of accelerations, of a table laid out as ``table_of`` says.

    A force is to its impulse what an acceleration is to a velocity, so one table serves both.
    Raises ``TableError`` as that, and for times that do not increase.
    """
    return _read(path, read_content(path))


@lru_cache(maxsize=2)  # a study asks for the same table again and again
def _read(path: Path, data: bytes) -> MotionTable:
    table = table_of(path, data, COLUMNS)
    return MotionTable(time=increasing(table), acceleration=table.values[:, 1:])
