"""Coupling schemes on model problems whose convergence theory predicts."""

import numpy as np
import pytest

from coupling.scene.numerics import Coupling
from coupling.schemes import SCHEMES
from coupling.schemes.aitken import Aitken
from coupling.schemes.fixed_point import FixedPoint
from coupling.schemes.iqn_ils import IqnIls, IqnIlsSettings


def iterate(scheme, matrix, offset, x, count, tolerance=0.0):
    """Residuals' norms of ``count`` iterations on x = matrix x + offset; stops at ``tolerance``."""
    scheme.begin_step()
    norms = []
    for _ in range(count):
        residual = matrix @ x + offset - x
        norms.append(float(np.linalg.norm(residual)))
        if norms[-1] <= tolerance:
            break
        x = scheme.update(x, residual)
    return np.array(norms), x


def end_step(scheme, matrix, offset, x):
    """Let the step of x = matrix x + offset end at ``x``."""
    scheme.accept_step(x, matrix @ x + offset - x)


def added_mass_problem(ratio):
    """One mode whose liquid is ``ratio`` times as heavy as the wall: S(F(x)) = -ratio x + 1."""
    return np.array([[-ratio]]), np.array([1.0])


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.1, 4.0, 139.0])
def test_fixed_point_has_the_factor_of_theory(ratio):
    norms, _ = iterate(FixedPoint(), *added_mass_problem(ratio), np.zeros(1), 6)
    assert norms[1:] / norms[:-1] == pytest.approx(ratio, rel=1e-9)
    assert (norms[-1] > norms[0]) == (ratio > 1)


def test_relaxed_fixed_point_converges_below_its_bound():
    # Factor |1 - omega (1 + ratio)|: convergent for omega < 2/(1 + ratio).
    matrix, offset = added_mass_problem(4.0)
    inside, _ = iterate(FixedPoint(0.39), matrix, offset, np.zeros(1), 20)
    outside, _ = iterate(FixedPoint(0.41), matrix, offset, np.zeros(1), 20)
    assert inside[-1] < inside[0]
    assert outside[-1] > outside[0]
    assert inside[1] / inside[0] == pytest.approx(abs(1 - 0.39 * 5), rel=1e-9)


def test_aitken_solves_one_mode_in_three():
    # A secant: two evaluations determine a linear scalar problem.
    norms, x = iterate(Aitken(0.1), *added_mass_problem(139.0), np.zeros(1), 3)
    assert norms[2] < 1e-12 * norms[0]
    assert x == pytest.approx(1 / 140)


def test_aitken_converges_where_the_fixed_point_does_not():
    matrix = -np.diag([0.5, 3.0, 9.0])
    norms, _ = iterate(Aitken(0.1), matrix, np.ones(3), np.zeros(3), 200, 1e-10)
    assert norms[-1] <= 1e-10
    assert iterate(FixedPoint(), matrix, np.ones(3), np.zeros(3), 20)[0][-1] > 1e10


def test_aitken_starts_a_step_no_larger_than_its_bound():
    scheme = Aitken(0.1)
    iterate(scheme, np.array([[0.9]]), np.ones(1), np.zeros(1), 3)  # leads to omega = 10
    scheme.begin_step()
    assert scheme.update(np.zeros(1), np.ones(1)) == pytest.approx(0.1)


def random_problem(dimension, seed=0):
    generator = np.random.default_rng(seed)
    basis = np.linalg.qr(generator.normal(size=(dimension, dimension)))[0]
    matrix = basis @ np.diag(-np.geomspace(0.2, 50.0, dimension)) @ basis.T
    return matrix, generator.normal(size=dimension)


@pytest.mark.parametrize("dimension", [1, 2, 4, 8])
def test_iqn_ils_needs_no_more_than_the_dimension(dimension):
    # k residual differences span the space: after the first, relaxed, update k + 1 more suffice.
    matrix, offset = random_problem(dimension)
    scheme = IqnIls(0.1, 0, settings=IqnIlsSettings(filtering=1e-6))
    norms, x = iterate(scheme, matrix, offset, np.zeros(dimension), dimension + 3, 1e-9)
    assert norms[-1] <= 1e-9
    assert len(norms) <= dimension + 2  # residuals: the first one, and one an update
    assert x == pytest.approx(np.linalg.solve(np.eye(dimension) - matrix, offset), abs=1e-8)


def test_iqn_ils_reuses_former_steps():
    dimension = 6
    matrix, offset = random_problem(dimension)
    scheme = IqnIls(0.1, 4)
    _, x = iterate(scheme, matrix, offset, np.zeros(dimension), 20, 1e-9)
    end_step(scheme, matrix, offset, x)
    norms, _ = iterate(scheme, matrix, 2 * offset, np.zeros(dimension), 20, 1e-9)
    assert len(norms) <= 3  # the Jacobian is known: one update, but for rounding
    fresh, _ = iterate(IqnIls(0.1, 0), matrix, 2 * offset, np.zeros(dimension), 20, 1e-9)
    assert len(fresh) > 4


def test_iqn_ils_keeps_the_pair_that_converges_a_step():
    # A scalar problem is solved by the second update's residual: the step's only difference of
    # residuals is the one that its last iterate makes, and the next step needs no other.
    scheme = IqnIls(0.1, 1)
    problem = added_mass_problem(9.0)
    scheme.begin_step()
    x = scheme.update(np.zeros(1), problem[1])  # 0.1, the solution
    end_step(scheme, *problem, x)
    assert len(scheme.save()) == 2
    norms, _ = iterate(scheme, problem[0], 2 * problem[1], np.zeros(1), 3, 1e-12)
    assert len(norms) == 2


def test_iqn_ils_drops_columns_that_depend_on_newer_ones():
    scheme = IqnIls(0.1, 4)
    columns = np.array([[1.0, 0.0], [1.0, 1e-6], [0.0, 1.0]]).T
    assert scheme._independent(columns) == [0, 2]


def test_iqn_ils_forgets_steps_beyond_its_reuse():
    scheme = IqnIls(0.1, 2)
    for seed in range(4):
        problem = random_problem(3, seed)
        _, x = iterate(scheme, *problem, np.zeros(3), 4)
        end_step(scheme, *problem, x)
    assert len(scheme.save()) == 4  # V and W of two steps


@pytest.mark.parametrize("name", SCHEMES)
def test_restored_scheme_goes_on_bit_for_bit(name):
    matrix, offset = random_problem(5)
    settings = Coupling(relaxation=0.1, reuse=3)
    one = SCHEMES[name].of(settings)
    _, x = iterate(one, matrix, offset, np.zeros(5), 5)
    end_step(one, matrix, offset, x)
    two = SCHEMES[name].of(settings)
    two.restore({key: value.copy() for key, value in one.save().items()})
    a = iterate(one, matrix, 3 * offset, np.ones(5), 5)
    b = iterate(two, matrix, 3 * offset, np.ones(5), 5)
    assert (a[0] == b[0]).all()
    assert (a[1] == b[1]).all()


def test_only_added_mass_is_taken_into_the_structure():
    assert [name for name in SCHEMES if SCHEMES[name].takes_inertia] == ["added-mass"]


def test_unknown_scheme_is_named():
    with pytest.raises(KeyError, match=r"coupling scheme 'newton'.*iqn-ils"):
        SCHEMES["newton"]
