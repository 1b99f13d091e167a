"""Response over excitation, as complex numbers: the tank's transfer functions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from coupling.metrics.harmonic import Harmonic

Complex = NDArray[np.complex128]


def tank_phasor(displacement: Complex) -> complex:
    """Complex amplitude [m] of the tank along its direction of shaking.

    ``displacement`` (3,) [m]; the sign is that of its largest component.
    """
    largest = complex(displacement[np.argmax(np.abs(displacement))])
    if largest == 0.0:
        return 0j
    return largest / abs(largest) * float(np.linalg.norm(displacement))


def transfer(response: Harmonic, excitation: complex) -> dict[str, Any]:
    """``response`` over ``excitation``, by component: complex, and as amplitude and phase [deg].

    The liquid's CG in the tank over the tank's displacement d is 0, the force over m omega^2 d
    = -m a is 1 where the liquid moves as one body with the tank: force = 1 + CG by Newton's law.
    All None without an excitation.
    """
    if excitation == 0.0:
        nothing = [None] * len(response.coefficient)
        return {"real": nothing, "imag": nothing, "amplitude": nothing, "phase_deg": nothing}
    ratio = response.coefficient / excitation
    return {
        "real": ratio.real,
        "imag": ratio.imag,
        "amplitude": np.abs(ratio),
        "phase_deg": response.phase_deg(excitation),
    }
