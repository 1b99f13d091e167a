"""How thick a laminar boundary layer is, and whether a mesh can show it."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from coupling.ports import Array


def stokes_layer(viscosity: float, frequency: float) -> float:
    """Thickness sqrt(nu/(pi f)) [m] of the layer beside a wall in an oscillating liquid.

    ``viscosity`` [m^2/s], ``frequency`` [Hz] (Stokes 1851; Landau and Lifshitz, Fluid Mechanics,
    section 24). Laminar, attached, amplitudes far above the thickness.
    """
    return math.sqrt(viscosity / (math.pi * frequency))


def layer_resolution(
    metrics: Mapping[str, Array], viscosity: float, frequency: float | None
) -> dict[str, float | None]:
    """``stokes_layer_m`` [m]; ``wall_cell_m`` [m], the mean height of the cells at the walls over
    the run; ``cells_in_layer``: the one over the other. ``metrics``: a run's scalars by name (S,).

    Below some 5 cells in the layer the solver's wall friction is not the liquid's. None where the
    motion has no frequency, or the model no mesh.
    """
    layer = stokes_layer(viscosity, frequency) if frequency else None
    distance = metrics.get("wall_distance", np.zeros(0))
    known = distance[np.isfinite(distance)]
    cell = 2.0 * float(known.mean()) if len(known) else None
    return {
        "stokes_layer_m": layer,
        "wall_cell_m": cell,
        "cells_in_layer": layer / cell if layer and cell else None,
    }
