"""A mechanical model as a Functional Mock-up Unit (FMI 3.0, co-simulation), by pythonfmu3.

The unit holds a Python program, which the simulator runs with the Python of its machine; the
program needs nothing but Python's own library.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pythonfmu3.builder import FmuBuilder

from coupling.mechanical.exports import fmu_program

FILE = "MechanicalModel.fmu"


def write_fmu(place: Path, row: Mapping[str, Any]) -> None:
    """Write ``MechanicalModel.fmu``: the tank's acceleration in, force and moment out."""
    parameters = {
        "fixed_mass_kg": row["fixed_mass_kg"],
        "fixed_height_m": row["fixed_height_m"],
        "modes": [
            {
                name: mode[name]
                for name in ("mass_kg", "frequency_hz", "damping_ratio", "hinge_height_m")
            }
            for mode in row["modes"]
        ],
    }
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "fmu_program.py"
        shutil.copy(fmu_program.__file__, program)
        (Path(folder) / "parameters.json").write_text(json.dumps(parameters), encoding="utf-8")
        built = FmuBuilder.build_FMU(
            program, dest=folder, project_files=[Path(folder) / "parameters.json"]
        )
        part = place / f".{FILE}.partial"
        shutil.copy(built, part)
        part.replace(place / FILE)
