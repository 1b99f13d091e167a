"""Axes of a model within the tank's: along the motion, across it, and against gravity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coupling.ports import Array


def axes_of(content: Mapping[str, Any]) -> Array:
    """Rows (3, 3): direction of the motion, the axis across it and upwards, in the tank's frame."""
    gravity = np.array(content["gravity_m_s2"])
    along, upwards = np.array(content["direction"]), -gravity / np.linalg.norm(gravity)
    return np.stack([along, np.cross(upwards, along), upwards])
