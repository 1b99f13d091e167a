"""What stays constant while the thesis' algorithm runs (its appendix C), and where it errs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cloth.arrays import Array
from cloth.material import Diaphragm
from cloth.thesis.grid import ThesisGrid, node_areas

# A pair is a node (i, j) and the one at (i + di, j + dj), in the order of the thesis' sweeps:
# along the columns, along the rows, the two diagonals, and two apart either way for bending.
OFFSETS = ((0, 1), (1, 0), (-1, 1), (1, 1), (0, 2), (2, 0))
STRETCHING, COLUMNS, ROWS = 4, 4, 5  # the first four keep the strain, the last two the bending


class Constants(NamedTuple):
    """Arrays over the ``size`` x ``size`` nodes; a pair's values stand at its first node.

    ``rest`` (6, size, size) [m]: lengths of the moulded pairs; ``back``, ``forth`` (6, size, size)
    [-]: the first and the second node's shares of a correction; ``mass`` [kg] and
    ``inverse_mass`` [1/kg], both 0 at the rim, which never moves; ``damping`` [kg/s];
    ``stiffness`` [N m] is kappa; ``radius`` [m] of the shell; ``allowed`` [m]: the sum of all
    pairs' length errors at which a projection stops.
    """

    rest: Array
    back: Array
    forth: Array
    mass: Array
    inverse_mass: Array
    damping: Array
    stiffness: float
    radius: float
    allowed: float


def constants(grid: ThesisGrid, diaphragm: Diaphragm, *, radius: float, strain: float) -> Constants:
    """Return the constants of a ``diaphragm`` on ``grid`` in a shell of ``radius`` [m].

    The allowed ``strain`` [-] sets where a projection stops.

    Kept, erratum 5: kappa = E t^3 / 12 lacks 1/(1 - nu^2), 4/3 for rubber.

    Kept, erratum 6: the damping constant 2 sqrt(m k) takes the k of a beam that begins at the
    node, not of the one that has it in the middle. Near the far edges that beam wraps round to the
    opposite rim, is as long as the tank is wide, and its k nearly zero.

    Kept, erratum 7: the allowed error sums the moulded lengths of the pairs that wrap round the
    grid as well (1.87 times those that exist), and the mean of |error| that it limits says nothing
    of the largest: 1 % allowed lets single triangles stretch by tens of per cent.

    Repaired: ``MFF(:, 1:joff)`` for a negative joff (appendix C) is never reached.
    """
    points = grid.points.reshape(grid.size, grid.size, 3)
    mass = diaphragm.area_density * node_areas(points)
    inner = mass > 0.0
    inverse = np.where(inner, 1.0 / np.where(inner, mass, 1.0), 0.0)
    rest, back, forth = np.zeros((3, len(OFFSETS), grid.size, grid.size))
    for k, (di, dj) in enumerate(OFFSETS):
        second = np.roll(points, (-di, -dj), axis=(0, 1))
        rest[k] = np.linalg.norm(second - points, axis=-1)
        other = np.roll(inverse, (-di, -dj), axis=(0, 1))
        total = np.where(inverse + other > 0.0, inverse + other, 1.0)
        back[k], forth[k] = inverse / total, other / total
    kappa = diaphragm.youngs_modulus * diaphragm.thickness**3 / 12.0
    stiffness = 48.0 * kappa * (1.0 / rest[COLUMNS] ** 2 + 1.0 / rest[ROWS] ** 2)
    return Constants(
        rest=rest,
        back=back,
        forth=forth,
        mass=mass,
        inverse_mass=inverse,
        damping=2.0 * np.sqrt(mass * stiffness),
        stiffness=kappa,
        radius=radius,
        allowed=strain * float(rest[:STRETCHING].sum()),
    )
