"""The flow's boundary as it follows the diaphragm: points on the free part, a rim on the shell.

The patch ``diaphragm`` of the half ball lies on the free part of the sheet. Every one of its points
keeps its place between the middle of the free part and the contact curve, in the moulded shape, so
that it slides through the sheet as the curve moves; a step's map holds it where it will be. Where
the sheet is creased more sharply than the patch can follow, the patch cuts the crease off. The rim
is the contact curve brought onto the shell. The shell's points lie on arcs from the pool's middle
to the rim. Only swept volumes matter to the flow: where points slide along, nothing is swept.

Where the sheet is smooth the map is of second order, so that waves are not flattened; in creases,
and beside the rim, where the sheet turns off the shell, it takes means, which never overshoot.
Interpolation alone would lose volume where the patch is coarser than the sheet's waves, and all of
it in the strip between a fixed rim and the points next to it. Within a step every node therefore
displaces exactly the volume that its own triangles sweep: what interpolation misses lifts the patch
beside it, and at the rim climbs the shell. In return a node bears the pressure on its own area.
Only where faces are pressed together, at the bottom of a crease, is it less of both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import csr_array

from coupling.finite_volume.geometry import face_centres_and_areas, fan_volume
from coupling.finite_volume.mesh import LiquidMesh, shell_shares
from coupling.finite_volume.swept import cross, swept_gradient
from coupling.interface.contact_curve import ContactSearch
from coupling.interface.creases import give_way, least_sine
from coupling.interface.liquid_shape import liquid_cg
from coupling.interface.mapping import moving_least_squares, moving_quadratics
from coupling.ports import Array, Ints, Structure, StructureState

WEDGE = math.tan(math.radians(15.0))  # least slope of the liquid's edge
STEEP = 0.25  # sine of the least angle at which the rim opens the liquid, about the wedge's
SMALLEST = 0.5  # over the median inside: area that a point inside has to be lifted by, at least
FILM = 0.02  # over R: the wedge's greatest depth
LOW = 0.3  # weight of the lowest point in the pool's middle, over its offset in radii
ROUNDS, MORE = 20, 60  # of smoothing, at most; that of corners goes on to more
# Mean normal round a point: where the map is no longer of second order, where it is of first and
# rounding sets in, where that is full.
SMOOTH, FLAT, CREASED = 0.997, 0.99, 0.9
OPEN, SHARP = 0.5, 0.2  # least sine of the corners round a point: likewise
INSET = 0.95  # of the contact curve, beyond which nodes have the pressure at its edge


class FreePatch:
    """Map from ``sheet`` to the patch of ``mesh`` in a shell of ``radius`` [m]."""

    def __init__(self, mesh: LiquidMesh, sheet: Structure, *, radius: float) -> None:
        self.mesh, self.radius = mesh, radius
        self._triangles, self._moulded = sheet.triangles, sheet.reference / radius
        self._search = ContactSearch(sheet.reference, sheet.triangles, sheet.fixed, radius)
        disc, wall = mesh.points[mesh.patch_points], mesh.points[mesh.shell_points]
        self._reach = np.linalg.norm(disc[:, :2], axis=1)
        self._azimuth = np.arctan2(disc[:, 1], disc[:, 0])
        self._wall_reach = np.arccos(np.clip(-wall[:, 2], -1.0, 1.0)) / (0.5 * np.pi)
        self._wall_azimuth = np.arctan2(wall[:, 1], wall[:, 0])
        rim = np.flatnonzero(mesh.rim)
        self._rim = rim[np.argsort(self._azimuth[rim])]
        faces, count = mesh.patch_faces, len(disc)
        self._around = _means(faces.ravel(), np.repeat(np.arange(len(faces)), 4), count)
        edges = np.concatenate([faces[:, [k, (k + 1) % 4]] for k in range(4)])
        edges = np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)
        self._others = np.searchsorted(edges[:, 0], np.arange(count + 1)), edges[:, 1]
        self._inside = ~mesh.rim  # and no neighbour of the rim, where the sheet turns off the shell
        self._inside[edges[mesh.rim[edges[:, 1]], 0]] = False
        self._below = _below(mesh)[self._rim]
        self.size = 1.0  # of the polyhedron that stands for the shell, over R

    def fit(self, state: StructureState, volume: float) -> None:
        """Take the size with which the polyhedron holds ``volume`` [m^3] below ``state``."""
        outline = np.zeros_like(self.mesh.points)

        def excess(size: float) -> float:
            self.size = size
            outline[self.mesh.shell_points] = self.begin_step(state, 0.0, state.position)
            outline[self.mesh.patch_points] = self.to_flow(state.position)
            return fan_volume(outline[self.mesh.faces[self.mesh.inner_faces :]]) / volume - 1.0

        self.size = brentq(excess, 0.9, 1.2, xtol=1e-15)

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> Array:
        """Take the map of a step of ``dt`` [s] from ``state``; the shell's points (s, 3) [m].

        It is that of the sheet at ``nodes`` (n, 3) [m], as far as they lie in the shell.
        """
        distance = np.linalg.norm(nodes, axis=1)[:, None]
        nodes = nodes * np.minimum(1.0, self.radius / np.maximum(distance, 1e-30))
        self._values: Array | None = None
        self.free = self._search.free_part(nodes, dt)
        edge = self.free.edge(self._azimuth)
        self.moulded = self.free.directions(self._reach * edge, self._azimuth)
        self.weights = moving_quadratics(self._moulded, self.moulded)
        flat = (self._flatness(self.weights @ nodes) - FLAT) / (SMOOTH - FLAT)
        sharp = np.where(self._inside, np.clip(flat, 0.0, 1.0), 0.0)
        plain = moving_least_squares(self._moulded, self.moulded)
        self.weights = plain + sharp[:, None] * (self.weights - plain)
        points = self.weights @ nodes
        rim = points[self._rim] / np.linalg.norm(points[self._rim], axis=1)[:, None]
        points[self._rim] = self.size * self.radius * rim
        self.weights[self._rim] = 0.0
        self._round(points)
        depth = np.minimum(FILM, WEDGE * (1.0 - self._reach) * edge)
        most = (1.0 - depth) * self.radius / np.linalg.norm(points, axis=1)
        points[~self.mesh.rim] *= np.minimum(1.0, most)[~self.mesh.rim, None]
        self._offset = points - self.weights @ nodes
        centre = liquid_cg(nodes, self._triangles, self.radius, state.volume) / self.radius
        shell = self._wall(centre - [0.0, 0.0, LOW], rim)
        self._let_lift(nodes, points, shell)
        return shell

    def _round(self, points: Array) -> None:
        """Round sharp creases of ``points`` (p, 3) [m], and of the weights with them.

        A point gives way to the mean of its neighbours, the more the sharper the crease, or a
        corner of a face where the bottom of a crease has been pressed together.
        """
        for turn in range(MORE):
            corners, normal = points[self.mesh.patch_faces], self._normals(points)
            flat = np.linalg.norm(self._around @ normal, axis=1)
            share = np.clip((FLAT - flat) / (FLAT - CREASED), 0.0, 1.0 if turn < ROUNDS else 0.0)
            least = np.ones(len(points))
            np.minimum.at(least, self.mesh.patch_faces, least_sine(corners, normal)[:, None])
            share = np.maximum(share, np.clip((OPEN - least) / (OPEN - SHARP), 0.0, 1.0)) ** 2
            creased = np.flatnonzero(np.where(self.mesh.rim, 0.0, share))
            if len(creased) == 0:
                break
            for values in (self.weights, points):
                give_way(values, creased, share, *self._others)

    def _normals(self, points: Array) -> Array:
        """Unit normals (F, 3) of the faces with the patch's ``points`` (p, 3) [m]."""
        normal = face_centres_and_areas(points[self.mesh.patch_faces])[1]
        return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])

    def _flatness(self, points: Array) -> Array:
        """Size (p,) of the mean normal round each of ``points`` (p, 3) [m]: 1, less at a crease."""
        return np.asarray(np.linalg.norm(self._around @ self._normals(points), axis=1))

    def _wall(self, middle: Array, rim: Array) -> Array:
        """Points (s, 3) [m] of the shell on arcs from the pool's middle to ``rim`` (r, 3)."""
        azimuth = self._azimuth[self._rim]
        turn = np.concatenate([azimuth[-1:] - 2 * np.pi, azimuth, azimuth[:1] + 2 * np.pi])
        closed = np.concatenate([rim[-1:], rim, rim[:1]])
        end = np.stack([np.interp(self._wall_azimuth, turn, closed[:, k]) for k in range(3)], 1)
        end /= np.linalg.norm(end, axis=1)[:, None]
        middle = middle / np.linalg.norm(middle)
        arc = np.arccos(np.clip(end @ middle, -1.0, 1.0))
        reach, arc = shell_shares(self._wall_reach, arc)[:, None], arc[:, None]
        wall = np.sin((1.0 - reach) * arc) * middle + np.sin(reach * arc) * end
        return np.asarray(self.size * self.radius * wall / np.sin(arc))

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) of cloth nodes (n, 3), in the step's map."""
        missed = np.einsum("nx,nx->n", self._missed, nodes - self._ahead)
        lift = (self._shares.T @ missed) / self._opened
        points: Array = self.weights @ nodes + self._offset + lift[:, None] * self._way
        return points

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""
        nodal: Array = self.rows_to_cloth(force[None])[0]
        return nodal

    def rows_to_cloth(self, rows: Array) -> Array:
        """Rows (r, n, 3) on cloth nodes of rows (r, p, 3) on flow points."""
        flat = rows.transpose(1, 0, 2).reshape(len(self.weights), -1)  # one large product
        through = (self.weights.T @ flat).reshape(-1, len(rows), 3).transpose(1, 0, 2)
        pressure = np.einsum("rpx,px->rp", rows, self._way) / self._opened
        own = (pressure @ self._shares.T)[:, :, None] * self._missed
        return np.ascontiguousarray(through + own)

    def save(self) -> dict[str, Array]:
        """What of the map a former step has left."""
        return {"contact": self._search.smooth.save()}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are left alone."""
        self._search.smooth.restore(saved["contact"])

    def _let_lift(self, nodes: Array, points: Array, shell: Array) -> None:
        """Let the patch rise by the volume that interpolation misses of the sheet's.

        ``nodes`` (n, 3), ``points`` (p, 3) and ``shell`` (s, 3) [m] are where all will be. A point
        inside rises along its normal, one on the rim along the edge that comes up to it, so that
        the shell's facets sweep nothing. A node's volume goes to the points from whose values its
        own would be interpolated, so that the volumes' first moments are kept as well.
        """
        area, own = np.zeros_like(points), np.zeros_like(nodes)
        np.add.at(area, self.mesh.patch_faces, swept_gradient(points[self.mesh.patch_faces]))
        a, b, c = (nodes[self._triangles[:, k]] for k in range(3))
        np.add.at(own, self._triangles, (cross(b - a, c - a) / 6.0)[:, None])
        way = area.copy()
        way[self._rim] = points[self._rim] - shell[self._below]
        self._way = way / np.linalg.norm(way, axis=1)[:, None]
        flattest = STEEP * np.linalg.norm(area, axis=1)
        flattest[~self.mesh.rim] = SMALLEST * np.median(
            np.linalg.norm(area[~self.mesh.rim], axis=1)
        )
        self._opened = np.maximum(np.einsum("px,px->p", area, self._way), flattest)
        self._missed = own - self.weights.T @ area
        self._shares = moving_least_squares(self.moulded, self.free.within(self._moulded, 1.0))
        self._ahead = nodes

    def to_nodes(self, values: Array) -> Array:
        """Values (n,) at the nodes of ``values`` (F,) on the patch's faces, in the step's map.

        Where the sheet lies on the shell they are those of the contact curve beside it.
        """
        if self._values is None:
            centre = self.moulded[self.mesh.patch_faces].mean(axis=1)
            centre /= np.linalg.norm(centre, axis=1)[:, None]
            self._values = moving_least_squares(centre, self.free.within(self._moulded, INSET))
        return self._values @ values


def _means(points: Ints, others: Ints, count: int) -> csr_array:
    """Matrix (count, k) that gives every one of ``points`` the mean over its ``others``."""
    share = 1.0 / np.bincount(points, minlength=count)[points]
    return csr_array((share, (points, others)))


def _below(mesh: LiquidMesh) -> Ints:
    """For every one of ``mesh.patch_points`` on the rim the shell's point, in the numbering of
    ``mesh.shell_points``, that an edge joins to it; -1 for the others."""
    ends = np.concatenate([mesh.edges, mesh.edges[:, ::-1]])
    rim = mesh.patch_points[mesh.rim]
    ends = ends[np.isin(ends[:, 0], rim) & np.isin(ends[:, 1], mesh.shell_points)]
    below = np.full(len(mesh.patch_points), -1)
    below[np.searchsorted(mesh.patch_points, ends[:, 0])] = np.searchsorted(
        mesh.shell_points, ends[:, 1]
    )
    return below
