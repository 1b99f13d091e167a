"""A run against a better one: the errors of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coupling.metrics.bernoulli import node_areas
from coupling.metrics.material import material_interpolation
from coupling.ports import Array, Ints
from coupling.store.results import Results

Errors = dict[str, float | None]
NAMES = ("shape_rms", "cg_amplitude", "cg_phase_deg", "force_amplitude", "pressure_rms")


def compare(
    results: Results,
    summary: Mapping[str, Any],
    reference: Results,
    reference_summary: Mapping[str, Any],
    size: float,
) -> Errors:
    """Errors of a run against ``reference``, all of them positive.

    ``shape_rms``: distance between equal material points, the nodes of ``reference``, rms over the
    surface and the common instants, over the shell's ``size`` [m]; sliding on the surface counts.
    ``pressure_rms``: rms difference of the net pressure there over its rms. Where the meshes
    differ, values come from ``material_interpolation``, which adds an error of O(h^2). Both are
    None where no instant is common. ``cg_amplitude`` and ``force_amplitude`` are relative,
    ``cg_phase_deg`` is in degrees at the component that moves most; from the summaries, None where
    those say null.
    """
    shape, pressure = _fields(results, reference)
    return {
        "shape_rms": None if shape is None else shape / size,
        "cg_amplitude": _relative(summary, reference_summary, "cg", "amplitude_m"),
        "cg_phase_deg": _phase(summary["cg"], reference_summary["cg"]),
        "force_amplitude": _relative(summary, reference_summary, "force", "amplitude_N"),
        "pressure_rms": pressure,
    }


def _fields(results: Results, reference: Results) -> tuple[float | None, float | None]:
    """rms distance [m], and rms difference of the pressure over its rms."""
    rows, reference_rows = common_instants(results.time, reference.time)
    if len(rows) == 0:
        return None, None
    position, pressure = results.position[rows], results.pressure[rows]
    if not _same_mesh(results, reference):
        taken = material_interpolation(results.reference, results.triangles, reference.reference)
        position = np.stack([taken @ instant for instant in position])
        pressure = (taken @ pressure.T).T
    there, pressure_there = reference.position[reference_rows], reference.pressure[reference_rows]
    weight = node_areas(there, reference.triangles)
    distance = np.linalg.norm(position - there, axis=2)
    difference = _over(_rms(pressure - pressure_there, weight), _rms(pressure_there, weight))
    return _rms(distance, weight), difference


def _same_mesh(one: Results, other: Results) -> bool:
    return np.array_equal(one.triangles, other.triangles) and np.array_equal(
        one.reference, other.reference
    )


def common_instants(time: Array, other: Array) -> tuple[Ints, Ints]:
    """Return the rows at which two sorted series of instants have equal times.

    Parameters
    ----------
    time
        Instants of one series (T,) [s], increasing.
    other
        Instants of the other series (S,) [s], increasing.

    Returns
    -------
    rows : Ints
        Rows of ``time`` (k,) that have an equal in ``other``; none where a series is empty.
    other_rows : Ints
        The rows of ``other`` (k,) that equal them: the nearest in time.

    Notes
    -----
    Times are equal when they differ by 1e-6 of the last instant of ``other`` at most. Whether the
    series are sorted is not checked.
    """
    if len(time) == 0 or len(other) == 0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    after = np.minimum(np.searchsorted(other, time), len(other) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(np.abs(time - other[before]) < np.abs(time - other[after]), before, after)
    rows = np.flatnonzero(np.abs(time - other[nearest]) <= 1e-6 * float(other[-1]))
    return rows.astype(np.int64), nearest[rows].astype(np.int64)


def cg_motion(mine: Mapping[str, Any], best: Mapping[str, Any]) -> float | None:
    """Return |c - c_best|/|c_best| of two complex CG amplitudes (3,), each a summary's ``cg``.

    Amplitude and phase in one number. None where either has none, or the second does not move.
    """
    if None in (*mine["amplitude_m"], *best["amplitude_m"]):
        return None
    one, other = _complex(mine), _complex(best)
    return _over(float(np.linalg.norm(one - other)), float(np.linalg.norm(other)))


def _complex(cg: Mapping[str, Any]) -> NDArray[np.complex128]:
    phase = [0.0 if value is None else value for value in cg["phase_deg"]]
    return np.asarray(cg["amplitude_m"] * np.exp(1j * np.radians(phase)))


def _rms(values: Array, weight: Array) -> float:
    return float(np.sqrt((weight * values**2).sum() / weight.sum()))


def _relative(
    summary: Mapping[str, Any], reference: Mapping[str, Any], part: str, name: str
) -> float | None:
    mine, best = summary[part][name], reference[part][name]
    if None in (*mine, *best):
        return None
    size = float(np.linalg.norm(best))
    return _over(abs(float(np.linalg.norm(mine)) - size), size)


def _phase(mine: Mapping[str, Any], best: Mapping[str, Any]) -> float | None:
    if None in best["amplitude_m"]:
        return None
    row = int(np.argmax(best["amplitude_m"]))
    one, other = mine["phase_deg"][row], best["phase_deg"][row]
    if one is None or other is None:
        return None
    return abs(float(one - other + 180.0) % 360.0 - 180.0)


def _over(part: float, whole: float) -> float | None:
    return part / whole if whole > 0.0 else None
