"""``model.fluid = "auto"``: the cheapest fluid model that is good enough for a scene.

Chosen before the run from estimates that are fitted to our own runs, and checked after it on the
next rung up, over the first period.
"""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np

from coupling.campaign.study import run_or_reuse
from coupling.estimate.model_errors import choose, ladder
from coupling.metrics.comparison import common_instants
from coupling.motion.shaking import driving_frequency, moves
from coupling.ports import Array
from coupling.scene.scene import Scene, load_scene
from coupling.simulation.driver import Progress, resume, run
from coupling.store.atomic import read_json, write_json
from coupling.store.results import read_results

FILE = "auto.json"
CHECK_FOLDER = "check"
_log = logging.getLogger(__name__)


def run_auto(scene: Scene, folder: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Run ``scene`` on the model that ``choose`` takes, then check it; as ``driver.run``.

    The scene in ``folder`` names the model taken; the choice stands in ``auto.json``.
    """
    choice = choose(scene)
    _log.info("auto takes %s: %s", choice.fluid, choice.reason)
    folder.mkdir(parents=True, exist_ok=True)
    write_json(
        folder / FILE,
        {
            "fluid": choice.fluid,
            "tolerance": scene.model.tolerance,
            "reason": choice.reason,
            "estimates": {name: vars(one) for name, one in choice.estimates.items()},
        },
    )
    return _finish(folder, run(_on(scene, choice.fluid), folder, progress=progress), progress)


def resume_auto(folder: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Go on with what ``run_auto`` began in ``folder``; as ``driver.resume``."""
    _read(folder)
    return _finish(folder, resume(folder, progress=progress), progress)


def _finish(folder: Path, summary: dict[str, Any], progress: Progress | None) -> dict[str, Any]:
    """Add to the ``summary`` of a run how its model was chosen, and the check of it.

    The check takes the scene's first period (a table's characteristic one) on the next rung up, in
    ``check``; its error is the rms distance of the CG's paths over the rms way of the better one.
    """
    auto = _read(folder)
    if summary["status"] == "completed" and "checked" not in auto:
        auto["checked"] = _checked(load_scene(folder), folder, progress)
        write_json(folder / FILE, auto)
        if (auto["checked"].get("error") or 0.0) > auto["tolerance"]:
            _log.warning("auto: %s", auto["checked"]["says"])
    summary["auto"] = auto
    write_json(folder / "summary.json", summary)
    return summary


def _read(folder: Path) -> dict[str, Any]:
    mend = f"Put it back, or run the scene again: edt run SCENE -o {folder} --force."
    return read_json(folder / FILE, {"fluid": str, "tolerance": float, "reason": str}, mend)


def _checked(scene: Scene, folder: Path, progress: Progress | None) -> dict[str, Any]:
    """What the next rung up says of the run's beginning."""
    fluid, rungs = scene.model.fluid, ladder()
    if fluid == rungs[-1] or not moves(scene):
        return {"against": None, "says": "there is no better model to check it on"}
    better = rungs[rungs.index(fluid) + 1]
    window = min(scene.time.duration, _first_period(scene))
    part = scene.time.model_copy(update={"duration": max(window, scene.time.step)})
    checking = _on(scene, better).model_copy(update={"time": part})
    found: dict[str, Any] = {"against": better, "simulated_s": window, "error": None}
    summary = run_or_reuse(checking, folder / CHECK_FOLDER, progress)
    if summary["status"] != "completed":
        return found | {"says": f"not checked: {better} failed: {summary['error']}"}
    found["wall_s"] = summary["wall_s"]
    one, other = read_results(folder).steps, read_results(folder / CHECK_FOLDER).steps
    error = path_error(one.time, one.liquid_cg, other.time, other.liquid_cg)
    if error is None:
        return found | {"says": f"not checked: in the first {window:.3g} s nothing moves"}
    keeps = error <= scene.model.tolerance
    says = (
        f"over the first {window:.3g} s the CG's path is {error:.2g} off that of {better}, "
        f"{'within' if keeps else 'above'} {scene.model.tolerance:.3g}"
    )
    if not keeps:
        says += f": run it with model.fluid = {better}"
    return found | {"error": error, "says": says}


def path_error(time: Array, cg: Array, other_time: Array, other_cg: Array) -> float | None:
    """Return the rms distance of two CG paths over the rms displacement of the second.

    Each path is taken relative to its first point, at the instants that both paths have.

    Parameters
    ----------
    time
        Instants of the first path (T,) [s], increasing.
    cg
        CG on the first path (T, 3) [m], T >= 1.
    other_time
        Instants of the second path (S,) [s], increasing.
    other_cg
        CG on the second path (S, 3) [m], S >= 1.

    Returns
    -------
    float or None
        The relative distance [-]; None where the second does not move, or no instant is common.
    """
    rows, other_rows = common_instants(time, other_time)
    way = other_cg[other_rows] - other_cg[0]
    whole = float(np.sqrt(np.sum(way**2)))
    if whole == 0.0:
        return None
    return float(np.sqrt(np.sum((cg[rows] - cg[0] - way) ** 2))) / whole


def _first_period(scene: Scene) -> float:
    frequency = driving_frequency(scene)
    return 1.0 / frequency if frequency > 0.0 else 0.0


def _on(scene: Scene, fluid: str) -> Scene:
    return scene.model_copy(update={"model": scene.model.model_copy(update={"fluid": fluid})})
