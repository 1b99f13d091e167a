"""What a shape of a tank is: the keys of [tank] that it takes, and the shell that follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cloth.arrays import Array

if TYPE_CHECKING:
    from cloth.shell.meridian import Meridian
    from coupling.scene.tank import Tank, TankShell


NARROWEST = 0.1  # radius of the clamped circle over the shell's, at least: a choice


@dataclass(frozen=True, kw_only=True)
class TankShape:
    """A shape: ``shell`` makes the shell of a tank that has the keys which it ``needs``.

    Of the keys that belong to shapes it takes no others. ``shell`` raises ValueError or
    ``TableError``, one line ``key: what is wrong. Mend.``, for a tank that is none.
    """

    shell: Callable[[Tank], TankShell]
    needs: tuple[str, ...] = ("radius",)


def clamped(pieces: Sequence[Array], tank: Tank) -> Meridian:
    """The shell of a meridian's ``pieces`` (7,), clamped at the tank's ``clamp_height``.

    The origin moves to the middle of the clamped circle. Raises ValueError where the shell has
    none there.
    """
    from cloth.shell.meridian import Meridian
    from cloth.shell.pieces import raised

    low, high, at = float(pieces[0][1]), float(pieces[-1][3]), tank.clamp_height
    if not low < at < high:
        raise ValueError(
            f"tank.clamp_height: must lie between the shell's poles, in ({low:.6g}, {high:.6g}) m, "
            f"got {at:g}. Give the height of the clamped circle above the shell's middle."
        )
    shell = Meridian([raised(piece, -at) for piece in pieces])
    widest = max(float(np.abs(np.array(pieces)[:, [0, 2]]).max()), tank.radius or 0.0)
    if shell.size < NARROWEST * widest:
        raise ValueError(
            f"tank.clamp_height: at {at:g} m the shell is {shell.size:.4g} m in radius, less than "
            f"{NARROWEST:g} of its largest. Clamp the diaphragm nearer to the middle."
        )
    return shell
