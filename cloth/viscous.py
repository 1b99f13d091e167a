"""What the rubber's stretch stores and loses: Kelvin and Voigt's solid in a sheet that wrinkles.

The membrane stress is C (m + tau dm/dt), C plane stress of T = E t and nu, m the rubber's own
strain in its plane, tau = eta/(2 pi f) of a loss factor eta at a frequency f (tan delta, ISO 4664:
a strain of amplitude a loses pi eta T a^2 a period and area). Of a relaxed sheet wrinkles take up
what would be compression, so m differs from the strain e of its triangles (Pipkin 1986): where
nothing pulls the rubber creeps back, m + tau dm/dt = 0, and pulls again when e has caught up.

A step takes the implicit Euler rate, c = tau/dt:
m + c (m - m_n) = (1 + c)(m - rest) with rest = c/(1 + c) m_n, so that a step's sheet is elastic, of
the stiffness (1 + c) T and the strain ``rest`` free of tension. Whatever the step, it loses
c C(m - m_n):(m - m_n) >= 0. The loss of a harmonic strain is (sin x / x)^2 of the exact one and its
stiffness 1 + eta x that of the elastic sheet, x = omega dt/2.

Strains are Biot's, sqrt(F^T F) - 1, as columns xx, xy, yy of the moulded triangles' own axes.
"""

from __future__ import annotations

import numpy as np

from cloth import kernels
from cloth.arrays import Array, Bools, Ints


def triangle_strain(position: Array, triangles: Ints, gradients: Array) -> Array:
    """Return Biot's strain of the triangles, see the module's text.

    Parameters
    ----------
    position
        Positions (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).
    gradients
        Of the moulded triangles (m, 3, 2) [1/m], as ``cloth.mesh.rest_gradients`` returns them.

    Returns
    -------
    Array
        Strain (m, 3) [-], as xx, xy, yy in the moulded triangles' own axes.
    """
    strain = np.empty((len(triangles), 3))
    kernels.triangle_strains(position, triangles, gradients, strain)
    return strain


def free_strain(rubber: Array, ratio: float) -> Array:
    """Return the strain (m, 3) [-] free of tension in a step, (0, 3) for a sheet without memory.

    ``rubber`` (m, 3) [-] is the rubber's own strain at the step's start; ``ratio`` is c = tau/dt,
    0 for a sheet without memory.
    """
    return ratio / (1.0 + ratio) * rubber if ratio > 0.0 else np.empty((0, 3))


def _principal(strain: Array) -> tuple[Array, Array, Array, Array]:
    """Mean and half the difference (m,) of the principal strains, and cos and sin of twice the
    angle of the larger one.
    """
    mean, half = 0.5 * (strain[:, 0] + strain[:, 2]), 0.5 * (strain[:, 0] - strain[:, 2])
    spread = np.hypot(half, strain[:, 1])
    size = np.where(spread > 0.0, spread, 1.0)
    return mean, spread, np.where(spread > 0.0, half / size, 1.0), strain[:, 1] / size


def rubber_strain(
    strain: Array, rest: Array, tensile: Array, compressive: Array, poisson: float
) -> tuple[Array, Bools]:
    """Return the rubber's own strain in triangles of a given strain, and where nothing pulls.

    Parameters
    ----------
    strain
        Strain of the triangles (m, 3) [-].
    rest
        The strain that is free of tension (m, 3) [-].
    tensile, compressive
        Stiffnesses (m,) [N/m] as in ``cloth.reference.limited``: a sheet that resists compression
        fully has no wrinkles.
    poisson
        Poisson's ratio [-].

    Returns
    -------
    strain : Array
        The rubber's own strain (m, 3) [-].
    slack : Bools
        Where nothing pulls (m,).
    """
    mean, spread, cosine, sine = _principal(strain - rest)
    e, f = mean + spread, mean - spread
    whole = (compressive >= tensile) | (f >= -poisson * e)
    slack = ~whole & (e <= 0.0)
    e = np.where(slack, 0.0, e)
    f = np.where(whole, f, np.where(slack, 0.0, -poisson * e))
    mean, spread = 0.5 * (e + f), 0.5 * (e - f)
    own = np.stack([mean + spread * cosine, spread * sine, mean - spread * cosine], axis=1)
    return rest + own, slack


def plane_stress_energy(strain: Array, tensile: Array, poisson: float) -> Array:
    """Return the energy per area of the rubber's strain in plane stress, C m:m / 2.

    Parameters
    ----------
    strain
        m (m, 3) [-].
    tensile
        T = E t (m,) [N/m].
    poisson
        Poisson's ratio [-].

    Returns
    -------
    Array
        Energy per area (m,) [J/m^2].
    """
    mean, spread, _, _ = _principal(strain)
    both, apart = 2.0 * mean, 2.0 * spread
    return np.asarray(0.25 * tensile * (both**2 / (1.0 - poisson) + apart**2 / (1.0 + poisson)))


def squared(strain: Array) -> Array:
    """Return m:m (m,) of a symmetric ``strain`` m (m, 3)."""
    return np.asarray(strain[:, 0] ** 2 + 2.0 * strain[:, 1] ** 2 + strain[:, 2] ** 2)
