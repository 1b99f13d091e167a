"""Where faces of a surface are pressed together or creased, and how its points give way."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from cloth.compiled import compiled
from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints


def least_sine(corners: Array, normal: Array) -> Array:
    """Return the least sine of the angles of each quadrilateral face.

    Parameters
    ----------
    corners
        Corners of the faces (F, 4, 3) [m].
    normal
        Unit normals of the faces (F, 3).

    Returns
    -------
    Array
        Least sine (F,) [-] about the normal, negative where a corner points inward.
    """
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    size = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
    sine = np.einsum("fkx,fx->fk", cross(ahead, behind), normal) / np.maximum(size, 1e-30)
    return np.asarray(sine.min(axis=1))


@compiled
def give_way(values: Array, at: Ints, share: Array, starts: Ints, others: Ints) -> None:
    """Move the values of some points towards the mean over their neighbours, all at the same time.

    Parameters
    ----------
    values
        Values of all points (p, k), of any unit, changed in place.
    at
        Points that are moved (a,).
    share
        Shares of the way to the mean (p,) [-], in [0, 1].
    starts, others
        Neighbours of point i: ``others[starts[i]]`` to ``others[starts[i + 1] - 1]``, one at least;
        ``starts`` (p + 1,).
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


def means(points: Ints, others: Ints, count: int) -> csr_array:
    """Return the matrix (count, k) that gives each of ``points`` the mean over its ``others``."""
    share = 1.0 / np.bincount(points, minlength=count)[points]
    return csr_array((share, (points, others)))
