"""The mechanical model of a tank, identified by runs of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coupling.api.start import Changes, Progress, check_installed, folder_for
from coupling.campaign.same_plan import check_same_plan
from coupling.mechanical.plan import RECORDS, conditions, with_runs
from coupling.scene.scene import tables_of
from coupling.scene.source import as_texts
from coupling.store.folder_lock import held
from coupling.store.run_folder import prepare_folder

IDENTIFICATION_FILES = frozenset(
    {
        "mechanical_model.json",
        "mechanical_model.csv",
        "report.html",
        "points",
        "exports",
        RECORDS,
    }
)


@dataclass(frozen=True, kw_only=True)
class Identification:
    """Mechanical models in their ``folder``.

    Attributes
    ----------
    folder : Path
        Where its files are.
    table : Mapping
        What ``mechanical_model.json`` holds: one row a fill and amplitude.
    """

    folder: Path
    table: Mapping[str, Any]

    @property
    def failures(self) -> dict[str, str]:
        """Why each condition that has no model has none, by its name."""
        return {row["condition"]: row["failure"] for row in self.table["rows"] if row["failure"]}


def identify(
    scene: str | Path,
    fills: Sequence[float],
    amplitudes: Sequence[float],
    out: str | Path | None = None,
    *,
    changes: Changes = (),
    force: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Identify the pendulums that stand for a tank's liquid, by runs at every fill and amplitude.

    What was stopped goes on: runs that are complete in the folder are not repeated. Worker
    processes import the main module, as ``multiprocessing`` has it: call this from a notebook, or
    below ``if __name__ == "__main__":``.

    Parameters
    ----------
    scene : str or Path
        A folder with ``scene.toml`` or a scene file. Of its motion the direction alone is used; a
        scene that names no fluid model takes ``potential``.
    fills : Sequence of float
        Fill fractions.
    amplitudes : Sequence of float
        Amplitudes of the tank's sway [m], centre to peak, that the models are to hold for.
    out : str or Path, optional
        Folder of the results; ``runs/NAME-identify`` after the scene's file if left out.
    changes, force, workers, scheduler, progress
        As ``sweep``.

    Returns
    -------
    Identification

    Raises
    ------
    SceneError, SweepError, FolderError, OpenFoamMissing
        The scene, the fills or amplitudes are wrong, the folder holds something else, OpenFOAM is
        needed and does not work: nothing was started. A run that fails is reported in its row.
    """
    wanted = conditions(Path(scene), as_texts(changes), fills, amplitudes)
    for condition in wanted:
        check_installed(condition.scene, [condition.scene.model.fluid])
    files = {path for condition in wanted for path in tables_of(condition.scene).values()}
    folder = folder_for(scene, files, out, suffix="-identify", written=IDENTIFICATION_FILES)
    with held(folder):
        folder = folder.resolve()
        prepare_folder(folder, force=force, study=IDENTIFICATION_FILES)
        planned = [with_runs(condition, folder) for condition in wanted]
        runs = {run.place: run.scene for condition in planned for run in condition.runs}
        check_same_plan(folder, runs, ("points/*/*",), force=force)
        from coupling.mechanical.identification import identify_all

        table = identify_all(
            planned, folder, workers=workers, scheduler=scheduler, progress=progress
        )
    return Identification(folder=folder, table=table)
