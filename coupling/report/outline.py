"""A shell's outline as it is seen from afar."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Shell

HALVINGS = 40  # of the bounds of a level
SAMPLES = 361  # heights of the shell; a sphere's outline then has corners of a degree


def meridian(shell: Shell, count: int) -> tuple[Array, Array]:
    """Return points of the ``shell`` at azimuth 0 and outward normals there, each (count, 3).

    From the lower pole to the upper one, at even steps of arc [m].
    """
    first, last = (shell.arc_to(height) for height in shell.poles)
    r, z = shell.along(np.linspace(first, last, count))
    points = np.column_stack([np.maximum(r, 0.0), np.zeros(count), z])
    return points, shell.normal(points)


def levels(shell: Shell, volume: Array, up: Array) -> Array:
    """Return the heights (k,) [m] above the origin, along each ``up``, of a level liquid.

    For pictures: by ``SAMPLES`` slices of the shell, within a twentieth of a slice.

    Parameters
    ----------
    volume
        Of the liquid at every instant (k,) [m^3].
    up
        Unit vectors (k, 3).
    """
    points, _ = meridian(shell, SAMPLES)
    r, z = 0.5 * (points[1:, 0] + points[:-1, 0]), 0.5 * (points[1:, 2] + points[:-1, 2])
    thick = np.diff(points[:, 2])
    slices = r**2 * thick
    # what a slice spans along ``up``: its chords, at the least half its thickness
    span = np.maximum(np.hypot(up[:, :1], up[:, 1:2]) * r, 0.5 * np.abs(thick))
    wanted = volume / shell.volume * np.pi * slices.sum()
    reach = float(np.hypot(points[:, 0], points[:, 2]).max())
    low, high = np.full(len(up), -reach), np.full(len(up), reach)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        chord = np.clip((middle[:, None] - up[:, 2:] * z) / span, -1.0, 1.0)
        share = np.pi - np.arccos(chord) + chord * np.sqrt(1.0 - chord**2)
        below = share @ slices < wanted
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(0.5 * (low + high))


def outline(shell: Shell, towards: Array) -> Array:
    """Return the closed curve (k, 3) [m] of a convex ``shell`` where its normal is across a view.

    At a height with the normal (n_r, n_z) that is where n_r cos(phi) v_r + n_z v_z = 0, phi the
    azimuth from the view's horizontal part v_r.

    Parameters
    ----------
    towards
        Unit vector (3,) to who looks from afar; not along z.
    """
    points, normal = meridian(shell, SAMPLES)
    flat = float(np.hypot(towards[0], towards[1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = -normal[:, 2] * towards[2] / (normal[:, 0] * flat)
    seen = np.abs(cosine) <= 1.0
    r, z, cosine = points[seen, 0], points[seen, 2], cosine[seen]
    sine = np.sqrt(1.0 - cosine**2)
    along, left = towards[:2] / flat, np.array([-towards[1], towards[0]]) / flat
    sides = [
        np.column_stack([r[:, None] * (cosine[:, None] * along + side * sine[:, None] * left), z])
        for side in (1.0, -1.0)
    ]
    return np.vstack([sides[0], sides[1][::-1], sides[0][:1]])
