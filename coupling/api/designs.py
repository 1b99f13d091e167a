"""A design curve: the least thickness that keeps a criterion, over the tank's radius."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coupling.api.start import Changes, Progress, check_installed, folder_for
from coupling.campaign.design_plan import plan_design
from coupling.campaign.same_plan import check_same_plan
from coupling.scene.scene import tables_of
from coupling.scene.source import as_texts
from coupling.store.folder_lock import held
from coupling.store.run_folder import prepare_folder

DESIGN_FILES = frozenset({"design.json", "design.csv", "runs.csv", "report.html", "points"})


@dataclass(frozen=True, kw_only=True)
class Design:
    """A design curve in its ``folder``.

    ``table`` is what ``design.json`` holds: one row a radius, with the bracket and its runs.
    """

    folder: Path
    table: Mapping[str, Any]


def design(
    scene: str | Path,
    radius: str,
    criterion: str,
    limit: float,
    out: str | Path | None = None,
    *,
    thickness: str | None = None,
    changes: Changes = (),
    force: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Design:
    """Bracket by runs, for each radius, the least thickness that keeps a criterion.

    The motion stays as the scene gives it, an amplitude in metres too. A search that was stopped
    goes on; one with another limit or criterion takes over the runs that it shares with a former
    one. Below ``if __name__ == "__main__":`` in a script, as ``sweep``.

    Parameters
    ----------
    scene : str or Path
        A folder with ``scene.toml`` or a scene file; every run reads it anew.
    radius : str
        ``start:stop:count``, ``start:stop:count:log`` or ``a,b,c`` [m].
    criterion : str
        ``folds``, ``self_rub``, ``wear`` or ``burst``, see ``coupling.metrics.criteria``.
    limit : float
        What the criterion's figure is to stay below.
    out : str or Path, optional
        Folder of the results; ``runs/NAME-design`` after the scene's file if left out.
    thickness : str, optional
        ``least:largest`` [m] of the search; from a quarter of the scene's own to twice that, but
        below what the radius allows, if left out.
    changes, force, workers, scheduler, progress
        As ``sweep``.

    Returns
    -------
    Design

    Raises
    ------
    SceneError, SweepError, FolderError, OpenFoamMissing
        The scene, a value or the folder are wrong, OpenFOAM is needed and does not work: nothing
        was started. A run that fails is a row with its reason.
    """
    plan = plan_design(Path(scene), as_texts(changes), radius, criterion, limit, thickness)
    runs = plan.scan.runs
    check_installed(next(iter(runs.values())), [plan.model])
    files = {path for one in runs.values() for path in tables_of(one).values()}
    folder = folder_for(scene, files, out, suffix="-design", written=DESIGN_FILES)
    with held(folder):
        prepare_folder(folder, force=force, study=DESIGN_FILES)
        check_same_plan(folder, runs, (), force=force)  # further runs are of other thicknesses
        from coupling.campaign.design import run_design

        table = run_design(plan, folder, workers=workers, scheduler=scheduler, progress=progress)
    return Design(folder=folder, table=table)
