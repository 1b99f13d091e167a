"""A run by a record against a better one, by bands of frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coupling.metrics.comparison import Errors, common_instants
from coupling.metrics.record import signals_of
from coupling.metrics.spectra import Spectrum, octaves, spectrum_of
from coupling.ports import Array
from coupling.store.step_series import StepSeries

COMPARED = ("cg", "force")
ANSWERED = 0.9  # share of the CG's power that the bands hold which the tank answers to
_SHAKEN = 0.01  # share of the acceleration's rms from which on a band is shaken
_NOTHING = 1e-4  # share of a signal's rms below which a band holds no signal to be wrong about

Band = tuple[float, float]


def band_name(band: Band) -> str:
    """As text, such as ``1 to 2 Hz``."""
    return f"{band[0]:g} to {band[1]:g} Hz"


def reference_bands(steps: StepSeries, mass: float) -> list[dict[str, Any]]:
    """What the reference of a study answers in every octave; empty of a short run.

    Of each band: rms of the tank's acceleration, of CG and force over all axes; the CG's share of
    its power; the force's rms over ``mass`` [kg] of the liquid times the acceleration's, which
    would be 1 for a liquid that moves as one body with the tank; None where the band is not shaken.
    """
    spectra = {name: spectrum_of(steps.time, signal) for name, signal in signals_of(steps).items()}
    known = {name: one for name, one in spectra.items() if one is not None}
    if not known:
        return []
    powers = {name: _powers(one) for name, one in known.items()}
    least = _SHAKEN * float(np.sqrt(powers["acceleration"].sum()))
    rows = []
    for index, band in enumerate(octaves(known["cg"])):
        shaken = float(np.sqrt(powers["acceleration"][index]))
        force = float(np.sqrt(powers["force"][index]))
        rows.append(
            {
                "from_hz": band[0],
                "to_hz": band[1],
                "acceleration_rms": shaken,
                "cg_rms_m": float(np.sqrt(powers["cg"][index])),
                "force_rms_N": force,
                "cg_share": float(powers["cg"][index] / max(powers["cg"].sum(), 1e-300)),
                "force_over_ma": force / (mass * shaken) if shaken > least else None,
            }
        )
    return rows


def band_errors(steps: StepSeries, reference: StepSeries) -> dict[str, Errors]:
    """Errors of a run against ``reference`` by signal (``COMPARED``) and name of the band.

    Root of the spectrum of the difference over that of the reference, both summed over the band
    and the axes: amplitude and phase in one number, and 1 for a run in which nothing moves. The
    whole spectrum is the band "all". Only bands that the steps of both carry; None where the
    reference has no signal. Empty without enough common instants.
    """
    rows, reference_rows = common_instants(steps.time, reference.time)
    found: dict[str, Errors] = {}
    mine, best = signals_of(steps), signals_of(reference)
    for name in COMPARED:
        there = best[name][reference_rows]
        error = spectrum_of(reference.time[reference_rows], mine[name][rows] - there)
        whole = spectrum_of(reference.time[reference_rows], there)
        if error is None or whole is None:
            return {}
        wrong, right = _powers(error), _powers(whole)
        least = _NOTHING**2 * right.sum()
        found[name] = {
            band_name(band): float(np.sqrt(part / of)) if of > least else None
            for band, part, of in zip(octaves(whole), wrong, right, strict=True)
        }
        total = right.sum()
        found[name]["all"] = float(np.sqrt(wrong.sum() / total)) if total > 0.0 else None
    return found


def _powers(spectrum: Spectrum) -> Array:
    """Power by octave (b,), summed over the axes."""
    return np.array([spectrum.power(band).sum() for band in octaves(spectrum)])


def answered(bands: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the fewest bands that hold ``ANSWERED`` of the CG's power, by frequency."""
    taken, held = [], 0.0
    for row in sorted(bands, key=lambda one: -one["cg_share"]):
        if held >= ANSWERED:
            break
        taken.append(row)
        held += row["cg_share"]
    ordered = sorted(taken, key=lambda one: one["from_hz"])
    return [band_name((row["from_hz"], row["to_hz"])) for row in ordered]
