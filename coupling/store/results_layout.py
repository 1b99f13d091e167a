"""How ``results.h5`` is laid out: its datasets, their units, how rows are added and dropped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from coupling.ports import Array, Ints
from coupling.store import xdmf
from coupling.store.run_record import Sample, StepSample

SCHEMA = "diaphragm-tank results 1"
STEPS = "steps"  # group of what is kept of every step

# dataset: (attribute of Sample and of Results, unit)
FIELDS = {
    "time": ("time", "s"),
    "tank/acceleration": ("tank_acceleration", "m/s^2"),
    "tank/displacement": ("tank_displacement", "m"),
    "tank/rotation": ("tank_rotation", "rad"),
    "tank/rate": ("tank_rate", "rad/s"),
    "diaphragm/position": ("position", "m"),
    "diaphragm/pressure": ("pressure", "Pa"),
    "diaphragm/dynamic_pressure": ("dynamic_pressure", "Pa"),
    "diaphragm/strain": ("strain", "-"),
    "diaphragm/tension": ("tension", "N/m"),
    "diaphragm/velocity": ("velocity", "m/s"),
    "diaphragm/contact_force": ("contact_force", "N"),
    "diaphragm/shell_pressure": ("shell_pressure", "Pa"),
    "diaphragm/self_pressure": ("self_pressure", "Pa"),
    "diaphragm/shell_slip": ("shell_slip", "m"),
    "diaphragm/self_slip": ("self_slip", "m"),
    "diaphragm/shell_work": ("shell_work", "J/m^2"),
    "diaphragm/self_work": ("self_work", "J/m^2"),
    "diaphragm/rub_place": ("rub_place", "m"),
    "liquid/volume": ("volume", "m^3"),
    "liquid/datum_pressure": ("datum_pressure", "Pa"),
    "liquid/cg": ("liquid_cg", "m"),
    "liquid/force": ("force", "N"),
    "liquid/moment": ("moment", "N m"),
    "coupling/iterations": ("iterations", "-"),
    "coupling/residual": ("residual", "-"),
}
_DIMS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("position", "velocity", "contact_force", "rub_place"), ("node", "axis")),
    **dict.fromkeys(
        (
            "pressure",
            "dynamic_pressure",
            "shell_pressure",
            "self_pressure",
            "shell_slip",
            "self_slip",
            "shell_work",
            "self_work",
        ),
        ("node",),
    ),
    **dict.fromkeys(("strain", "tension"), ("triangle",)),
    **dict.fromkeys(
        (
            "tank_acceleration",
            "tank_displacement",
            "tank_rotation",
            "tank_rate",
            "liquid_cg",
            "force",
            "moment",
        ),
        ("axis",),
    ),
}
_OVER_SURFACE = {"node", "triangle"}
# Those of every step, in the group ``STEPS``, as in FIELDS.
STEP_FIELDS = {
    dataset: (name, unit)
    for dataset, (name, unit) in FIELDS.items()
    if _OVER_SURFACE.isdisjoint(_DIMS.get(name, ()))
}
# Not in files of older versions: NaN there, and no rotation.
LATER = frozenset(
    {
        "velocity",
        "contact_force",
        "shell_pressure",
        "self_pressure",
        "shell_work",
        "self_work",
        "rub_place",
        "tank_rotation",
        "tank_rate",
    }
)
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
            "carrier_kinetic_energy", "spring_energy", "carrier_work", "damper_loss",
            "contents_work",
        ),
        "J",
    ),
    **dict.fromkeys(
        (
            "hydrostatic_pressure_rms", "dynamic_pressure_rms", "unsteady_pressure_rms",
            "kinetic_pressure_rms", "viscous_traction_rms", "pressure_drop", "pressure_drop_chords",
            "outlet_pressure",
        ),
        "Pa",
    ),
    "wall_slip": "m^4/s^2",
    **dict.fromkeys(("wall_distance", "patch_distance", "mesh_cg_offset", "outlet_gap"), "m"),
    **dict.fromkeys(("fold_radius", "fold_tenth_radius"), "m"),
    **dict.fromkeys(("non_orthogonality_max", "fold_polar", "fold_azimuth"), "deg"),
    "folded_area": "m^2",
    **dict.fromkeys(("fold_number", "layers_touch"), "-"),
    **{f"tank_velocity_{axis}": "m/s" for axis in "xyz"},
    **{f"support_force_{axis}": "N" for axis in "xyz"},
    **{f"support_moment_{axis}": "N m" for axis in "xyz"},
    **{f"momentum_{axis}": "kg m/s" for axis in "xyz"},
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
    sizes = {"node": len(reference), "triangle": len(triangles), "axis": 3}
    for group, datasets in ((file, FIELDS), (file.create_group(STEPS), STEP_FIELDS)):
        group.create_group("metrics")
        for dataset, (name, unit) in datasets.items():
            shape = tuple(sizes[dimension] for dimension in dims_of(name))
            _growing(group, dataset, shape, unit, integer=name == "iterations")


def dims_of(name: str) -> tuple[str, ...]:
    """Return the dimensions of a field's row, those beside time, by its name in ``Results``."""
    return _DIMS.get(name, ())


def is_field(name: str) -> bool:
    """Whether a row of a field is over the nodes or triangles, by its name in ``Results``."""
    return not _OVER_SURFACE.isdisjoint(dims_of(name))


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
    """Append ``samples`` after the ``written`` instants; a metric that a sample lacks is NaN there.

    So is one that begins late, in the rows before.
    """
    _extend(file, FIELDS, written, samples)
    xdmf.link_instants(file, written, written + len(samples))


def extend_steps(file: Any, written: int, samples: Sequence[StepSample]) -> None:
    """Append ``samples`` after the ``written`` steps, as ``extend``."""
    _extend(file[STEPS], STEP_FIELDS, written, samples)


def _extend(
    group: Any, datasets: Iterable[str], written: int, samples: Sequence[StepSample]
) -> None:
    total = written + len(samples)
    for dataset in datasets:
        name, _ = FIELDS[dataset]
        group[dataset].resize(total, axis=0)
        group[dataset][written:] = np.stack([np.asarray(getattr(item, name)) for item in samples])
    for name in {key for sample in samples for key in sample.metrics} - set(group["metrics"]):
        _growing(group, f"metrics/{name}", (), METRIC_UNITS.get(name, "-"))
        group[f"metrics/{name}"].resize(written, axis=0)
        group[f"metrics/{name}"][:] = np.nan
    for name, dataset in group["metrics"].items():
        dataset.resize(total, axis=0)
        dataset[written:] = [sample.metrics.get(name, np.nan) for sample in samples]


def truncate(file: Any, keep: int, keep_steps: int) -> None:
    """Drop the instants from number ``keep`` on, and the steps from number ``keep_steps`` on."""
    _truncate(file, FIELDS, keep)
    xdmf.unlink_instants(file, keep)
    if STEPS in file:
        _truncate(file[STEPS], STEP_FIELDS, keep_steps)


def _truncate(group: Any, datasets: Iterable[str], keep: int) -> None:
    for dataset in [*datasets, *(f"metrics/{name}" for name in group["metrics"])]:
        group[dataset].resize(keep, axis=0)
