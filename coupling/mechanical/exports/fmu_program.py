"""What runs within the Functional Mock-up Unit: the model in time, with Python's own library."""

import json
import math
from pathlib import Path
from typing import Any

from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability


class MechanicalModel(Fmi3Slave):  # type: ignore[misc]
    """Fixed mass and pendulums on a tank; ``acceleration`` in [m/s^2], ``force``, ``moment`` out.

    The acceleration is taken as constant over a step; for one that is, the step is exact.
    """

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.description = "Liquid in a tank: a fixed mass and pendulums"
        file = Path(str(self.resources)) / "parameters.json"
        self._model = json.loads(file.read_text(encoding="utf-8"))
        self._states = [(0.0, 0.0) for _ in self._model["modes"]]
        self.time = 0.0
        self.acceleration = 0.0
        self.force = 0.0
        self.moment = 0.0
        self.register_variable(
            Float64(
                "time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous
            )
        )
        for name, causality, description in (
            ("acceleration", Fmi3Causality.input, "of the tank along the direction [m/s^2]"),
            ("force", Fmi3Causality.output, "of the liquid on the tank along it [N]"),
            ("moment", Fmi3Causality.output, "about the tank's centre, height times force [N m]"),
        ):
            self.register_variable(Float64(name, causality=causality, description=description))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Go on by ``step_size`` [s]."""
        self.time = current_time + step_size
        self.force = -self._model["fixed_mass_kg"] * self.acceleration
        self.moment = self._model["fixed_height_m"] * self.force
        for index, mode in enumerate(self._model["modes"]):
            omega, damping = 2.0 * math.pi * mode["frequency_hz"], mode["damping_ratio"]
            state = _moved(omega, damping, *self._states[index], self.acceleration, step_size)
            self._states[index] = state
            force = mode["mass_kg"] * (omega**2 * state[0] + 2.0 * damping * omega * state[1])
            self.force += force
            self.moment += mode["hinge_height_m"] * force
        return True


def _moved(
    omega: float, damping: float, place: float, speed: float, acceleration: float, step: float
) -> tuple[float, float]:
    """State [m, m/s] of q'' + 2 z w q' + w^2 q = -a after ``step``, with a constant and z < 1."""
    level = -acceleration / omega**2
    rate = omega * math.sqrt(1.0 - damping**2)
    off = place - level
    slope = (speed + damping * omega * off) / rate
    fall = math.exp(-damping * omega * step)
    cosine, sine = math.cos(rate * step), math.sin(rate * step)
    moved = fall * (off * cosine + slope * sine)
    speed_then = fall * rate * (slope * cosine - off * sine) - damping * omega * moved
    return level + moved, speed_then
