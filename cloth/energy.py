"""What energy the diaphragm holds, and what its own damping takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from cloth.arrays import Array, Bools
from cloth.load import Settings
from cloth.model import ClothModel
from cloth.state import Memory
from cloth.viscous import plane_stress_energy, rubber_strain, squared, triangle_strain


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
    """Powers [W] that a sheet loses, means over the last step.

    By the damping of its ``bending`` and the ``drag`` along it, regularisations both; by the
    rubber's own loss, of its ``stretch``; by ``shell_friction`` and ``self_friction``.
    """

    bending: float = 0.0
    drag: float = 0.0
    stretch: float = 0.0
    shell_friction: float = 0.0
    self_friction: float = 0.0


def mean_losses(parts: Sequence[tuple[float, SheetLosses]]) -> SheetLosses:
    """Over ``parts`` of a step, each with its length [s]; none of no parts."""
    length = sum(dt for dt, _ in parts) or 1.0
    return SheetLosses(
        **{
            f.name: sum(dt * getattr(losses, f.name) for dt, losses in parts) / length
            for f in fields(SheetLosses)
        }
    )


def sheet_energy(model: ClothModel, memory: Memory) -> SheetEnergy:
    """Of a sheet that stands and moves as ``memory`` says."""
    x, v = memory.position, memory.velocity
    return SheetEnergy(
        kinetic=0.5 * float(model.mass @ np.einsum("id,id->i", v, v)),
        bending=model.bending.energy(x, _normals(model, x)),
        stretch=stretch_energy(model, x, memory.rubber_strain),
    )


def sheet_losses(model: ClothModel, settings: Settings, memory: Memory, b: float) -> SheetLosses:
    """What damping took in the step that led to ``memory``, of the implicit formula's ``b`` [s].

    ``b`` is that of ``cloth.inertia``; 0 where there was no step, which takes nothing. The
    damping's forces are those of an implicit step, at its end, and their work is that on the
    step's own displacement. The speed at the end times the length of the step would count
    grid-scale trembling twice.
    """
    x, v, dt = memory.position, memory.velocity, float(memory.previous_dt[0])
    if not (dt > 0.0 and b > 0.0):
        return SheetLosses()
    mean = (x - memory.previous_position) / dt
    rate = (model.held_normals_force(x) - model.held_normals_force(x - b * v)) / b
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


def stretch_energy(model: ClothModel, position: Array, rubber: Array | None = None) -> float:
    """Energy [J] that the triangles at ``position`` (n, 3) [m] hold in their plane.

    Plane stress of the ``rubber``'s own strain (m, 3), C m:m/2, and K/2 of the square of what its
    wrinkles take up beyond it, K the compressive stiffness. Without ``rubber`` that of a sheet
    without memory: T e^2/2 + K (f + nu e)^2/2 where the second principal strain f is slack,
    K (e^2 + f^2)/2 where both are; T is E t. These are the functions of which
    ``triangle_kernels.limited`` takes the proximal points, but for terms of K beside T.
    """
    strain = triangle_strain(position, model.triangles, model.gradients)
    if rubber is None:
        rubber, _ = rubber_at(model, position)
    density = plane_stress_energy(rubber, model.tensile, model.poisson)
    density += 0.5 * model.compressive * squared(strain - rubber)
    return float(model.areas @ density)


def rubber_at(model: ClothModel, position: Array, rest: Array | None = None) -> tuple[Array, Bools]:
    """The rubber's own strain (m, 3) at ``position`` (n, 3) [m], and where nothing pulls (m,).

    ``rest``: the step's strain free of tension; None or (0, 3) of a sheet without memory.
    """
    strain = triangle_strain(position, model.triangles, model.gradients)
    if rest is None or not len(rest):
        rest = np.zeros_like(strain)
    return rubber_strain(strain, rest, model.tensile, model.compressive, model.poisson)


def stretch_loss(
    model: ClothModel, damping: float, change: Array, slack: Bools, dt: float
) -> float:
    """Mean power [W] that the rubber loses in a step of ``dt`` [s] in which its strain changes.

    tau C d:d/dt per area of the ``change`` d (m, 3) in the step, tau the ``damping`` [s]. Where the
    rubber is ``slack`` at the end (m,) no force acts, and all that it held before and does not
    hold now is lost: C d:d/2 more.
    """
    if not (damping > 0.0 and dt > 0.0):
        return 0.0
    square = 2.0 * plane_stress_energy(change, model.tensile, model.poisson)
    return float(model.areas @ (square * (damping / dt + 0.5 * slack))) / dt
