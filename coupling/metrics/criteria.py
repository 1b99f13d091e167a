"""What a diaphragm must keep to be thick enough: figures of a run that stay below a limit.

``coupling.cli.design`` says the same in its help, where nothing that computes is imported.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.results import Results
from coupling.store.stored_rows import blocks


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """A figure of a run that is to stay below a limit.

    ``figure``: what it is, with its unit; ``reservation``: what the figure is known to leave open;
    ``value``: of a completed run's summary and scene, None where the run has none; ``badness``
    (T,): of its results and scene, largest at the instant to be shown; ``needs``: dotted key of the
    scene that has to be given, if any.
    """

    figure: str
    reservation: str
    value: Callable[[Mapping[str, Any], Scene], float | None]
    badness: Callable[[Results, Scene], Array]
    needs: str | None = None


def _folded(summary: Mapping[str, Any], scene: Scene) -> float | None:
    del scene
    share: float | None = summary["folds"]["folded_area_max_fraction"]
    return share


def _folded_area(results: Results, scene: Scene) -> Array:
    del scene
    return np.asarray(results.metrics["folded_area"])


def _self_rub(summary: Mapping[str, Any], scene: Scene) -> float:
    del scene
    return float(summary["rubs"]["self_work_max_J_per_m2"] or 0.0)  # null: nothing has slid


def _self_rub_rate(results: Results, scene: Scene) -> Array:
    del scene
    return _gained(results.self_work)


def _wear(summary: Mapping[str, Any], scene: Scene) -> float:
    ranges = (summary["rubs"][f"{kind}_wear_max_m"] for kind in ("shell", "self"))
    return max(float(found[1]) if found else 0.0 for found in ranges) / scene.diaphragm.thickness


def _wear_rate(results: Results, scene: Scene) -> Array:
    del scene
    most = [float(np.max(work[-1])) for work in (results.shell_work, results.self_work)]
    return _gained(results.shell_work if most[0] >= most[1] else results.self_work)


def _stress(summary: Mapping[str, Any], scene: Scene) -> float:
    strength = scene.diaphragm.strength
    assert strength is not None
    return float(summary["stress_max_Pa"] / strength)


def _tension(results: Results, scene: Scene) -> Array:
    del scene
    return np.concatenate([tension.max(axis=1) for (tension,) in blocks(results.tension)])


def _gained(work: Array) -> Array:
    """What the node with the most ``work`` (T, n) at the end gained since the last instant (T,)."""
    node = int(np.argmax(work[-1]))
    gathered = np.concatenate([rows[:, node] for (rows,) in blocks(work)])
    return np.diff(gathered, prepend=gathered[0])


_OF_THE_GRID = "Of what the grid shows: folds below it are relaxed, see summary.json's below_grid."
CRITERIA = {
    "folds": Criterion(
        figure="largest share of the moulded area folded over: faces whose normal has turned by "
        "more than 90 degrees from the moulded one",
        reservation="A diaphragm that everts as a whole has 71 % of it turned, without any fold. "
        + _OF_THE_GRID,
        value=_folded,
        badness=_folded_area,
    ),
    "self_rub": Criterion(
        figure="largest slip work per moulded area of the diaphragm on itself [J/m^2]",
        reservation="It gathers over the run: a longer one has more. " + _OF_THE_GRID,
        value=_self_rub,
        badness=_self_rub_rate,
    ),
    "wear": Criterion(
        figure="depth worn off over the thickness: largest slip work per area, on the shell or on "
        "itself, times the upper diaphragm.wear_coefficient",
        reservation="It gathers over the run: a longer one has more; coefficients of rigs differ "
        "by factors, and the depth with them.",
        value=_wear,
        badness=_wear_rate,
        needs="diaphragm.wear_coefficient",
    ),
    "burst": Criterion(
        figure="largest stress over diaphragm.strength",
        reservation="Where the sheet snaps taut, the largest stress grows as the step falls: it "
        "does not converge there.",
        value=_stress,
        badness=_tension,
        needs="diaphragm.strength",
    ),
}
