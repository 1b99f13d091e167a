"""Where the error of a study's reference comes from: each source by one run, with it alone changed.

Numerical sources are changed by a known factor, so that the error left can be estimated; what a
diaphragm is not known by, its folds' damping, its rim, its friction, is changed within what it may
be, and the change itself is reported.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from coupling.campaign.study_plan import (
    COARSER,
    Entry,
    altered,
    coarsening,
    coarser_cloth,
    coarser_scenes,
    is_valid,
    ladder_rows,
    less_resolved,
    stiffer,
    stretch_row,
    thesis_row,
)
from coupling.campaign.theory_checks import check_entries
from coupling.estimate.orders import SHEET_ORDER
from coupling.fluids import FLUIDS, by_rank
from coupling.fluids.model import CoarserScene
from coupling.scene.scene import Scene, SceneError

COARSEST, CLOTH_GRID, LOOSE_CLOTH = "coarsest_grid", "coarser_diaphragm", "looser_diaphragm"
_LOOSER = 10.0  # factor on a tolerance
UNKNOWN = "half_fold_damping", "other_rim", "friction"  # of the diaphragm


def refinements(scene: Scene) -> dict[str, CoarserScene]:
    """Return the scene with each of its numerical sources of error alone enlarged, by name.

    Beside those of ``study_plan``: a second coarser grid, from which the order of its error shows;
    a coarser diaphragm below a flow with a grid of its own; tolerances ten times as large, the
    error going with them; what the fluid model itself approximates by.
    """
    model, cloth = FLUIDS[scene.model.fluid], scene.cloth
    found = dict(model.approximations(scene))
    flow = model.coarser(scene)
    if flow is not None:
        coarser = altered(scene, "cloth", resolution=coarser_cloth(scene))
        width = cloth.resolution / coarser.cloth.resolution
        found[CLOTH_GRID] = CoarserScene(scene=coarser, width=width, order=SHEET_ORDER)
    second = coarsest_scene(scene)
    if second is not None:
        (first, order), (further, _) = (
            coarsening(one)[COARSER] for one in (scene, coarser_scenes(scene)[COARSER])
        )
        found[COARSEST] = CoarserScene(scene=second, width=first * further, order=order)
    if cloth.grid == "rings":
        looser = altered(scene, "cloth", tolerance=_LOOSER * cloth.tolerance)
        found[LOOSE_CLOTH] = CoarserScene(scene=looser, width=_LOOSER, order=1.0)
    return {name: one for name, one in found.items() if one.width != 1.0 and is_valid(one.scene)}


def coarsest_scene(scene: Scene) -> Scene | None:
    """Return the scene on the grid that is coarser than its coarser one; None without any."""
    coarser = coarser_scenes(scene).get(COARSER)
    return None if coarser is None else coarser_scenes(coarser).get(COARSER)


def unknowns(scene: Scene) -> dict[str, Scene]:
    """Return the scene with each of what is not known of its diaphragm alone changed, by name."""
    if scene.cloth.grid != "rings":
        return {}
    rubber = scene.diaphragm
    changed: dict[str, tuple[str, Mapping[str, Any]]] = {
        "half_fold_damping": ("cloth", {"fold_damping": 0.5 * scene.cloth.fold_damping}),
        "other_rim": ("diaphragm", {"rim": "hinged" if rubber.rim == "clamped" else "clamped"}),
    }
    if rubber.friction_shell == 0.0 and rubber.friction_self == 0.0:
        changed["friction"] = "diaphragm", {"friction_shell": 0.3, "friction_self": 0.3}
    scenes = {name: altered(scene, key, **values) for name, (key, values) in changed.items()}
    return {name: one for name, one in scenes.items() if is_valid(one)}


def coarsening_of(scene: Scene) -> dict[str, tuple[float, float]]:
    """By which factor every numerical source is enlarged, and the order of its error, by name."""
    further = {name: (one.width, one.order) for name, one in refinements(scene).items()}
    return coarsening(scene) | further


def planned_runs(scene: Scene, models: Sequence[str], *, quick: bool) -> dict[Path, Scene]:
    """The scene of each run that a study may make, by its folder within the study's.

    Which row is the reference shows only later, so a ``quick`` one has all less resolved runs.
    """
    rows, beside = ladder_rows(scene, models), []
    if not quick:
        with suppress(SceneError):  # no such row then
            rows.append(thesis_row(scene))
        with suppress(SceneError):
            beside = [stretch_row(scene, models)]
    finer = [*less_resolved(rows), *stiffer(rows)]
    if not quick:
        finer += [*coarsest(rows), *refined(rows), *with_unknowns(rows)]
        finer += check_entries(scene, models)
    return {entry.place: entry.scene for entry in [*rows, *beside, *finer]}


def refined(entries: Iterable[Entry]) -> list[Entry]:
    """Each of ``entries`` as ``refinements`` has it."""
    return [
        Entry(row=entry.row, resolution=name, scene=one.scene)
        for entry in entries
        for name, one in refinements(entry.scene).items()
    ]


def coarsest(entries: Iterable[Entry]) -> list[Entry]:
    """Return each of ``entries`` on its coarsest grid, where there is one.

    The thesis' algorithm stays out: its explicit steps of 1 ms do not end on so coarse a grid.
    """
    ladder = (entry for entry in entries if entry.row in FLUIDS)
    scenes = ((entry.row, coarsest_scene(entry.scene)) for entry in ladder)
    return [Entry(row=row, resolution=COARSEST, scene=one) for row, one in scenes if one]


def with_unknowns(entries: Sequence[Entry]) -> list[Entry]:
    """As ``unknowns`` has it, the best of ``entries`` that has no grid of its own for its liquid.

    For the cost; the best of all where each has one.
    """
    cheap = [e for e in entries if FLUIDS[e.scene.model.fluid].coarser(e.scene) is None]
    rows = {entry.row: entry for entry in cheap or entries if entry.row in FLUIDS}
    if not rows:
        return []
    best = rows[by_rank(rows)[-1]]
    return [
        Entry(row=best.row, resolution=name, scene=scene)
        for name, scene in unknowns(best.scene).items()
    ]
