"""What a report reads: the files of a run, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.fluids import FLUIDS
from coupling.fluids.supply import volume_error
from coupling.metrics.bernoulli import node_areas
from coupling.metrics.summary import summarise
from coupling.ports import Array
from coupling.scene.scene import Scene, load_scene
from coupling.store.attitude import body_force
from coupling.store.iteration_log import read_iterations
from coupling.store.results import Results, open_results
from coupling.store.run_record import RunStatistics, read_summary
from coupling.store.stored_rows import blocks


@dataclass(frozen=True, kw_only=True)
class RunFiles:
    """A run's folder, read: scene, results, summary, ``iterations`` (k, 4) of ``coupling.csv``.

    ``row``: what a study calls it.
    """

    folder: Path
    scene: Scene
    results: Results
    summary: dict[str, Any]
    iterations: Array
    row: str = ""

    @property
    def label(self) -> str:
        """The ``row`` of a study's table that it is, else its model."""
        return self.row or self.model

    @property
    def model(self) -> str:
        """Fluid model of the run."""
        return self.results.model

    @property
    def has_flow(self) -> bool:
        """Whether the model computes p* at all."""
        return FLUIDS[self.model].has_flow


def read_run(folder: Path) -> RunFiles:
    """Read a run's folder; one still running, which has no summary yet, is summarised from here.

    Raises UnreadableFile or SceneError where results or scene cannot be read.
    """
    results, scene = open_results(folder), load_scene(folder)
    summary, iterations = read_summary(folder), read_iterations(folder)
    if not summary:
        counted = _counted(results, scene, iterations)
        summary = summarise(results, counted, scene, "unfinished", None)
    return RunFiles(
        folder=folder,
        scene=scene,
        results=results,
        summary=summary,
        iterations=iterations,
    )


def _counted(results: Results, scene: Scene, iterations: Array) -> RunStatistics:
    """What an unfinished run's files say of it: strain and stress of the instants written out."""
    steps = results.steps
    if len(steps.time) == 0:
        return RunStatistics()
    _, per_step = np.unique(iterations[:, 0], return_counts=True)
    largest = {
        name: float(np.nanmax(steps.metrics[name]))
        for name in ("speed_max", "dphi_dt_max")
        if name in steps.metrics
    }
    simulated = float(steps.time[-1])
    thickness = _thickness(results, scene)
    largest_of = np.array(
        [
            (strain.max(), tension.max(), (tension / thickness).max())
            for strain, tension in blocks(results.strain, results.tension)
        ]
    ).max(axis=0)
    return RunStatistics(
        steps=round(simulated / scene.time.step),
        simulated_s=simulated,
        wall_s=float(iterations[:, 3].sum()),
        strain_tensile_max=max(0.0, float(largest_of[0])),
        tension_max=max(0.0, float(largest_of[1])),
        stress_max=max(0.0, float(largest_of[2])),
        volume_error_max=float(volume_error(scene, steps.time, steps.volume).max()),
        iterations_total=int(per_step.sum()),
        iterations_max=int(per_step.max(initial=0)),
        speed_max=largest.get("speed_max"),
        dphi_dt_max=largest.get("dphi_dt_max"),
    )


def _thickness(results: Results, scene: Scene) -> Array | float:
    """Of the rubber [m]; of every triangle (m,) where it is uneven."""
    uneven = scene.thickness_at(results.reference[results.triangles].mean(axis=1))
    return scene.diaphragm.thickness if uneven is None else uneven


def pressure_rms(run: RunFiles) -> tuple[Array, Array]:
    """rms over the interface (T,) [Pa] of p* and of the hydrostatic pressure, means removed."""
    results = run.results
    pulls = body_force(np.array(run.scene.gravity), results)
    found = []
    for position, pull, dynamic in blocks(results.position, pulls, results.dynamic_pressure):
        hydrostatic = run.scene.liquid.density * np.einsum("tni,ti->tn", position, pull)
        weight = node_areas(position, results.triangles)
        found.append((_rms(dynamic, weight), _rms(hydrostatic, weight)))
    dynamic_rms, hydrostatic_rms = (np.concatenate(part) for part in zip(*found, strict=True))
    return dynamic_rms, hydrostatic_rms


def _rms(values: Array, weight: Array) -> Array:
    share = weight / weight.sum(axis=1, keepdims=True)
    mean = (share * values).sum(axis=1, keepdims=True)
    rms: Array = np.sqrt((share * (values - mean) ** 2).sum(axis=1))
    return rms
