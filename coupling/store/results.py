"""What a run leaves behind: ``results.h5``, readable at any moment, also after a kill."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from coupling.ports import Array, Ints
from coupling.store import results_layout as layout
from coupling.store.atomic import H5_ERRORS, UnreadableFile
from coupling.store.results_head import FILE
from coupling.store.step_series import StepSeries
from coupling.store.stored_rows import StoredRows

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class Results:
    """A run's results as arrays: T instants, n nodes, m triangles (SI, tank frame).

    ``time`` (T,); ``tank_acceleration``, ``tank_displacement``, ``tank_rotation``, ``tank_rate``,
    ``liquid_cg``, ``force``, ``moment`` (T, 3), in the axes that ``StepSample`` says;
    ``reference`` (n, 3), ``triangles`` (m, 3); ``position`` (T, n, 3);
    ``pressure``, ``dynamic_pressure`` (T, n); ``strain``, ``tension`` (T, m);
    ``velocity``, ``contact_force``, ``rub_place`` (T, n, 3); ``shell_pressure``,
    ``self_pressure``, ``shell_slip``, ``self_slip``, ``shell_work``, ``self_work`` (T, n), as
    ``cloth.state.ClothState`` has them; ``volume``, ``datum_pressure``,
    ``iterations``, ``residual`` (T,); ``metrics`` by name, (T,) each, in ``metric_units``.
    ``every_step``: what the file keeps of every step, None in files of older versions.
    """

    model: str
    version: str
    scene_toml: str
    triangles: Ints
    reference: Array
    time: Array
    tank_acceleration: Array
    tank_displacement: Array
    tank_rotation: Array
    tank_rate: Array
    position: Array
    pressure: Array
    dynamic_pressure: Array
    strain: Array
    tension: Array
    velocity: Array
    contact_force: Array
    shell_pressure: Array
    self_pressure: Array
    shell_slip: Array
    self_slip: Array
    shell_work: Array
    self_work: Array
    rub_place: Array
    volume: Array
    datum_pressure: Array
    liquid_cg: Array
    force: Array
    moment: Array
    iterations: Ints
    residual: Array
    metrics: dict[str, Array]
    metric_units: dict[str, str]
    every_step: StepSeries | None = None

    @property
    def steps(self) -> StepSeries:
        """All but what is over nodes and triangles, at every step; else at the instants."""
        if self.every_step is not None:
            return self.every_step
        names = [item.name for item in fields(StepSeries)]
        return StepSeries(**{name: getattr(self, name) for name in names})

    @property
    def units(self) -> dict[str, str]:
        """Unit of every array by its name, metrics included; "-" where it has none."""
        fields = dict(layout.FIELDS.values())
        return {"triangles": "-", "reference": "m", **fields, **self.metric_units}

    def to_xarray(self) -> xr.Dataset:
        """Return all arrays as a dataset over time, node, triangle and axis, with their units.

        Those of every step are over ``step_time``, with ``step_`` before their names.
        """
        from coupling.store.results_dataset import dataset_of

        return dataset_of(self)


def read_results(folder: Path | str) -> Results:
    """Read ``results.h5`` of a run's folder, finished, running or killed.

    Raises
    ------
    UnreadableFile
        There is none, it is cut, or it is not one of ours.
    """
    with _readable(Path(folder) / FILE) as path, h5py.File(path, "r") as file:
        return _results(file, lambda _, dataset: dataset[()])


def open_results(folder: Path | str) -> Results:
    """As ``read_results``, with all that is over nodes or triangles and time left on the disk.

    Those fields are ``StoredRows``, which read what is asked of them; the file stays open as long
    as one of them is kept.
    """
    with _readable(Path(folder) / FILE) as path:
        return _results(
            h5py.File(path, "r"),
            lambda name, dataset: StoredRows(dataset) if layout.is_field(name) else dataset[()],
        )


@contextmanager
def _readable(path: Path) -> Iterator[Path]:
    if not path.is_file():
        raise UnreadableFile(f"{path}: no such file. Give the folder that `edt run` wrote to.")
    try:
        yield path
    except H5_ERRORS as error:
        raise UnreadableFile(
            f"{path}: not a results file ({error}). Run the scene again."
        ) from error


def _results(file: Any, taken: Callable[[str, Any], Any]) -> Results:
    metrics = file["metrics"]
    return Results(
        model=str(file.attrs["model"]),
        version=str(file.attrs["version"]),
        scene_toml=str(file.attrs["scene"]),
        triangles=file["diaphragm/triangles"][()],
        reference=file["diaphragm/reference"][()],
        metrics={name: metrics[name][()] for name in metrics},
        metric_units={name: str(metrics[name].attrs["unit"]) for name in metrics},
        **{
            name: taken(name, file[dataset])
            if name not in layout.LATER or dataset in file
            else _unknown(file, name)
            for dataset, (name, _) in layout.FIELDS.items()
        },
        every_step=_steps(file[layout.STEPS]) if layout.STEPS in file else None,
    )


def _unknown(file: Any, name: str) -> Any:
    """What a file of an older version does not hold: NaN at every instant and node.

    No tank turned then.
    """
    if not layout.is_field(name):
        return np.zeros_like(file["tank/acceleration"])
    instants, nodes, axes = file["diaphragm/position"].shape
    shape = (instants, nodes, axes) if "axis" in layout.dims_of(name) else (instants, nodes)
    return np.full(shape, np.nan)


def _steps(group: Any) -> StepSeries:
    return StepSeries(
        metrics={name: dataset[()] for name, dataset in group["metrics"].items()},
        **{
            name: group[dataset][()] if dataset in group else _unknown(group, name)
            for dataset, (name, _) in layout.STEP_FIELDS.items()
        },
    )
