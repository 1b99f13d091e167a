"""A moving liquid's scalars for the results."""

from __future__ import annotations

from collections.abc import Mapping

from coupling.ports import FlowSample, LiquidSample

LIQUID_METRICS = ("speed_max", "dphi_dt_max", "kinetic_energy", "wall_slip")
MESH_METRICS = ("volume_error", "continuity_error")


def liquid_metrics(liquid: LiquidSample | None) -> dict[str, float]:
    """Return the scalars of a moving ``liquid`` by name; before any step, None, it is at rest."""
    if liquid is None:
        return dict.fromkeys(LIQUID_METRICS, 0.0)
    return {name: float(getattr(liquid, name)) for name in LIQUID_METRICS}


def flow_metrics(flow: FlowSample | None, mesh: Mapping[str, float]) -> dict[str, float]:
    """Return the scalars of a ``flow`` on a mesh by name; before any step, None, it is at rest.

    ``mesh``: those of the committed mesh, by name, which are known then as well.
    """
    found = dict.fromkeys(MESH_METRICS, 0.0)
    if flow is not None:
        found = {name: float(getattr(flow, name)) for name in MESH_METRICS}
    return liquid_metrics(flow) | found | dict(mesh)
