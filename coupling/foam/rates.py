"""How the flux through moving faces changes, as OpenFOAM's ``backward`` has it."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


class FluxRate:
    """Rate of change of the fluxes of ``count`` faces, from the volumes they sweep step by step."""

    def __init__(self, count: int) -> None:
        self._past = np.zeros((3, count))  # swept [m^3] in the last step; flux [m^3/s], one before
        self._now = self._past

    def __call__(self, swept: Array, dt: float, *, first: bool) -> Array:
        """d(flux)/dt (k,) [m^3/s^2] at the end of a step of ``dt`` [s] that sweeps ``swept`` (k,).

        Euler's in a run's ``first`` step. The call can be repeated.
        """
        before, flux_0, flux_1 = self._past
        flux = swept / dt if first else (1.5 * swept - 0.5 * before) / dt
        self._now = np.stack([swept, flux, flux_0])
        if first:
            return np.asarray((flux - flux_0) / dt)
        return np.asarray((1.5 * flux - 2.0 * flux_0 + 0.5 * flux_1) / dt)

    def accept_step(self) -> None:
        """Commit the last call."""
        self._past = self._now

    def save(self) -> Array:
        """Everything ``restore`` needs (3, k)."""
        return self._past

    def restore(self, saved: Array) -> None:
        """The reverse of ``save``."""
        self._past = saved
