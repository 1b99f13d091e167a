"""A free tank that turns: its answer to the sheet is what the step's matrix has of it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from cloth.kinematics import kinematics
from cloth.material import Diaphragm
from cloth.mesh import moulded
from cloth.model import ClothModel
from cloth.recoil import first_moment
from cloth.rotation import axial, cross_matrix, rotation_matrix
from cloth.rotor import TurningRecoil
from cloth.shell.sphere import Hemisphere, Sphere

RUBBER = Diaphragm(density=1070.0, youngs_modulus=8.6e6, poisson_ratio=0.5, thickness=0.002)
RADIUS, WATER, STEP = 0.4, 1000.0, 0.01
BELOW = np.array([0.0, 0.0, -0.002])  # m^4
SECOND = np.diag([0.1, 0.15, 0.2])


@dataclass(frozen=True, kw_only=True)
class Rotating:
    history: np.ndarray
    torque: np.ndarray = field(default_factory=lambda: np.zeros(3))
    stiffness: np.ndarray = field(default_factory=lambda: np.diag([3.0, 1.0, 2.0]))
    walls: np.ndarray | None = None


@dataclass(frozen=True, kw_only=True)
class Given:
    """A load and its recoil in one."""

    rotor: Rotating
    prediction: np.ndarray
    density: float = WATER
    volume: float | None = None
    datum: float | None = 0.0
    compliance: np.ndarray = field(default_factory=lambda: np.diag([0.05, 0.04, 0.03]))
    below_rim: np.ndarray = field(default_factory=lambda: BELOW)
    body_force: np.ndarray = field(default_factory=lambda: np.array([0.3, 0.0, -9.81]))

    @property
    def recoil(self) -> Given:
        return self


@pytest.fixture(scope="module")
def model() -> ClothModel:
    mesh = moulded(Hemisphere(RADIUS), 5)
    return ClothModel(
        mesh=mesh, diaphragm=RUBBER, thickness=None, clamped=mesh.points, shell=Sphere(RADIUS),
        tensile_stiffness=None, compressive_stiffness=None, self_contact=False,
    )  # fmt: skip


def recoil(model: ClothModel, x: np.ndarray) -> TurningRecoil:
    """Of a tank whose sheet rests at ``x``, with a liquid that has some inertia."""
    still, count = np.zeros_like(x), 7
    rows = 0.2 * np.random.default_rng(4).standard_normal((count, *x.shape))
    walls = 0.1 * np.random.default_rng(5).standard_normal((count, 3))
    rotor = Rotating(history=SECOND, walls=walls)
    given = Given(rotor=rotor, prediction=first_moment(model, WATER, x, BELOW))
    kin = kinematics(STEP, 0.0, x, still, x, still)
    return TurningRecoil(model, given, given, rotor, kin=kin, start=x, rows=rows)


def test_matrix_is_the_answer_s_derivative(model):
    """By a central difference, at a sheet that has not moved; the matrix is off by theta there."""
    x = model.mesh.points * [1.0, 1.0, -0.4]
    none = np.zeros_like(x)
    way = np.random.default_rng(2).standard_normal(x.shape) * model.free[:, None]
    tank = recoil(model, x)
    assert np.abs(tank.answer(x, none).turned).max() < 1e-5
    step = 1e-5

    def whole(at: np.ndarray) -> np.ndarray:
        linear = np.einsum("kix,k->ix", tank.push, np.einsum("kix,ix->k", tank.pull, at))
        found = tank.answer(at, none)
        weight = np.zeros_like(at)
        for axis, row in enumerate(tank._weight):  # what the iteration itself adds, the pressure's
            weight += (row - np.where(model.free, model.mass, 0.0)[:, None] * np.eye(3)[axis]) * (
                found.body_force[axis]
            )
        return found.force + linear + weight

    slope = (whole(x + step * way) - whole(x - step * way)) / (2.0 * step)
    exact = np.einsum("kix,k->ix", tank.push, np.einsum("kix,ix->k", tank.pull, way))
    assert np.abs(slope - exact).max() < 1e-4 * np.abs(exact).max()


def test_a_body_that_turns_as_one_is_answered_by_all_its_inertia(model):
    """Of a sheet that does not move in the tank: theta is b^2 times torque over inertia."""
    x = model.mesh.points
    none, torque = np.zeros_like(x), np.array([0.02, -0.01, 0.03])
    still = kinematics(STEP, 0.0, x, none, x, none)
    rotor = Rotating(history=SECOND, torque=torque, stiffness=np.zeros((3, 3)))
    # In free fall no weight acts, and the contents' first moment is where it was.
    given = Given(
        rotor=rotor, prediction=model.mass @ x, body_force=np.zeros(3), density=0.0,
        compliance=np.eye(3) * 1e-9,
    )  # fmt: skip
    tank = TurningRecoil(model, given, given, rotor, kin=still, start=x, rows=None)
    found = tank.answer(x, none).turned
    second = SECOND + x.T @ (model.mass[:, None] * x)
    inertia = np.trace(second) * np.eye(3) - second
    # The rotation's own square is left: theta is of 1e-5.
    assert found == pytest.approx(STEP**2 * np.linalg.solve(inertia, torque), rel=1e-4)


def test_products_of_matrices_are_those_of_vectors():
    first, second = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -1.0])
    assert cross_matrix(first) @ second == pytest.approx(np.cross(first, second))
    assert axial(np.outer(second, first)) == pytest.approx(np.cross(first, second))
    turned = rotation_matrix(1e-6 * first) @ second
    assert turned == pytest.approx(second + 1e-6 * np.cross(first, second), abs=1e-11)
