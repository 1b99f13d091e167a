"""What the thesis' grid can do: one thickness, a hinged rim, no compliance, no volume kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

from coupling.scene.choices import fluid_models, keeps_volume, motion_kind

if TYPE_CHECKING:
    from coupling.scene.scene import Scene


def thesis_grid_problems(scene: Scene) -> list[str]:
    """One line ``key: what is wrong. Mend.`` for each thing that the grid cannot do."""
    if scene.cloth.grid != "thesis":
        return []
    problems = []
    if keeps_volume(scene.model.fluid):
        names = " or ".join(f'"{name}"' for name in fluid_models() if not keeps_volume(name))
        problems.append(
            f'cloth.grid: "thesis" needs model.fluid = {names}, got "{scene.model.fluid}". '
            'Take cloth.grid = "rings" for a liquid that keeps its volume.'
        )
    if motion_kind(scene.motion.kind).turns(scene.motion):
        problems.append(
            'cloth.grid: "thesis" computes no tank that turns. Take cloth.grid = "rings", or leave '
            "the rotation out of the motion."
        )
    if scene.tank.shape != "sphere":
        problems.append(
            f'tank.shape: must be "sphere" for cloth.grid = "thesis", got "{scene.tank.shape}". '
            'Take cloth.grid = "rings" for another shape.'
        )
    if scene.tank.clamp_height != 0.0:
        problems.append(
            'tank.clamp_height: must be 0 for cloth.grid = "thesis", got '
            f'{scene.tank.clamp_height:g}. Leave it out, or take cloth.grid = "rings".'
        )
    if scene.diaphragm.mould != "upper":
        problems.append(
            'diaphragm.mould: must be "upper" for cloth.grid = "thesis", got '
            f'"{scene.diaphragm.mould}". Leave it out, or take cloth.grid = "rings".'
        )
    if scene.cloth.resolution % 2:
        problems.append(
            f'cloth.resolution: must be even for cloth.grid = "thesis", got '
            f"{scene.cloth.resolution}. Give the number of nodes across, 26 in the thesis."
        )
    if not scene.diaphragm.inextensible:
        problems.append(
            'diaphragm.inextensible: must be true for cloth.grid = "thesis", got false. '
            'Take cloth.grid = "rings" for a diaphragm that stretches.'
        )
    if scene.diaphragm.rim != "hinged":
        problems.append(
            f'diaphragm.rim: must be "hinged" for cloth.grid = "thesis", got '
            f'"{scene.diaphragm.rim}". Take cloth.grid = "rings" for a clamped rim.'
        )
    if scene.diaphragm.thickness_map is not None:
        problems.append(
            'diaphragm.thickness_map: does not apply to cloth.grid = "thesis". '
            'Give diaphragm.thickness, or take cloth.grid = "rings".'
        )
    if scene.time.step_tolerance is not None:
        problems.append(
            'time.step_tolerance: does not apply to cloth.grid = "thesis", whose steps are of a '
            'millisecond. Leave it out, or take cloth.grid = "rings".'
        )
    if scene.cloth.wrinkling != "relaxed":
        problems.append(
            f'cloth.wrinkling: does not apply to cloth.grid = "thesis", got '
            f'"{scene.cloth.wrinkling}". Leave it out, or take cloth.grid = "rings".'
        )
    return problems
