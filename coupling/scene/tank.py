"""The tank: which shape its shell has, and of which size."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Protocol

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from cloth.mould import Mould
from cloth.shell.shell import Shell as ClothShell
from cloth.shell.sphere import Sphere
from coupling.ports import Shell
from coupling.scene.sections import Section


class TankShell(Shell, ClothShell, Protocol):
    """The shell as both sides of the interface ask of it, and the diaphragm's mould."""

    def upper_part(self) -> Mould:
        """The mould of a sheet that lies on the shell above the rim."""


# Shapes by name; each takes the section. A new one is a file of ``cloth.shell`` and a line here.
SHAPES: dict[str, Callable[[Tank], TankShell]] = {
    "sphere": lambda tank: Sphere(tank.radius),
}


class Tank(Section):
    """The rigid shell, the diaphragm's rim about the origin of the tank frame."""

    radius: float = Field(gt=0, description="tank's inner radius [m]")
    shape: str = Field(default="sphere", description='the tank\'s shape: "sphere"')

    @field_validator("shape", mode="after")
    @classmethod
    def _is_known(cls, value: str) -> str:
        if value not in SHAPES:
            names = " or ".join(f'"{name}"' for name in SHAPES)
            raise PydanticCustomError("unknown_shape", "must be {names}", {"names": names})
        return value

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
