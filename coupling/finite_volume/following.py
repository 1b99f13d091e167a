"""The liquid's mesh as it follows its boundary: outline imposed, volume closed, quality watched."""

from __future__ import annotations

import logging

import numpy as np

from coupling.finite_volume.elastic_mesh import ElasticMesh, MeshFolds
from coupling.finite_volume.geometry import (
    CellGeometry,
    cell_geometry,
    fan_volume,
    non_orthogonality,
    swept_volumes,
)
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.mesh_shape import MeshShape
from coupling.finite_volume.swept import level_shift
from coupling.ports import Array, Cause, Confinement, Ints, RunFailed, StepFailed, Turn

SKEWED = 75.0  # degrees of non-orthogonality beyond which the mesh is made anew
BETTER = 5.0  # degrees that a new mesh must gain
# Over the shell's size: least depth below the shell; it rises so from the patch's rim.
DEPTH, EDGE = 0.01, 0.1

_log = logging.getLogger(__name__)


class FollowingMesh:
    """Points of ``mesh`` in a tank's shell: the shapes ``committed`` and ``now``.

    In the tank's axes; ``begun`` is the committed shape in those at the end of the step.

    The boundary's points are imposed, those inside relax from where they were. A mesh that folds
    or gets skewed is made anew from the reference. That needs no interpolation of the fields: the
    cells keep their neighbours, and what they sweep on their way to their new places the solver
    carries over, as it does of any motion, with mass and momentum conserved to rounding.
    """

    def __init__(self, mesh: LiquidMesh, tank: Confinement) -> None:
        self.mesh, self.tank = mesh, tank
        self._boundary: Ints = mesh.faces[mesh.inner_faces :]
        self._elastic = ElasticMesh(mesh, tank.size)
        self._reference = tank.size * mesh.points
        reach = np.linalg.norm(mesh.points[mesh.patch_points][:, :2], axis=1)
        self._depth = np.minimum(DEPTH, EDGE * (1.0 - reach))
        self._fan, self._size = fan_volume(self._reference[self._boundary]), 1.0
        self.committed = self.now = self.begun = self._shape(self._reference)
        self.shell = self._reference[mesh.shell_points]  # (s, 3) [m] of the step
        self.volume = float(self.committed.geometry.volume.sum())  # [m^3] at the start
        self._base: Array | None = None  # the step's mesh; later iterations follow it linearly

    def raised(self, shell: Array, patch: Array, volume: float) -> Array:
        """Return the shell's points times the factor with which they hold a volume below the patch.

        Parameters
        ----------
        shell, patch
            Points of the shell without the rim (s, 3) and of the patch on the diaphragm (p, 3) [m].
        volume
            Volume of the liquid [m^3].

        Returns
        -------
        Array
            The points (s, 3) [m]. The volume is met to 1e-12 of it; that 20 iterations are enough
            for that is not checked.
        """
        factor = 1.0
        for _ in range(20):
            missing = volume - fan_volume(self._outline(patch, factor * shell)[self._boundary])
            if abs(missing) < 1e-12 * volume:
                break
            factor *= 1 + missing / (3 * volume)
        return factor * shell

    def place(self, patch: Array, shell: Array) -> None:
        """Put the mesh at rest below a patch, and take the volume there for that at the start.

        Parameters
        ----------
        patch, shell
            Points of the patch on the diaphragm (p, 3) and of the shell without the rim (s, 3) [m].

        Raises
        ------
        StepFailed
            No valid mesh is found.
        """
        self.shell = shell
        outline = self._outline(patch)
        self._fan = fan_volume(outline[self._boundary])
        self._size = self._fan / fan_volume(self._reference[self._boundary])
        points, geometry = self._made_anew(outline, "t = 0 s")
        placed = MeshShape(points=points, geometry=geometry, patch=patch)
        self.committed = self.now = self.begun = placed
        self.volume = float(geometry.volume.sum())

    def return_to(self, points: Array) -> None:
        """Stand at ``points`` (P, 3) [m], where the mesh has stood since it was placed."""
        self.committed = self.now = self.begun = self._shape(points)
        self.shell = points[self.mesh.shell_points]

    def _shape(self, points: Array) -> MeshShape:
        """Of a mesh whose ``points`` (P, 3) [m] are known."""
        patch = points[self.mesh.patch_points]
        return MeshShape(points=points, geometry=cell_geometry(self.mesh, points), patch=patch)

    @property
    def points(self) -> Array:
        """All points (P, 3) [m], as committed."""
        return self.committed.points

    @property
    def patch(self) -> Array:
        """The patch (p, 3) [m], as committed."""
        return self.committed.patch

    @property
    def geometry(self) -> CellGeometry:
        """The cells, as committed."""
        return self.committed.geometry

    def begin_step(self, shell: Array | None, turn: Turn | None = None) -> None:
        """Start a step that ends with the shell's points at ``shell`` (s, 3) [m], if they move.

        ``turn``: how the tank turns in it, None where it does not.
        """
        self._base, self.begun = None, self.committed
        if turn is not None:
            self.begun = self._shape(self.points @ turn.last.T)
        self.shell = self.shell if shell is None else shell

    def close_volume(self, patch: Array, shell: Array | None = None) -> Array:
        """Return the patch shifted along its normals until the volume is that at the start.

        Parameters
        ----------
        patch, shell
            Points of the patch (p, 3) and of the shell (s, 3) [m], by default the step's own.

        Returns
        -------
        Array
            Points (p, 3) [m], the rim where it was. The volume is met to rounding; that 30
            iterations are enough for that is not checked.
        """
        for _ in range(30):
            excess = self.excess(patch, shell)
            if abs(excess) <= 2e-16 * self.volume:
                break
            height, area = level_shift(patch, self.mesh.patch_faces, self.mesh.rim)
            patch = patch - height * excess / area
        return patch

    def excess(self, patch: Array, shell: Array | None = None) -> float:
        """Return the volume above the start's [m^3], as OpenFOAM's swept volumes add up to it.

        The parameters are those of ``close_volume``.
        """
        return fan_volume(self._outline(patch, shell)[self._boundary]) - self._fan

    def follow(self, patch: Array, moment: str) -> Array:
        """Let the step end at ``patch`` (p, 3) [m]; return what boundary faces sweep (B,) [m^3].

        What of it lies beyond the shell, where a linear map may throw it in a slam, stays inside.
        Every cell has a volume then; a corner of one may be inverted until the next step relaxes.
        Raises ``StepFailed`` where no mesh is found; ``moment`` says when.
        """
        patch = self._inside(patch)
        outline = self._outline(patch)
        if self._base is not None:
            points = self._elastic.carried(self._base, outline)
            geometry = cell_geometry(self.mesh, points)
        if self._base is None or not geometry.volume.min() > 0:
            points, geometry = self._relaxed(outline, moment)
            self._base = points
        self.now = MeshShape(points=points, geometry=geometry, patch=patch)
        return swept_volumes(self.begun.points[self._boundary], points[self._boundary])

    def _inside(self, patch: Array) -> Array:
        """``patch`` (p, 3) [m] but for points beyond the shell, of the same volume."""
        inside = np.where(self.mesh.rim[:, None], patch, self.tank.confine(patch, self._depth))
        if np.array_equal(inside, patch):
            return patch
        return self.close_volume(inside)

    def accept_step(self) -> None:
        """Commit where the last call of ``follow`` led."""
        self.committed = self.now

    @property
    def non_orthogonality_max(self) -> float:
        """Largest non-orthogonality [deg] of the committed mesh."""
        return self._skewness(self.geometry)

    def _outline(self, patch: Array, shell: Array | None = None) -> Array:
        """Points (P, 3) of which those on the boundary stand where they should."""
        points = np.zeros_like(self.mesh.points)
        points[self.mesh.shell_points] = self.shell if shell is None else shell
        points[self.mesh.patch_points] = patch
        return points

    def _relaxed(self, outline: Array, moment: str) -> tuple[Array, CellGeometry]:
        """Points (P, 3) and their cells, from those of the last step unless they get bad."""
        try:
            points = self._elastic.relax(self.points, outline, size=self._size)
        except MeshFolds:
            return self._made_anew(outline, moment)
        geometry = cell_geometry(self.mesh, points)
        skewed = self._skewness(geometry)
        if skewed <= SKEWED:
            return points, geometry
        try:
            other = self._made_anew(outline, moment)
        except RunFailed:
            if geometry.volume.min() > 0:
                return points, geometry
            raise
        if self._skewness(other[1]) < skewed - BETTER:
            _log.info("%s: the flow's mesh was made anew, %.0f degrees skewed", moment, skewed)
            return other
        return points, geometry

    def _made_anew(self, outline: Array, moment: str) -> tuple[Array, CellGeometry]:
        """Points (P, 3) and their cells, relaxed from the reference."""
        try:
            points = self._elastic.relax(self._reference, outline, size=self._size)
        except MeshFolds:
            why = "none of its shapes keeps all cells open"
        else:
            geometry = cell_geometry(self.mesh, points)
            if geometry.volume.min() > 0:
                return points, geometry
            place = ", ".join(f"{x:.3f}" for x in geometry.centre[np.argmin(geometry.volume)])
            why = f"a cell near ({place}) m is turned inside out"
        raise StepFailed(
            f"{moment}: no valid mesh of the liquid was found below the diaphragm: {why}.",
            cause=Cause.MESH,
        )

    def _skewness(self, geometry: CellGeometry) -> float:
        """Largest non-orthogonality [deg]; 180 where a cell has no volume."""
        if not geometry.volume.min() > 0:
            return 180.0
        return float(non_orthogonality(self.mesh, geometry).max())
