"""How ``results.h5`` is laid out: its datasets, their units, how rows are added and dropped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coupling.ports import Array, Ints
from coupling.store import xdmf
from coupling.store.run_record import Sample

SCHEMA = "diaphragm-tank results 1"

# dataset: (attribute of Sample and of Results, unit)
FIELDS = {
    "time": ("time", "s"),
    "tank/acceleration": ("tank_acceleration", "m/s^2"),
    "tank/displacement": ("tank_displacement", "m"),
    "diaphragm/position": ("position", "m"),
    "diaphragm/pressure": ("pressure", "Pa"),
    "diaphragm/dynamic_pressure": ("dynamic_pressure", "Pa"),
    "diaphragm/strain": ("strain", "-"),
    "diaphragm/tension": ("tension", "N/m"),
    "diaphragm/shell_slip": ("shell_slip", "m"),
    "diaphragm/self_slip": ("self_slip", "m"),
    "liquid/volume": ("volume", "m^3"),
    "liquid/datum_pressure": ("datum_pressure", "Pa"),
    "liquid/cg": ("liquid_cg", "m"),
    "liquid/force": ("force", "N"),
    "liquid/moment": ("moment", "N m"),
    "coupling/iterations": ("iterations", "-"),
    "coupling/residual": ("residual", "-"),
}
_DIMS: dict[str, tuple[str, ...]] = {
    "position": ("node", "axis"),
    **dict.fromkeys(("pressure", "dynamic_pressure", "shell_slip", "self_slip"), ("node",)),
    **dict.fromkeys(("strain", "tension"), ("triangle",)),
    **dict.fromkeys(
        ("tank_acceleration", "tank_displacement", "liquid_cg", "force", "moment"), ("axis",)
    ),
}
# fmt: off
METRIC_UNITS = {
    "speed_max": "m/s",
    "dphi_dt_max": "m^2/s^2",
    **dict.fromkeys(
        (
            "kinetic_energy", "energy_removed", "liquid_potential_energy",
            "sheet_potential_energy", "sheet_kinetic_energy", "bending_energy", "stretch_energy",
            "mechanical_energy", "tank_work", "datum_work", "pressure_work", "dissipated",
            "dissipated_by_liquid", "dissipated_by_bending", "dissipated_by_drag",
            "dissipated_by_stretch", "dissipated_by_shell_friction",
            "dissipated_by_self_friction", "dissipated_by_layers", "layer_estimate",
        ),
        "J",
    ),
    **dict.fromkeys(
        (
            "hydrostatic_pressure_rms", "dynamic_pressure_rms", "unsteady_pressure_rms",
            "kinetic_pressure_rms", "viscous_traction_rms",
        ),
        "Pa",
    ),
    "wall_slip": "m^4/s^2",
    **dict.fromkeys(("wall_distance", "patch_distance", "mesh_cg_offset"), "m"),
    "non_orthogonality_max": "deg",
    "volume_error": "-",
    "continuity_error": "-",
}
# fmt: on


def create(file: Any, attributes: Mapping[str, str], reference: Array, triangles: Ints) -> None:
    """Write what does not change, and every dataset over time without rows, to an empty file.

    Parameters
    ----------
    file
        An open ``h5py.File`` without these datasets.
    attributes
        Attributes of the file by name, beside ``schema``.
    reference
        Nodes of the diaphragm as moulded (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).
    """
    file.attrs.update({"schema": SCHEMA, **attributes})
    _dataset(file, "diaphragm/triangles", np.asarray(triangles, np.int64), "-")
    _dataset(file, "diaphragm/reference", np.asarray(reference, float), "m")
    file.create_group("metrics")
    sizes = {"node": len(reference), "triangle": len(triangles), "axis": 3}
    for dataset, (name, unit) in FIELDS.items():
        shape = tuple(sizes[dimension] for dimension in dims_of(name))
        _growing(file, dataset, shape, unit, integer=name == "iterations")


def dims_of(name: str) -> tuple[str, ...]:
    """Return the dimensions of a field's row, those beside time, by its name in ``Results``."""
    return _DIMS.get(name, ())


def is_field(name: str) -> bool:
    """Whether a row of a field is over the nodes or triangles, by its name in ``Results``."""
    return not {"node", "triangle"}.isdisjoint(dims_of(name))


def _dataset(file: Any, name: str, values: Any, unit: str) -> None:
    file.create_dataset(name, data=values).attrs["unit"] = unit


def _growing(
    file: Any, name: str, row: tuple[int, ...], unit: str, *, integer: bool = False
) -> None:
    rows_a_chunk = max(1, 65536 // (8 * int(np.prod(row, dtype=int))))
    file.create_dataset(
        name,
        shape=(0, *row),
        maxshape=(None, *row),
        chunks=(min(rows_a_chunk, 256), *row),
        dtype=np.int64 if integer else np.float64,
    ).attrs["unit"] = unit


def extend(file: Any, written: int, samples: Sequence[Sample]) -> None:
    """Append ``samples`` after the ``written`` rows; a metric that a sample lacks is NaN there.

    So is one that begins late, in the rows before.
    """
    total = written + len(samples)
    for dataset, (name, _) in FIELDS.items():
        file[dataset].resize(total, axis=0)
        file[dataset][written:] = np.stack([np.asarray(getattr(item, name)) for item in samples])
    for name in {key for sample in samples for key in sample.metrics} - set(file["metrics"]):
        _growing(file, f"metrics/{name}", (), METRIC_UNITS.get(name, "-"))
        file[f"metrics/{name}"].resize(written, axis=0)
        file[f"metrics/{name}"][:] = np.nan
    for name, dataset in file["metrics"].items():
        dataset.resize(total, axis=0)
        dataset[written:] = [sample.metrics.get(name, np.nan) for sample in samples]
    xdmf.link_instants(file, written, total)


def truncate(file: Any, keep: int) -> None:
    """Drop the rows from number ``keep`` on."""
    for dataset in [*FIELDS, *(f"metrics/{name}" for name in file["metrics"])]:
        file[dataset].resize(keep, axis=0)
    xdmf.unlink_instants(file, keep)
