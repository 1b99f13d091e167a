"""Small waves of an inviscid liquid below a level surface: modes, and their course in time."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import eigsh

from coupling.interface import swept_gradient
from coupling.inviscid.operator import ball_trace
from coupling.inviscid.surface import area_vectors
from coupling.ports import Array, HydrostaticLoad, Ints
from coupling.verify.case import CaseError
from coupling.verify.disc import disc_grid
from coupling.verify.free_surface import FreeSurface

MODES = 24  # of the surface, among which the lateral ones are sought


def level_surface(level: float, faces: int) -> tuple[Array, Ints, Array]:
    """Points (p, 3) and faces (F, 4) of the surface at the depth ``level`` in the unit ball.

    With them G (F, F), at most ``faces`` of them.
    """
    plan, quads = disc_grid(faces)
    points = np.empty((len(plan), 3))
    points[:, :2] = np.sqrt(1 - (level - 1) ** 2) * plan
    points[:, 2] = level - 1
    return points, quads, ball_trace(points, quads, radius=1.0, wall_share=level / 2)


def lateral_mode(points: Array, faces: Ints, trace: Array, mode: int) -> float:
    """omega^2 R/g of the ``mode``-th mode (m = 1) of a level surface, heights meant over faces."""
    area = area_vectors(points[faces])[:, 2]
    root = np.sqrt(area)
    mean = root / np.linalg.norm(root)
    operator = root[:, None] * trace * root
    operator -= np.outer(mean, mean @ operator)  # heights without volume
    operator -= np.outer(operator @ mean, mean)
    count = min(MODES, len(area) - 1)
    value, vector = eigsh(operator, k=count, v0=root * points[faces].mean(axis=1)[:, 0] + mean)
    order = np.argsort(-value)
    # Lateral ones are made of x r^(2k) and y r^(2k); of both kinds there is one each.
    plan = points[faces].mean(axis=1)[:, :2]
    plan /= np.linalg.norm(plan, axis=1).max()
    powers = np.einsum("fx,f,k->fxk", plan, np.ones(len(plan)), np.ones(6))
    powers *= (plan**2).sum(axis=1)[:, None, None] ** np.arange(6)
    base = np.linalg.qr(root[:, None] * powers.reshape(len(plan), -1))[0]
    lateral = ((base.T @ vector[:, order]) ** 2).sum(axis=0) > 0.5
    found = value[order][lateral]
    if len(found) < 2 * mode:
        raise CaseError(
            f"verify slosh: the lateral mode {mode} is not among the lowest {count}. "
            "Raise --resolution."
        )
    return float(1 / found[2 * mode - 2])


def released(
    points: Array,
    faces: Ints,
    trace: Array,
    shape: Array,
    *,
    density: float,
    gravity: float,
    step: float,
    duration: float,
) -> tuple[Array, Array, Array]:
    """Times (T,) [s], first moments (T,) of the heights and energies (T,) [J] after the release.

    From rest at the heights ``shape`` (p,) [m]. ``trace`` G (F, F) [1/m] as for ``points`` (p, 3)
    [m]. The liquid's inertia enters as rows, the steps are the structure's own.
    """
    path = np.zeros_like(points)
    path[:, 2] = 1.0
    surface = FreeSurface(points, faces, path, mass=1e-3, density=density, gravity=gravity)
    rows = added_mass(points, faces, trace, density)
    surface.displace(shape)
    load = HydrostaticLoad(density=density, body_force=np.array([0.0, 0.0, -gravity]))
    count = int(np.ceil(duration / step))
    signal, energy = [surface.moment(shape)], [surface.energy(rows)]
    for _ in range(count):
        surface.begin_step(step, load, rows)
        surface.solve(np.zeros_like(points))
        surface.accept_step()
        signal.append(surface.moment(shape))
        energy.append(surface.energy(rows))
    return np.linspace(0.0, step * count, count + 1), np.array(signal), np.array(energy)


def added_mass(points: Array, faces: Ints, trace: Array, density: float) -> Array:
    """Rows B (r, p, 3) [kg^(1/2)] with M_a = B^T B of ``trace`` G (F, F) [1/m], net flux removed.

    ``density`` [kg/m^3].
    """
    area = np.linalg.norm(area_vectors(points[faces]), axis=1)
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    value, vector = np.linalg.eigh(density * mean @ trace @ mean.T)
    kept = value > 1e-12 * value[-1]
    flux = np.zeros((len(faces), *points.shape))
    np.add.at(flux, (np.arange(len(faces))[:, None], faces), swept_gradient(points[faces]))
    return np.tensordot((vector[:, kept] * np.sqrt(value[kept])).T, flux, axes=1)
