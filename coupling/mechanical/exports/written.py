"""Every model of an identification in every format."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coupling.mechanical.exports.basilisk import write_basilisk
from coupling.mechanical.exports.fmu import write_fmu
from coupling.mechanical.exports.nastran import write_nastran

FOLDER = "exports"


def write_exports(folder: Path, content: Mapping[str, Any]) -> None:
    """Write every model of ``content``, as ``mechanical_model.json`` holds it, in all formats.

    They go to ``folder/exports/<condition>``: ``nastran.bdf``, ``MechanicalModel.fmu`` and
    ``basilisk.json``. A condition that failed has none.
    """
    for row in content["rows"]:
        if row["failure"] is None:
            place = folder / FOLDER / row["condition"]
            place.mkdir(parents=True, exist_ok=True)
            write_nastran(place, content, row)
            write_fmu(place, row)
            write_basilisk(place, content, row)
