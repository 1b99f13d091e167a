"""Plain NumPy definitions of what ``cloth.kernels`` compiles. Slow, and meant to be read."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools, Ints


def limited(
    first: Array,
    second: Array,
    penalty: Array,
    tensile: Array,
    compressive: Array,
    poisson: float,
) -> tuple[Array, Array]:
    """The sheet's own principal stretches for those asked for, ``first`` >= ``second``.

    Minimises k/2 |sigma' - sigma|^2 + W(sigma'), ``penalty`` k [N/m]. W of a sheet with
    T = ``tensile`` [N/m], its E t: the plane-stress energy
    T/(2 (1 - nu^2)) (e1^2 + e2^2 + 2 nu e1 e2) of e = sigma' - 1 where it pulls both ways;
    T/2 e1^2 where it pulls one way (tension field: Pipkin 1986), across which K = ``compressive``
    [N/m] holds the natural width, K/2 (e2 + nu e1)^2; K/2 (e1^2 + e2^2) where it does not pull.
    Where K >= T the first form holds for compression too.
    """
    soft = 1.0 / (penalty + compressive)
    e, f = first - 1.0, second - 1.0
    both = penalty * (e + f) / (penalty + tensile / (1.0 - poisson))
    apart = penalty * (e - f) / (penalty + tensile / (1.0 + poisson))
    pull = penalty * e / (penalty + tensile)
    two = (compressive >= tensile) | (f >= 0.5 * (both - apart))
    one = e > 0.0
    a = np.where(two, 0.5 * (both + apart), np.where(one, pull, penalty * e * soft))
    narrowing = np.where(one, compressive * poisson * pull, 0.0)
    b = np.where(two, 0.5 * (both - apart), (penalty * f - narrowing) * soft)
    return 1.0 + a, 1.0 + b


def membrane_step(
    x: Array,
    triangles: Ints,
    gradients: Array,
    areas: Array,
    penalty: Array,
    relaxation: float,
    tensile: Array,
    compressive: Array,
    poisson: float,
    rest: Array,
    z: Array,
    u: Array,
    rhs: Array,
) -> None:
    """Project every triangle's stretch and add its pull to ``rhs`` (n, 3) [N].

    y = r F(x) + (1 - r) z + u; z = y with its singular values ``limited``; u = y - z. ``z`` and
    ``u`` (m, 3, 2) [-] are changed; the tension is k u [N/m]. rhs += sum_t k A (z - u) g^T.
    With ``rest`` (m, 3), the strain free of tension (``cloth.viscous``), z is ``shifted``; without,
    it is empty, (0, 3).
    """
    stretch = np.einsum("tid,tie->tde", x[triangles], gradients)
    y = relaxation * stretch + (1.0 - relaxation) * z + u
    if len(rest):
        z[:] = shifted(y, rest, penalty, tensile, compressive, poisson)
    else:
        left, sigma, right = np.linalg.svd(y, full_matrices=False)
        new = np.stack(
            limited(sigma[:, 0], sigma[:, 1], penalty, tensile, compressive, poisson), axis=1
        )
        z[:] = left * new[:, None, :] @ right
    u[:] = y - z
    pull = (penalty * areas)[:, None, None] * np.einsum("tde,tie->tid", z - u, gradients)
    np.add.at(rhs, triangles, pull)


def shifted(
    y: Array, rest: Array, penalty: Array, tensile: Array, compressive: Array, poisson: float
) -> Array:
    """Deformation gradients z (m, 3, 2) for those asked for, ``y``, free of tension at ``rest``.

    z = Q U, U = 1 + rest + g, g the symmetric part of Q_y^T y - 1 - rest with its principal values
    ``limited``, Q_y the rotation of ``y``; Q, the rotation nearest to ``y``, that of y U, so that
    y - z turns no triangle. Where rest and strain have the same axes that is the minimum of
    k/2 |z - y|^2 + W(U - rest); elsewhere but for the third power of the strains.
    """
    left, sigma, right = np.linalg.svd(y, full_matrices=False)
    shift = np.stack([rest[:, :2], rest[:, 1:]], axis=1)
    values, axes = np.linalg.eigh(right.transpose(0, 2, 1) * sigma[:, None, :] @ right - shift)
    second, first = values.T
    new = limited(first, second, penalty, tensile, compressive, poisson)
    values = np.stack(new[::-1], axis=1)
    stretch = axes * values[:, None, :] @ axes.transpose(0, 2, 1) + shift
    left, _, right = np.linalg.svd(y @ stretch, full_matrices=False)
    return np.asarray(left @ right @ stretch)


def triangle_strains(x: Array, triangles: Ints, gradients: Array, strain: Array) -> None:
    """Biot's strain sqrt(F^T F) - 1 of every triangle into ``strain`` (m, 3): see ``viscous``."""
    stretch = np.einsum("tid,tie->tde", x[triangles], gradients)
    first, second = stretch[:, :, 0], stretch[:, :, 1]
    pairs = ((first, first), (first, second), (second, second))
    a, b, c = (np.einsum("td,td->t", one, other) for one, other in pairs)
    root = np.sqrt(np.maximum(a * c - b * b, 0.0))
    size = np.sqrt(np.maximum(a + c + 2.0 * root, 1e-300))
    strain[:] = np.stack([(a + root) / size - 1.0, b / size, (c + root) / size - 1.0], axis=1)


def principal_strains(x: Array, triangles: Ints, gradients: Array, strain: Array) -> float:
    """Largest principal strain sigma_max - 1 of every triangle into ``strain`` (m,)."""
    stretch = np.einsum("tid,tie->tde", x[triangles], gradients)
    strain[:] = np.linalg.norm(stretch, ord=2, axis=(1, 2)) - 1.0
    return float(strain.max())


def volume_and_gradient(x: Array, triangles: Ints, free: Bools, gradient: Array) -> float:
    """Signed volume [m^3] of the cone from the origin over the cloth.

    ``gradient`` (n, 3) [m^2] becomes dV/dx of the ``free`` nodes, zero elsewhere: p0 times it is
    the load of a uniform pressure p0. Exact for free nodes whose triangles close a fan.
    """
    corner = x[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 6.0
    gradient[:] = 0.0
    np.add.at(gradient, triangles, np.repeat(normal[:, None, :], 3, axis=1))
    gradient[~free] = 0.0
    return float(np.einsum("td,td->", corner[:, 0], normal))


def pressure_step(x: Array, triangles: Ints, datum: float, slope: Array, rhs: Array) -> None:
    """Add the load of p = ``datum`` [Pa] + ``slope`` . x, slope (3,) [Pa/m], to ``rhs`` (n, 3) [N].

    The gradient of the integral of p over the liquid, exact for the polyhedron: the mean of p over
    a triangle weighted by the node's hat function.
    """
    corner = x[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 6.0
    pressure = datum + corner @ slope
    weighted = 0.25 * (pressure + pressure.sum(axis=1)[:, None])
    np.add.at(rhs, triangles, weighted[:, :, None] * normal[:, None, :])


def triangle_step(
    x: Array,
    triangles: Ints,
    starts: Ints,
    corners: Ints,
    gradients: Array,
    areas: Array,
    penalty: Array,
    relaxation: float,
    tensile: Array,
    compressive: Array,
    poisson: float,
    rest: Array,
    z: Array,
    u: Array,
    datum: float,
    slope: Array,
    free: Bools,
    gradient: Array,
    rhs: Array,
) -> float:
    """``membrane_step``, ``pressure_step`` and ``volume_and_gradient``, whose result it returns.

    ``starts``, ``corners``: those of ``cloth.mesh.corners_of``, by which the compiled twin collects
    what acts on a node. ``rhs`` of fixed nodes means nothing.
    """
    membrane_step(
        x, triangles, gradients, areas, penalty, relaxation, tensile, compressive, poisson,
        rest, z, u, rhs,
    )  # fmt: skip
    pressure_step(x, triangles, datum, slope, rhs)
    return volume_and_gradient(x, triangles, free, gradient)
