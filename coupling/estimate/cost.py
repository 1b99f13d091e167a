"""How long a run will take, and how much memory: to a factor of 1.5, on a core that is free.

All constants are CPU seconds of one core of the machine of ``tests/benchmarks/foreseen.py``, whose
tables hold the estimates against runs; ``slowness`` says how this machine compares. What a liquid
adds its fluid model says.
"""

from __future__ import annotations

from dataclasses import dataclass

from coupling.estimate.machine import slowness
from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene

FACTOR = 1.5  # that an estimate may be off, either way

_RINGS = 24.0  # of the grid that the next constants are for


@dataclass(frozen=True)
class _Growth:
    """A cost that is ``fixed`` for any grid, and ``growing`` with a power of its rings."""

    fixed: float
    growing: float
    power: float

    def of(self, scene: Scene) -> float:
        """The cost of the grid of ``scene``."""
        return float(self.fixed + self.growing * (scene.cloth.rings / _RINGS) ** self.power)


# By ``cloth.wrinkling``, CPU time [s]: the nodes grow with the square of the rings, and finer grids
# take more iterations. Relaxed folds: fitted to 8, 16, 24 and 40 rings; resolved: to 24 and 42.
_STEP = {"relaxed": _Growth(0.018, 0.100, 3.5), "resolved": _Growth(0.018, 0.050, 3.5)}
_SETTLING = {"relaxed": _Growth(0.9, 7.7, 3.3), "resolved": _Growth(0.9, 2.4, 2.0)}
_ATTEMPTS = 2.0  # at a step whose tank turns freely: 2 or 3 (``foam_cases/free_tank``)
_MEMORY = _Growth(325e6, 30e6, 2.0)  # bytes of the program with its libraries, and of the diaphragm


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated CPU time of one step [s] with ``fluid`` in place of the scene's own model."""
    attempts = 1.0 if scene.carrier.inertia is None else _ATTEMPTS
    return attempts * FLUIDS[fluid].step_cost(scene, _STEP[scene.cloth.wrinkling].of(scene))


def start_cost(scene: Scene, fluid: str) -> float:
    """Estimated CPU time [s] before the first step: of settling, and of a flow solver's start."""
    model = FLUIDS[fluid]
    settling = model.settling * _SETTLING[scene.cloth.wrinkling].of(scene)
    return float(settling + model.start_cost(scene))


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated CPU time of the whole run [s]."""
    return start_cost(scene, fluid) + scene.time.steps * step_cost(scene, fluid)


def run_time(scene: Scene, fluid: str) -> tuple[float, float]:
    """Shortest and longest wall time [s] to expect of ``run_cost`` on a free core of this machine.

    Where no run has been here before, it takes a tenth of a second to see how fast the machine is.
    """
    likely = slowness() * run_cost(scene, fluid)
    return likely / FACTOR, likely * FACTOR


def run_memory(scene: Scene, fluid: str) -> float:
    """Most bytes of RAM that a run takes at once, its flow solver included, its report not."""
    return float(_MEMORY.of(scene) + FLUIDS[fluid].memory(scene))
