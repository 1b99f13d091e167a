"""What a run puts on record: its instants, and what it counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from coupling.ports import Array
from coupling.store.atomic import read_json

SUMMARY = "summary.json"
_NUMBER = (int, float)
_PARTS: dict[str, type | tuple[type, ...]] = {
    "status": str, "steps": int, "simulated_s": _NUMBER, "wall_s": _NUMBER, "wall_by_part": dict,
    "strain_tensile_max": _NUMBER,
    "coupling": dict, "cg": dict, "force": dict, "bernoulli": dict,
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class StepSample:
    """The end of a step as it goes into the results, but for what is over nodes and triangles.

    In the tank's frame and its own axes, SI. ``liquid_cg``, ``force`` and ``moment`` (3,):
    ``force`` [N] and ``moment`` [N m] act on tank and diaphragm, about the tank's centre.
    ``tank_acceleration`` and ``tank_displacement`` (3,) are in axes that do not turn; the first
    [m/s^2] is the one at ``time``, of a record its mean over the time step that ends there.
    ``tank_rotation`` (3,) [rad]: rotation vector from the tank's axes to those; ``tank_rate`` (3,)
    [rad/s], in the tank's axes. ``metrics``: further scalars by name (``speed_max``,
    ``dphi_dt_max``, ``non_orthogonality_max`` ...), the same names in every sample of a run.
    """

    time: float
    tank_acceleration: Array
    tank_displacement: Array
    volume: float
    datum_pressure: float
    liquid_cg: Array
    force: Array
    moment: Array
    iterations: int
    residual: float
    tank_rotation: Array = field(default_factory=lambda: np.zeros(3))
    tank_rate: Array = field(default_factory=lambda: np.zeros(3))
    metrics: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Sample(StepSample):
    """The same with what is over nodes and triangles: an instant that is written out.

    ``position`` (n, 3) [m]; ``pressure`` and ``dynamic_pressure`` (n,) [Pa], net pressure and p*
    with its mean removed; ``strain`` and ``tension`` (m,) [-, N/m]; ``velocity`` (n, 3) [m/s] in
    the tank; ``contact_force`` (n, 3) [N] that the sheet exerts; pressures (n,) [Pa], slips (n,)
    [m], works (n,) [J/m^2] and ``rub_place`` (n, 3) [m] of the contact with the shell and with
    itself, as ``cloth.state.ClothState`` has them.
    """

    position: Array
    pressure: Array
    dynamic_pressure: Array
    strain: Array
    tension: Array
    velocity: Array
    contact_force: Array
    shell_pressure: Array
    self_pressure: Array
    shell_slip: Array
    self_slip: Array
    shell_work: Array
    self_work: Array
    rub_place: Array

    def at_step(self) -> StepSample:
        """Return the same without what is over nodes and triangles."""
        return StepSample(**{item.name: getattr(self, item.name) for item in fields(StepSample)})


@dataclass(kw_only=True)
class RunStatistics:
    """What a run counts as it goes; becomes part of ``summary.json``.

    Every step counts here, not only those written out. ``cpu_s`` [s]: of all processes, but for a
    flow solver that was killed with the run; ``wall_by_part`` [s]; ``flow_solver``:
    whether the flow's solver stayed alive or was restarted; ``settle_residual`` [-]: force that
    settling left over rho g R^3; ``flow_fields_bytes``: on disk, where asked for.
    ``dynamic_in_band``: see ``simulation.pressure_band``.
    ``strain_areas``: as ``coupling.metrics.strains.spread`` has it, summed over steps times
    their lengths; ``cloth_...``: inner iterations of the solve that each part of a step ends with.
    """

    steps: int = 0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    cpu_s: float = 0.0
    wall_by_part: dict[str, float] = field(
        default_factory=lambda: {"structure": 0.0, "fluid": 0.0, "mapping": 0.0, "output": 0.0}
    )
    strain_tensile_max: float = 0.0
    strain_areas: list[float] = field(default_factory=list)
    cloth_solves: int = 0
    cloth_iterations_total: int = 0
    cloth_iterations_max: int = 0
    cloth_unconverged: int = 0
    tension_max: float = 0.0
    stress_max: float = 0.0
    volume_error_max: float = 0.0
    iterations_total: int = 0
    iterations_max: int = 0
    unconverged_steps: int = 0
    flow_solver: str | None = None
    settle_residual: float | None = None
    halved_steps: int = 0
    speed_max: float | None = None
    dphi_dt_max: float | None = None
    flow_fields_bytes: int | None = None
    dynamic_in_band: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return plain values by name, for the checkpoint."""
        return dict(vars(self))


def read_summary(folder: Path) -> dict[str, Any]:
    """``summary.json`` of a run's folder; empty where there is none. Raises ``UnreadableFile``."""
    path = folder / SUMMARY
    if not path.is_file():
        return {}
    mend = f"Remove the file; edt resume {folder} writes it again."
    return read_json(path, _PARTS, mend)


def is_whole(summary: Mapping[str, Any], steps: int) -> bool:
    """Whether a run's ``summary`` says that all its ``steps`` are done."""
    return summary.get("status") == "completed" and summary["steps"] >= steps
