"""A sheet that does not pass through itself: the end of a step moved until its motion is free."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.self_contact.broad_phase import motion_boxes, near_boxes
from cloth.self_contact.crossing import crossings_among
from cloth.self_contact.features import Features
from cloth.self_contact.pairs import (
    approaching_kernel,
    candidate_kernel,
    separation_rounds,
)
from cloth.self_contact.result import Contact, touching
from cloth.self_contact.zones import translated
from cloth.shell.shell import NO_SHELL, Shell

log = logging.getLogger(__name__)

ROUNDS = 20  # of pushing, for every set of candidates
SEARCHES = 4  # of candidates, as corrections leave the motion they were found for
ZONES = 4  # times that zones grow before nodes are held
HELD = 12  # times that the held nodes grow before the whole sheet is
MARGIN = 2.0  # thicknesses within which pairs are candidates
CROWD = 50  # pairs of triangles per triangle beyond which a motion is hopeless
DRIFT = 0.5  # of the margin beyond the thickness, that corrections may take before a new search


@dataclass(frozen=True, kw_only=True)
class _Candidates:
    """What may meet in a motion that ends ``at`` (n, 3) [m]: ``pairs`` (k, 5), ``gaps`` (k,) [m].

    ``failed`` (k, 2): triangles that cross at the start, whose pairs are left out. ``crowded``:
    more triangles may meet than is worth looking at; there are no pairs then. ``met`` (k,): which
    pairs a round of pushing has found to meet.
    """

    at: Array
    pairs: Ints
    gaps: Array
    failed: Ints
    crowded: bool
    met: Bools


class _Motion:
    """A step under correction: from ``start`` to ``x`` (n, 3) [m], with its candidate pairs."""

    def __init__(self, sheet: SelfContact, start: Array, end: Array, shell: Shell) -> None:
        self.sheet, self.start, self.x, self.shell = sheet, start, end.copy(), shell
        self.found = self._searched()
        self.known = False  # that the motion of these pairs is free

    def search(self) -> None:
        """Find the candidates of the present motion."""
        self.found, self.known = self._searched(), False

    def _searched(self) -> _Candidates:
        sheet = self.sheet
        facing = sheet.approaching(self.start, self.x)
        crowded = len(facing) > CROWD * len(sheet.triangles)
        failed = crossings_among(self.start, sheet.triangles, facing)
        pairs, gaps = sheet.candidates(self.start, self.x, facing[:0] if crowded else facing)
        if len(failed) and len(pairs):
            kept = ~sheet.belong(pairs, failed)
            pairs, gaps = pairs[kept], gaps[kept]
        return _Candidates(
            at=self.x.copy(), pairs=pairs, gaps=gaps, failed=failed, crowded=crowded,
            met=np.zeros(len(pairs), dtype=np.bool_),
        )  # fmt: skip

    def drifted(self) -> bool:
        """Return whether ``x`` has left the motion whose candidates are known."""
        drift = np.sum((self.x - self.found.at) ** 2, axis=1).max()
        return bool(drift > self.sheet.drift**2)

    def push(self, inverse_mass: Array, rounds: int) -> None:
        """Correct ``x`` until nothing is pushed any more, or the rounds are used up."""
        for _ in range(SEARCHES):
            left = separation_rounds(
                self.start, self.x, inverse_mass, self.shell.profile,
                self.found.pairs, self.found.gaps, self.sheet.thickness, rounds, self.found.met,
            )  # fmt: skip
            self.known = left == 0
            if self.drifted():
                self.search()
            elif self.known:
                return

    def meeting_nodes(self) -> Ints:
        """Return the nodes (k, 4) of the pairs whose motion is not known to be free."""
        if self.drifted():
            self.search()
        if not self.known:
            separation_rounds(
                self.start, self.x, np.zeros(len(self.x)), self.shell.profile,
                self.found.pairs, self.found.gaps, self.sheet.thickness, 1, self.found.met,
            )  # fmt: skip
        return np.asarray(self.found.pairs[self.found.met, 1:])


class SelfContact:
    """Contact of a triangulated sheet with itself, of mid-surfaces a ``thickness`` [m] apart.

    ``triangles`` (m, 3); ``inverse_mass`` (n,) [1/kg], 0 for a fixed node.
    """

    def __init__(self, triangles: Ints, inverse_mass: Array, thickness: float) -> None:
        if not thickness > 0.0:
            raise ValueError(f"diaphragm.thickness: must be positive, got {thickness}.")
        self.triangles, self.inverse_mass = triangles, inverse_mass
        self.thickness = thickness
        self.drift = DRIFT * (MARGIN - 1.0) * thickness
        self._features = Features(triangles)

    def approaching(self, start: Array, end: Array) -> Ints:
        """Return pairs (k, 2) of triangles, no node in common, that may come near each other.

        Parameters
        ----------
        start, end
            Positions (n, 3) [m] between which a straight motion may bring them within two
            thicknesses.
        """
        margin = MARGIN * self.thickness
        lower, upper = motion_boxes(start, end, self.triangles, 0.5 * margin)
        near = near_boxes(lower, upper)
        return approaching_kernel(start, end, lower + upper, self.triangles, near, margin)

    def candidates(self, start: Array, end: Array, facing: Ints) -> tuple[Ints, Array]:
        """Return the pairs of primitives that may come within two thicknesses, and their gaps.

        Parameters
        ----------
        start, end
            Positions (n, 3) [m] at either end of the straight motion.
        facing
            Pairs of triangles (j, 2), whose nodes and triangles, and edges and edges, are paired.

        Returns
        -------
        tuple
            Kind and four nodes of each pair (k, 5), and its distance at the start (k,) [m].
        """
        pairs = self._features.pairs(facing)
        gaps, kept = np.empty(len(pairs)), np.empty(len(pairs), dtype=np.bool_)
        candidate_kernel(start, end, pairs, MARGIN * self.thickness, gaps, kept)
        return pairs[kept], gaps[kept]

    def belong(self, pairs: Ints, crossings: Ints) -> Bools:
        """Return which pairs (k,) have their two sides in two triangles that cross each other.

        Parameters
        ----------
        pairs
            Kind and four nodes of each pair (k, 5).
        crossings
            Pairs of triangles that cross (j, 2).
        """
        result = np.zeros(len(pairs), dtype=np.bool_)
        first = np.where(pairs[:, :1] == 0, pairs[:, [1, 1]], pairs[:, 1:3])
        second = np.where(pairs[:, :1] == 0, pairs[:, 2:5], pairs[:, [3, 4, 4]])
        for s, t in crossings.tolist():
            for a, b in ((self.triangles[s], self.triangles[t]),
                         (self.triangles[t], self.triangles[s])):  # fmt: skip
                result |= np.isin(first, a).all(axis=1) & np.isin(second, b).all(axis=1)
        return result

    def resolve(self, start: Array, end: Array, shell: Shell = NO_SHELL) -> Contact:
        """Return the contact at a step's end, corrected so that the straight motion to it is free.

        Pushes pairs apart at the end of their motion until the gap is the thickness,
        or a little more than it was where it was less (Bridson et al. 2002, with the time of
        impact of Li et al. 2021): inelastic, without friction. Pairs that still meet then move
        as rigid zones (Harmon et al. 2008), and what still meets is left at ``start``, in growing
        neighbourhoods, at last the whole sheet: so the motion is free in any case. A motion with
        more than 50 pairs of triangles per triangle to look at is refused: the sheet stays.

        Guaranteed for a ``start`` without crossings, up to rounding: triangles that share no node
        never pass through each other, collapsed and turned ones included, during the motion and
        at its end. Not guaranteed: anything between triangles that share a node (a fold may close
        to nothing, a triangle collapse or flip); the gap, where corrections contradict each
        other; lengths, which the step's solver has to mend. A later move (the volume's closure)
        that leaves the nodes ``near`` and is below 0.15 thicknesses crosses nothing; any other
        has to be resolved again, from the same ``start``.

        Parameters
        ----------
        start, end
            Positions (n, 3) [m] where the step began, and where it ends without contact.
        shell
            Its inside is kept if both positions kept it.

        Raises
        ------
        ValueError
            For positions that are not finite.
        """
        if not (np.all(np.isfinite(start)) and np.all(np.isfinite(end))):
            raise ValueError("cloth: self-contact needs finite positions.")
        motion = _Motion(self, start, end, shell)
        rigid, held = np.zeros((2, len(end)), dtype=np.bool_)
        if motion.found.crowded:
            motion.x, held[:] = start.copy(), True
        elif len(motion.found.pairs):
            motion.push(self.inverse_mass, ROUNDS)
            self._make_safe(motion, rigid, held)
        if held.any():
            log.warning(
                "self-contact: %d of %d nodes were left where the step started.",
                held.sum(),
                len(held),
            )
        if len(motion.found.failed):
            log.warning(
                "self-contact: %d pairs of triangles had crossed before the step and may still.",
                len(motion.found.failed),
            )
        return touching(
            start=start, end=end, position=motion.x, pairs=motion.found.pairs,
            thickness=self.thickness, rigid=rigid, held=held, failed=motion.found.failed,
        )  # fmt: skip

    def _make_safe(self, motion: _Motion, rigid: Bools, held: Bools) -> None:
        """Zones, then held nodes, until nothing meets; fills ``rigid`` and ``held`` (n,)."""
        zones = np.arange(len(rigid))
        for attempt in range(ZONES + HELD + 1):
            nodes = motion.meeting_nodes()
            if len(nodes) == 0:
                return
            if attempt < ZONES:
                rigid[nodes] = True
                motion.x = translated(
                    motion.start, motion.x, nodes, zones, self.inverse_mass, motion.shell
                )
            else:
                if attempt == ZONES + HELD:
                    held[:] = True
                held[nodes] = True
                if attempt > ZONES:
                    held[self.triangles[held[self.triangles].any(axis=1)]] = True
                motion.x[held] = motion.start[held]
            rigid &= ~held
            motion.push(np.where(rigid | held, 0.0, self.inverse_mass), ROUNDS)
