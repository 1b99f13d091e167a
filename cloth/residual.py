"""The force that is left on a sheet at rest."""

from __future__ import annotations

import numpy as np

from cloth import reference
from cloth.arrays import Array
from cloth.load import Load, pressure_scale
from cloth.model import ClothModel

TOUCHING = 1e-6  # of the shell's size, within which a node lies on it


def stress(model: ClothModel, position: Array) -> Array:
    """Return the stress dW/dF (m, 3, 2) [N/m] of the triangles at ``position`` (n, 3) [m].

    W is the law whose proximal points ``cloth.reference.limited`` takes.
    """
    stretch = np.einsum("tid,tie->tde", position[model.triangles], model.gradients)
    left, sigma, right = np.linalg.svd(stretch, full_matrices=False)
    e, f = sigma[:, 0] - 1.0, sigma[:, 1] - 1.0
    stiff, soft, nu = model.tensile, model.compressive, model.poisson
    both = (soft >= stiff) | (f >= -nu * e)
    plane = stiff / (1.0 - nu**2)
    one = np.where(both, plane * (e + nu * f), np.where(e > 0.0, stiff * e, soft * e))
    two = np.where(both, plane * (f + nu * e), soft * (f + nu * np.maximum(e, 0.0)))
    return np.asarray(left * np.stack([one, two], axis=1)[:, None, :] @ right)


def residual(
    model: ClothModel, load: Load, position: Array, datum: float, contact_force: Array
) -> float:
    """Return the norm over all free nodes of the force that is left, over P L^2.

    Stress, bending, weight and pressure, less the contact forces; P is the ``pressure_scale``, L
    the sheet's size. A node on the shell keeps its tangential part alone where what is left points
    outward: the shell bears the rest. Whether contact forces between parts of the sheet balance is
    not checked.

    Parameters
    ----------
    model, load
        The sheet, and the liquid's density and body force.
    position
        Positions (n, 3) [m].
    datum
        Pressure at the origin [Pa].
    contact_force
        What the sheet exerts on the shell and on itself (n, 3) [N].

    Returns
    -------
    float
        The residual [-].
    """
    scale = pressure_scale(load, model.size)
    force = model.mass[:, None] * load.body_force - contact_force + model.bending_force(position)
    slope = load.density * load.body_force
    reference.pressure_step(position, model.triangles, datum, slope, force)
    pull = model.areas[:, None, None] * np.einsum(
        "tde,tie->tid", stress(model, position), model.gradients
    )
    np.add.at(force, model.triangles, -pull)
    shell = model.shell
    normal = shell.normal(position)
    outward = np.einsum("id,id->i", force, normal)
    borne = (shell.gap(position) <= TOUCHING * shell.size) & (outward > 0.0)
    force -= np.where(borne, outward, 0.0)[:, None] * normal
    return float(np.linalg.norm(force[model.free])) / (scale * model.size**2)
