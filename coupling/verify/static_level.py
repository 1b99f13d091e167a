"""The diaphragm at rest without bending stiffness: a level surface, the rest on the shell."""

from __future__ import annotations

import math
from time import perf_counter

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Ints
from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere
from cloth.step import Cloth
from coupling.ports import Array, HydrostaticLoad
from coupling.verify.case import VerifyResult, quantity
from coupling.verify.sheets import FILM, SLACK, TAUT, bring_to_rest, film_settings, within

# Tensions are of order 0.1 N/m here.
PENALTY = 0.6  # N/m
ITERATIONS = 150
CUTS = (0.2, 0.35, 0.5, 0.65, 0.8)  # of the way from the rim to the level


def static_level(*, fill_fraction: float = 0.8, resolution: int = 24) -> VerifyResult:
    """A hemisphere in its shell, inextensible and free to wrinkle, with liquid below it.

    It sets out as the spheroid of the liquid's volume: at half fill, that is the answer. Without
    bending, a sheet let down from its moulded shape may fold through itself on the way.
    ``resolution``: rings; both stand a little off the tank's sphere, so that the polyhedron has
    its volume. ``cg_height`` of the liquid from the tank's centre over R, the spherical cap's.
    ``datum_pressure`` at the centre over rho g R, the level's height over R: the sheet weighs up
    to 2e-5 of that, which is not corrected for. ``roundness``: largest over smallest radius of
    horizontal cuts between the rim and the level, the worst of five, exactly 1; where the level is
    nearer to the rim's plane than two rings are to each other, of the rim itself.
    """
    clock = perf_counter()
    within("static-level", "fill-fraction", fill_fraction, 0.05, 0.95)
    within("static-level", "resolution", resolution, 4, 200)
    size = _size(resolution)
    mesh = hemisphere(size, resolution)
    cloth = Cloth(
        mesh=mesh,
        diaphragm=FILM,
        shell=Sphere(size),
        position=mesh.points * [1.0, 1.0, 2.0 * fill_fraction - 1.0],
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=film_settings(PENALTY, ITERATIONS),
    )
    volume = fill_fraction * 4.0 / 3.0 * math.pi
    load = HydrostaticLoad(
        density=1.0,
        body_force=np.array([0.0, 0.0, -1.0]),
        volume=volume + 2.0 / 3.0 * math.pi * (size**3 - 1.0),  # half the shell is whose size it is
    )
    bring_to_rest("static-level", cloth, load)
    x, level = cloth.state.position, level_height(fill_fraction)
    cap = -0.25 * math.pi * (1.0 - level**2) ** 2 / volume
    heights = np.array(CUTS) * level if abs(level) > math.pi / resolution else np.zeros(0)
    rim = np.linalg.norm(x[mesh.fixed, :2], axis=1)
    return VerifyResult(
        case="static-level",
        options={"fill_fraction": fill_fraction, "resolution": resolution},
        quantities=(
            quantity("cg_height", _moment(x, mesh.triangles) / volume, cap),
            quantity("datum_pressure", cloth.state.datum_pressure, level),
            quantity(
                "roundness",
                max(
                    [roundness(x, mesh.triangles, float(z)) for z in heights],
                    default=float(rim.max() / rim.min()),
                ),
                1.0,
            ),
        ),
        wall_s=perf_counter() - clock,
    )


def _size(rings: int) -> float:
    """Radius [m] of the mesh whose polyhedron has the volume of the half ball of radius 1 m."""
    mesh = hemisphere(1.0, rings)
    corner = mesh.points[mesh.triangles]
    cone = np.einsum("td,td->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6.0
    return float((2.0 / 3.0 * math.pi / cone) ** (1.0 / 3.0))


def level_height(fill_fraction: float) -> float:
    """Return the height h over R of the free level, from the centre.

    It solves 1/2 + 3/4 h - h^3/4 = fill fraction, the volume of the spherical cap below.
    """
    return float(brentq(lambda h: 0.5 + 0.75 * h - 0.25 * h**3 - fill_fraction, -1.0, 1.0))


def _moment(x: Array, triangles: Ints) -> float:
    """First moment [m^4] of the liquid's height, R = 1: cones over the sheet, and the half ball."""
    corner = x[triangles]
    cone = np.einsum("td,td->t", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6.0
    return float(np.sum(cone * 0.25 * corner[:, :, 2].sum(axis=1))) - 0.25 * math.pi


def roundness(x: Array, triangles: Ints, height: float) -> float:
    """Return the largest over the smallest distance from the z axis of a horizontal cut of a sheet.

    Parameters
    ----------
    x
        Nodes of the sheet (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).
    height
        Height z of the cut [m], not that of a node: an edge that only ends there is left out.

    Returns
    -------
    float
        The ratio [-] over the points in which the edges are cut, 1 for a circle about the axis.

    Raises
    ------
    ValueError
        The plane cuts no edge.
    """
    start = x[triangles].reshape(-1, 3)
    end = x[np.roll(triangles, -1, axis=1)].reshape(-1, 3)
    below, above = start[:, 2] - height, end[:, 2] - height
    cut = below * above < 0.0
    share = (below[cut] / (below[cut] - above[cut]))[:, None]
    radius = np.linalg.norm((start[cut] + share * (end[cut] - start[cut]))[:, :2], axis=1)
    return float(radius.max() / radius.min())
