"""A mould that is no part of the shell: of a closed meridian of its own, in a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from coupling.scene.profile_table import read_profile
from coupling.scene.tables.text import TableError

if TYPE_CHECKING:
    from cloth.mould import Mould
    from coupling.scene.scene import Scene

SAME = 1e-6  # of the rim's radius, by which the circle at z = 0 may differ from it


def own_mould(file: str, part: str) -> Mould:
    """The ``part``, "upper" or "lower", of the surface through the points of ``file``.

    Raises ``TableError`` for a wrong file, ValueError for points of no meridian.
    """
    from cloth.shell.arc_spline import through
    from cloth.shell.meridian import Meridian

    surface = Meridian(through(read_profile(Path(file))))
    return surface.upper_part() if part == "upper" else surface.lower_part()


def mould_problems(scene: Scene) -> list[str]:
    """One line ``key: what is wrong. Mend.`` where the mould is none that the rim can hold."""
    file, key = scene.diaphragm.mould_profile, "diaphragm.mould_profile"
    if file is None:
        return []
    if scene.cloth.grid == "thesis":
        return [
            f'{key}: does not apply to cloth.grid = "thesis". Leave it out, or take '
            'cloth.grid = "rings".'
        ]
    try:
        made = scene.mould.ring(1, 1)[0]
    except TableError as error:
        return [f"{key}: {error}"]
    except ValueError as error:
        return [
            f"{key}: {file}: {str(error).removeprefix('meridian: ')} Give points of a closed "
            "smooth surface that every ray from the rim's middle meets once."
        ]
    rim = scene.tank.shell.size
    if abs(made - rim) <= SAME * rim:
        return []
    return [
        f"{key}: {file}: must be {rim:.7g} m in radius at z = 0, where the tank clamps the rim, "
        f"is {made:.7g} m. Move its heights, or give metres."
    ]
