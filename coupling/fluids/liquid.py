"""The liquid of a scene: its hydrostatic load, and the flow where the model has one."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import meshio

from coupling.finite_volume.mesh import half_ball
from coupling.fluids.datum import Datum
from coupling.fluids.hydrostatic import Hydrostatic
from coupling.fluids.openfoam import OpenFoamFlow
from coupling.fluids.potential.liquid import PotentialLiquid
from coupling.foam.installation import find_openfoam
from coupling.interface.free_patch import FreePatch
from coupling.interface.liquid_shape import level_of_fill_fraction
from coupling.ports import Array, HydrostaticLoad, Structure
from coupling.scene.scene import Scene


class LoadModel(Protocol):
    """What every rung of the ladder gives: the load that needs no flow."""

    def load(self, body_force: Array) -> HydrostaticLoad:
        """The load under ``body_force`` (3,) [m/s^2]."""


def load_model(scene: Scene) -> LoadModel:
    """The hydrostatic part of the scene's ``model.fluid``.

    ``ValueError`` for "auto", which names no model yet (``coupling.campaign.auto`` takes one).
    """
    if scene.model.fluid == "auto":
        raise ValueError(
            'model.fluid = "auto": take a model first, as coupling.campaign.auto.run_auto does'
        )
    if scene.model.fluid == "datum":
        depth = level_of_fill_fraction(scene.liquid.fill_fraction)  # over R, from the bottom
        return Datum(density=scene.liquid.density, level=(depth - 1.0) * scene.tank.radius)
    return Hydrostatic(density=scene.liquid.density, volume=scene.liquid_volume)


def potential_of(scene: Scene, cloth: Structure) -> PotentialLiquid:
    """The inviscid liquid below ``cloth``."""
    return PotentialLiquid(
        cloth.triangles,
        len(cloth.reference),
        radius=scene.tank.radius,
        degree=scene.potential.degree,
        density=scene.liquid.density,
    )


def flow_of(scene: Scene, folder: Path, cloth: Structure) -> tuple[OpenFoamFlow, FreePatch]:
    """The flow below the settled ``cloth``, not yet started, and its map to the cloth."""
    radius, mesh = scene.tank.radius, half_ball(scene.openfoam.cells)
    mapping = FreePatch(mesh, cloth, radius=radius)
    mapping.fit(cloth.state, scene.liquid_volume)
    flow = OpenFoamFlow(
        folder,
        mesh,
        openfoam=find_openfoam(
            scene.openfoam.command,
            keep_alive=scene.openfoam.keep_alive,
            processors=scene.openfoam.processors,
        ),
        radius=radius,
        density=scene.liquid.density,
        viscosity=scene.liquid.viscosity,
        timeout=scene.openfoam.timeout,
    )
    return flow, mapping


def start_flow(flow: OpenFoamFlow, mapping: FreePatch, scene: Scene, cloth: Structure) -> None:
    """Put the flow at rest below the settled ``cloth``, whose surface is left beside its mesh."""
    shell = mapping.begin_step(cloth.state, 0.0, cloth.state.position)
    flow.start(mapping.to_flow(cloth.state.position), shell, scene.liquid_volume)
    surface = flow.case.folder / "constant" / "triSurface" / "diaphragm.stl"
    surface.parent.mkdir()
    triangles = [("triangle", cloth.triangles)]
    meshio.write(surface, meshio.Mesh(cloth.state.position, triangles), binary=True)
