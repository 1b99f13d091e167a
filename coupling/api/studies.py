"""A study: one scene on several fluid models, and how far each is off the best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
    files_of,
    folder_for,
    scene_of,
)
from coupling.api.units import dataset_along
from coupling.campaign.error_sources import planned_runs
from coupling.campaign.same_plan import check_same_plan
from coupling.campaign.study_plan import study_rows
from coupling.campaign.wanted import unit_of_figure
from coupling.scene.scene import Scene
from coupling.store.folder_lock import held
from coupling.store.run_folder import prepare_folder
from coupling.store.run_record import read_summary

if TYPE_CHECKING:
    import xarray as xr

STUDY_RUNS = ("*", "discretisation/*/*")


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study in its ``folder``.

    Attributes
    ----------
    folder : Path
        Where its files are.
    table : Mapping
        What ``study.json`` holds: errors of every model against ``reference``, cost, advice.
    """

    folder: Path
    table: Mapping[str, Any]

    @property
    def reference(self) -> str | None:
        """The model that the errors are against: the highest that completed."""
        found: str | None = self.table["reference"]
        return found

    @property
    def advice(self) -> str:
        """Which model to take, in words."""
        return str(self.table["advice"])

    @cached_property
    def runs(self) -> dict[str, Run]:
        """The run of each row that has one, by its name."""
        places = {name: self.folder / name for name in self.table["models"]}
        return {
            name: Run(folder=place, summary=read_summary(place))
            for name, place in places.items()
            if (place / "results.h5").is_file()
        }

    def to_xarray(self) -> xr.Dataset:
        """Return errors, wall time and speed-up of every row, along ``model``, with units.

        ``NAME_uncertainty`` is the reference's own error in the figure ``NAME``. NaN stands where
        a run failed or a figure has no meaning. The attribute ``reference`` names the reference.
        """
        rows: Mapping[str, Mapping[str, Any]] = self.table["models"]
        bars: Mapping[str, Any] = self.table.get("uncertainty") or {}
        figures = {
            name: {"wall_s": row.get("wall_s"), "speedup": row.get("speedup"), **row["error"]}
            for name, row in rows.items()
        }
        found = dataset_along("model", figures)
        for name, value in bars.items():
            found[f"{name}_uncertainty"] = ((), np.nan if value is None else float(value))
            found[f"{name}_uncertainty"].attrs["units"] = unit_of_figure(name)
        return found.assign_attrs(reference=self.reference or "", advice=self.advice)


def study(
    scene: Scene | str | Path,
    models: Sequence[str] | None = None,
    out: str | Path | None = None,
    *,
    quick: bool = False,
    changes: Changes = (),
    force: bool = False,
    progress: Progress | None = None,
) -> Study:
    """Run one scene on several fluid models, and hold them against the best of them.

    A study that was stopped goes on: runs that are complete in the folder are not repeated.

    Parameters
    ----------
    scene : Scene, str or Path
        What to simulate: a folder with ``scene.toml``, a scene file, or a scene.
    models : Sequence of str, optional
        Two or more fluid models; all if left out.
    out : str or Path, optional
        Folder of the results; ``runs/NAME-study`` after the scene's file if left out.
    quick : bool
        Whether other resolutions, the thesis' algorithm and a diaphragm that stretches are left
        out, but for the best model less resolved, which says how well it knows its own figures.
    changes, force, progress
        As ``run``.

    Returns
    -------
    Study

    Raises
    ------
    SceneError, FolderError, OpenFoamMissing
        The scene or the models are wrong, the folder holds something else, OpenFOAM is needed and
        does not work: nothing was started. A run that fails is a row of the table with its reason.
    """
    chosen = chosen_models(models)
    valid = scene_of(scene, changes)
    planned = planned_runs(valid, chosen, quick=quick)
    check_installed(valid, chosen)
    files = frozenset({"study.json", "report.html", "discretisation", *study_rows()})
    folder = folder_for(scene, files_of(valid), out, suffix="-study", written=files)
    with held(folder):
        prepare_folder(folder, force=force, study=files)
        check_same_plan(folder, planned, STUDY_RUNS, force=force)
        from coupling.campaign.study import run_study

        table = run_study(valid, chosen, folder, quick=quick, progress=progress)
    return Study(folder=folder, table=table)
