"""What stays constant during a run, and the matrix of a step."""

from __future__ import annotations

import numpy as np

from cloth import kernels, node_kernels
from cloth.arrays import Array
from cloth.bending import bending_of
from cloth.linear import System, stretch_matrix
from cloth.load import Settings
from cloth.material import Diaphragm
from cloth.mesh import Mesh, corners_of, lumped, rest_gradients
from cloth.self_contact.resolve import SelfContact
from cloth.shell.shell import Shell


class ClothModel:
    """Mesh, mass, stretch and bending of a sheet, and the ``shell`` around it, if any.

    ``mass`` (n,) [kg] and ``node_areas`` (n,) [m^2], lumped; ``thickness`` (m,) [m];
    ``tensile`` and ``compressive`` (m,) [N/m]; ``poisson`` [-], 0 of a sheet stiffer than its
    rubber; ``size`` L [m], half the mesh's largest extent; ``clamped`` (n, 3) [m], where fixed
    nodes are held; ``mobility`` (n,) [1/kg], 0 where fixed; ``inertia`` [kg], of an area L^2;
    ``below_rim`` [m^3]: the shell's volume below the rim's plane.
    """

    def __init__(
        self,
        *,
        mesh: Mesh,
        diaphragm: Diaphragm,
        thickness: Array | None,
        clamped: Array,
        shell: Shell,
        tensile_stiffness: float | None,
        compressive_stiffness: float | None,
        self_contact: bool,
        clamped_rim: bool = False,
    ) -> None:
        self.mesh, self.clamped = mesh, clamped
        self.shell = shell
        self.triangles, self.free = mesh.triangles, ~mesh.fixed
        self.corner_starts, self.corners = corners_of(mesh.triangles, len(mesh.points))
        self.size = 0.5 * float(np.ptp(mesh.points, axis=0).max())
        self.gradients, self.areas = rest_gradients(mesh.points, mesh.triangles)
        if thickness is None:
            thickness = np.full(len(self.areas), diaphragm.thickness)
        self.thickness = thickness
        self.node_areas = area = lumped(mesh)
        self.mass = lumped(mesh, diaphragm.density * thickness)
        self.inertia = float(self.mass.sum() / area.sum()) * self.size**2
        self.mobility = np.where(self.free, 1.0 / self.mass, 0.0)
        self.self_contact = (
            SelfContact(mesh.triangles, self.mobility, float(thickness.max()))
            if self_contact
            else None
        )
        stiffness = diaphragm.youngs_modulus * thickness
        self.poisson, self.tensile = diaphragm.poisson_ratio, stiffness
        if tensile_stiffness is not None:
            self.poisson, self.tensile = 0.0, np.full_like(stiffness, tensile_stiffness)
        self.compressive = (
            stiffness
            if compressive_stiffness is None
            else np.full_like(stiffness, compressive_stiffness)
        )
        if clamped_rim and np.any(clamped[mesh.fixed] != mesh.points[mesh.fixed]):
            raise ValueError("cloth: a clamped rim must be held where it was moulded.")
        self.bending = bending_of(
            mesh,
            lumped(mesh, diaphragm.bending_stiffness_at(thickness)) / area,
            diaphragm.poisson_ratio,
            clamped=clamped_rim,
        )
        self.below_rim = shell.volume_below(0.0)

    def volume(self, position: Array) -> float:
        """Return the volume [m^3] of the liquid: the shell's below the rim, and the cone's.

        The cone is the one from the origin over the cloth at ``position`` (n, 3) [m]. Without a
        shell it is the cone alone: what a closed sheet encloses.
        """
        return self.volume_and_gradient(position)[0]

    def volume_and_gradient(self, position: Array) -> tuple[float, Array]:
        """Return the liquid's volume [m^3] and its derivative (n, 3) [m^2], zero on fixed nodes."""
        gradient = np.empty_like(position)
        cone = kernels.volume_and_gradient(position, self.triangles, self.free, gradient)
        return self.below_rim + float(cone), gradient

    def shell_penalty(self, settings: Settings, penalty: float) -> Array:
        """Return the shell's penalty (n,) [N/m] for the stretch's ``penalty`` [N/m]; 0 if fixed."""
        if not len(self.shell.profile):
            return np.zeros(len(self.mass))
        share = self.mass / self.mass[self.free].mean()
        return np.where(self.free, settings.shell_weight * penalty * share, 0.0)

    def stiffness(self, settings: Settings, dt: float) -> tuple[Array, Array]:
        """Return the stretch's stiffnesses in a step of ``dt`` [s], as ``cloth.viscous`` has them.

        In place of ``tensile`` and ``compressive`` (m,) [N/m]. A relaxed sheet's ``compressive``
        is no rubber's, and loses nothing.
        """
        stiffer = 1.0 + settings.stretch_damping / dt
        whole = self.compressive >= self.tensile
        return stiffer * self.tensile, np.where(whole, stiffer, 1.0) * self.compressive

    def bending_force(self, position: Array) -> Array:
        """Return the force -dE/dx (n, 3) [N] of the bending energy; no meaning on fixed nodes."""
        _, gradient = self.volume_and_gradient(position)
        bent, force = self.bending, self._held_normals_force(position, gradient)
        node_kernels.bending_turning_step(
            position, self.triangles, gradient,
            bent.starts, bent.columns, bent.values, bent.moment, force,
        )  # fmt: skip
        return force

    def held_normals_force(self, position: Array) -> Array:
        """Return the bending force (n, 3) [N] but for what turns the normals.

        Its rate is what bending's damping resists.
        That damping may be hundreds of times as stiff in a step as the energy; an explicit part of
        it that stretches the sheet keeps the iteration from converging in sharp folds.
        """
        return self._held_normals_force(position, self.volume_and_gradient(position)[1])

    def _held_normals_force(self, position: Array, gradient: Array) -> Array:
        """As ``held_normals_force``, with the volume's ``gradient`` (n, 3) [m^2]."""
        bent = self.bending
        force = np.asarray(bent.held - bent.matrix @ position)
        node_kernels.bending_rest_step(
            gradient, bent.starts, bent.columns, bent.values, bent.moment, force
        )
        return force

    def system(self, settings: Settings, penalty: float, b: float) -> System:
        """Return a step's factorised matrix for the ``penalty`` k [N/m] and the time ``b`` [s].

        S = M (1 + alpha b)/b^2 + k L + Q (1 + tau_b/b) + w_c.
        """
        size = len(self.mass)
        diagonal = self.mass * (1.0 + settings.drag * b) / b**2
        diagonal += self.shell_penalty(settings, penalty)
        matrix = stretch_matrix(self.triangles, self.gradients, penalty * self.areas, size)
        matrix = matrix + self.bending.matrix * (1.0 + settings.bending_damping / b)
        matrix.setdiag(matrix.diagonal() + diagonal)
        return System(matrix, self.free)
