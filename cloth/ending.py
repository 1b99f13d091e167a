"""From an iterate to a step's end: in the shell, of exact volume, not too long, not crossing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth import kernels
from cloth.arrays import Array, Bools
from cloth.contact import clamp_to_shell
from cloth.model import ClothModel
from cloth.self_contact.result import Contact

VOLUME_TOLERANCE = 1e-13  # relative, aimed at
VOLUME_ALLOWED = 1e-8  # relative, above which a step counts as not converged
STRAIN_MARGIN = 0.8  # of the limit, from where on a triangle is drawn together
SWEEPS = 50  # of drawing together, at most
ROUNDS = 6  # of drawing together, contact and volume in turn, at most
HARMLESS = 0.15  # thicknesses that a move away from touching nodes may have: see ``resolve``


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """What an end has to keep.

    ``start`` (n, 3) [m], where the step began; ``limit`` (n,) [m], the largest |x_i|; ``volume``
    [m^3] or None; ``strain_limit`` [-]; ``response`` (n, 3) [m/Pa], what the datum moves.
    """

    model: ClothModel
    start: Array
    limit: Array
    volume: float | None
    strain_limit: float
    response: Array


@dataclass(frozen=True, kw_only=True)
class Ending:
    """``position`` (n, 3) [m]; ``volume`` [m^3]; ``strain`` (m,), largest principal ones;
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
    """The end of a step whose iterate is ``x`` (n, 3) [m], changed as little as the bounds ask.

    Each of the three mends undoes a little of the others, so they take turns; most steps need
    none of them but a few millionths of a metre for the volume. Raises VolumeLostError.
    """
    model, nobody = bounds.model, np.zeros(len(x), dtype=np.bool_)
    x, volume = _closed(clamp_to_shell(x, bounds.limit), bounds, nobody)
    strain, contact, safe = _strain(x, model), None, True
    for turn in range(ROUNDS):
        too_long = turn < ROUNDS - 1 and _worst(strain, model) > _aim(bounds)
        if too_long:
            x = _shortened(x, bounds)
        near = nobody
        if model.self_contact is not None:
            contact = model.self_contact.resolve(bounds.start, x, bounds.limit)
            x, near = contact.position, contact.near
        if not too_long and (contact is None or contact.moved == 0.0):
            break
        before = x
        x, volume = _closed(x, bounds, near)
        if contact is not None and near.any():
            moved = float(np.linalg.norm(x - before, axis=1).max())
            safe = moved <= HARMLESS * contact.thickness
        strain = _strain(x, model)
        if safe and _worst(strain, model) <= bounds.strain_limit:
            break
    if not safe:
        assert model.self_contact is not None
        x = model.self_contact.resolve(bounds.start, x, bounds.limit).position
        strain, volume = _strain(x, model), model.volume(x)
    drift = 0.0 if bounds.volume is None else abs(volume / bounds.volume - 1.0)
    parted = contact is None or not (contact.held.any() or len(contact.failed))
    return Ending(
        position=x,
        volume=volume,
        strain=strain,
        contact=contact,
        converged=_worst(strain, model) <= bounds.strain_limit
        and drift <= VOLUME_ALLOWED
        and parted,
    )


def _aim(bounds: Bounds) -> float:
    """Strain above which triangles are drawn together."""
    return STRAIN_MARGIN * bounds.strain_limit


def _strain(x: Array, model: ClothModel) -> Array:
    strain = np.empty(len(model.triangles))
    kernels.principal_strains(x, model.triangles, model.gradients, strain)
    return strain


def _worst(strain: Array, model: ClothModel) -> float:
    """Largest strain that is too much; none is where the sheet may stretch."""
    return 0.0 if model.elastic else float(strain.max())


def _shortened(x: Array, bounds: Bounds) -> Array:
    """``x`` with the few triangles that still exceed the strain limit drawn together."""
    model, x = bounds.model, x.copy()
    for _ in range(SWEEPS):
        worst = kernels.shorten_step(
            x, model.triangles, model.gradients, model.mobility, _aim(bounds)
        )
        if worst <= 0.1 * bounds.strain_limit:
            break
        x = clamp_to_shell(x, bounds.limit)
    return x


def _closed(x: Array, bounds: Bounds, near: Bools) -> tuple[Array, float]:
    """``x`` moved along the datum's response, off the shell and not ``near``; and its volume."""
    model, wanted = bounds.model, bounds.volume
    volume, gradient = model.volume_and_gradient(x)
    if wanted is None:
        return x, volume
    for _ in range(8):
        if abs(volume - wanted) <= VOLUME_TOLERANCE * wanted:
            break
        free = (np.linalg.norm(x, axis=1) < bounds.limit * (1.0 - 1e-9)) & ~near
        direction = np.where(free[:, None], bounds.response, 0.0)
        slope = float(np.vdot(gradient, direction))
        if not slope > 0.0:
            if near.any():
                break
            raise VolumeLostError("the volume no longer answers to the pressure")
        x = clamp_to_shell(x + (wanted - volume) / slope * direction, bounds.limit)
        volume, gradient = model.volume_and_gradient(x)
    return x, volume
