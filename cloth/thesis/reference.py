"""Plain NumPy definitions of what ``cloth.thesis.kernels`` compiles: the thesis' own algorithm.

Arrays over the nodes are (size, size, ...), row i and column j as in the listings.
"""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array
from cloth.thesis.constants import COLUMNS, OFFSETS, ROWS, STRETCHING, Constants
from cloth.thesis.grid import node_areas

BENDING_SWEEPS = 10
SWEEPS_MAX = 5000  # of one projection; the thesis sets no bound
TOUCHING = 1.001  # radii from the centre beyond which a node is put back on the shell


def _ends(values: Array, di: int, dj: int) -> tuple[Array, Array]:
    """Views on the first and the second node of every pair that exists; ``dj`` is not negative."""
    n, m = values.shape[:2]
    if di < 0:
        return values[-di:, : m - dj], values[: n + di, dj:]
    return values[: n - di, : m - dj], values[di:, dj:]


def unit_normals(x: Array) -> Array:
    """Return unit normals towards the gas at the inner nodes (size, size, 3) [-]; 0 at the rim.

    The rim needs none. MATLAB's ``surfnorm``: the product of the central differences along and
    across.
    """
    normals = np.zeros_like(x)
    along, across = x[1:-1, 2:] - x[1:-1, :-2], x[2:, 1:-1] - x[:-2, 1:-1]
    product = np.cross(along, across)
    normals[1:-1, 1:-1] = product / np.linalg.norm(product, axis=-1, keepdims=True)
    return normals


def add_bending(
    x: Array, normals: Array, rest: Array, stiffness: float, di: int, dj: int, force: Array
) -> None:
    """Add the bending force of the beams over three nodes to ``force``.

    Eq. 4.7, listing 1: on the middle node, k d along its normal towards the chord's side, with
    k = 48 kappa / rest^2 and the deflection d = sqrt(rest^2 - length^2) / 2.

    Kept, erratum 6: d is computed from the chord's shortening, so that it is zero in the moulded
    and in the mirrored state, and where the beam is stretched (a square root of a negative number,
    of which the listing takes the real part).

    Parameters
    ----------
    x
        Positions (size, size, 3) [m].
    normals
        Unit normals there (size, size, 3).
    rest
        Moulded length of each beam at its first node (size, size) [m].
    stiffness
        kappa [N m].
    di, dj
        Rows and columns from a beam's first node to its last.
    force
        Forces (size, size, 3) [N], to which the beams' are added.
    """
    h, g = di // 2, dj // 2
    first, second = _ends(x, di, dj)
    span = (slice(h, x.shape[0] - h), slice(g, x.shape[1] - g))
    chord, (relaxed, _) = second - first, _ends(rest, di, dj)
    shortened = relaxed**2 - np.einsum("ijd,ijd->ij", chord, chord)
    deflection = 0.5 * np.sqrt(np.maximum(shortened, 0.0))
    side = np.einsum("ijd,ijd->ij", x[span] - 0.5 * (first + second), normals[span])
    # The listing compares the middle's distances from chord + normal and chord - normal: the same.
    pull = -np.sign(side) * deflection * 48.0 * stiffness / relaxed**2
    force[span] += pull[:, :, None] * normals[span]


def relieve(x: Array, rest: Array, back: Array, forth: Array, di: int, dj: int) -> float:
    """Sweep once over the pairs at (di, dj), all at once, and return the error before, sum |error|.

    Listing 3: every pair goes back to its moulded length, either way. Repaired: the shift of
    the second node's part lacks its second index in the listing and in appendix F.

    Parameters
    ----------
    x
        Positions (size, size, 3) [m], which are changed.
    rest
        Moulded length of each pair at its first node (size, size) [m].
    back, forth
        The first and the second node's shares of a correction (size, size) [-].
    di, dj
        Rows and columns from a pair's first node to its second.

    Returns
    -------
    float
        Sum of the pairs' length errors before the sweep [m].
    """
    first, second = _ends(x, di, dj)
    apart = second - first
    length = np.linalg.norm(apart, axis=-1)
    error = length - _ends(rest, di, dj)[0]
    pull = (error / length)[:, :, None] * apart
    move = np.zeros_like(x)
    to_first, to_second = _ends(move, di, dj)
    to_first += _ends(back, di, dj)[0][:, :, None] * pull
    to_second -= _ends(forth, di, dj)[0][:, :, None] * pull
    x += move
    return float(np.abs(error).sum())


def put_inside(x: Array, radius: float) -> None:
    """Put inner nodes beyond the shell of ``radius`` [m] back on it (appendix G); changes ``x``."""
    inner = x[1:-1, 1:-1]
    distance = np.linalg.norm(inner, axis=-1, keepdims=True)
    inner[:] = np.where(distance > TOUCHING * radius, radius * inner / distance, inner)


def project(x: Array, c: Constants) -> tuple[float, int]:
    """Sweep until the sum of all errors is allowed; return it [m], and the sweeps: -1 if too many.

    Appendix A. Kept, erratum 7: a mean of |error| is limited, see ``constants``.
    """
    for sweep in range(1, SWEEPS_MAX + 1):
        error = 0.0
        for k, (di, dj) in enumerate(OFFSETS[:STRETCHING]):
            error += relieve(x, c.rest[k], c.back[k], c.forth[k], di, dj)
        if not error > c.allowed:
            return error, sweep
    return error, -1


def move_freely(
    x: Array, v: Array, c: Constants, density: float, datum: float, body: Array, force: Array,
    dt: float,
) -> None:  # fmt: skip
    """Move the nodes without constraints (listing 2, appendix E), by a step of forward Euler.

    Repaired, erratum 3: the listing has p rise along +a, 180 degrees out of phase with the tank it
    draws, and gives the diaphragm its weight but no inertia in the shaking direction; both follow
    ``body``, gravity less the tank's acceleration, here. Repaired, errata 1 and 2: the datum's
    level is the caller's, and a level.

    Kept, erratum 6: the moulded lengths of the two directions are swapped in the bending beams
    (next to the far edges a wrapped one is taken), and the critical damping of the bending
    multiplies the node's total velocity. Kept, erratum 8: see ``advance``.

    Read: the listing adds two calls of four results each, which MATLAB cannot; result by result.

    Parameters
    ----------
    x, v
        Positions and velocities (size, size, 3) [m, m/s], which are changed.
    c
        What stays constant during the run.
    density
        Density of the liquid [kg/m^3].
    datum, body
        Pressure at the origin [Pa] and body force (3,) [m/s^2]: p = datum + density body . x.
    force
        Further nodal forces (size, size, 3) [N].
    dt
        Length of the step [s].
    """
    normals = unit_normals(x)
    pressure = node_areas(x) * (datum + density * x @ body)
    total = pressure[:, :, None] * normals + c.mass[:, :, None] * body + force
    for k, swapped in ((COLUMNS, ROWS), (ROWS, COLUMNS)):
        add_bending(x, normals, c.rest[k], c.stiffness, *OFFSETS[swapped], total)
    total -= c.damping[:, :, None] * v
    v += dt * c.inverse_mass[:, :, None] * total
    x += dt * v


def advance(
    x: Array, v: Array, c: Constants, density: float, datum: Array, body: Array, force: Array,
    dt: float, steps: int,
) -> tuple[float, int]:  # fmt: skip
    """Do several steps of the thesis' algorithm; return the last error sum and the sweeps in all.

    The load changes evenly during them.

    Kept, erratum 4: nothing holds the liquid's volume. Kept, erratum 8: ten sweeps a step bring the
    beams over three nodes back to their moulded length, whatever dt. That is a stiffness that
    grows as 1/dt, since nodes in balance keep their terminal velocity, force over damping; it
    would be 1/dt^2 without damping. The state converges neither in dt nor in the grid.

    Kept, erratum 9: the projection moves nodes but never corrects ``v``, which is left with what
    pressure and damping made of it: nodes at rest have metres per second, and the kinetic energy
    is a phantom.

    Parameters
    ----------
    x, v
        Positions and velocities (size, size, 3) [m, m/s], which are changed.
    c, density, force
        As in ``move_freely``.
    datum, body
        Pressures (2,) [Pa] and body forces (2, 3) [m/s^2] before the first step and at the last.
    dt, steps
        Length of a step [s], and their number.

    Returns
    -------
    error : float
        Sum of all pairs' length errors after the last projection [m].
    sweeps : int
        Sweeps of all projections, -1 when one finds no end.
    """
    error, total = 0.0, 0
    for step in range(1, steps + 1):
        s = step / steps
        move_freely(
            x, v, c, density, (1.0 - s) * float(datum[0]) + s * float(datum[1]),
            (1.0 - s) * body[0] + s * body[1], force, dt,
        )  # fmt: skip
        put_inside(x, c.radius)
        error, sweeps = project(x, c)
        if sweeps < 0:
            return error, -1
        for _ in range(BENDING_SWEEPS):
            for k in (COLUMNS, ROWS):
                relieve(x, c.rest[k], c.back[k], c.forth[k], *OFFSETS[k])
        error, again = project(x, c)
        if again < 0:
            return error, -1
        total += sweeps + again
        put_inside(x, c.radius)
    return error, total
