"""A study's own checks against theory: three short runs of its tank whose answers are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coupling.campaign.study_plan import CHECKS, Entry
from coupling.estimate.numbers import numbers_of
from coupling.estimate.sloshing_modes import covered_eigenvalue, lateral_eigenvalue, mode_shares
from coupling.fluids import ASSUMED, FLUIDS, by_rank
from coupling.scene.scene import Scene, plain_values, scene_from

SIMILAR, SMALL, LEVEL = "similar", "small_sway", "level_sway"
_QUARTER = 0.25  # of the lengths: a similar tank's numbers are the scene's times powers of two
_SMALL = 0.005  # amplitude over R: linear but for its square
_GENTLE = 1.0  # cloth.fold_damping: more of it stands for folds of violent motion, and lags in slow
_TILT = 0.02  # acceleration over g: the level tilts by it, linear but for its square
_MODES = 6  # lateral ones; further ones hold 4e-4 of a slow motion at a fill of 0.8


def check_entries(scene: Scene, models: Sequence[str]) -> list[Entry]:
    """Return the runs of the checks that ``scene`` has, on the best cheap one of ``models``.

    ``similar``: the scene at a quarter of all lengths and half of all times. ``small_sway``: at
    half the first slosh frequency. ``level_sway``: so slow that the surface stays level, with
    hydrostatics. None where theory has no answer: a motion other than a level sine, another shape
    than a sphere, a thickness map.
    """
    if not _has_theory(scene):
        return []
    meshless = by_rank([m for m in models if FLUIDS[m].coarser(_with(scene, m)) is None])
    found = []
    if meshless and FLUIDS[meshless[-1]].keeps_volume:
        found.append((SIMILAR, _similar(_with(scene, meshless[-1]))))
    if meshless and FLUIDS[meshless[-1]].has_flow:
        found.append((SMALL, _slow(_with(scene, meshless[-1]), 0.5, _SMALL * _radius(scene))))
    if ASSUMED in models:
        amplitude = _TILT * _gravity(scene) / _angular(scene, 0.25) ** 2
        found.append((LEVEL, _slow(_with(scene, ASSUMED), 0.25, amplitude)))
    return [Entry(row=CHECKS, resolution=name, scene=one) for name, one in found]


def check_rows(
    done: Sequence[tuple[Entry, Mapping[str, Any]]], as_run: Mapping[str, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return what the checks of ``done`` found beside theory, CG amplitudes over the sway's.

    ``as_run``: summaries of the study's completed rows, by model. ``error`` is that of the complex
    amplitude, so that it holds the phase.
    """
    rows = []
    for entry, summary in done:
        if entry.row != CHECKS or summary.get("status") != "completed":
            continue
        scene, found = entry.scene, _transfer(summary)
        if entry.resolution == SIMILAR:
            whole = as_run.get(scene.model.fluid)
            exact = None if whole is None else _transfer(whole)
        elif entry.resolution == SMALL:
            exact = small_sway(scene)
        else:
            exact = level_sway(scene)
        if found is None or exact is None:
            continue
        rows.append({
            "check": entry.resolution, "model": scene.model.fluid,
            "frequency_ratio": numbers_of(scene).frequency_ratio,
            "computed": abs(found), "phase_deg": float(np.degrees(np.angle(found / exact))),
            "theory": abs(exact), "error": abs(found - exact) / abs(exact),
        })  # fmt: skip
    return rows


def small_sway(scene: Scene) -> complex:
    """Return the CG's amplitude over a small level sway's, below a limp sheet, without viscosity.

    Every lateral mode is a mass on a spring, m_k/m (f/f_k)^2/(1 - (f/f_k)^2), the spring's rate
    m_k (2 pi f_k)^2 that without the sheet, whose mass lowers f_k (``covered_eigenvalue``). What
    the sheet stiffens, and that it is clamped, is left out.
    """
    numbers, sheet = numbers_of(scene), scene.diaphragm.sheet
    cover = sheet.area_density / (scene.liquid.density * _radius(scene))
    square = _angular(scene) ** 2 * _radius(scene) / _gravity(scene)
    found = 0.0
    for mode, share in enumerate(mode_shares(numbers.level, _MODES), 1):
        value = lateral_eigenvalue(numbers.level, mode)
        found += share * square / value / (1.0 - square / covered_eigenvalue(value, cover))
    return complex(found)


def level_sway(scene: Scene) -> complex:
    """Return the CG's amplitude over the sway's, of a surface that stays level.

    Tilted by a/g it moves the CG by (pi r^4/4)/V a/g, r the surface's radius: 3 R/8 a/g half full.
    """
    level = numbers_of(scene).level
    moment = np.pi * (level * (2.0 - level)) ** 2 / 4.0 * _radius(scene) ** 4
    return complex(moment / scene.liquid_volume * _angular(scene) ** 2 / _gravity(scene))


def _has_theory(scene: Scene) -> bool:
    motion, gravity = scene.motion, np.array(scene.gravity)
    return (
        motion.kind == "sine"
        and bool(motion.amplitude)
        and not motion.angle
        and scene.tank.shape == "sphere"
        and scene.tank.clamp_height == 0.0
        and scene.diaphragm.mould_profile is None
        and not scene.carrier.free
        and scene.diaphragm.thickness_range[0] == scene.diaphragm.thickness_range[1]
        and gravity[2] < 0.0 == gravity[0] == gravity[1]
        and abs(float(gravity @ np.array(motion.direction))) < 1e-9 * _gravity(scene)
    )


def _similar(scene: Scene) -> Scene:
    """The scene at a quarter of all lengths: times go with the root, E with the length."""
    values = plain_values(scene)
    for section, key, power in (
        ("tank", "radius", 1.0), ("diaphragm", "thickness", 1.0),
        ("diaphragm", "youngs_modulus", 1.0), ("liquid", "viscosity", 1.5),
        ("motion", "amplitude", 1.0), ("motion", "frequency", -0.5),
        ("time", "duration", 0.5), ("time", "step", 0.5),
    ):  # fmt: skip
        values[section][key] *= _QUARTER**power
    values["diaphragm"].pop("material", None)
    values["liquid"].pop("name", None)
    return scene_from(values)


def _slow(scene: Scene, ratio: float, amplitude: float) -> Scene:
    """The scene swaying at ``ratio`` of f1 by ``amplitude`` [m]: four soft periods, and four.

    Its folds are damped no more than ``_GENTLE``.
    """
    values = plain_values(scene)
    frequency = ratio * numbers_of(scene).slosh_frequency
    values["motion"] |= {"frequency": frequency, "amplitude": amplitude, "ramp": 4.0}
    values["time"] |= {"duration": 8.0 / frequency, "step": 1.0 / (60.0 * frequency)}
    values["time"].pop("step_tolerance", None)
    values["cloth"]["fold_damping"] = min(scene.cloth.fold_damping, _GENTLE)
    return scene_from(values)


def _with(scene: Scene, model: str) -> Scene:
    return scene.model_copy(update={"model": scene.model.model_copy(update={"fluid": model})})


def _transfer(summary: Mapping[str, Any]) -> complex | None:
    """CG over the tank's displacement, of the component that moves most; None where not known."""
    found = summary["cg"].get("transfer")
    if not found:
        return None
    return max(map(complex, found["real"], found["imag"]), key=abs)


def _radius(scene: Scene) -> float:
    return scene.tank.shell.size


def _gravity(scene: Scene) -> float:
    return float(np.linalg.norm(scene.gravity))


def _angular(scene: Scene, ratio: float | None = None) -> float:
    """2 pi f [1/s] of the scene, or of ``ratio`` of its first slosh frequency."""
    numbers = numbers_of(scene)
    return 2.0 * np.pi * (numbers.frequency if ratio is None else ratio * numbers.slosh_frequency)
