"""A run's results as one dataset of xarray, which knows dimensions and units.

The only module of ``store`` that imports xarray, which takes half a second, so it is imported when
a dataset is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from coupling.store.results_layout import FIELDS, STEP_FIELDS, dims_of

if TYPE_CHECKING:
    from coupling.store.results import Results


def dataset_of(results: Results) -> xr.Dataset:
    """Return every array of ``results`` as a variable, metrics by their own names.

    Dimensions are ``time``, ``node``, ``triangle``, ``axis`` (x, y, z of the tank's frame),
    ``corner``, and ``step_time`` of what is known of every step, whose names begin with ``step_``.
    The attribute ``units`` of each variable is as the CF conventions write it: "1"
    where it has none. Attributes of the dataset: model, version, and the scene as TOML.
    """
    units = {name: "1" if unit == "-" else unit for name, unit in results.units.items()}
    found = xr.Dataset(
        {
            "reference": (("node", "axis"), results.reference),
            "triangles": (("triangle", "corner"), results.triangles),
            **{
                name: (("time", *dims_of(name)), getattr(results, name))
                for name, _ in FIELDS.values()
                if name != "time"
            },
            **{name: ("time", values) for name, values in results.metrics.items()},
            **{
                f"step_{name}": (("step_time", *dims_of(name)), getattr(results.steps, name))
                for name, _ in STEP_FIELDS.values()
                if name != "time"
            },
            **{f"step_{name}": ("step_time", one) for name, one in results.steps.metrics.items()},
        },
        coords={
            "time": results.time,
            "step_time": results.steps.time,
            "axis": ["x", "y", "z"],
        },
        attrs={"model": results.model, "version": results.version, "scene": results.scene_toml},
    )
    for name, variable in found.variables.items():
        if name != "axis":
            variable.attrs["units"] = units[str(name).removeprefix("step_")]
    return found
