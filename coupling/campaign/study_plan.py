"""What a study runs: the rows of its table, and each of them less resolved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cloth.thesis.grid import SIZE
from coupling.estimate.orders import LIMIT_ORDER, SHEET_ORDER, STEP_ORDER
from coupling.fluids import FLUIDS, by_rank
from coupling.scene.scene import Scene, SceneError, plain_values, scene_from, with_overrides

THESIS = "thesis"
STRETCH = {True: "compliant", False: "inextensible"}  # by what the scene's own diaphragm is not
CHECKS = "checks"  # row of the runs that are held against theory
AS_RUN, COARSER = "as_run", "coarser_grid"
DOUBLED, HALVED = "doubled_step", "halved_step"
STIFFER = "doubled_stiffness"


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One run of a study: a row of its table at one resolution."""

    row: str
    resolution: str
    scene: Scene

    @property
    def place(self) -> Path:
        """Folder of the run, relative to the study's."""
        if self.resolution == AS_RUN:
            return Path(self.row)
        if self.row == CHECKS:
            return Path(self.row) / self.resolution
        return Path("discretisation") / self.row / self.resolution


def study_rows() -> tuple[str, ...]:
    """Names of all rows that a study can have."""
    return (*FLUIDS, THESIS, *STRETCH.values())


def ladder_rows(scene: Scene, models: Sequence[str]) -> list[Entry]:
    """The scene with each of ``models``, the cheapest first. ``SceneError`` where it takes none."""

    def with_model(model: str) -> Scene:
        return scene_from(plain_values(altered(scene, "model", fluid=model)), f"--models {model}")

    return [
        Entry(row=model, resolution=AS_RUN, scene=with_model(model)) for model in by_rank(models)
    ]


def thesis_row(scene: Scene) -> Entry:
    """The scene on the thesis' own grid, with its own algorithm and steps of its own length.

    It knows no loss of the rubber's and no friction.

    ``SceneError`` where that cannot be, as with a thickness map.
    """
    fluid = next(name for name in FLUIDS if not FLUIDS[name].keeps_volume)
    changes = (
        'cloth.grid="thesis"', f"cloth.resolution={SIZE}", 'cloth.wrinkling="relaxed"',
        f"model.fluid={fluid}", 'diaphragm.rim="hinged"', "diaphragm.inextensible=true",
        "diaphragm.loss_factor=0", "diaphragm.friction_shell=0", "diaphragm.friction_self=0",
    )  # fmt: skip
    return Entry(row=THESIS, resolution=AS_RUN, scene=with_overrides(scene, changes))


def stretch_row(scene: Scene, models: Sequence[str]) -> Entry:
    """The scene with a diaphragm that stretches, or does not where the scene's own does.

    On the best of ``models`` that has no grid of its own, for the cost: what stretching does is
    read against the same model, not against the reference. Without the rubber's loss, of which a
    diaphragm that does not stretch has none. ``SceneError`` where the scene cannot stretch.
    """
    cheap = [model for model in models if FLUIDS[model].coarser(scene) is None] or models
    stiff = scene.diaphragm.inextensible
    changed = altered(scene, "model", fluid=by_rank(cheap)[-1])
    return Entry(
        row=stretch_name(scene),
        resolution=AS_RUN,
        scene=scene_from(
            plain_values(altered(changed, "diaphragm", inextensible=not stiff, loss_factor=0.0))
        ),
    )


def stretch_name(scene: Scene) -> str:
    """Name of the row of ``stretch_row``."""
    return STRETCH[scene.diaphragm.inextensible]


def less_resolved(entries: Iterable[Entry]) -> list[Entry]:
    """Each of ``entries`` as ``coarser_scenes`` has it."""
    return [
        Entry(row=entry.row, resolution=resolution, scene=variant)
        for entry in entries
        for resolution, variant in coarser_scenes(entry.scene).items()
    ]


def stiffer(entries: Iterable[Entry]) -> list[Entry]:
    """Each of ``entries`` whose sheet is inextensible, with ``cloth.stiffness`` doubled."""
    return [
        Entry(
            row=entry.row,
            resolution=STIFFER,
            scene=altered(entry.scene, "cloth", stiffness=2.0 * entry.scene.cloth.stiffness),
        )
        for entry in entries
        if _has_limit(entry.scene)
    ]


def _has_limit(scene: Scene) -> bool:
    """Whether the scene's sheet stands for an inextensible one by its stiffness."""
    return scene.diaphragm.inextensible and scene.cloth.grid == "rings"


def coarser_scenes(scene: Scene) -> dict[str, Scene]:
    """The scene with half the cells, and with the doubled step; the output's instants stay.

    A step that a scene may not have is halved instead: a motion takes 20 steps in a period, a
    table reaches to the last one's end. A coarser grid that may not be is left out.

    Half the cells are the flow's where there is one, as near as its meshes come to that, else half
    the diaphragm's triangles. The thesis' algorithm takes steps of 1 ms whatever the scene says: it
    has no other.
    """
    flow = FLUIDS[scene.model.fluid].coarser(scene)
    grid = altered(scene, "cloth", resolution=coarser_cloth(scene)) if flow is None else flow.scene
    variants = {COARSER: grid} if is_valid(grid) else {}
    if scene.cloth.grid == "thesis":
        return variants
    every = scene.time.output_every
    doubled = altered(
        scene,
        "time",
        step=2.0 * scene.time.step,
        output_every=every // 2 if every % 2 == 0 else every,
    )
    if is_valid(doubled):
        return variants | {DOUBLED: doubled}
    step = 0.5 * scene.time.step
    halved = altered(scene, "time", step=step, output_every=2 * every)
    return variants | {HALVED: halved}


def is_valid(scene: Scene) -> bool:
    """Whether ``scene``, put together without a check, can be read again from its own file."""
    try:
        scene_from(plain_values(scene))
    except SceneError:
        return False
    return True


def coarser_cloth(scene: Scene) -> int:
    """Resolution of the diaphragm with about half its triangles, four at least."""
    even = 2 if scene.cloth.grid == "thesis" else 1
    return max(4, even * round(scene.cloth.resolution / (even * 2**0.5)))


def coarsening(scene: Scene) -> dict[str, tuple[float, float]]:
    """By which factor the reference's other runs are coarser, and the order of the error.

    Those of ``coarser_scenes``, and the one of ``stiffer``, whose compliance is half the scene's.
    """
    variants = coarser_scenes(scene)
    step = {DOUBLED: (2.0, STEP_ORDER), HALVED: (0.5, STEP_ORDER)}
    if _has_limit(scene):
        step[STIFFER] = (0.5, LIMIT_ORDER)
    grid = variants.get(COARSER)
    if grid is None:
        return step
    flow = FLUIDS[scene.model.fluid].coarser(scene)
    if flow is None:
        coarser = scene.cloth.resolution / grid.cloth.resolution, SHEET_ORDER
    else:
        coarser = flow.width, flow.order
    return {COARSER: coarser, **step}


def altered(scene: Scene, section: str, **values: Any) -> Scene:
    """The scene with ``values`` in a ``section``, unchecked: ``is_valid`` says if it may be."""
    return scene.model_copy(update={section: getattr(scene, section).model_copy(update=values)})
