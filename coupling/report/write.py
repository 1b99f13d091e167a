"""From a folder to its ``report.html``."""

from __future__ import annotations

import json
from pathlib import Path

from coupling.atomic import write_text
from coupling.report.files import read_run
from coupling.report.page import html
from coupling.report.run_report import run_page
from coupling.report.study_report import study_page
from coupling.report.style import house_style
from coupling.report.sweep_report import sweep_page

FILE = "report.html"


def write_report(folder: Path | str) -> Path:
    """Write ``report.html`` of a run, a study or a sweep, from its files, and return its path.

    The page is self-contained. Works for runs that failed, and for those still going.

    Raises
    ------
    RunFailed, SceneError
        The folder's files cannot be read, or the page cannot be written.
    """
    folder = Path(folder)
    study, sweep = folder / "study.json", folder / "sweep.json"
    with house_style():
        if sweep.is_file():
            page = sweep_page(folder, json.loads(sweep.read_text(encoding="utf-8")))
        elif study.is_file():
            page = study_page(folder, json.loads(study.read_text(encoding="utf-8")))
        else:
            page = run_page(read_run(folder))
    path = folder / FILE
    write_text(path, html(page))
    return path
