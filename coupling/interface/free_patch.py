"""The flow's boundary as it follows the diaphragm: points on the free part, a rim on the shell.

The patch ``diaphragm`` of the half ball lies on the free part of the sheet. Every one of its points
keeps its place between the middle of the free part and the contact curve, in the moulded shape, so
that it slides through the sheet as the curve moves; a step's map holds it where it will be. Where
the sheet is creased more sharply than the patch can follow, the patch cuts the crease off. The rim
is the contact curve brought onto the shell. The shell's points lie on arcs from the pool's middle
to the rim. Facets inscribed in the shell hold less than it does, by a share that changes with their
places: shell and rim are put as far out, in every step, as makes up for it, so that the patch may
lie where the sheet does. Where points slide along, nothing moves the liquid.

Where the sheet is smooth the map is of second order, so that waves are not flattened; in creases,
and beside the rim, where the sheet turns off the shell, it takes means, which never overshoot. What
the map of a step is, and how it keeps volumes, says ``patch_map``.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.optimize import brentq

from coupling.finite_volume.geometry import face_centres_and_areas, fan_volume
from coupling.finite_volume.mesh import LiquidMesh
from coupling.interface.contact_curve import ContactSearch, FreePart
from coupling.interface.creases import give_way, least_sine, means
from coupling.interface.liquid_shape import volume_below
from coupling.interface.patch_map import Lift, PatchMap, node_area, patch_area
from coupling.interface.patch_settings import PatchSettings
from coupling.interface.shell_arcs import ShellArcs, pool_middle
from coupling.interface.weights import Sources, moving_least_squares, moving_quadratics
from coupling.ports import Array, Cause, Shell, StepFailed, Structure, StructureState

_SIZES = 0.9, 1.2  # of the shell's points: inscribed facets stand out by some hundredths at most


class FreePatch:
    """Map from ``sheet`` to the patch of ``mesh`` in a ``shell``.

    ``moulded`` (n, 3): directions of the sheet's nodes on the unit hemisphere of its mould's chart;
    ``stretch``: length of the mould's meridian over that of a hemisphere on its rim.
    """

    def __init__(
        self,
        mesh: LiquidMesh,
        sheet: Structure,
        *,
        shell: Shell,
        moulded: Array,
        stretch: float = 1.0,
        settings: PatchSettings | None = None,
    ) -> None:
        self.settings, self._stretch = settings or PatchSettings(), stretch
        self.mesh, self.shell = mesh, shell
        self._triangles, self._nodes = sheet.triangles, Sources(moulded)
        self._search = ContactSearch(moulded, sheet.triangles, sheet.fixed, shell)
        disc = mesh.points[mesh.patch_points]
        self._reach = np.linalg.norm(disc[:, :2], axis=1)
        self._azimuth = np.arctan2(disc[:, 1], disc[:, 0])
        rim = np.flatnonzero(mesh.rim)
        self._rim = rim[np.argsort(self._azimuth[rim])]
        self._arcs = ShellArcs(mesh, self._rim, self._azimuth[self._rim])
        faces, count = mesh.patch_faces, len(disc)
        self._around = means(faces.ravel(), np.repeat(np.arange(len(faces)), 4), count)
        edges = np.concatenate([faces[:, [k, (k + 1) % 4]] for k in range(4)])
        edges = np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)
        self._others = np.searchsorted(edges[:, 0], np.arange(count + 1)), edges[:, 1]
        self._inside = ~mesh.rim  # and no neighbour of the rim, where the sheet turns off the shell
        self._inside[edges[mesh.rim[edges[:, 1]], 0]] = False
        self.map: PatchMap | None = None  # of the last step begun

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> PatchMap:
        """The map of a step of ``dt`` [s] from ``state``.

        It is that of the sheet at ``nodes`` (n, 3) [m], as far as they lie in the shell.
        """
        s, tank = self.settings, self.shell
        nodes = tank.confine(nodes)
        free = self._search.free_part(nodes, dt)
        edge = free.edge(self._azimuth)
        moulded = free.directions(self._reach * edge, self._azimuth)
        weights = self._weights(moulded, nodes)
        points = weights @ nodes
        points[self._rim] = tank.project(points[self._rim])
        rim = points[self._rim] / np.linalg.norm(points[self._rim], axis=1)[:, None]
        weights[self._rim] = 0.0
        self._round(points, weights)
        depth = np.minimum(s.film, s.wedge * self._stretch * (1.0 - self._reach) * edge)
        points = np.where(self.mesh.rim[:, None], points, tank.confine(points, depth))
        shell = self._arcs.points(tank, pool_middle(rim), rim)
        size = self._size(points, shell, volume_below(nodes, self._triangles, tank))
        points[self._rim] *= size
        shell *= size
        faces = moulded[self.mesh.patch_faces].mean(axis=1)
        self.map = PatchMap(
            shell=shell,
            nodes=nodes,
            weights=weights,
            offset=points - weights @ nodes,
            lift=self._lift(nodes, points, shell, weights, moulded, free),
            face_directions=faces / np.linalg.norm(faces, axis=1)[:, None],
            node_directions=free.within(self._nodes.points, s.inset),
            support=s.linear,
        )
        return self.map

    def _size(self, points: Array, shell: Array, volume: float) -> float:
        """Factor on the shell's points and the rim with which the liquid's outline holds a volume.

        ``points`` (p, 3), ``shell`` (s, 3) [m]; the ``volume`` [m^3] is met to rounding.
        """
        mesh, outline = self.mesh, np.empty_like(self.mesh.points)
        rim = mesh.patch_points[self._rim]

        def excess(size: float) -> float:
            outline[mesh.patch_points], outline[mesh.shell_points] = points, size * shell
            outline[rim] = size * points[self._rim]
            return fan_volume(outline[mesh.faces[mesh.inner_faces :]]) / volume - 1.0

        least, most = _SIZES
        if excess(least) * excess(most) > 0.0:
            raise StepFailed(
                "the flow's patch, as fine as it is, cannot follow the diaphragm: with it no "
                "outline of the liquid near the shell holds its volume.",
                cause=Cause.MESH,
            )
        return float(brentq(excess, least, most, xtol=1e-14))

    def _weights(self, moulded: Array, nodes: Array) -> Array:
        """Weights (p, n) of the points ``moulded`` (p, 3) on a sheet at ``nodes`` (n, 3) [m]."""
        s = self.settings
        beside = self._nodes.beside(moulded, s.quadratic, s.linear)
        weights = moving_quadratics(beside, s.quadratic)
        flat = (self._flatness(weights @ nodes) - s.flat) / (s.smooth - s.flat)
        sharp = np.where(self._inside, np.clip(flat, 0.0, 1.0), 0.0)
        plain = moving_least_squares(beside, s.linear)
        return np.asarray(plain + sharp[:, None] * (weights - plain))

    def _round(self, points: Array, weights: Array) -> None:
        """Round sharp creases of ``points`` (p, 3) [m], and of the ``weights`` (p, n) with them.

        A point gives way to the mean of its neighbours, the more the sharper the crease, or a
        corner of a face where the bottom of a crease has been pressed together.
        """
        s = self.settings
        for turn in range(s.more):
            corners, normal = points[self.mesh.patch_faces], self._normals(points)
            flat = np.linalg.norm(self._around @ normal, axis=1)
            share = np.clip(
                (s.flat - flat) / (s.flat - s.creased), 0.0, 1.0 if turn < s.rounds else 0.0
            )
            least = np.ones(len(points))
            np.minimum.at(least, self.mesh.patch_faces, least_sine(corners, normal)[:, None])
            corner = np.clip((s.open - least) / (s.open - s.sharp), 0.0, 1.0)
            share = np.maximum(share, corner) ** 2
            creased = np.flatnonzero(np.where(self.mesh.rim, 0.0, share))
            if len(creased) == 0:
                break
            for values in (weights, points):
                give_way(values, creased, share, *self._others)

    def _normals(self, points: Array) -> Array:
        """Unit normals (F, 3) of the faces with the patch's ``points`` (p, 3) [m]."""
        normal = face_centres_and_areas(points[self.mesh.patch_faces])[1]
        return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])

    def _flatness(self, points: Array) -> Array:
        """Size (p,) of the mean normal round each of ``points`` (p, 3) [m]: 1, less at a crease."""
        return np.asarray(np.linalg.norm(self._around @ self._normals(points), axis=1))

    def save(self) -> dict[str, Array]:
        """What of the map a former step has left."""
        return {"contact": self._search.save()}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""
        self._search.restore(saved["contact"])

    def _lift(
        self,
        nodes: Array,
        points: Array,
        shell: Array,
        weights: Array,
        moulded: Array,
        free: FreePart,
    ) -> Lift:
        """How the points ``moulded`` (p, 3) of a map of ``weights`` (p, n) rise.

        ``nodes`` (n, 3), ``points`` (p, 3) and ``shell`` (s, 3) [m] are where all will be. A point
        inside rises along its normal, one on the rim along the edge that comes up to it, so that
        the shell's facets sweep nothing. A node's volume goes to the points from whose values its
        own would be interpolated, so that the volumes' first moments are kept as well.
        """
        area, inside = patch_area(points, self.mesh.patch_faces), ~self.mesh.rim
        way = area.copy()
        way[self._rim] = points[self._rim] - shell[self._arcs.below]
        way /= np.linalg.norm(way, axis=1)[:, None]
        linear = self.settings.linear
        within = Sources(moulded).beside(free.within(self._nodes.points, 1.0), linear)
        size = np.linalg.norm(area, axis=1)
        flattest = self.settings.steep * size
        flattest[inside] = self.settings.smallest * np.median(size[inside])
        return Lift(
            way=way,
            opened=np.maximum(np.einsum("px,px->p", area, way), flattest),
            missed=node_area(nodes, self._triangles) - weights.T @ area,
            shares=moving_least_squares(within, linear),
        )

    def to_nodes(self, values: Array) -> Array:
        """Values (n, k) at the nodes of ``values`` (F, k) on the patch's faces, in the last map."""
        assert self.map is not None, "begin_step comes first"
        return self.map.to_nodes(values)
