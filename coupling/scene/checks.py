"""What the sections of a scene must be to each other, and the files that it names."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from coupling.finite_volume.mesh_sizes import cells_above, cells_least, cells_made
from coupling.scene.carrier import carrier_problems
from coupling.scene.choices import (
    fluid_problems,
    motion_kind,
    motions_reading,
)
from coupling.scene.numerics import FEWEST_STEPS_A_PERIOD, MOST_RINGS
from coupling.scene.ridges import ridge_problems
from coupling.scene.sections import LEAST, Motion
from coupling.scene.shapes.own_mould import mould_problems
from coupling.scene.supply import supply_problems
from coupling.scene.thesis_grid import thesis_grid_problems
from coupling.scene.wrinkles import (
    CELLS_A_WAVELENGTH,
    grid_spacing,
    rings_to_resolve,
    shortest_wavelength,
)

if TYPE_CHECKING:
    from coupling.scene.scene import Scene

THICKNESS_OVER_RADIUS = 0.05
WIDEST_SPACING = 0.5  # of the rings over the rim's radius; 0.39 is that of 4 rings on a hemisphere
FEWEST_ACROSS = 4  # cells across the mesh's inner cube, those of the least ``openfoam.cells``
LEAST_SPACING, MOST_SPACING = 1e-5, 0.2  # of wall cells over the radius; that of the coarsest mesh
FARTHEST_CELLS = 1.5  # that may be asked, over those that the mesh has
_OF_ONE_KIND = (
    "file",
    "at_rest",
    "angle",
    "point",
    "duration",
    "seed",
)  # keys that another kind would pass over


def problems_between(scene: Scene) -> list[str]:
    """One line ``key: what is wrong. Mend.`` for each problem of more than one section."""
    wrong_mould = mould_problems(scene)
    if wrong_mould:  # without a mould the others cannot be looked for
        return wrong_mould
    return [
        *_check_shape(scene),
        *_check_gravity(scene),
        *_check_fill(scene),
        *_check_cells(scene),
        *thesis_grid_problems(scene),
        *_check_losses(scene),
        *_check_wrinkling(scene),
        *ridge_problems(scene),
        *_check_motion(scene),
        *carrier_problems(scene),
        *_check_time(scene),
        *supply_problems(scene),
        *fluid_problems(scene),
    ]


def _check_shape(scene: Scene) -> list[str]:
    problems, shell = [], scene.tank.shell
    smallest = min(shell.size, 0.5 * (shell.poles[1] - shell.poles[0]))
    thickest = THICKNESS_OVER_RADIUS * smallest
    thinnest, thickness = scene.diaphragm.thickness_range
    if thinnest < LEAST:
        problems.append(
            f"diaphragm.thickness_map: must be at least {LEAST:g} m thick, got {thinnest:g}. "
            "Give metres."
        )
    if thickness >= thickest:
        key = "thickness" if scene.diaphragm.thickness_map is None else "thickness_map"
        problems.append(
            f"diaphragm.{key}: must be below {THICKNESS_OVER_RADIUS} radii ({thickest:.4g} m), "
            f"got {thickness:g}. Give metres; a thicker diaphragm is no membrane."
        )
    spacing = grid_spacing(scene.mould.length, scene.cloth)
    if scene.cloth.grid == "rings" and spacing > WIDEST_SPACING * shell.size:
        rings = math.ceil(scene.cloth.resolution * spacing / (WIDEST_SPACING * shell.size))
        finer = f"Give cloth.resolution = {rings}"
        mend = finer if rings <= MOST_RINGS else "No grid is fine enough: give a shorter tank"
        problems.append(
            f"cloth.resolution: rings of a diaphragm {scene.mould.length:.4g} m from pole to rim "
            f"must lie within half the rim's radius of each other ({0.5 * shell.size:.4g} m), got "
            f"{spacing:.4g} m. {mend}."
        )
    return problems


def _check_gravity(scene: Scene) -> list[str]:
    if any(scene.gravity):
        return []
    return [
        f"gravity: must not be zero, got {list(scene.gravity)}. A weightless liquid has no level "
        "that the diaphragm could settle on: give the steady acceleration that holds it down, such "
        "as [0.0, 0.0, -9.81] on the ground."
    ]


def _check_fill(scene: Scene) -> list[str]:
    """Whether the diaphragm, which keeps its lengths, can hold the liquid's volume."""
    tank = scene.tank
    own = scene.diaphragm.mould_profile is not None
    least, largest = (volume / tank.volume for volume in tank.held_by(scene.mould, own=own))
    if least <= scene.liquid.fill_fraction <= largest:
        return []
    return [
        f"liquid.fill_fraction: a diaphragm moulded to the {scene.diaphragm.mould} part of this "
        f"{'profile' if own else 'shell'} holds fill fractions from {least:.4g} to {largest:.4g}, "
        f"got {scene.liquid.fill_fraction:g}. Give one of them, mould it to the other part "
        "(diaphragm.mould), or clamp it nearer to the middle (tank.clamp_height)."
    ]


def _check_cells(scene: Scene) -> list[str]:
    """The meshes come in steps: whether the one taken has about as many cells as were asked.

    In a long tank the steps hang on the fill fraction, and none is refused but the least.
    """
    asked, spacing, length = scene.half_ball
    if spacing and not LEAST_SPACING <= spacing <= MOST_SPACING:
        size = scene.tank.shell.size
        return [
            f"openfoam.wall_spacing: must be 0 or lie in {LEAST_SPACING * size:g} to "
            f"{MOST_SPACING * size:g} m in this tank, got {scene.openfoam.wall_spacing:g}. Give a "
            "fraction of the boundary layer's thickness, sqrt(nu/(pi f))."
        ]
    least = cells_least(FEWEST_ACROSS, spacing, length)
    if asked < least:
        given = (
            f"with wall_spacing = {scene.openfoam.wall_spacing:g}"
            if spacing
            else "in so long a tank"
        )
        mend = ", or a larger wall_spacing" if spacing else ""
        return [
            f"openfoam.cells: {given} the coarsest mesh has {least} cells, got {asked}. "
            f"Give {least} or more{mend}."
        ]
    made, next_ = cells_made(asked, spacing, length), cells_above(asked, spacing, length)
    if length > 0.0 or asked <= FARTHEST_CELLS * made:
        return []
    return [
        f"openfoam.cells: the mesh of at most {asked} cells has {made}, the next one {next_}. "
        f"Give {made} or {next_}."
    ]


def _check_losses(scene: Scene) -> list[str]:
    """What the rubber's loss is of, and at which frequency."""
    rubber, problems = scene.diaphragm, []
    for key in ("friction_shell", "friction_self"):
        value = getattr(rubber, key)
        if value > 0.0 and scene.cloth.grid == "thesis":
            problems.append(
                f'diaphragm.{key}: does not apply to cloth.grid = "thesis", got {value:g}. '
                'Leave it out, or take cloth.grid = "rings".'
            )
    if rubber.loss_factor == 0.0:
        return problems
    if rubber.inextensible:
        problems.append(
            f"diaphragm.loss_factor: is of the rubber's own stretch, got {rubber.loss_factor:g} "
            "with inextensible = true, whose stretch is numerical and tends to nothing. Give "
            "diaphragm.inextensible = false, or leave it out."
        )
    if rubber.loss_frequency is None and scene.period is None:
        problems.append(
            "diaphragm.loss_frequency: is required for a loss_factor without a sine, got none. "
            f"Give the {type(rubber).model_fields['loss_frequency'].description}."
        )
    return problems


def _check_wrinkling(scene: Scene) -> list[str]:
    """Whether the grid is fine enough for the wrinkles that it is asked to resolve."""
    cloth, length = scene.cloth, scene.mould.length
    if cloth.wrinkling != "resolved" or cloth.grid == "thesis":
        return []
    wavelength = shortest_wavelength(scene.diaphragm, scene.liquid, np.array(scene.gravity))
    needed = rings_to_resolve(length, wavelength)
    if cloth.resolution >= needed:
        return []
    finer = f"Give cloth.resolution = {needed} or more, or take"
    mend = finer if needed <= MOST_RINGS else f"A grid has at most {MOST_RINGS} rings: take"
    return [
        f'cloth.wrinkling: "resolved" needs {CELLS_A_WAVELENGTH} spacings to the elasto-gravity '
        f"wavelength of {wavelength:.4g} m, so {needed} rings; got {cloth.resolution} rings, "
        f'{grid_spacing(length, cloth):.4g} m apart. {mend} cloth.wrinkling = "relaxed".'
    ]


def _check_motion(scene: Scene) -> list[str]:
    motion = scene.motion
    kind = motion_kind(motion.kind)
    problems = [
        f'motion.{key}: is required for kind = "{motion.kind}". '
        f"Give the {Motion.model_fields[key].description}."
        for key in kind.needs
        if getattr(motion, key) is None
    ]
    if not any(motion.direction):
        problems.append(
            "motion.direction: must not be zero, got [0, 0, 0]. "
            "Give the direction of the shaking, such as [1.0, 0.0, 0.0]."
        )
    for key in _OF_ONE_KIND:
        if getattr(motion, key) is not None and key not in (*kind.needs, *kind.takes):
            kinds = " or ".join(f'"{name}"' for name in motions_reading(key))
            problems.append(
                f"motion.{key}: is read with motion.kind = {kinds} only, got kind = "
                f'"{motion.kind}". Set motion.kind = {kinds}, or leave the {key} out.'
            )
    time = scene.time
    return [*problems, *kind.problems(motion, time.step * time.steps, time.step)]


def _check_time(scene: Scene) -> list[str]:
    time, problems = scene.time, []
    if time.duration < time.step:
        problems.append(
            f"time.duration: must be at least time.step ({time.step:g} s), got {time.duration:g}. "
            "Give a longer duration, or a smaller step."
        )
    longest = None if scene.period is None else scene.period / FEWEST_STEPS_A_PERIOD
    if longest is not None and time.step > longest * (1.0 + 1e-9):
        problems.append(
            f"time.step: must be at most 1/{FEWEST_STEPS_A_PERIOD} of the motion's period "
            f"({longest:.4g} s), got {time.step:g}. Give a smaller step."
        )
    return problems
