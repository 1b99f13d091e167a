"""The tank: which shape its shell has, and of which size."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Protocol

from pydantic import Field

from coupling.ports import Shell
from coupling.scene.choices import one_of, tank_shapes
from coupling.scene.sections import Section
from coupling.scene.shapes import SHAPES

if TYPE_CHECKING:
    from cloth.mould import Mould
    from cloth.shell.shell import Shell as ClothShell

    class TankShell(Shell, ClothShell, Protocol):
        """The shell as both sides of the interface ask of it, and the diaphragm's mould."""

        def upper_part(self) -> Mould:
            """The mould of a sheet that lies on the shell above the rim."""


class Tank(Section):
    """The rigid shell; the origin is the middle of the circle on which the rim is clamped."""

    radius: float = Field(gt=0, description="tank's inner radius [m]")
    shape: Annotated[str, one_of(tank_shapes)] = Field(
        default="sphere", description='the tank\'s shape: "sphere"'
    )

    @cached_property
    def shell(self) -> TankShell:
        """The shell as a surface."""
        return SHAPES[self.shape](self)

    @cached_property
    def mould(self) -> Mould:
        """The shape in which the diaphragm is moulded: the shell's above the rim."""
        return self.shell.upper_part()

    @property
    def volume(self) -> float:
        """Of the whole shell [m^3]."""
        return self.shell.volume
