"""The tables of studies and sweeps as datasets: figures with their units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coupling.campaign.wanted import unit_of_figure

if TYPE_CHECKING:
    import xarray as xr


def dataset_along(dimension: str, rows: Mapping[str, Mapping[str, Any]]) -> xr.Dataset:
    """Return ``rows`` of figures by name as variables along ``dimension``, NaN where one lacks."""
    import xarray as xr

    names = dict.fromkeys(name for row in rows.values() for name in row)
    found = xr.Dataset(coords={dimension: list(rows)})
    for name in names:
        given = [row.get(name) for row in rows.values()]
        found[name] = (dimension, [np.nan if value is None else float(value) for value in given])
        found[name].attrs["units"] = unit_of_figure(name)
    return found
