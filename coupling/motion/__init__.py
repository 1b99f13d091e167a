"""How the tank moves, and what is known of its motion before a run.

A kind of motion is one file with a ``MotionKind``, and one line in ``MOTIONS``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from coupling.registry import Registry

if TYPE_CHECKING:  # a scene reads the names before there is a section that a kind could be of
    from coupling.motion.kind import MotionKind

__all__ = ["MOTIONS"]

MOTIONS: Registry[MotionKind] = Registry(
    "kind of motion",
    {
        "sine": "coupling.motion.sine:SINE",
        "table": "coupling.motion.table:TABLE",
        "psd": "coupling.motion.psd:PSD",
        "rest": "coupling.motion.rest:REST",
    },
)
