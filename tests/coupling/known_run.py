"""A run whose results are known: a level surface that tilts and shifts in step with the tank."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

from coupling.ports import Array, Ints
from coupling.scene.scene import Scene, scene_from
from coupling.simulation.sampling import NodePressures, split_metrics
from coupling.store.results_writer import ResultsWriter
from coupling.store.run_record import RunStatistics, Sample

RADIUS, FREQUENCY, AMPLITUDE, DENSITY, GRAVITY = 0.4, 1.25, 0.1, 1000.0, 9.81
OMEGA = 2.0 * np.pi * FREQUENCY
LAG = np.radians(30.0)
CG_AMPLITUDE, FORCE_AMPLITUDE, MASS = 0.02, 150.0, 200.0
PRESSURE = 800.0  # of the contact with the shell [Pa]


def disc(rings: int = 8) -> tuple[Array, Ints]:
    """A hemisphere's points (n, 3) and triangles (m, 3) over a disc of ``rings``."""
    points = [np.zeros(2)]
    for ring in range(1, rings + 1):
        angle = 2.0 * np.pi * np.arange(6 * ring) / (6 * ring)
        points += [
            (ring / rings * c, ring / rings * s)
            for c, s in zip(np.cos(angle), np.sin(angle), strict=True)
        ]
    plan = np.array(points)
    triangles = Delaunay(plan).simplices.astype(np.int64)
    polar = np.hypot(*plan.T) * np.pi / 2
    azimuth = np.arctan2(plan[:, 1], plan[:, 0])
    ring_radius = RADIUS * np.sin(polar)
    reference = np.stack(
        [ring_radius * np.cos(azimuth), ring_radius * np.sin(azimuth), -RADIUS * np.cos(polar)],
        axis=1,
    )
    return reference, triangles


def sample(time: float, reference: Array, triangles: Ints) -> Sample:
    """The instant of the known run at ``time`` [s]."""
    displacement = AMPLITUDE * np.sin(OMEGA * time)
    slope = 0.3 * np.sin(OMEGA * time - LAG)
    position = reference * [1.0, 1.0, 0.2]
    rim = 1.0 - np.sum(reference[:, :2] ** 2, axis=1) / RADIUS**2
    position[:, 2] += rim * slope * reference[:, 0]
    depth = -position[:, 2]
    dynamic = 200.0 * np.sin(OMEGA * time) * reference[:, 0] / RADIUS
    parts = NodePressures(dynamic=dynamic, kinetic=0.0 * dynamic, viscous=0.0 * dynamic)
    return Sample(
        time=time,
        tank_acceleration=np.array([-(OMEGA**2) * displacement, 0.0, 0.0]),
        tank_displacement=np.array([displacement, 0.0, 0.0]),
        position=position,
        pressure=DENSITY * GRAVITY * depth + dynamic + 500.0,
        dynamic_pressure=dynamic - dynamic.mean(),
        strain=np.full(len(triangles), 0.002),
        tension=np.full(len(triangles), 300.0),
        velocity=np.zeros_like(reference),
        contact_force=np.zeros_like(reference),
        shell_pressure=np.full(len(reference), PRESSURE),
        self_pressure=np.zeros(len(reference)),
        shell_slip=np.full(len(reference), 0.01 * time),
        self_slip=np.zeros(len(reference)),
        shell_work=np.full(len(reference), PRESSURE * 0.01 * time),
        self_work=np.zeros(len(reference)),
        rub_place=reference,
        volume=0.2,
        datum_pressure=500.0,
        liquid_cg=np.array([CG_AMPLITUDE * np.sin(OMEGA * time - LAG), 0.0, -0.1]),
        force=np.array([FORCE_AMPLITUDE * np.sin(OMEGA * time), 0.0, -MASS * GRAVITY]),
        moment=np.zeros(3),
        iterations=4,
        residual=1e-5,
        metrics={"speed_max": 0.8, "non_orthogonality_max": 40.0}
        | split_metrics(position, triangles, DENSITY * GRAVITY * depth, parts),
    )


def write_run(
    folder: Path,
    *,
    periods: float = 3.0,
    step: float = 0.02,
    scene: str = "",
    model: str = "openfoam",
    tilt: float = 1.0,
    every: int = 1,
    rings: int = 8,
    metrics: Mapping[str, Callable[[float], float]] | None = None,
) -> None:
    """The known run as a results folder; ``tilt`` scales how far the diaphragm moves.

    ``every``: number of steps between the instants that are written out. ``metrics``:
    further ones, by name, as functions of the time.
    """
    reference, triangles = disc(rings)
    writer = ResultsWriter.create(
        folder, scene_toml=scene, model=model, reference=reference, triangles=triangles
    )
    for number, time in enumerate(np.arange(0.0, periods / FREQUENCY + step / 2, step)):
        known = sample(float(time), reference, triangles)
        flat = reference * [1.0, 1.0, 0.2]
        position = flat + tilt * (known.position - flat)
        more = {name: value(float(time)) for name, value in (metrics or {}).items()}
        one = replace(known, position=position, metrics={**known.metrics, **more})
        writer.append(one.at_step() if number % every else one)
    writer.close()


def scene() -> Scene:
    """The scene of the known run."""
    return scene_from(
        {
            "title": "Known run",
            "tank": {"radius": RADIUS},
            "diaphragm": {
                "thickness": 0.0018,
                "density": 1070.0,
                "youngs_modulus": 8.6e6,
                "poisson_ratio": 0.5,
            },
            "liquid": {"density": DENSITY, "viscosity": 1e-6, "fill_fraction": 0.5},
            "motion": {"kind": "sine", "frequency": FREQUENCY, "amplitude": AMPLITUDE, "ramp": 0.0},
            "time": {"duration": 2.4, "step": 0.02},
        }
    )


def statistics() -> RunStatistics:
    """What the known run counted."""
    return RunStatistics(
        steps=480,
        simulated_s=2.4,
        wall_s=96.0,
        wall_by_part={"structure": 40.0, "fluid": 50.0, "mapping": 4.0, "output": 2.0},
        strain_tensile_max=0.004,
        tension_max=320.0,
        stress_max=2e5,
        volume_error_max=3e-6,
        iterations_total=1920,
        iterations_max=7,
        speed_max=0.8,
        dphi_dt_max=2.5,
    )
