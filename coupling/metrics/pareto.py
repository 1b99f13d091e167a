"""Which of several runs no other beats in both speed and error."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the (wall time, error) pairs that no other dominates, fastest first.

    One dominates another if it is not worse in either and better in one; equal pairs keep each
    other company. Errors are taken as they are: their error bars do not count.
    """
    ranked = sorted(range(len(points)), key=lambda index: points[index])
    front: list[int] = []
    for index in ranked:
        if (
            not front
            or points[index][1] < points[front[-1]][1]
            or points[index] == points[front[-1]]
        ):
            front.append(index)
    return front
