"""From an iterate to a step's end: in the shell, of exact volume, not crossing itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth import kernels
from cloth.arrays import Array, Bools
from cloth.model import ClothModel
from cloth.self_contact.result import Contact

VOLUME_TOLERANCE = 1e-13  # relative, aimed at
VOLUME_ALLOWED = 1e-8  # relative, above which a step counts as not converged
ROUNDS = 6  # of contact and volume in turn, at most
OFF = 1e-9  # of the shell's size, beyond which a node is off it
HARMLESS = 0.15  # thicknesses that a move away from touching nodes may have: see ``resolve``


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """The bounds that the end of a step has to keep.

    ``start`` (n, 3) [m], where the step began; ``volume`` [m^3] or None; ``response`` (n, 3)
    [m/Pa], what the datum moves. And the model's shell.
    """

    model: ClothModel
    start: Array
    volume: float | None
    response: Array


@dataclass(frozen=True, kw_only=True)
class Ending:
    """The end of a step.

    ``position`` (n, 3) [m]; ``volume`` [m^3]; ``strain`` (m,), largest principal ones;
    ``contact`` of the sheet with itself, None where it is not looked for; ``converged``: all
    bounds are kept, without holding nodes back from touching.
    """

    position: Array
    volume: float
    strain: Array
    contact: Contact | None
    converged: bool


class VolumeLostError(ArithmeticError):
    """The volume no longer answers to the pressure."""


def ending(x: Array, bounds: Bounds) -> Ending:
    """Return the end of a step whose iterate is ``x`` (n, 3) [m], changed as little as bounds ask.

    Contact and volume each undo a little of the other, so they take turns; most steps need but a
    few millionths of a metre for the volume. Raises VolumeLostError.
    """
    model, nobody = bounds.model, np.zeros(len(x), dtype=np.bool_)
    x, volume = _closed(model.shell.confine(x), bounds, nobody)
    contact, safe = None, True
    for _ in range(ROUNDS):
        if model.self_contact is None:
            break
        contact = model.self_contact.resolve(bounds.start, x, model.shell)
        if contact.moved == 0.0:
            break
        x, volume = _closed(contact.position, bounds, contact.near)
        moved = float(np.linalg.norm(x - contact.position, axis=1).max())
        safe = not contact.near.any() or moved <= HARMLESS * contact.thickness
        if safe:
            break
    if not safe:
        assert model.self_contact is not None
        x = model.self_contact.resolve(bounds.start, x, model.shell).position
        volume = model.volume(x)
    drift = 0.0 if bounds.volume is None else abs(volume / bounds.volume - 1.0)
    parted = contact is None or not (contact.held.any() or len(contact.failed))
    return Ending(
        position=x,
        volume=volume,
        strain=_strain(x, model),
        contact=contact,
        converged=drift <= VOLUME_ALLOWED and parted,
    )


def _strain(x: Array, model: ClothModel) -> Array:
    strain = np.empty(len(model.triangles))
    kernels.principal_strains(x, model.triangles, model.gradients, strain)
    return strain


def _closed(x: Array, bounds: Bounds, near: Bools) -> tuple[Array, float]:
    """``x`` moved along the datum's response, off the shell and not ``near``; and its volume."""
    model, shell, wanted = bounds.model, bounds.model.shell, bounds.volume
    volume, gradient = model.volume_and_gradient(x)
    if wanted is None:
        return x, volume
    for _ in range(8):
        if abs(volume - wanted) <= VOLUME_TOLERANCE * wanted:
            break
        free = (shell.gap(x) > OFF * shell.size) & ~near
        direction = np.where(free[:, None], bounds.response, 0.0)
        slope = float(np.vdot(gradient, direction))
        if not slope > 0.0:
            if near.any():
                break
            raise VolumeLostError("the volume no longer answers to the pressure")
        x = shell.confine(x + (wanted - volume) / slope * direction)
        volume, gradient = model.volume_and_gradient(x)
    return x, volume
