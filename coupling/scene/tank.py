"""The tank: which shape its shell has, and of which size."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Protocol, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from coupling.ports import Shell
from coupling.scene.choices import one_of, tank_shapes
from coupling.scene.sections import Section
from coupling.scene.shapes import SHAPES

if TYPE_CHECKING:
    from cloth.mould import Mould as Mould
    from cloth.shell.shell import Shell as ClothShell

    class TankShell(Shell, ClothShell, Protocol):
        """The shell as both sides of the interface ask of it, and the diaphragm's moulds."""

        def upper_part(self) -> Mould:
            """The mould of a sheet that lies on the shell above the rim."""

        def lower_part(self) -> Mould:
            """The mould of a sheet that lies on the shell below the rim."""


_OF_ALL = ("shape", "clamp_height")  # keys that every shape takes


class Tank(Section):
    """The rigid shell; the origin is the middle of the circle on which the rim is clamped.

    A closed surface of revolution about z. ``sphere``: of ``radius``. ``pill``: a cylinder of
    ``radius`` and ``cylinder_length`` between two half spheres. ``ellipsoid``: of ``radius`` across
    and ``semi_axis`` along z. ``profile``: by points of its meridian in a CSV file. The rim is
    clamped ``clamp_height`` above the shell's middle, of a profile above the file's z = 0.
    """

    radius: float | None = Field(default=None, gt=0, description="tank's inner radius [m]")
    shape: Annotated[str, one_of(tank_shapes)] = Field(
        default="sphere",
        description='the tank\'s shape: "sphere", "pill", "ellipsoid" or "profile"',
    )
    cylinder_length: float | None = Field(
        default=None, ge=0, description="length of a pill's cylindrical part [m]"
    )
    semi_axis: float | None = Field(
        default=None, gt=0, description="half the height of an ellipsoid, along z [m]"
    )
    profile: str | None = Field(
        default=None,
        description="CSV file with columns r, z (m, or as its header says): points of the shell's "
        "meridian from pole to pole",
    )
    clamp_height: float = Field(
        default=0.0,
        description="height of the circle on which the rim is clamped above the shell's middle, "
        "of a profile above its z = 0 [m]",
    )

    @model_validator(mode="after")
    def _check_shape(self) -> Self:
        problems = self._wrong_keys()
        if not problems:
            try:
                _ = self.shell
            except ValueError as error:
                text = str(error)
                problems = [text if text.startswith("tank.") else f"tank.profile: {text}"]
        if problems:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": "\n".join(problems)}
            )
        return self

    def _wrong_keys(self) -> list[str]:
        """What is wrong with the keys that belong to shapes."""
        fields, problems = type(self).model_fields, []
        for key in (key for key in fields if key not in _OF_ALL):
            given = getattr(self, key)
            if given is None and key in SHAPES[self.shape].needs:
                mend = f"Give the {fields[key].description}."
                problems.append(f'tank.{key}: is required for shape = "{self.shape}". {mend}')
            if given is not None and key not in SHAPES[self.shape].needs:
                shapes = " or ".join(f'"{name}"' for name in SHAPES if key in SHAPES[name].needs)
                problems.append(
                    f"tank.{key}: is read with tank.shape = {shapes} only, got shape = "
                    f'"{self.shape}". Set tank.shape = {shapes}, or leave the {key} out.'
                )
        return problems

    @cached_property
    def shell(self) -> TankShell:
        """The shell as a surface."""
        return SHAPES[self.shape].shell(self)

    @property
    def volume(self) -> float:
        """Of the whole shell [m^3]."""
        return self.shell.volume

    def held_by(self, mould: Mould, *, own: bool = False) -> tuple[float, float]:
        """The least and the largest volume [m^3] of liquid below a sheet of the ``mould``.

        ``own``: whether that is no part of the shell.

        Nothing and the whole shell where the mould or its mirror image lies on all of it, as in a
        sphere clamped at its equator.
        """
        if self.shape == "sphere" and self.clamp_height == 0.0 and not own:
            return 0.0, self.volume
        from cloth.level import volumes_held

        return volumes_held(self.shell, mould, self.volume)
