"""One run: started, gone on with, and what it found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coupling.api.start import Changes, Progress, check_installed, files_of, folder_for, scene_of
from coupling.estimate.machine import remember_speed
from coupling.ports import RunFailed
from coupling.scene.choices import AUTO
from coupling.scene.scene import Scene, load_scene
from coupling.store.folder_lock import held
from coupling.store.run_folder import check_resumable, prepare_folder

if TYPE_CHECKING:
    import xarray as xr

    from coupling.store.results import Results
    from coupling.store.resumption import SavedRun


@dataclass(frozen=True, kw_only=True)
class Run:
    """A run in its ``folder``; scene and results are read when they are asked for.

    Attributes
    ----------
    folder : Path
        Where its files are.
    summary : Mapping
        What ``summary.json`` holds: status, amplitudes and phases, cost.
    was_complete : bool
        Whether ``resume`` found nothing left to compute.
    """

    folder: Path
    summary: Mapping[str, Any]
    was_complete: bool = False

    @cached_property
    def scene(self) -> Scene:
        """The scene as run: all defaults written out, ``auto`` replaced by the model it took."""
        return load_scene(self.folder)

    @cached_property
    def results(self) -> Results:
        """Everything over time, as arrays; raises ``UnreadableFile`` where nothing was written."""
        from coupling.store.results import read_results

        return read_results(self.folder)

    def to_xarray(self) -> xr.Dataset:
        """Return the results as a dataset whose variables carry their units."""
        return self.results.to_xarray()

    def write_report(self) -> Path:
        """Write ``report.html`` and return its path; raises ``RunFailed`` where it cannot be."""
        from coupling.report import write_report

        return write_report(self.folder)


class FailedRun(RunFailed):
    """A run that failed on its way; ``run`` is what it left, the message says when and why."""

    def __init__(self, message: str, run: Run) -> None:
        super().__init__(message)
        self.run = run


def run(
    scene: Scene | str | Path,
    out: str | Path | None = None,
    *,
    fluid: str | None = None,
    changes: Changes = (),
    force: bool = False,
    report: bool = False,
    progress: Progress | None = None,
) -> Run:
    """Settle the diaphragm, then shake the tank; the results go to a folder.

    Parameters
    ----------
    scene : Scene, str or Path
        What to simulate: a folder with ``scene.toml``, a scene file, or a scene.
    out : str or Path, optional
        Folder of the results; ``runs/NAME`` after the scene's file if left out.
    fluid : str, optional
        Fluid model in place of ``model.fluid``.
    changes : Mapping or Sequence of str
        Values by dotted key, or ``key=value`` as on the command line.
    force : bool
        Whether a run that the folder holds is replaced.
    report : bool
        Whether ``report.html`` is written as well.
    progress : callable, optional
        Called with the stage, what is done, the total (0 where unknown), both in seconds, and text.

    Returns
    -------
    Run

    Raises
    ------
    SceneError, FolderError, OpenFoamMissing
        The scene is wrong, the folder holds something else, OpenFOAM is needed and does not work:
        nothing was started.
    FailedRun
        The run failed; its ``run`` has what was computed.
    """
    valid = scene_of(scene, changes)
    if fluid is not None:
        valid = scene_of(valid, {"model.fluid": fluid})
    if valid.model.fluid == AUTO:
        from coupling.campaign.auto import run_auto as run_scene
        from coupling.estimate.model_errors import choose

        check_installed(valid, [choose(valid).fluid])
    else:
        from coupling.simulation.driver import run as run_scene

        check_installed(valid, [valid.model.fluid])
    folder = folder_for(scene, files_of(valid), out)
    with held(folder):
        prepare_folder(folder, force=force)
        return _ended(folder, run_scene(valid, folder, progress=progress), report=report)


def resume(folder: str | Path, *, report: bool = False, progress: Progress | None = None) -> Run:
    """Go on from the last checkpoint in ``folder``, with the results of a run that never stopped.

    Raises
    ------
    FolderError, UnreadableFile
        There is no run to go on with, its scene is not that of its checkpoint, or a file is
        damaged.
    OpenFoamMissing
        OpenFOAM is needed and does not work.
    FailedRun
        As ``run``.
    """
    folder = Path(folder)
    check_resumable(folder)
    from coupling.store.resumption import saved_run

    with held(folder):
        scene = load_scene(folder)
        saved = saved_run(folder, scene)
        auto = (folder / "auto.json").is_file()
        if saved is not None and saved.finished is not None and not (auto and _unchecked(saved)):
            return Run(folder=folder, summary=saved.finished, was_complete=True)
        check_installed(scene, [scene.model.fluid])
        if auto:
            from coupling.campaign.auto import resume_auto as resume_run
        else:
            from coupling.simulation.driver import resume as resume_run
        return _ended(folder, resume_run(folder, progress=progress), report=report)


def _unchecked(saved: SavedRun) -> bool:
    """Whether the check of the model that auto took is still to come."""
    return "checked" not in ((saved.finished or {}).get("auto") or {})


def _ended(folder: Path, summary: Mapping[str, Any], *, report: bool) -> Run:
    """The run that has ended, however; one that failed is reported too, and then raised."""
    done = Run(folder=folder, summary=summary)
    failure = str(summary.get("error")) if summary.get("status") == "failed" else ""
    if report and (folder / "results.h5").is_file():
        try:
            done.write_report()
        except RunFailed as error:
            failure = failure or str(error)
    if failure:
        raise FailedRun(failure, done)
    remember_speed()
    return done
