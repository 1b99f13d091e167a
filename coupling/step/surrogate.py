"""The next iterate where the liquid's inertia changes much within a step."""

from __future__ import annotations

from coupling.ports import Array
from coupling.schemes.iqn_ils import IqnIls
from coupling.step.convergence import rms
from coupling.step.interface_problem import InterfaceProblem

LEFT = 0.03  # of the residual, once the surrogate is solved: what it lacks leaves more than that
FAILED = 0.3  # of the residual: with more left the surrogate has not been solved
ITERATIONS = 8


def surrogate_iterate(
    problem: InterfaceProblem, points: Array, image: Array, guess: Array, *, tolerance: float
) -> Array | None:
    """The interface y (p, 3) [m] that solves the ``problem`` with ``problem.surrogate()``.

    Defect correction (Stetter, Numer. Math. 29, 1978): at ``points`` x (p, 3) [m], just solved, the
    surrogate leads to the very ``image`` (p, 3) [m] that the flow has led to; from there to y its
    pressure changes as the liquid's inertia does. What it lacks of the change is left to the next
    iteration. It is solved from ``guess`` (p, 3) [m], by quasi-Newton steps of its own, to
    ``tolerance`` or ``LEFT`` of the residual at x. None where it is not; raises ``StepFailed``,
    ArithmeticError.
    """
    answer, scheme = problem.surrogate(), IqnIls(1.0, 0)
    scheme.update(points.ravel(), (image - points).ravel())
    start = rms(image - points)
    for _ in range(ITERATIONS):
        points = problem.close_volume(guess)
        residual = answer(points) - points
        guess = scheme.update(points.ravel(), residual.ravel()).reshape(points.shape)
        left = rms(residual) / start
        if left <= max(tolerance, LEFT):
            return guess
    return guess if left <= FAILED else None
