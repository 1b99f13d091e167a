"""Liquid drawn from the tank: what the diaphragm takes of the gas's pressure, and what stays.

The outlet is the shell's lower pole. Pressures are above the gas's, as everywhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.interface.sheet_distance import distance_to_sheet
from coupling.ports import Array, DiaphragmState, HydrostaticLoad, Ints
from coupling.scene.scene import Scene
from coupling.scene.wrinkles import grid_spacing
from coupling.store.step_series import StepSeries

ON_SHELL = 1e-3  # of the shell's size: a node within that of the shell lies on it
CHORD = 0.75  # mean distance of a triangle from a sphere through its corners, over its centroid's


class Expulsion:
    """Figures at every step of a tank from which liquid is drawn; none of any other.

    ``triangles`` (m, 3): of the diaphragm.
    """

    def __init__(self, scene: Scene, triangles: Ints) -> None:
        self._drawn, self._triangles = scene.supply.drawn, triangles
        self._shell = scene.tank.shell
        self._outlet = np.array([0.0, 0.0, self._shell.poles[0]])

    def metrics(self, state: DiaphragmState, load: HydrostaticLoad) -> dict[str, float]:
        """Return the figures of a ``state`` under the ``load`` that led to it, by name.

        ``pressure_drop`` [Pa]: the gas's pressure over the liquid's, beyond the head of a level
        liquid without a diaphragm, rho b h - p0 with its level h; so it is what the diaphragm takes
        of the gas's pressure, below 0 where it presses on the liquid itself.
        ``pressure_drop_chords`` [Pa]: what of it corrects h for the chords by which the grid cuts
        the shell off. ``outlet_pressure`` [Pa] of the liquid. ``outlet_gap`` [m]: the diaphragm's
        distance from the outlet.
        """
        if not self._drawn:
            return {}
        size = float(np.linalg.norm(load.body_force))
        up, weight = -load.body_force / size, load.density * size
        cut = self._cut_off(state.position)
        whole = self._shell.volume
        as_given, level = (
            self._shell.level_of(float(np.clip(volume, 1e-6 * whole, (1.0 - 1e-6) * whole)), up)
            for volume in (state.volume, state.volume + cut)
        )
        at_outlet = load.density * float(load.body_force @ self._outlet)
        gap = distance_to_sheet(self._outlet[None], state.position, self._triangles)
        return {
            "pressure_drop": weight * level - state.datum_pressure,
            "pressure_drop_chords": weight * (level - as_given),
            "outlet_pressure": state.datum_pressure + at_outlet,
            "outlet_gap": float(gap[0]),
        }

    def _cut_off(self, position: Array) -> float:
        """Volume [m^3] between the shell and what lies on it, below 0 below the rim.

        There it is liquid; above the rim it is gas, and the liquid stands higher for it.
        """
        corners = position[self._triangles]
        on = (self._shell.gap(position) <= ON_SHELL * self._shell.size)[self._triangles].all(axis=1)
        centre = corners[on].mean(axis=1)
        a, b, c = (corners[on, corner] for corner in range(3))
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return float(np.sum(CHORD * self._shell.gap(centre) * area * np.sign(centre[:, 2])))


def covering_gap(scene: Scene) -> float:
    """Distance [m] from the outlet below which the diaphragm covers it, h^2/(2 R).

    By so much the middle of a triangle with a circumscribed circle of the grid's spacing h is off
    the shell, of radius R, on which its corners lie.
    """
    spacing = grid_spacing(scene.mould.length, scene.cloth)
    return 0.5 * spacing**2 / scene.tank.shell.size


def expulsion_summary(steps: StepSeries, scene: Scene) -> dict[str, Any] | None:
    """Return what ``summary.json`` says of the drawing; None where nothing is drawn.

    Parameters
    ----------
    steps
        The run at every step.
    scene
        Its scene.

    Returns
    -------
    dict
        ``drawn_m3``, ``fill_fraction_end`` as reached. ``pressure_drop_..._Pa``: the largest and
        ``..._at_fill``, the mean over the drawn volume; of these the rms of what the grid's chords
        correct (``chords``) and the mean that the damping of bending and drag takes (``damping``),
        which falls with the rate but for what snapping folds lose. ``work_J``: the drop's, that of
        the gas on the diaphragm. ``residual_volume_m3``: liquid left when the diaphragm comes to
        cover the outlet for good, at ``outlet_covered_at_fill``; null where it does not.
        ``folded_area_max_at_fill``, ``folds_max_at_fill`` (null where the grid does not resolve
        them). ``inertia_ratio``: u^2/(g R) with the mean speed u of the surface, which the liquid's
        inertia is over its weight; ``sheet_kinetic_energy_max_J``.
    """
    if not scene.supply.drawn or "pressure_drop" not in steps.metrics or len(steps.time) < 2:
        return None
    fill, metrics = steps.volume / scene.tank.volume, steps.metrics
    drawn = float(steps.volume[0] - steps.volume[-1])
    drop, work = metrics["pressure_drop"], work_of(steps)[-1]
    damped = sum(
        float(metrics[f"dissipated_by_{name}"][-1] - metrics[f"dissipated_by_{name}"][0])
        for name in ("bending", "drag")
    )
    most, covered = int(np.argmax(drop)), _covered_from(metrics["outlet_gap"], scene)
    folds = metrics.get("fold_number")
    return {
        "drawn_m3": drawn,
        "fill_fraction_end": float(fill[-1]),
        "pressure_drop_max_Pa": float(drop[most]),
        "pressure_drop_max_at_fill": float(fill[most]),
        "pressure_drop_mean_Pa": work / drawn,
        "pressure_drop_chords_Pa": float(np.sqrt(np.mean(metrics["pressure_drop_chords"] ** 2))),
        "pressure_drop_damping_Pa": damped / drawn,
        "outlet_pressure_end_Pa": float(metrics["outlet_pressure"][-1]),
        "outlet_covered_at_fill": None if covered is None else float(fill[covered]),
        "residual_volume_m3": None if covered is None else float(steps.volume[covered]),
        "work_J": float(work),
        "folded_area_max_at_fill": float(fill[int(np.argmax(metrics["folded_area"]))]),
        "folds_max_at_fill": None if folds is None else float(fill[int(np.argmax(folds))]),
        "inertia_ratio": _inertia_ratio(scene),
        "sheet_kinetic_energy_max_J": float(metrics["sheet_kinetic_energy"].max()),
    }


def work_of(steps: StepSeries) -> Array:
    """Return the work of the pressure drop on the drawn volume since the start (S,) [J]."""
    drop = steps.metrics["pressure_drop"]
    parts = -0.5 * (drop[1:] + drop[:-1]) * np.diff(steps.volume)
    return np.append(0.0, np.cumsum(parts))


def _covered_from(gap: Array, scene: Scene) -> int | None:
    """The step from which on the diaphragm covers the outlet to the end; None where it does not."""
    open_ = np.flatnonzero(gap > covering_gap(scene))
    first = int(open_[-1]) + 1 if len(open_) else 0
    return first if first < len(gap) else None


def _inertia_ratio(scene: Scene) -> float:
    """u^2/(g R) with u = q/(pi R^2) of the drawn q [m^3/s]."""
    end, duration = scene.supply.end_fill_fraction, scene.supply.duration
    assert end is not None
    assert duration is not None
    size = scene.tank.shell.size
    speed = (scene.liquid_volume - end * scene.tank.volume) / duration / (np.pi * size**2)
    return float(speed**2 / (np.linalg.norm(scene.gravity) * size))
