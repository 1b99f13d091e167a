"""From a folder to its ``report.html``."""

from __future__ import annotations

from pathlib import Path

from coupling.report.files import read_run
from coupling.report.page import html
from coupling.report.run_report import run_page
from coupling.report.study_report import study_page
from coupling.report.style import house_style
from coupling.report.sweep_report import sweep_page
from coupling.store.atomic import read_json, write_text

FILE = "report.html"
_OF_SWEEP = {
    "title": str, "axes": list, "models": list, "reference": object, "points": int, "rows": list,
}  # fmt: skip
_OF_STUDY = {
    "models": dict, "discretisation": dict, "reference": object, "advice": str,
}  # fmt: skip
_AGAIN = "Give the same edt {} command again: it writes the file anew from the runs."


def write_report(folder: Path | str) -> Path:
    """Write ``report.html`` of a run, a study or a sweep, from its files, and return its path.

    The page is self-contained. Works for runs that failed, and for those still going.

    Raises
    ------
    UnreadableFile, SceneError
        The folder's files cannot be read.
    RunFailed
        The page cannot be written.
    """
    folder = Path(folder)
    study, sweep = folder / "study.json", folder / "sweep.json"
    with house_style():
        if sweep.is_file():
            page = sweep_page(folder, read_json(sweep, _OF_SWEEP, _AGAIN.format("sweep")))
        elif study.is_file():
            page = study_page(folder, read_json(study, _OF_STUDY, _AGAIN.format("study")))
        else:
            page = run_page(read_run(folder))
    path = folder / FILE
    write_text(path, html(page))
    return path
