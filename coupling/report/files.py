"""What a report reads: the files of a run, and nothing else."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.iteration_log import read_iterations
from coupling.metrics.bernoulli import node_areas
from coupling.metrics.summary import summarise
from coupling.ports import Array, RunStatistics
from coupling.results import Results, read_results
from coupling.scene import Scene, load_scene


@dataclass(frozen=True, kw_only=True)
class RunFiles:
    """A run's folder, read: scene, results, summary, ``iterations`` (k, 4) of ``coupling.csv``."""

    folder: Path
    scene: Scene
    results: Results
    summary: dict[str, Any]
    iterations: Array

    @property
    def model(self) -> str:
        """Fluid model of the run."""
        return self.results.model

    @property
    def has_flow(self) -> bool:
        """Whether the model computes p* at all."""
        return self.model not in ("datum", "hydrostatic")


def read_run(folder: Path) -> RunFiles:
    """Read a run's folder; one still running, which has no summary yet, is summarised from here.

    Raises RunFailed or SceneError where results or scene cannot be read.
    """
    results, scene = read_results(folder), load_scene(folder)
    path = folder / "summary.json"
    if path.is_file():
        summary = json.loads(path.read_text(encoding="utf-8"))
    else:
        summary = summarise(results, RunStatistics(), scene, "unfinished", None)
    return RunFiles(
        folder=folder,
        scene=scene,
        results=results,
        summary=summary,
        iterations=read_iterations(folder),
    )


def pressure_rms(run: RunFiles) -> tuple[Array, Array]:
    """rms over the interface (T,) [Pa] of p* and of the hydrostatic pressure, means removed."""
    results = run.results
    body_force = np.array(run.scene.gravity) - results.tank_acceleration
    hydrostatic = run.scene.liquid.density * np.einsum("tni,ti->tn", results.position, body_force)
    weight = node_areas(results.position, results.triangles)
    return _rms(results.dynamic_pressure, weight), _rms(hydrostatic, weight)


def _rms(values: Array, weight: Array) -> Array:
    share = weight / weight.sum(axis=1, keepdims=True)
    mean = (share * values).sum(axis=1, keepdims=True)
    rms: Array = np.sqrt((share * (values - mean) ** 2).sum(axis=1))
    return rms
