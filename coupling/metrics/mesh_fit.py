"""How well the flow's mesh stands for the liquid below the diaphragm."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.ports import Array


def mesh_fit(metrics: Mapping[str, Array]) -> dict[str, float] | None:
    """Return how far the flow's mesh was from the liquid over a run; None for a model without one.

    Parameters
    ----------
    metrics
        Scalars of a run by name, each over its steps (S,).

    Returns
    -------
    dict of float by str, or None
        ``patch_distance_rms_m`` and ``patch_distance_max_m``: of the patch's points to the
        diaphragm, as rms over the patch, its rms and maximum over time [m]; ``cg_offset_rms_m`` and
        ``cg_offset_max_m``: of the mesh's centre of gravity to that of the liquid below the
        diaphragm [m]; ``non_orthogonality_max_deg`` [deg].
    """
    if "mesh_cg_offset" not in metrics or not len(metrics["mesh_cg_offset"]):
        return None
    found: dict[str, float] = {}
    for name, key in (("patch_distance", "patch_distance"), ("cg_offset", "mesh_cg_offset")):
        found[f"{name}_rms_m"] = float(np.sqrt(np.mean(metrics[key] ** 2)))
        found[f"{name}_max_m"] = float(metrics[key].max())
    return found | {"non_orthogonality_max_deg": float(metrics["non_orthogonality_max"].max())}
