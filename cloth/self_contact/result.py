"""What self-contact leaves of a step: where it ended, what touches and how far it slid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.self_contact.pairs import end_gaps
from cloth.self_contact.planes import Planes

TOUCHING = 1.2  # thicknesses up to which a pair is reported
NEAR = 1.5  # thicknesses up to which nodes are kept out of what follows


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The end of a step without crossings.

    ``thickness`` [m]; ``position`` (n, 3) [m]. Touching pairs: ``pairs`` (k, 5), kind
    (``proximity``) and four nodes; ``weights`` (k, 4) of their nearest points; ``normal``
    (k, 3) from the second side to the first; ``gap`` (k,) between mid-surfaces [m]; ``slip``
    (k, 3) [m], the first side's motion along the second during the step. ``planes``: half-spaces
    that keep them apart, by their gap where less than the thickness, and by all of it those pairs
    that would have passed each other, but no longer touch. ``near`` (n,): nodes of
    pairs within 1.5 thicknesses, and those ``held``. ``moved`` [m], the largest correction;
    ``rigid`` and ``held`` (n,): nodes that the fail-safe moved as rigid zones or left where they
    started. ``failed``: pairs (k, 2) of triangles that crossed at the start and were let through:
    then the end may cross too.
    """

    thickness: float
    position: Array
    pairs: Ints
    weights: Array
    normal: Array
    gap: Array
    slip: Array
    planes: Planes
    near: Bools
    moved: float
    rigid: Bools
    held: Bools
    failed: Ints

    def node_slip(self) -> Array:
        """Return the slip (n,) [m] of every node: the mean of its pairs' slips by their weights."""
        total, weight = np.zeros((2, len(self.position)))
        size = np.abs(self.weights)
        length = np.linalg.norm(self.slip, axis=1)
        np.add.at(total, self.pairs[:, 1:], size * length[:, None])
        np.add.at(weight, self.pairs[:, 1:], size)
        return np.asarray(total / np.maximum(weight, 1e-30))


def touching(
    *,
    start: Array,
    end: Array,
    position: Array,
    pairs: Ints,
    thickness: float,
    rigid: Bools,
    held: Bools,
    failed: Ints,
) -> Contact:
    """Return the contact at a step's end: which pairs touch, how they slid, what keeps them apart.

    Parameters
    ----------
    start, end
        Positions (n, 3) [m] where the step began, and where it would have ended without contact.
    position
        Positions (n, 3) [m] at its end.
    pairs
        Candidate pairs (j, 5), of which those within 1.2 thicknesses touch.
    thickness
        Thickness of the sheet [m].
    rigid, held
        Nodes (n,) that moved as rigid zones, or were left where they started.
    failed
        Pairs (k, 2) of triangles that had crossed before.

    Returns
    -------
    Contact
        The contact; its arrays are named there.
    """
    gap, weights = np.empty(len(pairs)), np.empty((len(pairs), 4))
    normal = np.empty((len(pairs), 3))
    end_gaps(position, pairs, gap, weights, normal)
    near = held.copy()
    near[pairs[gap < NEAR * thickness, 1:]] = True
    on = gap < TOUCHING * thickness
    rest = np.minimum(gap, thickness)
    passing = np.einsum("ki,kid,kd->k", weights, end[pairs[:, 1:]], normal) < rest
    kept, rest = on | passing, np.where(on, rest, gap)
    planes = Planes(
        nodes=pairs[kept, 1:], weights=weights[kept], normal=normal[kept], rest=rest[kept]
    )
    weights, normal = weights[on], normal[on]
    between = np.einsum("ki,kid->kd", weights, (position - start)[pairs[on, 1:]])
    along = np.einsum("kd,kd->k", between, normal)[:, None] * normal
    return Contact(
        thickness=thickness,
        position=position,
        pairs=pairs[on],
        weights=weights,
        normal=normal,
        gap=gap[on],
        slip=between - along,
        planes=planes,
        near=near,
        moved=float(np.linalg.norm(position - end, axis=1).max(initial=0.0)),
        rigid=rigid,
        held=held,
        failed=failed,
    )
