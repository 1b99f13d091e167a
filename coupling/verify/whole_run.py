"""A whole run of a tank, from settling to results, for a case that reads what came of it."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coupling.ports import RunFailed
from coupling.scene.scene import Scene, scene_from
from coupling.simulation.driver import run
from coupling.store.results import Results, read_results

RADIUS, DENSITY, FILL_FRACTION = 0.4445, 1000.0, 0.8


def whole_run(case: str, **sections: Mapping[str, Any]) -> tuple[Scene, Results]:
    """Run the scene of these ``sections``; every step is in the results.

    Water at a fill fraction of 0.8 under a diaphragm of AF-E-332 unless they say other.
    ``RunFailed`` with the reason if the run did not end well.
    """
    data: dict[str, dict[str, Any]] = {
        "tank": {"radius": RADIUS},
        "diaphragm": {"thickness": 1.778e-3, "material": "AF-E-332"},
        "liquid": {"density": DENSITY, "viscosity": 1e-6, "fill_fraction": FILL_FRACTION},
        "time": {"output_every": 1},
    }
    for name, values in sections.items():
        data[name] = data.get(name, {}) | dict(values)
    scene = scene_from(data, where=f"verify {case}")
    with tempfile.TemporaryDirectory() as folder:
        summary = run(scene, Path(folder))
        if summary["status"] != "completed":
            raise RunFailed(f"verify {case}: {summary['error']}")
        return scene, read_results(Path(folder))
