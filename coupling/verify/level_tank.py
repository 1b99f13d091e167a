"""Tanks of the slosh cases, as they lie: where a level surface and the points below it stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.shell.below_plane import Plane, section_samples, wetted_samples
from cloth.shell.meridian import Meridian
from cloth.shell.pieces import arc, line
from cloth.shell.sphere import Sphere
from coupling.finite_volume.geometry import fan_volume
from coupling.finite_volume.mesh import LiquidMesh
from coupling.interface.shell_arcs import ShellArcs, pool_middle
from coupling.ports import Array

RADIUS, GRAVITY, DENSITY = 0.4445, 9.81, 1000.0
BISECTIONS = 60
TIP = 1e-6  # half chord of the disc below which its end is one point

# Rows are the shell's x, y and z axes in those of the liquid, whose z is up.
UPRIGHT = np.eye(3)
LYING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]).T


@dataclass(frozen=True, kw_only=True)
class LevelTank:
    """A ``shell`` that lies in its ``frame`` (3, 3): rows are its axes in those of the liquid.

    The liquid's axes have the shell's origin, and z up. Points are (n, 3) [m], in those.
    ``lowest`` [m]: height of the tank's lowest point.
    """

    shell: Sphere | Meridian
    frame: Array
    lowest: float

    @property
    def size(self) -> float:
        """Radius [m] of the shell's rim."""
        return self.shell.size

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """``x`` (n, 3), what lies less than ``depth`` (n,) sizes inside moved to there."""
        return np.asarray(self.shell.confine(x @ self.frame.T, depth) @ self.frame)

    def on_rays(self, directions: Array) -> Array:
        """Where rays from the origin in ``directions`` (n, 3), of length 1, meet it (n, 3)."""
        return np.asarray(self.shell.on_rays(directions @ self.frame.T) @ self.frame)

    def surface(self, plan: Array, height: float) -> Array:
        """Points (n, 3) [m] of the surface at ``height`` [m], by those of a disc of radius 1.

        ``plan`` (n, 2). Lines along x stay such, and chords across them go to the surface's own: a
        long one's points do not shear. Points beyond the disc by a factor are so beyond the wall.
        """
        beyond = max(1.0, float(np.linalg.norm(plan, axis=1).max()))
        u, v = plan.T / beyond
        middle = np.array([[0.0, 0.0, height]])
        x = self._reach(np.broadcast_to(middle, (len(u), 3)), 0, np.sign(u)) * np.abs(u)
        x = x * np.sign(u)
        starts = np.stack([x, np.zeros_like(x), np.full_like(x, height)], axis=1)
        chord = np.sqrt(np.maximum(1.0 - u**2, 0.0))
        y = self._reach(starts, 1, np.ones_like(x)) * v / np.maximum(chord, 1e-300)
        y[chord < TIP] = 0.0
        return np.stack([beyond * x, beyond * y, np.full_like(x, height)], axis=1)

    def _reach(self, starts: Array, axis: int, side: Array) -> Array:
        """Distances (n,) [m] from ``starts`` (n, 3) to the wall along an axis, by ``side`` (n,)."""
        low, high = np.zeros(len(starts)), np.full(len(starts), 4.0 * max(self.shell.poles))
        way = np.zeros_like(starts)
        way[:, axis] = side
        for _ in range(BISECTIONS):
            tried = 0.5 * (low + high)
            inside = self.shell.gap((starts + tried[:, None] * way) @ self.frame.T) > 0.0
            low, high = np.where(inside, tried, low), np.where(inside, high, tried)
        return low

    def wetted(self, height: float, degree: int) -> tuple[Array, Array]:
        """Samples (n, 3) of the walls below ``height`` [m], their area vectors (n, 3) [m^2].

        For products of two polynomials of ``degree``, one times the normal.
        """
        points, area = wetted_samples(self.shell.profile, self._plane(height), degree)
        return points @ self.frame, area @ self.frame

    def volume_below(self, height: float) -> float:
        """Volume [m^3] below ``height`` [m], by the divergence theorem for x."""
        plane = self._plane(height)
        points, area = wetted_samples(self.shell.profile, plane, 2)
        _, size = section_samples(self.shell.profile, plane, 2)
        return float(np.sum(points * area) + height * size.sum()) / 3.0

    def _plane(self, height: float) -> Plane:
        return Plane(up=self.frame[:, 2], level=height)


def pill() -> Meridian:
    """The pill of ``RADIUS`` whose cylinder is twice that long: 2:1 in all."""
    quarter = 0.5 * np.pi
    return Meridian(
        [
            arc((0.0, -RADIUS), RADIUS, -quarter, 0.0),
            line((RADIUS, -RADIUS), (RADIUS, RADIUS)),
            arc((0.0, RADIUS), RADIUS, 0.0, quarter),
        ]
    )


def level_tank(name: str) -> LevelTank:
    """The ``sphere``, or the ``pill`` of 2:1, upright or as ``lying-pill`` its axis along x."""
    if name == "sphere":
        return LevelTank(shell=Sphere(RADIUS), frame=UPRIGHT, lowest=-RADIUS)
    lying = name == "lying-pill"
    frame, lowest = (LYING, -RADIUS) if lying else (UPRIGHT, -2.0 * RADIUS)
    return LevelTank(shell=pill(), frame=frame, lowest=lowest)


def level_shape(
    mesh: LiquidMesh, tank: LevelTank, height: float
) -> tuple[Array, Array, Array, float]:
    """Return where the points of a half ball's ``mesh`` stand below a level surface.

    All points lie a little off the shell, so that the polyhedron has the liquid's volume.

    Parameters
    ----------
    mesh
        The half ball's mesh.
    tank
        The tank.
    height
        Of the surface above the origin [m].

    Returns
    -------
    patch, shell, path : Array
        Points of the surface (p, 3) and of the wall (s, 3) [m]; how the former move up (p, 3) [-].
    volume : float
        Volume of the liquid [m^3].
    """
    disc = mesh.points[mesh.patch_points]
    azimuth = np.arctan2(disc[:, 1], disc[:, 0])
    patch = tank.surface(disc[:, :2], height)
    rim = np.flatnonzero(mesh.rim)
    rim = rim[np.argsort(azimuth[rim])]
    arcs = ShellArcs(mesh, rim, azimuth[rim])
    towards = patch[rim] / np.linalg.norm(patch[rim], axis=1)[:, None]
    shell = arcs.points(tank, pool_middle(towards), towards)
    path = np.zeros_like(patch)
    path[:, 2] = 1.0
    # The rim slides in the wall's facets, along the edge that comes up to it, and sweeps nothing.
    edge = patch[rim] - shell[arcs.below]
    path[rim] = edge / edge[:, 2:]
    points = np.zeros_like(mesh.points)
    points[mesh.patch_points], points[mesh.shell_points] = patch, shell
    volume = tank.volume_below(height)
    size = (volume / fan_volume(points[mesh.faces[mesh.inner_faces :]])) ** (1 / 3)
    return size * patch, size * shell, path, volume
