"""A moving liquid's scalars for the results."""

from __future__ import annotations

from coupling.ports import FlowSample, LiquidSample

LIQUID_METRICS = ("speed_max", "dphi_dt_max", "kinetic_energy", "wall_slip")
MESH_METRICS = ("non_orthogonality_max", "volume_error", "continuity_error", "wall_distance")


def liquid_metrics(liquid: LiquidSample | None) -> dict[str, float]:
    """Return the scalars of a moving ``liquid`` by name; before any step, None, it is at rest."""
    if liquid is None:
        return dict.fromkeys(LIQUID_METRICS, 0.0)
    return {name: float(getattr(liquid, name)) for name in LIQUID_METRICS}


def flow_metrics(
    flow: FlowSample | None, *, non_orthogonality: float, wall_distance: float
) -> dict[str, float]:
    """Return the scalars of a ``flow`` on a mesh by name; before any step, None, it is at rest.

    ``non_orthogonality`` [deg], ``wall_distance`` [m]: the committed mesh's, all that is known
    then.
    """
    if flow is None:
        return liquid_metrics(None) | {
            "non_orthogonality_max": non_orthogonality,
            "volume_error": 0.0,
            "continuity_error": 0.0,
            "wall_distance": wall_distance,
        }
    return liquid_metrics(flow) | {name: float(getattr(flow, name)) for name in MESH_METRICS}
