"""The flux through moving faces and how it changes, as OpenFOAM's ``backward`` has them."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


class FluxRate:
    """Fluxes of ``count`` faces and their rates, from the volumes that they sweep step by step."""

    def __init__(self, count: int) -> None:
        self._past = np.zeros((3, count))  # mean flux of the last step; flux at its end, before it
        self._now = self._past

    def __call__(self, swept: Array, dt: float, previous_dt: float) -> Array:
        """d(flux)/dt (k,) [m^3/s^2] at the end of a step of ``dt`` [s] that sweeps ``swept`` (k,).

        ``previous_dt`` [s] is the length of the step before, 0 in a run's first, which is Euler's.
        The call can be repeated.
        """
        mean_0, flux_0, flux_1 = self._past
        mean, before = swept / dt, 0.0
        if previous_dt > 0.0:
            before = dt / (dt + previous_dt)
        flux = (1.0 + before) * mean - before * mean_0
        self._now = np.stack([mean, flux, flux_0])
        if not previous_dt > 0.0:
            return np.asarray((flux - flux_0) / dt)
        older = before * dt / previous_dt
        return np.asarray(
            ((1.0 + before) * flux - (1.0 + before + older) * flux_0 + older * flux_1) / dt
        )

    @property
    def flux(self) -> Array:
        """Of the last call, at its step's end (k,) [m^3/s]."""
        return np.asarray(self._now[1])

    def accept_step(self) -> None:
        """Commit the last call."""
        self._past = self._now

    def save(self) -> Array:
        """Everything ``restore`` needs (3, k)."""
        return self._past

    def restore(self, saved: Array) -> None:
        """The reverse of ``save``."""
        self._past = saved
