"""How well a model follows runs that it was not identified by."""

from __future__ import annotations

import numpy as np

from coupling.mechanical.apparent_mass import unfollowed
from coupling.mechanical.modal_model import ModalModel
from coupling.mechanical.recording import Recording

FOLLOWED = 0.05  # rms error of the force over its rms, up to which a run counts as followed
LINEAR = 0.1  # error of a sweep that was left out, above which the motion is said not to be linear


def force_error(recording: Recording, model: ModalModel) -> float | None:
    """Rms over time of the force that ``model`` misses, over that of the force along the motion.

    None where there is no force.
    """
    size = float(np.sum(recording.force**2))
    if size == 0.0:
        return None
    return float(np.sqrt(np.sum(unfollowed(recording, model)[0] ** 2) / size))
