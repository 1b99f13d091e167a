"""Partitioned fluid-structure interaction of elastomeric diaphragm tanks.

What a program or a notebook needs is here: ``load_scene``, ``run``, ``resume``, ``study``,
``sweep``, ``design``, ``identify``, ``compare_scan`` and ``read_results``, and what they return.
Each is imported when it is first asked for, so that importing the package costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coupling.api.designs import Design, design
    from coupling.api.identification import Identification, identify
    from coupling.api.runs import FailedRun, Run, resume, run
    from coupling.api.scans import ScanComparison, compare_scan
    from coupling.api.studies import Study, study
    from coupling.api.sweeps import Sweep, sweep
    from coupling.scene.scene import Scene, SceneError, load_scene
    from coupling.store.results import Results, read_results

__all__ = [
    "Design",
    "FailedRun",
    "Identification",
    "Results",
    "Run",
    "ScanComparison",
    "Scene",
    "SceneError",
    "Study",
    "Sweep",
    "compare_scan",
    "design",
    "identify",
    "load_scene",
    "read_results",
    "resume",
    "run",
    "study",
    "sweep",
]

_HOMES = {
    "coupling.api.designs": ("Design", "design"),
    "coupling.api.identification": ("Identification", "identify"),
    "coupling.api.runs": ("FailedRun", "Run", "resume", "run"),
    "coupling.api.scans": ("ScanComparison", "compare_scan"),
    "coupling.api.studies": ("Study", "study"),
    "coupling.api.sweeps": ("Sweep", "sweep"),
    "coupling.scene.scene": ("Scene", "SceneError", "load_scene"),
    "coupling.store.results": ("Results", "read_results"),
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(home), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
