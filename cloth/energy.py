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
    """Return the mean losses over ``parts`` of a step, each with its length [s]; 0 of no parts."""
    length = sum(dt for dt, _ in parts) or 1.0
    return SheetLosses(
        **{
            f.name: sum(dt * getattr(losses, f.name) for dt, losses in parts) / length
            for f in fields(SheetLosses)
        }
    )


def sheet_energy(model: ClothModel, memory: Memory) -> SheetEnergy:
    """Return the energies of a sheet that stands and moves as ``memory`` says."""
    x, v = memory.position, memory.velocity
    return SheetEnergy(
        kinetic=0.5 * float(model.mass @ np.einsum("id,id->i", v, v)),
        bending=model.bending.energy(x, _normals(model, x)),
        stretch=stretch_energy(model, x, memory.rubber_strain),
    )


def sheet_losses(model: ClothModel, settings: Settings, memory: Memory, b: float) -> SheetLosses:
    """Return the mean powers that damping took in the step that led to ``memory``.

    ``b`` [s] of the implicit formula is that of ``cloth.kinematics``; 0 where there was no step,
    which takes nothing. The damping's forces are those of an implicit step, at its end, and their
    work is that on the step's own displacement. The speed at the end times the length of the step
    would count grid-scale trembling twice.
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
    """Return the energy [J] that the triangles hold in their plane.

    Plane stress of the rubber's own strain m, C m:m/2, and K/2 of the square of what its
    wrinkles take up beyond it, K the compressive stiffness. Of a sheet without memory:
    T e^2/2 + K (f + nu e)^2/2 where the second principal strain f is slack,
    K (e^2 + f^2)/2 where both are; T is E t. These are the functions of which
    ``triangle_kernels.limited`` takes the proximal points, but for terms of K beside T.

    Parameters
    ----------
    model
        The sheet: triangles, areas and stiffnesses.
    position
        Positions of its nodes (n, 3) [m].
    rubber
        The rubber's own strain (m, 3) [-]; None for that of a sheet without memory.

    Returns
    -------
    float
        Energy of all triangles [J].
    """
    strain = triangle_strain(position, model.triangles, model.gradients)
    if rubber is None:
        rubber, _ = rubber_at(model, position)
    density = plane_stress_energy(rubber, model.tensile, model.poisson)
    density += 0.5 * model.compressive * squared(strain - rubber)
    return float(model.areas @ density)


def rubber_at(model: ClothModel, position: Array, rest: Array | None = None) -> tuple[Array, Bools]:
    """Return the rubber's own strain, and in which triangles nothing pulls.

    Parameters
    ----------
    model
        The sheet: triangles and stiffnesses.
    position
        Positions of its nodes (n, 3) [m].
    rest
        The step's strain free of tension (m, 3) [-]; None or (0, 3) of a sheet without memory.

    Returns
    -------
    strain : Array
        The rubber's own strain (m, 3) [-], as ``cloth.viscous`` defines it.
    slack : Bools
        Where nothing pulls (m,).
    """
    strain = triangle_strain(position, model.triangles, model.gradients)
    if rest is None or not len(rest):
        rest = np.zeros_like(strain)
    return rubber_strain(strain, rest, model.tensile, model.compressive, model.poisson)


def stretch_loss(
    model: ClothModel, damping: float, change: Array, slack: Bools, dt: float
) -> float:
    """Return the mean power [W] that the rubber loses in a step in which its strain changes.

    tau C d:d/dt per area, with the change d of strain in the step. Where the rubber is slack at
    the end no force acts, and all that it held before and does not hold now is lost: C d:d/2 more.

    Parameters
    ----------
    model
        The sheet: areas and stiffnesses.
    damping
        tau [s].
    change
        d (m, 3) [-].
    slack
        Where nothing pulls at the end (m,).
    dt
        Length of the step [s]; without length, as without damping, nothing is lost.

    Returns
    -------
    float
        Power of all triangles [W].
    """
    if not (damping > 0.0 and dt > 0.0):
        return 0.0
    square = 2.0 * plane_stress_energy(change, model.tensile, model.poisson)
    return float(model.areas @ (square * (damping / dt + 0.5 * slack))) / dt
