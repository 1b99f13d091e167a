"""Which part of the diaphragm is free of the shell, and the contact curve round it.

Both are described in the moulded shape, unrolled on the unit hemisphere, where it never folds: the
free part is star-shaped about an axis, and its edge lies at the polar angle psi(phi) from it. In
any sector of azimuths the sheet that lies on the shell takes the solid angle omega(phi) dphi off
the hemisphere's, so that cos psi = cos psi_rim + omega, psi_rim being the clamped rim's. omega is
kept as a few Fourier coefficients, sums over triangles whose weight falls off smoothly with the
gap: the curve moves smoothly with the sheet. The sheet comes off the shell node by node all the
same, so that the curve goes only part of the way in each step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coupling.interface.contact_distance import ContactDistance
from coupling.ports import Array, Ints, Shell

_WIDEST = 0.98  # |cos psi| of the curve, at most


@dataclass(frozen=True, kw_only=True)
class ContactSettings:
    """Constants of the search for the contact curve, all without a unit.

    What each does to iterations and to the CG's motion: ``tests/benchmarks/README.md``.

    - ``reach``: mean edges of the grid, along the sheet, over which it goes from resting on the
      shell to free;
    - ``order``: highest wave round the axis; finer waves of the curve are left out;
    - ``share``: of the way to where the sheet's contact ends that the curve goes in a step; 1 moves
      the mesh in jumps, and the lag of the others vanishes with the step;
    - ``upright``: weight of the pole in the axis, over that of the whole sheet lifted to its
      centre: the axis of a sheet that is free all round is the pole.
    """

    reach: float = 0.5
    order: int = 6
    share: float = 0.5
    upright: float = 0.5


@dataclass(frozen=True, kw_only=True)
class FreePart:
    """Free part of the unit hemisphere: ``frame`` (3, 3), rows u, v, axis; ``waves`` of omega."""

    frame: Array
    waves: NDArray[np.complex128]

    def edge(self, azimuth: Array) -> Array:
        """Return the polar angle psi (k,) [rad] of the contact curve at ``azimuth`` (k,) [rad].

        Both are about the axis.
        """
        u, v, axis = self.frame
        rim = np.arctan2(axis[2], -(np.cos(azimuth) * u[2] + np.sin(azimuth) * v[2]))
        turns = np.exp(1j * np.multiply.outer(azimuth, np.arange(len(self.waves))))
        taken = np.maximum((turns @ self.waves).real, 0.0)
        return np.asarray(np.arccos(np.clip(np.cos(rim) + taken, -_WIDEST, _WIDEST)))

    def directions(self, polar: Array, azimuth: Array) -> Array:
        """Return points of the unit hemisphere at given angles about the axis of the free part.

        Parameters
        ----------
        polar
            Angles from the axis (k,) [rad].
        azimuth
            Angles about the axis (k,) [rad], from u to v.

        Returns
        -------
        Array
            Unit vectors (k, 3).
        """
        across = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1) @ self.frame[:2]
        return np.asarray(np.cos(polar)[:, None] * self.frame[2] + np.sin(polar)[:, None] * across)

    def within(self, directions: Array, inset: float) -> Array:
        """Return ``directions`` (k, 3) moved on to the curve where they lie beyond it.

        The curve is the contact curve with ``inset`` times its polar angle.
        """
        u, v, height = self.frame @ directions.T
        azimuth, polar = np.arctan2(v, u), np.arccos(np.clip(height, -1.0, 1.0))
        most = inset * self.edge(azimuth)
        moved = self.directions(most, azimuth)
        return np.asarray(np.where((polar > most)[:, None], moved, directions))


class ContactSearch:
    """Finds the free part of a sheet in a ``shell``, its nodes ``moulded`` (n, 3) at a direction.

    On the unit hemisphere of a mould's chart. ``fixed`` (n,) nodes are always at the shell: a
    triangle goes by its others.
    """

    def __init__(
        self,
        moulded: Array,
        triangles: Ints,
        fixed: NDArray[np.bool_],
        shell: Shell,
        settings: ContactSettings | None = None,
    ) -> None:
        self.settings = settings or ContactSettings()
        self._triangles = triangles
        moving = (~fixed)[triangles].astype(float)
        self._share = moving / np.maximum(moving.sum(axis=1), 1.0)[:, None]
        self._angle = solid_angles(moulded, triangles)
        centre = moulded[triangles].mean(axis=1)
        self._distance = ContactDistance(triangles, shell)
        self._curve = np.zeros(0)  # axis and waves as the last step has them
        self._centre = centre / np.linalg.norm(centre, axis=1)[:, None]

    def free_part(self, position: Array, dt: float) -> FreePart:
        """Return the free part ``dt`` [s] after the last, of nodes at ``position`` (n, 3) [m].

        At once where ``dt`` is 0, else part of the way.
        """
        now = self._measured(position)
        if dt > 0.0:
            now = self._curve + self.settings.share * (now - self._curve)
        self._curve = now
        real, imaginary = np.split(now[3:], 2)
        return FreePart(frame=upright_frame(now[:3]), waves=real + 1j * imaginary)

    def save(self) -> Array:
        """Everything ``restore`` needs (k,)."""
        return self._curve

    def restore(self, saved: Array) -> None:
        """The reverse of ``save``."""
        self._curve = saved

    def _measured(self, position: Array) -> Array:
        """Axis, real and imaginary parts of the waves, one after the other."""
        near = np.clip(1.0 - self._distance.of(position) / self.settings.reach, 0.0, 1.0)
        resting = (near * near * (3.0 - 2.0 * near))[self._triangles]
        resting = (self._share * resting).sum(axis=1)
        axis = ((1.0 - resting) * self._angle) @ self._centre / self._angle.sum()
        axis[2] += self.settings.upright
        frame = upright_frame(axis)
        azimuth = np.arctan2(self._centre @ frame[1], self._centre @ frame[0])
        order = np.arange(self.settings.order + 1)
        turns = np.exp(-1j * np.multiply.outer(order, azimuth))
        # Lanczos' factors keep the truncated series from overshooting where contact begins.
        waves = (
            turns @ (resting * self._angle) / np.pi * np.sinc(order / (self.settings.order + 1.0))
        )
        waves[0] /= 2.0
        return np.concatenate([axis, waves.real, waves.imag])


def upright_frame(axis: Array) -> Array:
    """Return the rows u, v, axis (3, 3) of x, y, z turned so that z points along ``axis``.

    The turn is the smallest one. ``axis`` (3,) of any length, above the horizon.
    """
    axis = axis / np.linalg.norm(axis)
    x, y, z = axis
    return np.array(
        [
            [1.0 - x * x / (1.0 + z), -x * y / (1.0 + z), -x],
            [-x * y / (1.0 + z), 1.0 - y * y / (1.0 + z), -y],
            axis,
        ]
    )


def solid_angles(points: Array, triangles: Ints) -> Array:
    """Return the solid angles of triangles seen from the origin.

    By the formula of van Oosterom & Strackee (IEEE Trans. Biomed. Eng. 30, 1983).

    Parameters
    ----------
    points
        Corners (n, 3), in any unit of length.
    triangles
        Corners of each triangle (m, 3).

    Returns
    -------
    Array
        Solid angles (m,) [sr], positive where the corners run counter-clockwise seen from outside.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    la, lb, lc = (np.linalg.norm(p, axis=1) for p in (a, b, c))
    ab, bc, ca = (np.einsum("mx,mx->m", p, q) for p, q in ((a, b), (b, c), (c, a)))
    triple = np.einsum("mx,mx->m", a, np.cross(b, c))
    return np.asarray(2.0 * np.arctan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb))
