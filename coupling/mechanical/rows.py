"""What is kept of an identification: a row for every fill and amplitude, in JSON and in a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coupling.mechanical.apparent_mass import ApparentMass
from coupling.mechanical.modal_choice import Choice
from coupling.mechanical.modal_fit import Fit
from coupling.mechanical.plan import Condition

ERRORS = 2.0  # standard errors that every stated error is
_MODE = (
    "mass_kg", "frequency_hz", "damping_ratio", "pendulum_length_m", "hinge_height_m",
    "spring_rate_n_m", "damper_n_s_m", "mass_height_m",
)  # fmt: skip


def fitted_row(condition: Condition, choice: Choice, shown: ApparentMass) -> dict[str, Any]:
    """The row of a condition that was identified; ``shown`` is what its sweeps have shown."""
    fit, gravity = choice.fit, float(np.linalg.norm(condition.scene.gravity))
    model, modes = fit.model, fit.modes
    masses = fit.covariance[:modes, :modes]
    return _head(condition) | {
        "failure": None,
        "fixed_mass_kg": model.fixed,
        "fixed_mass_kg_error": ERRORS * float(np.sqrt(masses.sum())),
        "fixed_height_m": float(model.heights[0]),
        "fixed_height_m_error": ERRORS * float(fit.heights_error[0]),
        "modes": [_mode(fit, index, gravity) for index in range(modes)],
        "left_out_error": {str(count): error for count, error in choice.left_out.items()},
        "coherence_least": float(shown.coherence.min()),
        "coherence_median": float(np.median(shown.coherence)),
        "apparent_mass": _curve(shown, fit),
    }


def failed_row(condition: Condition, failure: str) -> dict[str, Any]:
    """The row of a condition whose sweeps did not complete, with why."""
    return _head(condition) | {"failure": failure, "modes": [], "validation": []}


def _head(condition: Condition) -> dict[str, Any]:
    return {
        "condition": condition.name,
        "fill_fraction": condition.fill_fraction,
        "amplitude_m": condition.amplitude,
        "liquid_mass_kg": condition.mass,
        "slosh_frequency_hz": condition.slosh,
    }


def _mode(fit: Fit, index: int, gravity: float) -> dict[str, float]:
    """One mode as a pendulum and as a spring-mass, each figure with its error.

    A pendulum has the length g/w^2. A spring-mass with the same force and moment lies that far
    below its hinge, has the spring rate m w^2 and the damper 2 z w m. Errors of products go by the
    fit's covariance, to first order.
    """
    model, modes = fit.model, fit.modes
    mass, omega, damping = (
        float(values[index]) for values in (model.masses, model.omegas, model.dampings)
    )
    places = [index, modes + index, 2 * modes + index]
    covariance = fit.covariance[np.ix_(places, places)]

    def error(*slopes: float) -> float:
        return ERRORS * float(np.sqrt(np.array(slopes) @ covariance @ np.array(slopes)))

    length, height = gravity / omega**2, float(model.heights[index + 1])
    length_error = error(0.0, -2.0 * length / omega, 0.0)
    height_error = ERRORS * float(fit.heights_error[index + 1])
    figures = {
        "mass_kg": (mass, error(1.0, 0.0, 0.0)),
        "frequency_hz": (omega / (2.0 * np.pi), error(0.0, 0.5 / np.pi, 0.0)),
        "damping_ratio": (damping, error(0.0, 0.0, 1.0)),
        "pendulum_length_m": (length, length_error),
        "hinge_height_m": (height, height_error),
        "spring_rate_n_m": (mass * omega**2, error(omega**2, 2.0 * mass * omega, 0.0)),
        "damper_n_s_m": (
            2.0 * damping * omega * mass,
            error(2.0 * damping * omega, 2.0 * damping * mass, 2.0 * omega * mass),
        ),
        "mass_height_m": (height - length, float(np.hypot(height_error, length_error))),
    }
    return {
        key: value
        for name, (figure, its_error) in figures.items()
        for key, value in ((name, figure), (f"{name}_error", its_error))
    }


def _curve(shown: ApparentMass, fit: Fit) -> dict[str, list[float]]:
    """Apparent mass of the runs and of the model, line by line."""
    omega = 2.0 * np.pi * shown.frequency
    model = fit.model.apparent_mass(omega)
    return {
        "frequency_hz": shown.frequency.tolist(),
        "real_kg": shown.mass.real.tolist(),
        "imag_kg": shown.mass.imag.tolist(),
        "error_kg": (ERRORS * shown.mass_error).tolist(),
        "model_real_kg": model.real.tolist(),
        "model_imag_kg": model.imag.tolist(),
        "moment_real_kg_m": shown.moment.real.tolist(),
        "moment_imag_kg_m": shown.moment.imag.tolist(),
        "moment_error_kg_m": (ERRORS * shown.moment_error).tolist(),
        "coherence": shown.coherence.tolist(),
    }


def model_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """One line a fill and amplitude; the modes' columns are numbered, empty beyond the last."""
    most = max((len(row["modes"]) for row in rows), default=0)
    heads = [
        "fill_fraction", "amplitude_m", "liquid_mass_kg", "fixed_mass_kg", "fixed_mass_kg_error",
        "fixed_height_m", "fixed_height_m_error",
    ]  # fmt: skip
    lines = []
    for row in rows:
        line = {head: row.get(head) for head in heads}
        for place in range(most):
            mode = row["modes"][place] if place < len(row["modes"]) else {}
            for name in _MODE:
                for key in (name, f"{name}_error"):
                    line[f"mode{place + 1}_{key}"] = mode.get(key)
        line |= {
            f"error_{check['name']}": check["force_error"] for check in row.get("validation", [])
        }
        lines.append(line | {"failure": row["failure"]})
    columns = list(dict.fromkeys(name for line in lines for name in line))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    return text.getvalue()
