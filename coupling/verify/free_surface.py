"""A free liquid surface as the structure: the stiffness of gravity and of a tension, no other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from coupling.finite_volume.swept import swept_gradient
from coupling.ports import Array, HydrostaticLoad, Ints

LUMPED = 0.05


def slope_form(plan: Array, faces: Ints) -> Array:
    """Return the matrix of int grad h . grad h over bilinear quadrilaterals.

    By 2 x 2 Gauss points a face: exact for parallelograms.

    Parameters
    ----------
    plan
        Points in the plane (p, 2) [m].
    faces
        Corners of the quadrilaterals (F, 4), counter-clockwise, convex; not checked.

    Returns
    -------
    Array
        Symmetric matrix (p, p) [-], dense.
    """
    node = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)
    u, v = np.repeat(node, 2), np.tile(node, 2)
    by_u = np.stack([v - 1, 1 - v, v, -v], axis=1)
    by_v = np.stack([u - 1, -u, u, 1 - u], axis=1)
    slopes = np.stack([by_u, by_v], axis=1)  # (Q, 2, 4)
    jacobian = slopes @ plan[faces][:, None]  # (F, Q, 2, 2)
    gradient = np.linalg.solve(jacobian, np.broadcast_to(slopes, (len(faces), *slopes.shape)))
    area = np.linalg.det(jacobian) / 4
    parts = np.einsum("fq,fqxi,fqxj->fij", area, gradient, gradient)
    form = np.zeros((len(plan), len(plan)))
    np.add.at(form, (faces[:, :, None], faces[:, None, :]), parts)
    return form


@dataclass(frozen=True, kw_only=True)
class SurfaceState:
    """A ``StructureState``; ``volume`` [m^3] is what the heights add."""

    position: Array
    velocity: Array
    datum_pressure: float
    volume: float
    strain: Array


@dataclass(frozen=True, kw_only=True)
class SurfaceStep:
    """A step in hand, of heights (p,) [m]; ``b`` [s] is its formula's.

    ``anchor`` and ``predicted`` (p,): without speed and without forces; ``force`` (p,) [N] of the
    load and of all inertia at ``predicted``; ``matrix`` (p + 1, p + 1), bordered by the volume.
    """

    b: float
    anchor: Array
    predicted: Array
    force: Array
    matrix: Array


class FreeSurface:
    """Small heights above a level surface whose nodes are the flow's patch points.

    A node moves along ``path`` (p, 3), which is 1 along gravity's opposite: straight up inside, and
    tangentially to the wall at the rim. Gravity's stiffness rho g A acts on the faces' means, as
    the flow's pressure does, but for a share ``LUMPED`` on the nodes, which gives a stiffness to
    the checkerboard that no mean sees. A surface mass ``mass`` [kg/m^2] is lumped, a ``tension``
    [N/m] acts on bilinear faces. Exact for small heights up to the grid's error; steps are
    ``backward``, the first one Euler.
    """

    def __init__(
        self,
        points: Array,
        faces: Ints,
        path: Array,
        *,
        mass: float,
        density: float,
        gravity: float,
        tension: float = 0.0,
    ) -> None:
        self.reference, self.path = points, path
        self.triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        self.fixed: NDArray[np.bool_] = np.zeros(len(points), dtype=bool)
        gradient = np.zeros_like(points)
        np.add.at(gradient, faces, swept_gradient(points[faces]))
        self._area = np.einsum("px,px->p", gradient, path)  # dV/dh: the volume a height adds
        self._mass = mass * self._area
        flux = np.zeros((len(faces), len(points)))
        along = np.einsum("fkx,fkx->fk", swept_gradient(points[faces]), path[faces])
        np.add.at(flux, (np.arange(len(faces))[:, None], faces), along)
        self._flux, self._centre = flux, points[faces].mean(axis=1)
        means = flux.T @ (flux / flux.sum(axis=1)[:, None])
        lumped = np.diag(self._area)
        self._stiffness = density * gravity * ((1 - LUMPED) * means + LUMPED * lumped)
        self._stiffness += tension * slope_form(points[:, :2], faces)
        self.height = np.zeros(len(points))
        self.speed = np.zeros((2, len(points)))  # now, one step ago
        self._before = self._now = self.height  # a step ago; what the last solve has found
        self.steps = 0
        self._step: SurfaceStep | None = None

    def mode(self, shape: Array, liquid_inertia: Array) -> tuple[float, Array]:
        """Return the mode of small oscillations that is most like given heights.

        It keeps the volume.

        Parameters
        ----------
        shape
            Heights of the points (p,), of any unit.
        liquid_inertia
            Rows B (r, p, 3) [kg^(1/2)] of the liquid's inertia B^T B.

        Returns
        -------
        omega : float
            Its angular frequency [1/s].
        heights : Array
            Its heights (p,) [-], the one of largest magnitude 1.
        """
        rows = np.einsum("rpx,px->rp", liquid_inertia, self.path)
        inertia = rows.T @ rows + np.diag(self._mass)
        kept = null_space(self._area[None])
        value, vector = eigh(kept.T @ self._stiffness @ kept, kept.T @ inertia @ kept)
        most = int(np.argmax(np.abs(vector.T @ (kept.T @ (inertia @ shape)))))
        heights = kept @ vector[:, most]
        return float(np.sqrt(value[most])), heights / heights[np.argmax(np.abs(heights))]

    def displace(self, height: Array) -> None:
        """Start at rest from ``height`` (p,) [m], its mean removed."""
        self.height = self._before = height - self._area @ height / self._area.sum()

    def moment(self, shape: Array) -> float:
        """Integral of the heights times ``shape`` (p,) [m^3]."""
        return float((self._area * shape) @ self.height)

    def energy(self, liquid_inertia: Array) -> float:
        """Kinetic and potential energy [J] with the liquid's ``liquid_inertia`` (r, p, 3)."""
        speed = self.speed[0]
        liquid = np.einsum("rpx,px,p->r", liquid_inertia, self.path, speed)
        kinetic = float(liquid @ liquid + speed @ (self._mass * speed))
        return 0.5 * (kinetic + float(self.height @ self._stiffness @ self.height))

    def begin_step(
        self, dt: float, load: HydrostaticLoad, liquid_inertia: Array | None = None
    ) -> None:
        """Start a step of ``dt`` [s]; gravity is built in, ``load`` adds its horizontal part."""
        sideways = load.body_force * (1.0, 1.0, 0.0)
        force = load.density * self._flux.T @ (self._centre @ sideways)
        if self.steps == 0:
            b, anchor, speed = dt, self.height, self.speed[0]
        else:
            b = 2 * dt / 3
            anchor = (4 * self.height - self._before) / 3
            speed = (4 * self.speed[0] - self.speed[1]) / 3
        predicted = anchor + b * speed
        force = force + self._mass * predicted / b**2
        matrix = np.diag(self._mass) / b**2 + self._stiffness
        if liquid_inertia is not None:
            rows = np.einsum("rpx,px->rp", liquid_inertia, self.path)
            matrix += rows.T @ rows / b**2
            force += rows.T @ (rows @ predicted) / b**2
        border = self._area[:, None]  # by the volume: the heights add none
        bordered = np.block([[matrix, border], [border.T, np.zeros((1, 1))]])
        self._step = SurfaceStep(
            b=b, anchor=anchor, predicted=predicted, force=force, matrix=bordered
        )

    @property
    def step(self) -> SurfaceStep:
        """The step that has begun."""
        if self._step is None:
            raise RuntimeError("free surface: begin_step comes first.")
        return self._step

    @property
    def acceleration_scale(self) -> float:
        """b^2 [s^2] of this step's implicit formula."""
        return self.step.b**2

    def still_position(self) -> Array:
        """Where the nodes (p, 3) [m] would have no velocity."""
        return np.asarray(self.reference + self.step.anchor[:, None] * self.path)

    def inertial_prediction(self) -> Array:
        """Where the nodes (p, 3) [m] would go without forces."""
        return np.asarray(self.reference + self.step.predicted[:, None] * self.path)

    def solve(self, force: Array) -> Array:
        """Nodes (p, 3) [m] under nodal ``force`` (p, 3) [N]."""
        right = np.einsum("px,px->p", force, self.path) + self.step.force
        self._now = np.linalg.solve(self.step.matrix, np.append(right, 0.0))[:-1]
        return self.reference + self._now[:, None] * self.path

    def accept_step(self) -> None:
        """Commit the last solve."""
        self.speed = np.stack([(self._now - self.step.anchor) / self.step.b, self.speed[0]])
        self._before, self.height = self.height, self._now
        self.steps += 1

    @property
    def state(self) -> SurfaceState:
        """The committed state."""
        return SurfaceState(
            position=self.reference + self.height[:, None] * self.path,
            velocity=self.speed[0][:, None] * self.path,
            datum_pressure=0.0,
            volume=float(self._area @ self.height),
            strain=np.zeros(len(self.triangles)),
        )

    def save(self) -> dict[str, Array]:
        """Heights and speeds of two steps."""
        return {"height": np.stack([self.height, self._before]), "speed": self.speed}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self.height, self._before = saved["height"]
        self.speed = saved["speed"]
        self.steps = 1
