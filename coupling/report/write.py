"""From a folder to its ``report.html``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coupling.ports import Array, Ints
from coupling.report.design_report import design_page
from coupling.report.files import read_run
from coupling.report.identification_report import identification_page
from coupling.report.page import html
from coupling.report.run_report import run_page
from coupling.report.scan_report import scan_page
from coupling.report.study_report import study_page
from coupling.report.style import house_style
from coupling.report.sweep_report import sweep_page
from coupling.store.atomic import read_json, write_text

FILE = "report.html"
_OF_SWEEP = {
    "title": str, "axes": list, "models": list, "reference": object, "points": int, "rows": list,
}  # fmt: skip
_OF_DESIGN: dict[str, type | tuple[type, ...]] = {
    "title": str, "criterion": str, "limit": (int, float), "model": str, "rows": list,
    "searched": list,
}  # fmt: skip
_OF_IDENTIFICATION = {
    "title": str, "model": str, "followed_within": float, "linear_within": float, "rows": list,
}  # fmt: skip
_OF_STUDY = {
    "models": dict, "discretisation": dict, "reference": object, "advice": str,
}  # fmt: skip
_AGAIN = "Give the same edt {} command again: it writes the file anew from the runs."


def write_report(folder: Path | str) -> Path:
    """Write ``report.html`` of a run, study, sweep, design or identification; return its path.

    It is made from the folder's files and self-contained. Works for runs that failed, and for
    those still going.

    Raises
    ------
    UnreadableFile, SceneError
        The folder's files cannot be read.
    RunFailed
        The page cannot be written.
    """
    folder = Path(folder)
    study, sweep, design = (folder / f"{name}.json" for name in ("study", "sweep", "design"))
    identified = folder / "mechanical_model.json"
    with house_style():
        if identified.is_file():
            content = read_json(identified, _OF_IDENTIFICATION, _AGAIN.format("identify"))
            page = identification_page(folder, content)
        elif sweep.is_file():
            page = sweep_page(folder, read_json(sweep, _OF_SWEEP, _AGAIN.format("sweep")))
        elif design.is_file():
            page = design_page(folder, read_json(design, _OF_DESIGN, _AGAIN.format("design")))
        elif study.is_file():
            page = study_page(folder, read_json(study, _OF_STUDY, _AGAIN.format("study")))
        else:
            page = run_page(read_run(folder))
    path = folder / FILE
    write_text(path, html(page))
    return path


def write_scan_report(
    folder: Path, table: Mapping[str, Any], nodes: Mapping[str, Array], triangles: Ints
) -> Path:
    """Write ``compare.html`` of a scan held against a run; return its path.

    ``table``: what ``compare.json`` holds; ``nodes``: the columns (n,) of ``compare.csv``;
    ``triangles`` (m, 3) of the run's diaphragm. Raises ``RunFailed`` where it cannot be written.
    """
    with house_style():
        page = scan_page(table, nodes, triangles)
    path = folder / "compare.html"
    write_text(path, html(page))
    return path
