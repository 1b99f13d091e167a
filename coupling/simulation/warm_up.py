"""Compiling the kernels ahead, so that no wall time of a run holds it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path

from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene
from coupling.simulation.driver import run

STEPS, RINGS, SETTLE = 5, 6, 0.1


def warm_up(scenes: Iterable[Scene]) -> None:
    """Run a few steps of each of ``scenes``, on a mesh of few triangles.

    Compiled kernels are kept on disk, by place and version of the code: mostly this only loads
    them. How the runs end does not matter. Scenes of a model whose kernels a quicker one
    has too are left out.
    """
    with tempfile.TemporaryDirectory() as folder:
        for number, scene in enumerate(scenes):
            if FLUIDS[scene.model.fluid].kernels_of is None:
                run(_short(scene), Path(folder) / str(number))


def _short(scene: Scene) -> Scene:
    duration, cloth = STEPS * scene.time.step, scene.cloth
    if cloth.grid != "thesis":
        cloth = cloth.model_copy(update={"resolution": RINGS})
    time = scene.time.model_copy(update={"duration": duration, "settle": SETTLE})
    return scene.model_copy(update={"time": time, "cloth": cloth})
