"""A membrane on the liquid of an upright cylinder: the frequency of one of its modes."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.special import jnp_zeros, jv
from threadpoolctl import threadpool_limits

from cloth.shell.sphere import Sphere
from coupling.finite_volume.geometry import fan_volume
from coupling.finite_volume.mesh import LiquidMesh
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.ritz import RitzLiquid, wall_integral
from coupling.foam.installation import find_openfoam
from coupling.ports import Array, Ints
from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.disc import disc_grid
from coupling.verify.free_surface import FreeSurface
from coupling.verify.potential_slosh import FACES
from coupling.verify.prism import prism_mesh
from coupling.verify.release import coupled_release, fitted_frequency
from coupling.verify.sheets import within

RADIUS, GRAVITY, DENSITY = 0.4445, 9.81, 1000.0
MEMBRANE = 1.9025  # kg/m^2: 1.778 mm of AF-E-332
AMPLITUDE = 2e-3  # over R
PERIODS = 2.0


def cylinder(
    *,
    tension: float = 100.0,
    mode: str = "1,1",
    depth: float = 1.0,
    fluid: str = "potential",
    step: float = 0.02,
    resolution: int = 0,
) -> VerifyResult:
    """Frequency ``omega`` of a heavy membrane under ``tension`` [N/m] that slides up the wall.

    omega^2 = (rho g + T k^2)/(rho_d t + rho coth(k H)/k), k = j'_mn/R; ``mode``: m,n; ``depth``: H
    over R. ``fluid``:

    - ``potential``: the surface's mode on the liquid of harmonic polynomials; ``resolution``: their
      degree d, 0 for 12, with 4 d^2 faces on the surface. No step. The error is of order 2 in 1/d
      and below 1 % from d = 2 k R on; below that the polynomials do not hold the mode.
    - ``openfoam``: released from the mode's shape, through the whole coupling; ``step`` [s],
      ``resolution``: cells of the mesh, 0 for 2000. ``backward`` lowers omega by (omega dt)^2/3.
    """
    clock = perf_counter()
    m, k = _wave_number(mode)
    if fluid not in ("openfoam", "potential"):
        raise CaseError(f"verify cylinder: --fluid: must be openfoam or potential, got '{fluid}'.")
    if not (depth > 0 and tension >= 0):
        raise CaseError("verify cylinder: --depth must be positive and --tension not negative.")
    inertia = MEMBRANE + DENSITY / (k * np.tanh(k * depth * RADIUS))
    omega = float(np.sqrt((DENSITY * GRAVITY + tension * k**2) / inertia))
    tank = Tank(tension=tension, order=m, wave_number=k, depth=depth)
    if fluid == "potential":
        step, resolution = 0.0, resolution or 12
        within("cylinder", "resolution", resolution, 2, 24)
        with threadpool_limits(1):
            found = tank.potential(resolution)
    else:
        resolution = resolution or 2000
        within("cylinder", "step", step, 1e-4, 0.1 * np.pi / omega)  # 20 of them in a period
        within("cylinder", "resolution", resolution, 8, 100_000)
        with tempfile.TemporaryDirectory() as folder:
            found = tank.openfoam(Path(folder), omega, step, resolution)
    return VerifyResult(
        case="cylinder",
        options={
            "tension": tension,
            "mode": mode,
            "depth": depth,
            "fluid": fluid,
            "step": step,
            "resolution": resolution,
        },
        quantities=(quantity("omega", found, omega, "rad/s"),),
        wall_s=perf_counter() - clock,
    )


def _wave_number(mode: str) -> tuple[int, float]:
    """m and k [1/m] of the mode m,n."""
    try:
        m, n = (int(part) for part in mode.split(","))
    except ValueError:
        m, n = -1, 0
    if m < 0 or n < 1:
        raise CaseError(f"verify cylinder: --mode: must be m,n as in 1,1, got '{mode}'.")
    return m, float(jnp_zeros(m, n)[-1]) / RADIUS


@dataclass(frozen=True, kw_only=True)
class Tank:
    """A cylinder of ``depth`` over R, its membrane's ``tension`` [N/m], and one of its modes.

    ``order``: m, the number of the mode's nodal diameters; ``wave_number``: k [1/m].
    """

    tension: float
    order: int
    wave_number: float
    depth: float

    def potential(self, degree: int) -> float:
        """omega [1/s] of the mode with the liquid's inertia by polynomials of ``degree``.

        Their origin is the middle of the liquid.
        """
        plan, quads = disc_grid(FACES * degree**2)
        half = 0.5 * self.depth * RADIUS
        top = np.column_stack([RADIUS * plan, np.full(len(plan), half)])
        surface = self.surface(top, quads)
        harmonics = SolidHarmonics(degree, float(np.hypot(RADIUS, half)))
        wall = wall_integral(harmonics, *cylinder_samples(degree, RADIUS, half))
        liquid = RitzLiquid(
            triangles=surface.triangles, harmonics=harmonics, wall=wall, density=DENSITY
        )
        return surface.mode(self.shape(top), liquid.at(top).rows())[0]

    def openfoam(self, folder: Path, omega: float, step: float, cells: int) -> float:
        """Return omega [1/s] of the surface released from the mode's shape, on OpenFOAM's liquid.

        In ``folder``, with at most so many ``cells`` and steps of ``step`` [s]; ``omega`` [1/s] is
        the expected one, which sets the duration and begins the fit. Raises ``RunFailed``.
        """
        mesh = prism_mesh(cells, self.depth)
        flow = OpenFoamFlow(
            folder, mesh, openfoam=find_openfoam(keep_alive=True), shell=Sphere(RADIUS),
            density=DENSITY, viscosity=1e-6, timeout=120.0,
        )  # fmt: skip
        top, shell = (
            RADIUS * mesh.points[mesh.patch_points],
            RADIUS * mesh.points[mesh.shell_points],
        )
        surface = self.surface(top, flow.faces)
        shape = self.shape(top)
        surface.displace(AMPLITUDE * RADIUS * shape)
        flow.start(surface.state.position, shell, _volume(mesh))
        try:
            time, signal = coupled_release(
                surface, flow, shape, step=step, duration=PERIODS * 2 * np.pi / omega,
                acceleration=AMPLITUDE * RADIUS * omega**2,
            )  # fmt: skip
        finally:
            flow.close()
        return fitted_frequency(time, signal, omega)

    def surface(self, top: Array, faces: Ints) -> FreeSurface:
        """Return the membrane as a free surface whose nodes move straight up.

        Parameters
        ----------
        top
            Points of the level surface (p, 3) [m], those of the rim included.
        faces
            Corners of its quadrilaterals (F, 4), as ``FreeSurface`` takes them.

        Returns
        -------
        FreeSurface
            The membrane on the liquid, level and at rest.
        """
        path = np.zeros_like(top)
        path[:, 2] = 1.0
        return FreeSurface(
            top, faces, path,
            mass=MEMBRANE, density=DENSITY, gravity=GRAVITY, tension=self.tension,
        )  # fmt: skip

    def shape(self, top: Array) -> Array:
        """Return the heights (p,) [-] of the mode at ``top`` (p, 3) [m], of largest magnitude 1."""
        angle = np.arctan2(top[:, 1], top[:, 0])
        distance = np.linalg.norm(top[:, :2], axis=1)
        shape = jv(self.order, self.wave_number * distance) * np.cos(self.order * angle)
        return np.asarray(shape / np.abs(shape).max())


def cylinder_samples(degree: int, radius: float, half: float) -> tuple[Array, Array]:
    """Points (N, 3) [m] on side and bottom, z = -``half`` to ``half`` [m]; area vectors (N, 3).

    Exact for products of two polynomials of ``degree``: Gauss's points along the height and in the
    square of the distance from the axis, even ones around.
    """
    count = degree + 1
    node, weight = np.polynomial.legendre.leggauss(count)
    angle = np.pi * np.arange(2 * count) / count
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    flat = (count, 2 * count)
    side, bottom = np.empty((2, *flat, 3))
    side[..., :2], side[..., 2] = radius * around, half * node[:, None]
    bottom[..., :2] = radius * np.sqrt(0.5 * (1.0 + node))[:, None, None] * around
    bottom[..., 2] = -half
    outward, down = side * (1.0, 1.0, 0.0), np.broadcast_to((0.0, 0.0, -1.0), bottom.shape)
    share = (np.pi / count) * weight[:, None, None]  # of a turn and of [-1, 1]
    area = np.concatenate([half * share * outward, 0.25 * radius**2 * share * down])
    return np.concatenate([side, bottom]).reshape(-1, 3), area.reshape(-1, 3)


def _volume(mesh: LiquidMesh) -> float:
    """Of the reference mesh [m^3]."""
    return RADIUS**3 * fan_volume(mesh.points[mesh.faces[mesh.inner_faces :]])
