"""The irrotational liquid as a fluid model."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from coupling.fluids.hydrostatic import Hydrostatic, hydrostatic_of
from coupling.fluids.model import CoarserScene, ErrorLaw, FluidModel, Record, inertia_wrong
from coupling.ports import IterativeStructure, TimeStep
from coupling.scene.scene import Scene

_OWN = 0.02  # CPU time [s] that the potential adds to a step, on the machine of ``estimate.cost``


class PotentialModel(FluidModel):
    """Potential flow in the true shape: added mass, laminar wall layers, no vortices."""

    name = "potential"
    colour, line = "#009E73", "-."
    has_flow = True
    error_law = ErrorLaw(law=inertia_wrong)
    dissipation_note = (
        "This model’s liquid loses energy in laminar layers at the walls, by Stokes’ formula, in "
        "impacts and to the step."
    )
    pressure_note = "Exact for the harmonic polynomials that this model’s potential is made of."

    def load_model(self, scene: Scene) -> Hydrostatic:
        """The part of the pressure that needs no flow."""
        return hydrostatic_of(scene)

    def time_step(
        self, scene: Scene, cloth: IterativeStructure, folder: Path, record: Record
    ) -> TimeStep:
        """Return the step that solves diaphragm and liquid as one system, without iterations."""
        from coupling.fluids.potential.liquid import PotentialLiquid
        from coupling.fluids.potential.step import PotentialStep
        from coupling.fluids.potential.wall_layers import layer_speed

        del folder, record
        liquid = PotentialLiquid(
            cloth.triangles,
            len(cloth.reference),
            shell=scene.tank.shell,
            degree=scene.potential.degree,
            density=scene.liquid.density,
        )
        frequency = scene.frequency
        if frequency is None:  # what lasts after a shock, and most of what a record stirs
            frequency = liquid.slowest_wave(cloth.state.position, np.array(scene.gravity))
        liquid.layer = layer_speed(scene.liquid.viscosity, frequency)
        return PotentialStep(cloth, liquid)

    def approximations(self, scene: Scene) -> Mapping[str, CoarserScene]:
        """Return the scene with polynomials of two degrees less.

        Their errors fall by no power: what two degrees change is taken for what is left out.
        """
        lower = scene.potential.model_copy(update={"degree": scene.potential.degree - 2})
        changed = scene.model_copy(update={"potential": lower})
        return {"lower_degree": CoarserScene(scene=changed, width=2.0, order=1.0)}

    def step_cost(self, scene: Scene, solve: float) -> float:
        """Return the CPU time [s] of the diaphragm's step, and of the potential."""
        del scene
        return solve + _OWN


POTENTIAL = PotentialModel()
