"""A sweep: a grid of scenes on several fluid models, run in parallel."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coupling.api.runs import Run
from coupling.api.start import (
    Changes,
    Progress,
    check_installed,
    chosen_models,
    folder_for,
    scene_of,
)
from coupling.api.units import dataset_along
from coupling.campaign.same_plan import check_same_plan
from coupling.campaign.sweep_plan import POINTS, Axis, parse_axis, plan_sweep
from coupling.campaign.wanted import check_wanted
from coupling.fluids import ASSUMED, FLUIDS
from coupling.ports import AnyArray
from coupling.scene.reference import unit_of_key
from coupling.scene.scene import tables_of
from coupling.scene.source import as_texts
from coupling.store.atomic import replacing
from coupling.store.folder_lock import held
from coupling.store.run_folder import prepare_folder
from coupling.store.run_record import read_summary

if TYPE_CHECKING:
    import xarray as xr

NETCDF = "sweep.nc"
SWEEP_FILES = frozenset({"sweep.json", "sweep.csv", NETCDF, "report.html", "points"})


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """A sweep in its ``folder``.

    Attributes
    ----------
    folder : Path
        Where its files are.
    table : Mapping
        What ``sweep.json`` holds: the axes, and one row a point with every model's figures.
    """

    folder: Path
    table: Mapping[str, Any]

    @property
    def failures(self) -> dict[str, str]:
        """Why each point that failed on some model did, by its name."""
        return {row["point"]: row["failure"] for row in self.table["rows"] if row["failure"]}

    @cached_property
    def runs(self) -> dict[tuple[str, str], Run]:
        """The run of every point's name and model that has results."""
        found = {}
        for row in self.table["rows"]:
            for model in row["models"]:
                place = self.folder / POINTS / row["point"] / model
                if (place / "results.h5").is_file():
                    found[row["point"], model] = Run(folder=place, summary=read_summary(place))
        return found

    def to_xarray(self) -> xr.Dataset:
        """Return every figure over the axes of the sweep and ``model``, with units.

        Errors are against each point's best model; figures that were wanted have their dotted
        names, and errors are left out beside them. NaN stands where a run failed. A coordinate is
        named as the scene's key: ``dataset["motion.frequency"]``; a list of numbers is a text.
        """
        axes = self.table["axes"]
        keys = [axis["key"] for axis in axes]
        labels = [[_label(value) for value in axis["values"]] for axis in axes]
        import xarray as xr

        points = []
        for row in self.table["rows"]:
            one = dataset_along("model", {m: _figures(found) for m, found in row["models"].items()})
            for name, value in row["numbers"].items():
                if isinstance(value, int | float):
                    one[name] = float(value)
            place = {key: [_label(row["values"][key])] for key in keys}
            points.append(one.expand_dims(place))
        found = xr.combine_by_coords(points, combine_attrs="override", join="outer")
        assert isinstance(found, xr.Dataset)
        order = dict(zip(keys, labels, strict=True)) | {"model": self.table["models"]}
        found = found.reindex(order)
        for key in keys:
            found[key].attrs["units"] = unit_of_key(key) or "1"
        return found.assign_attrs(reference=self.table["reference"] or "")


def _label(value: Any) -> Any:
    return str(value) if isinstance(value, list) else value


def _figures(row: Mapping[str, Any]) -> dict[str, Any]:
    """The figures of a model's row, one by one; those wanted alone where there are any."""
    if row.get("wanted"):
        return {"wall_s": row["wall_s"], **row["wanted"]}
    moved = (row["cg"] or {}).get("amplitude_m") or [None] * 3
    along = {f"cg_{axis}_m": value for axis, value in zip("xyz", moved, strict=True)}
    return {"wall_s": row["wall_s"], **row["error"], **along, **(row["bernoulli"] or {})}


def sweep(
    scene: str | Path,
    over: Mapping[str, Sequence[Any] | AnyArray] | Sequence[str],
    models: Sequence[str] | None = None,
    out: str | Path | None = None,
    *,
    want: Sequence[str] = (),
    changes: Changes = (),
    force: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Run a scene over a grid of values on one or several fluid models, in parallel.

    A sweep that was stopped goes on: runs that are complete in the folder are not repeated. Worker
    processes import the main module, as ``multiprocessing`` has it: call this from a notebook, or
    below ``if __name__ == "__main__":``.

    Parameters
    ----------
    scene : str or Path
        A folder with ``scene.toml`` or a scene file. Not a scene: every point reads the file anew,
        so that what it derives, as a duration from a number of periods, follows the point's values.
    over : Mapping or Sequence of str
        Values by dotted key, or ``key=start:stop:count``, ``key=start:stop:count:log`` and
        ``key=a,b,c`` as on the command line. All combinations are run.
    models : Sequence of str, optional
        Two or more fluid models; hydrostatics and the next better one if left out. With ``want``
        one is enough, the scene's own if left out; a single one has no errors.
    out : str or Path, optional
        Folder of the results; ``runs/NAME-sweep`` after the scene's file if left out.
    workers : int, optional
        Number of worker processes; one for each core if left out.
    scheduler : str, optional
        Address of a running Dask cluster that sees the same files, in place of worker processes.
    want : Sequence of str
        Figures of ``summary.json`` by their dotted names, as ``rubs.self_work_max_J_per_m2``, of a
        list by index from 0, as ``cg.amplitude_m.0``. ``sweep.csv`` then has one row a run, with
        these, and ``sweep.nc`` (netCDF 3) holds ``to_xarray``.
    changes, force, progress
        As ``run``; progress counts runs.

    Returns
    -------
    Sweep

    Raises
    ------
    SceneError, SweepError, FolderError, OpenFoamMissing
        A scene, the axes, the models or a wanted name are wrong, the folder holds something else,
        OpenFOAM is needed and does not work: nothing was started. A run that fails is part of a
        row with its reason, and among the ``failures``.
    """
    if models is None:
        first = [f"{axis.key}={json.dumps(axis.values[0])}" for axis in _axes(over) if axis.values]
        own = scene_of(scene, [*as_texts(changes), *first]).model.fluid if want else None
        models = _assumed_and_next() if own is None else [own]
    chosen = chosen_models(models, least=1 if want else 2)
    plan = plan_sweep(Path(scene), as_texts(changes), _axes(over), chosen)
    for one in plan.points[0].scenes.values():
        plan = replace(plan, wanted=check_wanted(want, one))
    for point in plan.points:
        for model, one in point.scenes.items():
            check_installed(one, [model])
    runs = plan.runs
    files = {path for one in runs.values() for path in tables_of(one).values()}
    folder = folder_for(scene, files, out, suffix="-sweep", written=SWEEP_FILES)
    with held(folder):
        prepare_folder(folder, force=force, study=SWEEP_FILES)
        check_same_plan(folder, runs, ("points/*/*",), force=force)
        from coupling.campaign.sweep import run_sweep

        table = run_sweep(plan, folder, workers=workers, scheduler=scheduler, progress=progress)
        done = Sweep(folder=folder, table=table)
        if want:
            with replacing(folder / NETCDF) as part:
                # SciPy's netCDF 3 has all that a table of numbers needs, and takes no package more
                done.to_xarray().to_netcdf(part, engine="scipy")
    return done


def _assumed_and_next() -> tuple[str, ...]:
    rank = FLUIDS.rank(ASSUMED)
    return FLUIDS.names[rank : rank + 2]


def _axes(over: Mapping[str, Sequence[Any] | AnyArray] | Sequence[str]) -> list[Axis]:
    if isinstance(over, Mapping):
        return [
            Axis(key=key, values=tuple(np.asarray(values).tolist())) for key, values in over.items()
        ]
    return [parse_axis(text) for text in over]
