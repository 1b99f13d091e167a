"""A flat sheet on the liquid of a half-full ball: the frequency of its first lateral mode."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import Final

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from numpy.polynomial import legendre
from scipy.linalg import eigh, null_space
from threadpoolctl import threadpool_limits

from cloth.bending import bending_of
from cloth.flat import disc
from cloth.material import Diaphragm, diaphragm
from cloth.mesh import Mesh, lumped
from cloth.shell.sphere import Sphere
from coupling.estimate.sloshing_modes import surface_inertia
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.ritz import RitzLiquid, wall_integral
from coupling.ports import Array
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.sheets import within

RADIUS, GRAVITY, DENSITY = 0.4445, 9.81, 1000.0
ELASTOMER = "AF-E-332"
HELD: Final = {"free": 0, "hinged": 1, "clamped": 2}  # of deflection and slope, at the rim
SECTORS = 4  # to a ring: triangles as long as wide at 0.64 of the radius
MODES = 8  # slowest, of which the lateral one is that most like a slope
FUNCTIONS = 24  # of the exact answer: 20 to 40 agree to 3e-7


def plate(
    *, rim: str = "clamped", thickness: float = 0.001778, degree: int = 16, resolution: int = 24
) -> VerifyResult:
    """First lateral ``frequency`` [Hz] of a flat rubber sheet on a half-full ball.

    The sheet covers the level, without tension; ``thickness`` [m] of AF-E-332 in a tank of
    0.4445 m. ``rim``: free to slide up the wall, hinged, or clamped level. ``resolution``: rings of
    the sheet's mesh; ``degree``: of the liquid's harmonic polynomials. The exact answer is
    ``plate_frequency``. The error is of second order in the rings once they resolve the length
    (kappa/(rho g))^(1/4) over which the rim bends the sheet, 27 mm or a sixteenth of the radius: at
    12 / 24 / 48 rings 0.3 / 0.07 / 0.02 % free, 0.8 / 0.2 / 0.05 % hinged, 1.9 / 0.7 / 0.2 %
    clamped.
    """
    clock = perf_counter()
    if rim not in HELD:
        raise CaseError(f"verify plate: --rim: must be one of {', '.join(HELD)}, got '{rim}'.")
    within("plate", "thickness", thickness, 1e-4, 0.05 * RADIUS)
    within("plate", "degree", degree, 4, 24)
    within("plate", "resolution", resolution, 4, 96)
    rubber = diaphragm(ELASTOMER, thickness)
    with threadpool_limits(1):
        exact = plate_frequency(rubber, rim)
        found = sheet_frequency(rubber, rim, resolution, degree)
    return VerifyResult(
        case="plate",
        options={
            "rim": rim,
            "thickness": thickness,
            "degree": degree,
            "resolution": resolution,
        },
        quantities=(quantity("frequency", found, exact, "Hz"),),
        wall_s=perf_counter() - clock,
    )


def plate_frequency(rubber: Diaphragm, rim: str, functions: int = FUNCTIONS) -> float:
    """Return the exact frequency [Hz] of the mode of ``plate``, by Rayleigh's quotient.

    The deflection is w(r) cos(angle), w of ``functions`` odd powers. Per area the sheet holds
    rho g w^2/2 and kappa/2 (w_rr^2 + 2 nu w_rr b + (3 - 2 nu) b^2), b = (w/r)', and moves rho_d t
    and the liquid below. The rim's conditions are the deflection's and the slope's; those of moment
    and shear come by themselves. Shares no code with the cloth.
    """
    node, weight = legendre.leggauss(2 * functions)
    node, weight = 0.5 * (node + 1.0), 0.5 * weight
    single = np.eye(functions)

    def powers(t: Array) -> tuple[Array, Array, Array]:
        """p, p' and p'' (functions, q) of the Legendre polynomials in t = r^2, on [0, 1]."""
        x = 2.0 * t - 1.0
        first = np.array([2.0 * legendre.legval(x, legendre.legder(row)) for row in single])
        second = np.array([4.0 * legendre.legval(x, legendre.legder(row, 2)) for row in single])
        return np.asarray(legendre.legvander(x, functions - 1).T), first, second

    p, by, twice = powers(node**2)  # w = r p(r^2)
    bent, turned = 6.0 * node * by + 4.0 * node**3 * twice, 2.0 * node * by
    area, nu = weight * node, rubber.poisson_ratio
    cross = (bent * area) @ turned.T
    bending = (bent * area) @ bent.T + nu * (cross + cross.T)
    bending += (3.0 - 2.0 * nu) * (turned * area) @ turned.T
    mass = (p * node * area) @ (p * node).T
    liquid = surface_inertia(1.0, node, weight, p * node)
    stiffness = DENSITY * GRAVITY * mass + rubber.bending_stiffness / RADIUS**4 * bending
    inertia = DENSITY * RADIUS * liquid + rubber.area_density * mass
    at_rim = np.stack([part[:, 0] for part in powers(np.ones(1))[:2]])[: HELD[rim]]
    kept = null_space(at_rim) if len(at_rim) else single
    value = eigh(kept.T @ stiffness @ kept, kept.T @ inertia @ kept, eigvals_only=True)
    return float(np.sqrt(value[0]) / (2.0 * np.pi))


def sheet_frequency(rubber: Diaphragm, rim: str, rings: int, degree: int) -> float:
    """Return the frequency [Hz] of ``plate`` by the cloth's matrices and harmonic polynomials.

    The sheet has the cloth's bending stiffness and mass, on ``rings``; ``degree`` is that of the
    liquid's polynomials.
    """
    mesh = disc(RADIUS, rings, SECTORS * rings)
    if rim == "free":
        mesh = replace(mesh, fixed=np.zeros_like(mesh.fixed))
    count, free = len(mesh.points), ~mesh.fixed
    bent = bending_of(
        mesh,
        np.full(count, rubber.bending_stiffness),
        rubber.poisson_ratio,
        clamped=rim == "clamped",
    )
    stiffness = sp.csc_matrix(bent.matrix + DENSITY * GRAVITY * _heights_squared(mesh))
    harmonics = SolidHarmonics(degree, RADIUS)
    liquid = RitzLiquid(
        triangles=mesh.triangles,
        harmonics=harmonics,
        wall=wall_integral(harmonics, *Sphere(RADIUS).quadrature(degree)),
        density=DENSITY,
    )
    rows = liquid.at(mesh.points).rows()[:, free, 2]
    mass = lumped(mesh, rubber.area_density)[free]
    inertia = spl.LinearOperator(
        (len(mass), len(mass)), matvec=lambda v: mass * v + rows.T @ (rows @ v), dtype=np.float64
    )
    held = stiffness[free][:, free]
    inverse = spl.LinearOperator(held.shape, matvec=spl.splu(held).solve, dtype=np.float64)
    slope = mesh.points[free, 0]
    square, shape = spl.eigsh(inertia, k=MODES, M=held, Minv=inverse, v0=slope)
    alike = np.abs(shape.T @ (inertia @ slope)) / np.sqrt(square)
    return float(1.0 / (2.0 * np.pi * np.sqrt(square[np.argmax(alike)])))


def _heights_squared(mesh: Mesh) -> sp.csc_matrix:
    """int h^2 dA (n, n) [m^2] of heights that are linear on every triangle."""
    size = len(mesh.points)
    corner = mesh.points[mesh.triangles]
    area = 0.5 * np.linalg.norm(
        np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1
    )
    blocks = area[:, None, None] * (1.0 + np.eye(3)) / 12.0
    rows = np.repeat(mesh.triangles[:, :, None], 3, axis=2)
    columns = np.repeat(mesh.triangles[:, None, :], 3, axis=1)
    return sp.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
