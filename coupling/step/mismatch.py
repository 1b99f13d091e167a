"""How far the flow's interface lags behind the structure, and what that means for the next step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.ports import Array


class VelocityMismatch:
    """Velocity of the structure less that of the flow's interface (p, 3) [m/s], of two steps.

    A step ends with the flow's interface at x and the structure's answer at x + r, r being what the
    tolerance leaves. The next step is to lead both to one place. The flow makes up for r on its
    way: it has an acceleration beyond the structure's, known before that step is solved. Left in
    the defect that is carried on, its pressure doubles r in every step that is accepted at its
    first iteration (``tests/foam/test_rest.py``).
    """

    def __init__(self) -> None:
        self._past: list[Array] = []  # newest first
        self._dt = 0.0  # of the step that the newest ended

    def add(self, mismatch: Array, dt: float) -> None:
        """Append that (p, 3) [m/s] at the end of the step of ``dt`` [s] just accepted."""
        self._past = [mismatch, *self._past[:1]]
        self._dt = dt

    def acceleration(self, dt: float) -> Array:
        """The flow's acceleration beyond the structure's (p, 3) [m/s^2] in a step of ``dt`` [s].

        Of one that ends at equal velocities, by OpenFOAM's ``backward``: (c0 e_n - c00 e_(n-1))/dt
        with the coefficients of ``cloth.kinematics``. A scalar zero before the first step.
        """
        if not self._past:
            return np.zeros(())
        if len(self._past) == 1:
            return self._past[0] / dt
        before = dt * dt / (self._dt * (dt + self._dt))
        last = 1.0 + dt / (dt + self._dt) + before
        return np.asarray((last * self._past[0] - before * self._past[1]) / dt)

    def save(self) -> dict[str, Array]:
        """The mismatches by ``mismatch0`` and ``mismatch1``, and the length of the last step."""
        past = {f"mismatch{number}": mismatch for number, mismatch in enumerate(self._past)}
        return past | {"mismatch_dt": np.array([self._dt])}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""
        names = ("mismatch0", "mismatch1")
        self._past = [saved[name] for name in names if name in saved]
        self._dt = float(saved["mismatch_dt"][0])
