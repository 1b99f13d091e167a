"""A free tank's recoil: its moments against differences, its matrix against a dense one."""

from dataclasses import dataclass, field

import numpy as np
import pytest
import scipy.sparse as sp

from cloth.linear import System
from cloth.material import Diaphragm
from cloth.mesh import moulded
from cloth.model import ClothModel
from cloth.recoil import TankRecoil, first_moment, moment_rows
from cloth.shell.sphere import Hemisphere, Sphere

RUBBER = Diaphragm(density=1070.0, youngs_modulus=8.6e6, poisson_ratio=0.5, thickness=0.002)
RADIUS, WATER = 0.4, 1000.0


@dataclass(frozen=True, kw_only=True)
class Given:
    """A load and its recoil in one."""

    compliance: np.ndarray
    prediction: np.ndarray
    density: float = WATER
    volume: float | None = 0.1
    datum: float | None = None
    below_rim: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -0.02]))

    @property
    def body_force(self):
        return np.array([0.3, 0.0, -9.81])

    @property
    def recoil(self):
        return self


@pytest.fixture(scope="module")
def model() -> ClothModel:
    mesh = moulded(Hemisphere(RADIUS), 5)
    return ClothModel(
        mesh=mesh, diaphragm=RUBBER, thickness=None, clamped=mesh.points, shell=Sphere(RADIUS),
        tensile_stiffness=None, compressive_stiffness=None, self_contact=False,
    )  # fmt: skip


@pytest.fixture
def moved(model) -> np.ndarray:
    """A folded shape, its fixed nodes where they are."""
    shift = 0.05 * np.random.default_rng(1).standard_normal(model.mesh.points.shape)
    return model.mesh.points * [1.0, 1.0, -0.4] + np.where(model.free[:, None], shift, 0.0)


@pytest.mark.parametrize("density", [0.0, WATER])
def test_rows_are_the_moment_s_derivative(model, moved, density: float):
    """A cubic's central difference errs by the square of the step alone."""
    rows = moment_rows(model, density, moved)
    way = np.random.default_rng(2).standard_normal(moved.shape) * model.free[:, None]
    step = 1e-5
    both = [
        first_moment(model, density, moved + sign * step * way, np.zeros(3)) for sign in (1.0, -1.0)
    ]
    found = np.einsum("kix,ix->k", rows, way)
    # Third derivative over 6: the density times some of the mesh's way cubed.
    allowed = 1e-8 * np.abs(found).max() + WATER * step**2 * np.sum(way**2) * np.abs(way).max()
    assert np.abs((both[0] - both[1]) / (2.0 * step) - found).max() < allowed


def test_pressure_of_the_recoil_is_that_of_the_iteration(model, moved):
    """Its rows are the force of a unit body force, as ``triangle_step`` has the pressure's."""
    from cloth.reference import pressure_step

    force = np.zeros_like(moved)
    pressure_step(moved, model.triangles, 0.0, np.array([0.0, WATER, 0.0]), force)
    force[:, 1] += model.mass
    force[model.mesh.fixed] = 0.0
    row = moment_rows(model, WATER, moved)[1]
    assert np.abs(row - force).max() < 1e-12 * np.abs(force).max()


def test_body_force_answers_to_what_moves(model, moved):
    """Contents of a tenth of the mass that accelerate by 1 m/s^2 push the tank back by 0.1."""
    b, mass = 0.01, 10.0 * model.mass.sum()
    start = first_moment(model, 0.0, moved, np.zeros(3))
    given = Given(compliance=np.eye(3) / mass, prediction=start, density=0.0, volume=None)
    step = TankRecoil(model, given, given, b=b, start=moved)
    moved = moved + b * b * np.array([0.0, 1.0, 0.0])
    found = step.answer(moved, np.zeros_like(moved))
    assert found.body_force == pytest.approx([0.3, 0.1, -9.81])
    assert not found.turned.any()


def dense(system_of, rows: np.ndarray, free: np.ndarray) -> np.ndarray:
    """B^T B over the free nodes' unknowns."""
    flat = rows[:, free].reshape(len(rows), -1)
    return system_of + flat.T @ flat


@pytest.mark.parametrize("same", [True, False])
def test_matrix_is_that_of_a_dense_solve(same: bool):
    """With the liquid's rows and the recoil's, symmetric and not; to the matrix' condition."""
    random, count = np.random.default_rng(3), 12
    root = random.standard_normal((count, count))
    matrix = root @ root.T + count * np.eye(count)
    free = np.arange(count) > 2
    inertia = random.standard_normal((2, count, 3)) * free[None, :, None]
    push = 0.2 * random.standard_normal((3, count, 3)) * free[None, :, None]
    pull = push if same else push + 0.02 * random.standard_normal(push.shape)
    pull = pull * free[None, :, None]
    system = System(sp.csc_matrix(matrix), free)
    system.add_mass(inertia)
    system.take_recoil(push, pull)
    right = random.standard_normal((count, 3)) * free[:, None]
    whole = dense(np.kron(matrix[np.ix_(free, free)], np.eye(3)), inertia, free)
    whole -= push[:, free].reshape(3, -1).T @ pull[:, free].reshape(3, -1)
    exact = np.linalg.solve(whole, right[free].ravel()).reshape(-1, 3)
    assert np.abs(system.solve(right)[free] - exact).max() < 1e-12 * np.abs(exact).max()
    system.add_mass(None)
    exact = np.linalg.solve(matrix[np.ix_(free, free)], right[free])
    assert np.abs(system.solve(right)[free] - exact).max() < 1e-12 * np.abs(exact).max()


def test_a_tank_without_mass_is_refused():
    """What moves in it cannot have more inertia than both together."""
    free = np.ones(4, dtype=bool)
    system = System(sp.csc_matrix(np.eye(4)), free)
    heavy = np.zeros((3, 4, 3))
    for axis in range(3):
        heavy[axis, :, axis] = 0.51
    with pytest.raises(ArithmeticError, match="too light"):
        system.take_recoil(heavy, heavy)
    system.take_recoil(0.9 * heavy, 0.9 * heavy)
