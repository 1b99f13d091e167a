"""Pressure of an inviscid liquid that accelerates from rest: the trace of its Neumann Laplacian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.inviscid.kernels import influence
from coupling.inviscid.panels import COARSE, FINE, kept_off, rule, topology
from coupling.inviscid.symmetric import SymmetricTrace
from coupling.ports import Array, Ints


@dataclass(frozen=True, kw_only=True)
class BoundaryIntegrals:
    """(1/2 + K) phi = S q + constant: ``single`` S [1/m] and ``double`` K (F, F)."""

    single: Array
    double: Array


def ball_trace(
    points: Array,
    faces: Ints,
    *,
    radius: float,
    wall_share: float = 0.5,
    clearance: float = 0.0,
) -> Array:
    """G (F, F) [1/m] of the liquid between a sheet and the spherical shell around the origin.

    p_f = -rho (G a)_f for accelerations a of the flux [m^3/s^2], sum a = 0; so does the potential
    phi = G q belong to fluxes q [m^3/s]. Both are means over the faces, up to a constant. The wall
    needs no elements: the kernel is the Neumann function of the ball.

    ``points`` (p, 3) [m], ``faces`` (F, 4) or (F, 3), counter-clockwise seen from outside the
    liquid; the border of the sheet lies on the shell of ``radius`` [m]. ``wall_share``: wetted wall
    over the whole shell, 1/2 for a sheet clamped at the equator. ``clearance``: least thickness
    of a film of liquid between sheet and shell over R; thinner ones count as ``kept_off`` says.

    Symmetric and positive definite for any sheet; constant elements, of second order in the grid
    where it is smooth. Self-intersection is not checked.
    """
    integrals = boundary_integrals(
        points, faces, radius=radius, wall_share=wall_share, clearance=clearance
    )
    return SymmetricTrace(integrals.single, integrals.double).matrix()


def boundary_integrals(
    points: Array, faces: Ints, *, radius: float, wall_share: float, clearance: float
) -> BoundaryIntegrals:
    """The two integral operators of a sheet in a ball; arguments as in ``ball_trace``."""
    if not 0.0 < wall_share < 1.0:
        raise ValueError(f"wall_share must lie in (0, 1), got {wall_share}.")
    edge = topology(faces, len(points)).edge
    kept = kept_off(points, edge, radius, clearance)
    return _integrals(kept, faces, radius, wall_share - 0.5)


def closed_trace(points: Array, faces: Ints) -> Array:
    """G (F, F) [1/m] as in ``ball_trace``, of the liquid inside any closed surface of panels.

    ``points`` (p, 3) [m], ``faces`` (F, 4) or (F, 3), counter-clockwise seen from outside. Walls
    are faces without flux. Symmetric and positive as there; edges lower the order in the grid to
    1.4 (flux on both sides) to 1.75. That the surface is closed is not checked.
    """
    integrals = _integrals(points, faces, 0.0, -0.5)
    return SymmetricTrace(integrals.single, integrals.double, closed=True).matrix()


def _integrals(points: Array, faces: Ints, radius: float, row_sum: float) -> BoundaryIntegrals:
    corner = points[faces]
    single, double = np.empty((2, len(faces), len(faces)))
    influence(
        points, faces, corner.mean(axis=1),
        *rule(faces.shape[1], COARSE).sample(corner), *rule(faces.shape[1], FINE).sample(corner),
        topology(faces, len(points)).touching, radius, row_sum, single, double,
    )  # fmt: skip
    return BoundaryIntegrals(single=single, double=double)
