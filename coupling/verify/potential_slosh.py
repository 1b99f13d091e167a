"""Small waves of an inviscid liquid below a level surface: its inertia, and its course in time."""

from __future__ import annotations

import numpy as np

from coupling.fluids.potential.harmonics import harmonics_in
from coupling.fluids.potential.ritz import RitzLiquid, wall_integral
from coupling.ports import Array, HydrostaticLoad
from coupling.verify.disc import disc_grid
from coupling.verify.free_surface import FreeSurface
from coupling.verify.level_tank import DENSITY, GRAVITY, LevelTank

FACES = 4  # on the surface, over the square of the polynomials' degree: both errors fall together


def level_liquid(tank: LevelTank, height: float, degree: int) -> tuple[FreeSurface, Array]:
    """Return a level surface in a tank, and the liquid's inertia below it.

    The surface is at ``height`` [m] above the origin. The rows B (k, p, 3) [kg^(1/2)] are those of
    polynomials of ``degree``, as ``RitzShape`` has them.
    """
    plan, quads = disc_grid(FACES * degree**2)
    points = tank.surface(plan, height)
    path = np.zeros_like(points)
    path[:, 2] = 1.0
    surface = FreeSurface(points, quads, path, mass=1e-3, density=DENSITY, gravity=GRAVITY)
    harmonics = harmonics_in(tank.shell, degree)
    liquid = RitzLiquid(
        triangles=surface.triangles, harmonics=harmonics,
        wall=wall_integral(harmonics, *tank.wetted(height, degree)), density=DENSITY,
    )  # fmt: skip
    return surface, liquid.at(points).rows()


def released(
    surface: FreeSurface,
    rows: Array,
    shape: Array,
    *,
    step: float,
    duration: float,
) -> tuple[Array, Array, Array]:
    """Return the course in time of a surface that is released from rest on an inviscid liquid.

    Parameters
    ----------
    surface
        The surface on p points, which is displaced here.
    rows
        Rows B (k, p, 3) [kg^(1/2)] of the liquid's inertia, constant; see ``level_liquid``.
    shape
        Heights at the start (p,) [m]; their mean is removed.
    step
        Time step [s], the structure's own.
    duration
        Time to cover [s], rounded up to whole steps.

    Returns
    -------
    time : Array
        Instants (T,) [s], the start included.
    moment : Array
        Integral of the heights times ``shape`` (T,) [m^4].
    energy : Array
        Kinetic and potential energy (T,) [J].
    """
    surface.displace(shape)
    load = HydrostaticLoad(density=DENSITY, body_force=np.array([0.0, 0.0, -GRAVITY]))
    count = int(np.ceil(duration / step))
    signal, energy = [surface.moment(shape)], [surface.energy(rows)]
    for _ in range(count):
        surface.begin_step(step, load, rows)
        surface.solve(np.zeros_like(surface.reference))
        surface.accept_step()
        signal.append(surface.moment(shape))
        energy.append(surface.energy(rows))
    return np.linspace(0.0, step * count, count + 1), np.array(signal), np.array(energy)
