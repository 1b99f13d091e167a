"""One run among those that workers take, described without the workers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Task:
    """One run of ``point``: ``scene`` in ``folder`` (absolute); the largest ``cost`` goes first."""

    point: str
    model: str
    scene: Scene
    folder: Path
    cost: float
