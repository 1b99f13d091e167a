"""What the flow's pressure leaves beyond its inertia, carried forward from former steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coupling.ports import Array

# Weights of former defects, newest first: constant, to the middle of the step, linear, quadratic.
EXTRAPOLATIONS = ((1.0,), (1.5, -0.5), (2.0, -1.0), (3.0, -3.0, 1.0))


@dataclass(frozen=True, kw_only=True)
class DefectSettings:
    """``order``: how many of ``EXTRAPOLATIONS`` are tried, 0 for a defect of zero.

    Without any a gentle sway takes 2.43 iterations a step in place of 2.10, a violent one 3.98 in
    place of 3.93 (``tests/benchmarks/README.md``).
    """

    order: int = 4


class Defects:
    """Pressures p + M_a a (F,) [Pa] on the interface's faces, of the last steps.

    As pressures on faces, which turn with the diaphragm, they change less than nodal forces, and
    never pull an almost massless sheet along itself. How smooth they are depends on the moment:
    the order of extrapolation is the one that would have served the last step best.
    """

    def __init__(self, settings: DefectSettings | None = None) -> None:
        self.settings = settings or DefectSettings()
        self._past: list[Array] = []  # newest first, of steps of one length
        self._dt = 0.0  # that length

    def add(self, defect: Array, dt: float) -> None:
        """Append that of the step of ``dt`` [s] just accepted (F,) [Pa]."""
        kept = 1 + max(map(len, EXTRAPOLATIONS))  # the last one says how well the order has done
        self._past = [defect, *(self._past if dt == self._dt else [])][:kept]
        self._dt = dt

    def next(self, faces: int, dt: float) -> Array:
        """The coming step's (F,) [Pa], of ``dt`` [s]; zero before the first.

        The last one where that was of another length: there is no trend to go on with.
        """
        if not self._past or self.settings.order == 0:
            return np.zeros(faces)
        if dt != self._dt:
            return self._past[0]
        tried = EXTRAPOLATIONS[: self.settings.order]
        known = [weights for weights in tried if len(weights) < len(self._past)]
        newest, before = self._past[0], self._past[1:]
        best = min(known, key=lambda w: _distance(_combined(w, before), newest), default=(1.0,))
        return _combined(best, self._past)

    def save(self) -> dict[str, Array]:
        """The defects by ``defect0``, ``defect1`` ... and the length of their steps."""
        past = {f"defect{number}": defect for number, defect in enumerate(self._past)}
        return past | {"defects_dt": np.array([self._dt])}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""
        count = sum(name.removeprefix("defect").isdigit() for name in saved)
        self._past = [saved[f"defect{number}"] for number in range(count)]
        self._dt = float(saved["defects_dt"][0])


def _combined(weights: tuple[float, ...], past: list[Array]) -> Array:
    terms = [w * defect for w, defect in zip(weights, past, strict=False)]
    return np.asarray(np.sum(terms, axis=0))


def _distance(one: Array, other: Array) -> float:
    return float(np.linalg.norm(one - other))
