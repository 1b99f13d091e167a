"""The section of a report on a tank that is free to move."""

from __future__ import annotations

import numpy as np

from coupling.metrics.carrier import by_axis
from coupling.report.figures import motion_figure
from coupling.report.files import RunFiles
from coupling.report.page import Picture, Section, Table, number

_ROWS = (
    ("Largest displacement (mm)", "displacement_max_m", 1e3),
    ("Largest acceleration (m/s²)", "acceleration_max_m_s2", 1.0),
    ("Largest force of springs and dampers (N)", "support_force_max_N", 1.0),
    ("Largest rotation (°)", "rotation_max_deg", 1.0),
    ("Largest moment of what holds it (N m)", "support_moment_max_N_m", 1.0),
    ("Momentum with the contents at the end (kg m/s)", "momentum_kg_m_s", 1.0),
)
_ENERGIES = (
    ("Work of the ground and of the given force", "work_J"),
    ("Taken by the dampers", "damper_loss_J"),
    ("Given to liquid and diaphragm in the tank", "contents_work_J"),
    ("Kinetic, of all but the contents’ own in the tank", "kinetic_energy_J"),
    ("In the springs", "spring_energy_J"),
    ("Rest, of the time step", "rest_J"),
)


def carrier_section(run: RunFiles) -> Section | None:
    """How the tank moved and what held it; None where its motion is prescribed."""
    found = run.summary.get("carrier")
    if found is None:
        return None
    moved = [
        [head, *(number(scale * value) for value in found[name])]
        for head, name, scale in _ROWS
        if found.get(name) is not None
    ]
    energies = [[head, number(found[name], "J")] for head, name in _ENERGIES]
    return Section(
        title="Free tank",
        text=f"The tank, {number(found['mass_kg'], 'kg')} without its contents, moves as it is "
        "pushed. What holds it up at rest is left out of the forces.",
        tables=[
            Table(head=["", "x", "y", "z"], rows=moved),
            Table(head=["Energy at the end", ""], rows=energies),
        ],
        pictures=[
            motion_figure(
                run,
                by_axis(run.results.steps, "support_force"),
                "springs, dampers (N)",
                "Tank, and the force of springs and dampers on it beyond that at rest.",
            ),
            *_rotation(run),
        ],
    )


def _rotation(run: RunFiles) -> list[Picture]:
    """How the tank turned; nothing of one that is held against it."""
    if run.scene.carrier.inertia is None:
        return []
    turned = np.degrees(run.results.steps.tank_rotation)
    return [motion_figure(run, turned, "rotation (°)", "Tank, and its rotation vector.")]
