"""Any surface of revolution, by points of its meridian in a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cloth.shell.arc_spline import through
from coupling.scene.profile_table import read_profile
from coupling.scene.shapes.shape import TankShape, clamped

if TYPE_CHECKING:
    from cloth.shell.meridian import Meridian
    from coupling.scene.tank import Tank


def profile_of(tank: Tank) -> Meridian:
    """The shell through the points of the tank's ``profile``. Raises ``TableError`` as well."""
    assert tank.profile is not None
    points = read_profile(Path(tank.profile))
    try:
        return clamped(through(points), tank)
    except ValueError as error:
        text = str(error)
        if text.startswith("tank."):
            raise
        raise ValueError(
            f"tank.profile: {tank.profile}: {text.removeprefix('meridian: ')} "
            "Give points of a smooth surface that every ray from the rim's middle meets once."
        ) from error


PROFILE = TankShape(shell=profile_of, needs=("profile",))
