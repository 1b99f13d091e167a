"""What energy the diaphragm holds, and what its own damping takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array
from cloth.load import Settings
from cloth.model import ClothModel
from cloth.state import Memory


@dataclass(frozen=True, kw_only=True)
class SheetEnergy:
    """Energies [J] of a sheet in its own frame.

    ``kinetic``; ``bending``, less the constant of the moulded curvature; ``stretch``.
    """

    kinetic: float
    bending: float = 0.0
    stretch: float = 0.0


@dataclass(frozen=True, kw_only=True)
class SheetLosses:
    """Powers [W] that a sheet's damping takes: of its ``bending``, and of the ``drag`` along it.

    Means over the last step, of the forces at its end.
    """

    bending: float = 0.0
    drag: float = 0.0


def sheet_energy(model: ClothModel, memory: Memory) -> SheetEnergy:
    """Of a sheet that stands and moves as ``memory`` says."""
    x, v = memory.position, memory.velocity
    return SheetEnergy(
        kinetic=0.5 * float(model.mass @ np.einsum("id,id->i", v, v)),
        bending=model.bending.energy(x, _normals(model, x)),
        stretch=stretch_energy(model, x),
    )


def sheet_losses(model: ClothModel, settings: Settings, memory: Memory, b: float) -> SheetLosses:
    """Powers taken in the step that led to ``memory``, of the implicit formula's ``b`` [s].

    ``b`` is that of ``cloth.inertia``; 0 where there was no step, which takes nothing. The
    damping's forces are those of an implicit step, at its end, and their work is that on the
    step's own displacement. The speed at the end times the length of the step would count
    grid-scale trembling twice.
    """
    x, v, dt = memory.position, memory.velocity, float(memory.previous_dt[0])
    if not (dt > 0.0 and b > 0.0):
        return SheetLosses()
    mean = (x - memory.previous_position) / dt
    rate = (model.bending_force(x) - model.bending_force(x - b * v)) / b
    normal = _normals(model, x)
    sliding = v - np.einsum("id,id->i", v, normal)[:, None] * normal
    return SheetLosses(
        bending=-settings.bending_damping * float(np.vdot(mean, rate)),
        drag=settings.drag * float(model.mass @ np.einsum("id,id->i", mean, sliding)),
    )


def _normals(model: ClothModel, position: Array) -> Array:
    """Unit vectors (n, 3) along the volume's gradient, 0 where nodes are fixed."""
    _, gradient = model.volume_and_gradient(position)
    size = np.sqrt(np.einsum("id,id->i", gradient, gradient))
    return np.asarray(gradient / np.where(size > 0.0, size, 1.0)[:, None])


def stretch_energy(model: ClothModel, position: Array) -> float:
    """Energy [J] that the triangles at ``position`` (n, 3) [m] hold in their plane.

    Per area, of principal strains e >= f: plane stress where both directions are taut, a tension
    field T e^2/2 + C (f + nu e)^2/2 where the second is slack, C (e^2 + f^2)/2 where both are; T is
    E t, C the compressive stiffness. These are the functions of which ``kernels.limited`` takes
    the proximal points, but for terms of C beside T.
    """
    corner = position[model.triangles]
    stretch = np.einsum("tid,tie->tde", corner, model.gradients)
    first, second = stretch[:, :, 0], stretch[:, :, 1]
    pairs = ((first, first), (first, second), (second, second))
    a, b, c = (np.einsum("td,td->t", one, other) for one, other in pairs)
    mean, spread = 0.5 * (a + c), np.hypot(0.5 * (a - c), b)
    e = np.sqrt(mean + spread) - 1.0
    f = np.sqrt(np.maximum(mean - spread, 0.0)) - 1.0
    soft, nu = model.compressive, model.poisson
    stiff = model.tensile
    taut = 0.25 * stiff * ((e + f) ** 2 / (1.0 - nu) + (e - f) ** 2 / (1.0 + nu))
    field = 0.5 * stiff * e**2 + 0.5 * soft * (f + nu * e) ** 2
    slack = 0.5 * soft * (e**2 + f**2)
    both = (soft >= stiff) | (f >= -nu * e)
    density = np.where(both, taut, np.where(e > 0.0, field, slack))
    return float(model.areas @ density)
