"""Where faces of a surface are pressed together or creased, and how its points give way."""

from __future__ import annotations

import numpy as np

from cloth.compiled import compiled
from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints


def least_sine(corners: Array, normal: Array) -> Array:
    """Least sine (F,) of the angles of faces with ``corners`` (F, 4, 3) about ``normal`` (F, 3).

    Negative where a corner points inward.
    """
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    size = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
    sine = np.einsum("fkx,fx->fk", cross(ahead, behind), normal) / np.maximum(size, 1e-30)
    return np.asarray(sine.min(axis=1))


@compiled
def give_way(values: Array, at: Ints, share: Array, starts: Ints, others: Ints) -> None:
    """Move ``values`` (p, k) ``at`` points by ``share`` (p,) towards the mean over their others.

    Those of point i stand in ``others`` from ``starts[i]`` to ``starts[i + 1]``.
    """
    moved = np.zeros((len(at), values.shape[1]))
    for a in range(len(at)):
        i = at[a]
        part = share[i] / (starts[i + 1] - starts[i])
        for q in range(starts[i], starts[i + 1]):
            for k in range(values.shape[1]):
                moved[a, k] += part * values[others[q], k]
    for a in range(len(at)):
        for k in range(values.shape[1]):
            values[at[a], k] = moved[a, k] + (1.0 - share[at[a]]) * values[at[a], k]
