"""Small rigid motions of a scan in the tank's frame, and which of them a surface determines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from coupling.ports import Array
from coupling.scans.sheet import Matches, Sheet

_UNKNOWN = 0.1  # part of an axis along unknown motions, beyond which it is not known
AXES = ("shift_x", "shift_y", "shift_z", "tilt_x", "tilt_y", "azimuth")


@dataclass(frozen=True, kw_only=True)
class Pose:
    """A rigid motion x -> R x + t: ``rotation`` R (3, 3), ``shift`` t (3,) [m]."""

    rotation: Array
    shift: Array

    @classmethod
    def turned(cls, azimuth: float) -> Pose:
        """Return the rotation about the tank's axis, from x to y [rad]."""
        return cls(
            rotation=Rotation.from_rotvec([0.0, 0.0, azimuth]).as_matrix(), shift=np.zeros(3)
        )

    def moved(self, points: Array) -> Array:
        """Return ``points`` (p, 3) [m], moved."""
        found: Array = points @ self.rotation.T + self.shift
        return found

    def then(self, motion: Array, size: float) -> Pose:
        """Return this pose followed by a small ``motion`` (6,) [m], see ``rates``."""
        turn = Rotation.from_rotvec(motion[3:] / size).as_matrix()
        return Pose(rotation=turn @ self.rotation, shift=turn @ self.shift + motion[:3])

    @property
    def azimuth(self) -> float:
        """Rotation about the tank's axis [rad] in (-pi, pi], before the tilt."""
        _, _, z, w = Rotation.from_matrix(self.rotation).as_quat()
        return float((2.0 * np.arctan2(z, w) + np.pi) % (2.0 * np.pi) - np.pi)

    @property
    def tilt(self) -> Array:
        """Rotation about a horizontal axis after that about the tank's: vector (2,) [rad]."""
        level = Rotation.from_matrix(self.rotation @ Pose.turned(self.azimuth).rotation.T)
        found: Array = level.as_rotvec()[:2]
        return found


def rates(points: Array, ways: Array, size: float) -> Array:
    """Return how a quantity of each point grows with a small motion of all of them.

    Parameters
    ----------
    points
        Points (p, 3) [m].
    ways
        Gradient of the quantity with the point's place (p, 3) [1/m of its unit].
    size
        Length [m] by which rotations become lengths, the rim's radius.

    Returns
    -------
    Array
        Rates (p, 6) [1/m of its unit] with the shift (x, y, z) and with the rotation about the
        tank's centre (x, y, z), times ``size``.
    """
    return np.concatenate([ways, np.cross(points, ways) / size], axis=1)


def determined(sheet: Sheet, matches: Matches, points: Array, size: float) -> Array:
    """Return a basis (6, k) of the motions of which the surface at these points shows something.

    A sphere that turns about its centre and a level surface that moves sideways stay where they
    are; a grid of triangles that stands for them does not, by as much as its normals differ from
    the smooth surface's. So of each principal motion the mean square speed along the smooth normals
    has to exceed that along the difference, or nothing is known of it.
    """
    inside = ~matches.beyond
    at, smooth = points[inside], sheet.smooth_normal(matches)[inside]
    faces = sheet.normal[matches.triangle[inside]]
    _, motions = np.linalg.eigh(_squares(rates(at, faces, size)))
    shown = _squares(rates(at, smooth, size))
    feigned = _squares(rates(at, faces - smooth, size))
    known = [motion for motion in motions.T if motion @ shown @ motion > motion @ feigned @ motion]
    return np.array(known).reshape(-1, 6).T


def names_known(basis: Array) -> dict[str, bool]:
    """Whether each of the six ``AXES`` lies in the span of a ``basis`` (6, k) of the known motions.

    An axis of which a tenth points along a motion of which nothing is known is not known either.
    """
    return {
        name: bool(row @ row > 1.0 - _UNKNOWN**2) for name, row in zip(AXES, basis, strict=True)
    }


def _squares(values: Array) -> Array:
    found: Array = values.T @ values / len(values)
    return found
