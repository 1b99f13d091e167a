"""What the laminar boundary layers along the walls take from a liquid of harmonic polynomials.

Stokes's layer beside a wall (Trans. Cambridge Phil. Soc. 9, 1851; Landau and Lifshitz, Fluid
Mechanics, section 24): below a flow u cos(omega t) it dissipates rho u^2 sqrt(nu omega/2)/2 per
area in the mean, which is that of a drag rho sqrt(nu omega/2) per area and speed. Over all walls,

    P = rho sqrt(nu omega/2) int |u_t|^2 dA,   u_t = grad phi along the wall, less the wall's own,

is a quadratic form of the potential's coefficients, and acts on them as a decay. A free mode of
energy E = rho int |grad phi|^2 dV/2, with phi at its largest, so loses at the rate

    (dE/dt)/E = -sqrt(nu omega/2) int |u_t|^2 dA/int |grad phi|^2 dV

(Case and Parkinson, J. Fluid Mech. 2, 1957, and Miles, Proc. R. Soc. A 297, 1967, both for upright
cylinders, whose closed form this reproduces).

What it assumes: one frequency, attached laminar layers much thinner than the liquid is deep, and
strokes that may be long, as the layer is linear along an even wall. A motion at f' in place of f is
damped sqrt(f/f') times what it should be. The part of the drag in phase with the acceleration is
left out; it lowers a mode's frequency by as much as its damping ratio.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.ritz import RitzShape
from coupling.ports import Array, Turn


def slip_form(harmonics: SolidHarmonics, values: Array, normal: Array, weight: Array) -> Array:
    """Return int grad_t H_i . grad_t H_j dA over walls, grad_t along the wall.

    Parameters
    ----------
    harmonics
        The k harmonics H.
    values
        Their values at the walls' samples (N, k) [-].
    normal
        Unit normals there (N, 3), of either sign.
    weight
        Areas of the samples (N,) [m^2].

    Returns
    -------
    Array
        Symmetric matrix (k, k) [-].
    """
    slopes = [values @ slope for slope in harmonics.slopes]
    across = sum((normal[:, [x]] * slopes[x] for x in range(3)), np.zeros_like(values))
    total = sum((s.T @ (weight[:, None] * s) for s in slopes), 0.0 * harmonics.slopes[0])
    return np.asarray(total - across.T @ (weight[:, None] * across))


def layer_speed(viscosity: float, frequency: float) -> float:
    """Return sqrt(nu omega/2) [m/s], the layer's drag per area, speed and density.

    ``viscosity`` nu [m^2/s], ``frequency`` omega/(2 pi) [Hz].
    """
    return float(np.sqrt(np.pi * frequency * viscosity))


@dataclass(frozen=True, kw_only=True)
class WallLayers:
    """The layers' drag on the liquid in one ``shape``, and on the sheet.

    ``speed`` [m/s]: see ``layer_speed``; ``form`` (k - 1, k - 1) [-]: ``slip_form`` of all wetted
    walls, without the constant; ``wetted`` (m,) [m^2]: areas of the sheet's triangles, 0 where it
    is dry.
    """

    shape: RitzShape
    speed: float
    form: Array
    wetted: Array

    @cached_property
    def decay(self) -> Array:
        """Rates D (k - 1, k - 1) [1/s] of potentials y = W^T c, of unit stiffness, W the inverse.

        Symmetric, and not negative even where the rounding of a film's two sides would make it so.
        """
        inverse = self.shape.inverse
        value, vector = np.linalg.eigh(self.speed * (inverse.T @ self.form @ inverse))
        return np.asarray((vector * np.maximum(value, 0.0)) @ vector.T)

    def rows(self, b: float) -> Array:
        """Return rows B (k - 1, n, 3) [kg^(1/2)] of the inertia, with the drag over ``b`` [s].

        B^T B v/b is then what pushes the liquid in an implicit step from rest, rho A^T (1/b + D) c.
        """
        rows = self.shape.rows()
        return np.asarray(self._root(b).T @ rows.reshape(len(rows), -1)).reshape(rows.shape)

    def walls(self, b: float) -> Array:
        """Return what a shell that turns adds to those rows, C (k - 1, 3) [kg^(1/2) m]."""
        return np.asarray(self._root(b).T @ self.shape.walls())

    def _root(self, b: float) -> Array:
        """Lower triangle L (k - 1, k - 1) of L L^T = 1 + b D."""
        return np.asarray(np.linalg.cholesky(np.eye(len(self.decay)) + b * self.decay))

    def rate(self, velocity: Array, turn: Turn | None = None) -> Array:
        """Rate (k,) [m^2/s^2] at which the potential of nodes at ``velocity`` (n, 3) decays.

        And walls that ``turn``.
        """
        inverse = self.shape.inverse
        modal = inverse.T @ self.shape.source(velocity, turn)
        return np.concatenate([[0.0], inverse @ (self.decay @ modal)])

    def carried(self, velocity: Array) -> Array:
        """What a sheet moving along itself at ``velocity`` (n, 3) takes off that rate (k,)."""
        inverse, slopes = self.shape.inverse, self.shape.liquid.harmonics.slopes
        push = self.wetted[:, None] * self._along(velocity[self.shape.liquid.triangles].mean(1))
        taken = sum(
            (slopes[x].T @ (self.shape.values.T @ push[:, x]) for x in range(3)),
            np.zeros(len(inverse) + 1),
        )
        return np.concatenate([[0.0], self.speed * inverse @ (inverse.T @ taken[1:])])

    def _slip(self, coefficient: Array, velocity: Array) -> Array:
        """Liquid's velocity along the triangles (m, 3) [m/s], less theirs."""
        slopes = self.shape.liquid.harmonics.slopes
        flow = np.stack([self.shape.values @ (s @ coefficient) for s in slopes], axis=1)
        return self._along(flow - velocity[self.shape.liquid.triangles].mean(axis=1))

    def _along(self, vectors: Array) -> Array:
        """The part of ``vectors`` (m, 3) along the triangles."""
        normal = self.shape.area / np.linalg.norm(self.shape.area, axis=1)[:, None]
        return np.asarray(vectors - np.einsum("tx,tx->t", vectors, normal)[:, None] * normal)

    def force(self, coefficient: Array, velocity: Array) -> Array:
        """Return the drag on the nodes of the sheet (n, 3) [N].

        ``coefficient`` (k,) [m^2/s] of the potential, ``velocity`` (n, 3) [m/s] of the nodes.
        """
        drag = self.shape.liquid.density * self.speed * self.wetted[:, None]
        share = drag * self._slip(coefficient, velocity) / 3.0
        force = np.zeros_like(velocity)
        np.add.at(force, self.shape.liquid.triangles, share[:, None])
        return force

    def power(self, coefficient: Array, velocity: Array) -> float:
        """Return the power [W] that the layers on all walls take; parameters as of ``force``."""
        return self.shape.liquid.density * self.speed * self.slip(coefficient, velocity)

    def slip(self, coefficient: Array, velocity: Array) -> float:
        """Return int of the squared speed along all wetted walls, relative to them [m^4/s^2]."""
        slopes, c = self.shape.liquid.harmonics.slopes, coefficient[1:]
        sheet = velocity[self.shape.liquid.triangles].mean(axis=1)
        still = np.stack([self.shape.values @ (s @ coefficient) for s in slopes], axis=1)
        both = self._along(sheet) * (sheet - 2.0 * still)
        return max(float(c @ self.form @ c + np.sum(both, axis=1) @ self.wetted), 0.0)
