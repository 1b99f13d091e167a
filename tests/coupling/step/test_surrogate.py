"""The surrogate's iterate on a linear problem, whose solution is known."""

import numpy as np
import pytest

from coupling.step.interface_step import Iterate
from coupling.step.surrogate import SurrogateSettings, surrogate_iterate

SETTINGS = SurrogateSettings()


class Linear:
    """x = matrix x + offset, of which the surrogate knows ``known`` only."""

    def __init__(self, matrix, known, offset):
        self.matrix, self.known, self.offset = matrix, known, offset
        self.asked = 0

    def image(self, points):
        image = points @ self.matrix.T + self.offset
        return Iterate(points=points, pressure=np.zeros(0), image=image)

    def surrogate(self, iterate):
        def answer(points):
            self.asked += 1
            return iterate.image + (points - iterate.points) @ self.known.T

        return answer

    @staticmethod
    def close_volume(points):
        return points


def left(problem, **options):
    """What a surrogate's iteration leaves of the residual at the start."""
    start = np.random.default_rng(0).normal(size=(40, 3))
    first = problem.image(start)
    found = surrogate_iterate(problem, first, first.image, settings=SETTINGS, **options)
    if found is None:
        return None
    return np.linalg.norm(problem.image(found).residual) / np.linalg.norm(first.residual)


def spread(largest):
    """A symmetric matrix (3, 3) with eigenvalues up to ``largest`` in size, of both signs."""
    turned = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    return turned @ np.diag([largest, -0.5 * largest, 0.1 * largest]) @ turned.T


@pytest.mark.parametrize("largest", [0.3, 0.6, 3.0, 10.0])
def test_an_exact_surrogate_leaves_what_it_is_solved_to(largest):
    # The fixed point of 3 and 10 diverges. A last quasi-Newton step only gains on a linear problem.
    problem = Linear(spread(largest), spread(largest), np.ones(3))
    assert left(problem, tolerance=1e-6) <= SETTINGS.left
    assert left(problem, tolerance=0.2) <= 0.2
    assert problem.asked <= 2 * 4  # three eigenvalues, solved in four answers


def test_what_the_surrogate_lacks_is_left():
    # The residual at y is (matrix - known)(y - x), and y - x = (1 - known)^-1 times the first one.
    matrix, known = spread(0.6), spread(0.5)
    factor = np.linalg.norm(matrix - known, 2) * np.linalg.norm(np.linalg.inv(np.eye(3) - known), 2)
    assert 0.01 < left(Linear(matrix, known, np.ones(3)), tolerance=1e-6) < factor + SETTINGS.left


def test_a_surrogate_that_is_not_solved_is_not_taken():
    # A map with 120 eigenvalues of size 5, which eight columns cannot span.
    class Wild(Linear):
        def surrogate(self, iterate):
            turn = 5.0 * np.linalg.qr(np.random.default_rng(2).normal(size=(120, 120)))[0]
            return lambda points: (
                iterate.image + (turn @ (points - iterate.points).ravel()).reshape(-1, 3)
            )

    assert left(Wild(spread(0.6), spread(0.6), np.ones(3)), tolerance=1e-6) is None
