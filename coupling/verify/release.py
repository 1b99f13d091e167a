"""A surface let go from rest above a flow: its course in time, and the frequency of that."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from coupling.interface.mapping import Matching
from coupling.ports import Array, Flow, HydrostaticLoad, RunFailed
from coupling.schemes.added_mass import AddedMass
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledStep
from coupling.verify.free_surface import FreeSurface


def coupled_release(
    surface: FreeSurface,
    flow: Flow,
    shape: Array,
    *,
    step: float,
    duration: float,
    acceleration: float,
) -> tuple[Array, Array]:
    """Times (T,) [s] and the moment (T,) of the heights with ``shape`` (p,) after the release.

    Through the whole coupling; ``surface`` is displaced and ``flow`` started already.
    ``acceleration`` [m/s^2]: the surface's largest, whose way in a step is what counts as small.
    """
    coupled = CoupledStep(
        surface, flow, Matching(), AddedMass(), takes_inertia=True, max_iterations=30,
        convergence=Convergence(tolerance=1e-4, acceleration=acceleration),
        record=lambda *_: None,
    )  # fmt: skip
    load = HydrostaticLoad(density=0.0, body_force=np.zeros(3))  # gravity is the surface's own
    steps = int(np.ceil(duration / step))
    signal = [surface.moment(shape)]
    for number in range(steps):
        outcome = coupled.advance(number * step, step, load)
        if not outcome.converged:
            raise RunFailed(f"verify: step {number} left {outcome.residual:.1e}.")
        signal.append(surface.moment(shape))
    return np.linspace(0.0, step * steps, steps + 1), np.array(signal)


def fitted_frequency(time: Array, signal: Array, omega: float) -> float:
    """Return omega [1/s] of the damped cosine that fits a signal best.

    One neighbouring mode beside it, at 1.84 omega to begin with, is fitted as well. The fit is a
    local one; how well it fits is not checked.

    Parameters
    ----------
    time
        Instants (T,) [s].
    signal
        Signal (T,), of any unit, not 0 throughout.
    omega
        Frequency [1/s] from which the fit begins.

    Returns
    -------
    float
        The frequency of the mode whose fit began at ``omega`` [1/s].
    """
    signal = signal / np.abs(signal).max()  # the fit's tolerances are absolute

    def basis(parameters: Array) -> Array:
        columns = []
        for frequency, damping in parameters.reshape(-1, 2) * omega:
            decay = np.exp(-damping * time)
            columns += [decay * np.cos(frequency * time), decay * np.sin(frequency * time)]
        return np.array(columns).T

    def misfit(parameters: Array) -> Array:
        matrix = basis(parameters)
        return np.asarray(matrix @ np.linalg.lstsq(matrix, signal, rcond=None)[0] - signal)

    fit = least_squares(misfit, np.array([1.0, 0.0, 1.84, 0.0]), x_scale=0.1)
    return float(fit.x[0] * omega)
