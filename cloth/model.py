"""What stays constant during a run, and the matrix of a step."""

from __future__ import annotations

import math

import numpy as np

from cloth import kernels
from cloth.arrays import Array
from cloth.bending import bending_matrix, build_hinges
from cloth.linear import System, stretch_matrix
from cloth.load import Settings
from cloth.material import Diaphragm
from cloth.mesh import Mesh, node_areas, rest_gradients


class ClothModel:
    """Mesh, mass, stretch and bending of a diaphragm in its shell.

    ``tensile`` [N/m]: E t of an elastic sheet, or -1 for an inextensible one; ``compressive``
    [N/m] as in ``cloth.reference.softened``; ``mass`` (n,) [kg], lumped.
    """

    def __init__(
        self,
        *,
        mesh: Mesh,
        diaphragm: Diaphragm,
        shell_radius: float,
        clearance: float,
        elastic: bool,
        compressive: float,
    ) -> None:
        self.mesh, self.shell_radius, self.clearance = mesh, shell_radius, clearance
        self.triangles, self.free = mesh.triangles, ~mesh.fixed
        self.gradients, self.areas = rest_gradients(mesh.points, mesh.triangles)
        self.mass = diaphragm.area_density * node_areas(mesh)
        self.tensile = diaphragm.membrane_stiffness if elastic else -1.0
        self.compressive = compressive
        self.hinges = build_hinges(mesh, diaphragm.bending_stiffness)
        self.moment = self.hinges.weight * self.hinges.curvature
        self.bending = bending_matrix(self.hinges, len(mesh.points))
        self.half_shell = 2.0 / 3.0 * math.pi * shell_radius**3

    def volume(self, position: Array) -> float:
        """Liquid volume [m^3] below the cloth at ``position``: half the shell plus the cone."""
        return self.volume_and_gradient(position)[0]

    def volume_and_gradient(self, position: Array) -> tuple[float, Array]:
        """The same and its derivative (n, 3) [m^2], zero on the fixed nodes."""
        gradient, unused = np.empty_like(position), np.empty_like(position)
        cone = kernels.volume_and_loads(
            position, self.triangles, np.zeros(3), self.free, gradient, unused
        )
        return self.half_shell + float(cone), gradient

    def contact_weight(self, settings: Settings, b: float) -> Array:
        """Penalty of the shell (n,) [N/m], none on the fixed nodes."""
        return np.where(self.free, settings.contact_weight * self.mass / b**2, 0.0)

    def penalty(self, settings: Settings) -> Array:
        """Penalty of the strain limit (m,) [N/m]."""
        return np.full(len(self.triangles), settings.penalty)

    def system(self, settings: Settings, b: float) -> System:
        """S = M (1 + alpha b)/b^2 + k L + Q (1 + tau_b/b) + w_c, factorised."""
        size = len(self.mass)
        diagonal = self.mass * (1.0 + settings.drag * b) / b**2 + self.contact_weight(settings, b)
        matrix = stretch_matrix(
            self.triangles, self.gradients, self.penalty(settings) * self.areas, size
        )
        matrix = matrix + self.bending * (1.0 + settings.bending_damping / b)
        matrix.setdiag(matrix.diagonal() + diagonal)
        return System(matrix, self.free)
