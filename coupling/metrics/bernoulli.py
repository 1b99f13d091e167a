"""The terms of Bernoulli's equation against each other: what hydrostatics may leave out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.estimate.numbers import potential_to_kinetic
from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints


def effective_gravity(gravity: Array, tank_acceleration: Array) -> float:
    """Return the largest |g - a_tank| of a run [m/s^2].

    Parameters
    ----------
    gravity
        Gravity g (3,) [m/s^2], constant.
    tank_acceleration
        Acceleration a_tank of the tank (T, 3) [m/s^2] at T instants; without any, |g| is returned.

    Returns
    -------
    float
        The largest magnitude [m/s^2] over the instants given; what lies between them is not seen.
    """
    if len(tank_acceleration) == 0:
        return float(np.linalg.norm(gravity))
    return float(np.linalg.norm(gravity - tank_acceleration, axis=1).max())


def kinetic_ratio(*, body_force: float, radius: float, speed_max: float | None) -> float | None:
    """Return rho g_eff R over rho max|u|^2/2: the ratio of thesis Eq. 4.6, with the measured speed.

    ``body_force`` [m/s^2], ``radius`` [m], ``speed_max`` [m/s], None where the model has no flow:
    then, or for a liquid at rest, None.
    """
    return _over(body_force * radius, None if speed_max is None else 0.5 * speed_max**2)


def unsteady_ratio(*, body_force: float, radius: float, dphi_dt_max: float | None) -> float | None:
    """Return rho g_eff R over max|rho dphi/dt|: what thesis Eq. 4.6 leaves out, the added mass.

    ``dphi_dt_max`` [m^2/s^2]: largest |p*/rho + |u|^2/2| on the diaphragm's free part, less its
    mean there (see ``fluids.gauge``), None where the model has no flow.
    """
    return _over(body_force * radius, dphi_dt_max)


def dynamic_fraction(metrics: Mapping[str, Array]) -> float | None:
    """Return the rms of p* over the rms of the hydrostatic pressure.

    Both are taken over the interface and over time; of both, the mean over the interface at each
    instant is removed first. A node counts with a third of the area of its triangles.

    Parameters
    ----------
    metrics
        Scalars of a run (S,) by name: the rms over the interface at every step [Pa].

    Returns
    -------
    float or None
        The ratio [-], 0 for models without a flow; None without steps, where the hydrostatic
        pressure is uniform, or where the results do not hold the values.
    """
    dynamic = _over_time(metrics.get("dynamic_pressure_rms"))
    return _over(dynamic, _over_time(metrics.get("hydrostatic_pressure_rms")))


PARTS = {
    "unsteady": "unsteady_pressure_rms",
    "kinetic": "kinetic_pressure_rms",
    "viscous": "viscous_traction_rms",
}


def pressure_split(metrics: Mapping[str, Array], *, has_flow: bool) -> dict[str, float | None]:
    """Return the rms [Pa] of the hydrostatic pressure, of p* and of its parts, and their fractions.

    ``metrics`` (S,) [Pa] by name: rms over the interface at every step, as ``dynamic_fraction``
    takes them. The rms returned is that over interface and time; a fraction is that of a part over
    that of the hydrostatic pressure; a median is that over time of the ratio at each instant, which
    blows do not move.

    ``unsteady``: p* less its kinetic part -rho |u|^2/2, which of an inviscid liquid is
    -rho dphi/dt exactly, and otherwise includes the effect of vorticity. ``viscous``: the magnitude
    of the viscous stress on the diaphragm, which acts in addition to p*. None where the model has
    no flow, or the results do not hold the value.
    """
    whole = _over_time(metrics.get("hydrostatic_pressure_rms"))
    names = {"dynamic": "dynamic_pressure_rms"} | PARTS
    rms = {name: _over_time(metrics.get(key)) if has_flow else None for name, key in names.items()}
    return (
        {"hydrostatic_rms_Pa": whole}
        | {f"{name}_rms_Pa": value for name, value in rms.items()}
        | {f"{name}_fraction": _over(rms[name], whole) for name in PARTS}
        | {
            f"{name}_median": _median(metrics, key) if has_flow else None
            for name, key in names.items()
        }
    )


def _median(metrics: Mapping[str, Array], key: str) -> float | None:
    """Median over time of the rms of a part over that of the hydrostatic pressure."""
    part, whole = metrics.get(key), metrics.get("hydrostatic_pressure_rms")
    if part is None or whole is None:
        return None
    known = np.isfinite(part) & np.isfinite(whole) & (whole > 0.0)
    return float(np.median(part[known] / whole[known])) if known.any() else None


def _over_time(rms: Array | None) -> float | None:
    return None if rms is None or len(rms) == 0 else float(np.sqrt(np.mean(rms**2)))


def node_areas(position: Array, triangles: Ints) -> Array:
    """Return the area of every node: a third of the area of the triangles around it.

    Parameters
    ----------
    position
        Nodes (T, n, 3) [m] at T instants.
    triangles
        Nodes of each triangle (m, 3).

    Returns
    -------
    Array
        Areas (T, n) [m^2]; their sum over the nodes is the area of all triangles, to rounding.
    """
    corners, nodes = triangles.ravel(), position.shape[1]
    areas = np.empty(position.shape[:2])
    for row, points in enumerate(position):
        a, b, c = (points[triangles[:, side]] for side in range(3))
        normal = cross(b - a, c - a)
        third = np.sqrt(np.einsum("mx,mx->m", normal, normal)) / 6.0
        areas[row] = np.bincount(corners, np.repeat(third, 3), nodes)
    return areas


def weighted_rms(values: Array, weight: Array) -> float:
    """Return the weighted root mean square of values whose mean at each instant is removed first.

    Parameters
    ----------
    values
        Values (T, n), of any unit, at T >= 1 instants.
    weight
        Weights (T, n), not negative, such as the nodes' areas [m^2]; only their ratios at one
        instant count, since every instant has the same weight.

    Returns
    -------
    float
        The rms over nodes and instants, in the unit of ``values``.
    """
    return float(np.sqrt(_mean_squares(values, weight).mean()))


def _mean_squares(values: Array, weight: Array) -> Array:
    """Weighted mean squares (T,) of ``values`` less their mean at each instant."""
    total = weight.sum(axis=1, keepdims=True)
    mean = (values * weight).sum(axis=1, keepdims=True) / total
    squares: Array = (weight * (values - mean) ** 2 / total).sum(axis=1)
    return squares


def thesis_estimates(
    *, body_force: float, radius: float, frequency: float | None
) -> dict[str, float | None]:
    """Eq. 4.6 of the thesis for this scene: ``eq46_as_printed`` and ``eq46_as_worded``.

    Its print has the liquid cover a quarter of the radius a period, its text a quarter of the
    diameter. None without a frequency.
    """
    travels = {"eq46_as_printed": 0.25 * radius, "eq46_as_worded": 0.5 * radius}
    return {
        name: potential_to_kinetic(
            body_force=body_force, radius=radius, frequency=frequency, travel=travel
        )
        if frequency
        else None
        for name, travel in travels.items()
    }


def _over(part: float | None, whole: float | None) -> float | None:
    return part / whole if whole and part is not None else None
