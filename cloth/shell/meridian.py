"""A surface of revolution by its meridian: lines and arcs in the half plane of r and z."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Array
from cloth.shell.below_plane import LEVEL, Plane, volume_under
from cloth.shell.kernels import nearest_points
from cloth.shell.part import ShellPart
from cloth.shell.pieces import (
    JOINT,
    check_smooth,
    piece_length,
    piece_points,
    share_below,
)

NEWTON = 60  # steps along a ray, at most; a sphere takes one
NODES = 24  # of Gauss's rule on a piece: a quarter circle's powers up to the tenth to rounding
BISECTIONS = 60  # of a share between 0 and 1
ROUNDING = 8.0 * np.finfo(float).eps  # of a distance from the shell, over its reach


class Meridian:
    """A shell (a ``Shell``) whose meridian consists of lines and arcs.

    ``pieces`` (k of (7,): ``line``, ``arc``) run from the lower pole to the upper one, both on the
    axis; they join without a kink, every ray from the origin meets the meridian once, and its
    height rises throughout. The rim is where it crosses z = 0. Raises ValueError where that is not
    so, rays and heights at ``SAMPLES`` places of each piece.
    """

    def __init__(self, pieces: Sequence[Array]) -> None:
        self.profile: Array = np.array(pieces)
        starts, ends = self.profile[:, :2], self.profile[:, 2:4]
        allowed = JOINT * float(np.abs(self.profile[:, :4]).max())
        if np.abs(starts[1:] - ends[:-1]).max(initial=0.0) > allowed:
            raise ValueError("meridian: every piece must start where the one before ends.")
        if max(abs(starts[0, 0]), abs(ends[-1, 0])) > allowed:
            raise ValueError("meridian: its ends must lie on the axis, r = 0.")
        self.poles = float(starts[0, 1]), float(ends[-1, 1])
        if not self.poles[0] < 0.0 < self.poles[1]:
            raise ValueError(
                "meridian: its ends must lie below and above z = 0, the rim's plane, "
                f"got {self.poles}."
            )
        check_smooth(self.profile)
        self._lengths = np.array([piece_length(piece) for piece in self.profile])
        self._below_rim = self._length_to(0.0)
        self.size = float(self.along(np.zeros(1))[0][0])
        self._reach = float(np.hypot(*self.profile[:, [[0, 2], [1, 3]]].swapaxes(0, 1)).max())
        self._reach += float(np.abs(self.profile[:, 6]).max())

    def _nearest(self, x: Array) -> tuple[Array, Array, Array]:
        """Nearest points (n, 3), their normals (n, 3), how far ``x`` (n, 3) is beyond them (n,)."""
        place, normal, beyond = np.empty_like(x), np.empty_like(x), np.empty(len(x))
        nearest_points(self.profile, np.ascontiguousarray(x), place, normal, beyond)
        return place, normal, beyond

    def gap(self, x: Array) -> Array:
        """Return the distance (n,) [m] of ``x`` (n, 3) [m] from the shell, below 0 outside."""
        return -self._nearest(x)[2]

    def normal(self, x: Array) -> Array:
        """Return outward unit normals (n, 3) where the shell is nearest to ``x`` (n, 3) [m]."""
        return self._nearest(x)[1]

    def project(self, x: Array) -> Array:
        """Return the shell's nearest points (n, 3) [m] to ``x`` (n, 3) [m]."""
        return self._nearest(x)[0]

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """Return points moved to a depth inside the shell where they lie less deep.

        Parameters
        ----------
        x
            Points (n, 3) [m].
        depth
            Least depth over the shell's ``size`` (n,) [-].

        Returns
        -------
        Array
            The points (n, 3) [m].
        """
        place, normal, beyond = self._nearest(x)
        depth = np.broadcast_to(depth, beyond.shape) * self.size
        inner = place - depth[:, None] * normal
        return np.where((beyond > -depth)[:, None], inner, x)

    def share_within(self, start: Array, shift: Array) -> float:
        """Return the largest share of a shift that keeps all points inside.

        Of a convex shell; of another the first bisection's choice among several.

        Parameters
        ----------
        start
            Points (k, 3) [m], inside the shell.
        shift
            The shift of all of them (3,) [m].

        Returns
        -------
        float
            Share in [0, 1].
        """
        low, high = 0.0, 1.0
        if self.gap(start + shift).min() >= 0.0:
            return 1.0
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            inside = self.gap(start + middle * shift).min() >= 0.0
            low, high = (middle, high) if inside else (low, middle)
        return low

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Return the meridian's radius and height (n,) [m] at ``arc`` (n,) [m] above the rim.

        ``arc`` is measured along the meridian.
        """
        ends = np.cumsum(self._lengths)
        place = np.clip(arc + self._below_rim, 0.0, ends[-1])
        piece = np.minimum(np.searchsorted(ends, place), len(ends) - 1)
        share = (place - (ends - self._lengths)[piece]) / self._lengths[piece]
        r, z, _, _ = piece_points(self.profile[piece], share)
        return r, z

    def arc_to(self, height: float) -> float:
        """Return the arc length [m] from the rim up to ``height`` [m], the reverse of ``along``."""
        return self._length_to(height) - self._below_rim

    def _length_to(self, height: float) -> float:
        """Arc length [m] from the lower pole up to ``height`` [m]."""
        return float(sum(share * piece_length(piece) for piece, share in self._below(height)))

    def _below(self, height: float) -> Iterator[tuple[Array, float]]:
        """The pieces (7,) that begin below ``height`` [m], and their shares that lie below it."""
        for piece in self.profile:
            if piece[1] < height:
                yield piece, share_below(piece, height) if piece[3] > height else 1.0

    def _samples(self, height: float, nodes: int) -> tuple[Array, Array, Array, Array, Array]:
        """Gauss's points of the meridian below ``height`` [m]: r, z, the normal's parts, ds."""
        node, weight = np.polynomial.legendre.leggauss(nodes)
        parts = [(np.zeros(0),) * 5] + [
            (*piece_points(np.tile(piece, (nodes, 1)), 0.5 * share * (1.0 + node)),
             0.5 * share * piece_length(piece) * weight)
            for piece, share in self._below(height)
        ]  # fmt: skip
        r, z, nr, nz, ds = (np.concatenate(column) for column in zip(*parts, strict=True))
        return r, z, nr, nz, ds

    @property
    def volume(self) -> float:
        """Volume of the whole inside [m^3]."""
        return self.volume_below(self.poles[1])

    def volume_below(self, height: float) -> float:
        """Return the volume [m^3] inside, below the plane z = ``height`` [m]."""
        r, _, nr, _, ds = self._samples(height, NODES)
        return math.pi * float(np.sum(r * r * nr * ds))

    def moment_below(self, height: float) -> float:
        """Return int z dV [m^4] over the inside below the plane z = ``height`` [m]."""
        r, z, nr, _, ds = self._samples(height, NODES)
        return math.pi * float(np.sum(r * r * z * nr * ds))

    def level_of(self, volume: float, up: Array) -> float:
        """Return the height [m] above the origin, along ``up`` (3,), of a level liquid's surface.

        ``volume`` [m^3], from 0 to the shell's.
        """
        up = up / np.linalg.norm(up)

        def excess(level: float) -> float:
            return self._volume_under(Plane(up=up, level=level)) - volume

        return float(brentq(excess, -self._reach, self._reach, xtol=1e-15 * self._reach))

    def _volume_under(self, plane: Plane) -> float:
        """Volume [m^3] inside, below a plane however it lies."""
        if plane.lean > LEVEL:
            return volume_under(self.profile, plane)
        below = self.volume_below(plane.level / float(plane.up[2]))
        return below if plane.up[2] > 0.0 else self.volume - below

    def on_rays(self, directions: Array) -> Array:
        """Return where rays from the origin meet the shell (n, 3) [m].

        ``directions`` (n, 3): unit vectors along the rays. By Newton's method along each ray from
        outside: the distance from a convex shell is convex along it, so that no step passes the
        shell. Raises ArithmeticError where rays of another have not met it.
        """
        reach = np.full(len(directions), self._reach)
        for _ in range(NEWTON):
            _, normal, beyond = self._nearest(reach[:, None] * directions)
            step = beyond / np.einsum("nx,nx->n", normal, directions)
            reach -= step
            if np.abs(step).max() <= ROUNDING * self._reach:
                return np.asarray(reach[:, None] * directions)
        raise ArithmeticError(f"meridian: rays have not met the shell in {NEWTON} steps.")

    def scaled(self, factor: float) -> Meridian:
        """Return the shell ``factor`` times as large, about the origin."""
        return Meridian(list(factor * self.profile))

    def quadrature(self, degree: int, height: float = 0.0) -> tuple[Array, Array]:
        """Return points (n, 3) [m] below z = ``height`` [m] and their outward areas (n, 3) [m^2].

        For products of two polynomials of ``degree``, one times the normal: exact around, to
        rounding along an arc of a quarter circle or less.
        """
        count = 2 * (degree + 1)
        r, z, nr, nz, ds = self._samples(height, 2 * degree + NODES)
        angle = 2.0 * np.pi * np.arange(count) / count
        around = np.stack([np.cos(angle), np.sin(angle), np.ones(count)], axis=1)
        points = np.stack([r, r, z], axis=1)[:, None] * around
        size = (2.0 * np.pi / count) * r * ds
        area = (size[:, None] * np.stack([nr, nr, nz], axis=1))[:, None] * around
        return points.reshape(-1, 3), area.reshape(-1, 3)

    def upper_part(self) -> ShellPart:
        """Return the mould of a sheet that lies on the shell above the rim."""
        return ShellPart(self)

    def lower_part(self) -> ShellPart:
        """Return the mould of a sheet that lies on the shell below the rim."""
        return ShellPart(self, below=True)
