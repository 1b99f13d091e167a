"""Which runs a design curve may take: radii, thicknesses between two ends, one criterion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from coupling.campaign.bracket import scan
from coupling.campaign.sweep_plan import Axis, Plan, Point, SweepError, Value, parse_axis, point_at
from coupling.fluids import FLUIDS
from coupling.metrics.criteria import CRITERIA, Criterion
from coupling.scene.checks import THICKNESS_OVER_RADIUS
from coupling.scene.scene import Scene, SceneError, load_scene

RADIUS, THICKNESS = "tank.radius", "diaphragm.thickness"
_THINNER, _THICKER = 4.0, 2.0  # the ends by the scene's own thickness, where none are given
_BELOW = 0.99  # of the largest thickness that a scene takes
KEPT = (
    "The same for all radii: the motion as the scene gives it (an amplitude in metres stays, so "
    "f^2 R/g changes with the radius), gravity, fill fraction, liquid, rubber, grid and steps. "
    "cloth.fold_damping goes with the bending stiffness."
)


@dataclass(frozen=True, kw_only=True)
class DesignPlan:
    """A scene over ``radii`` [m], with the least thickness to be found that keeps a criterion.

    ``model``: fluid model of all runs; ``criterion``: its name, kept below ``limit``; ``ends`` [m]:
    the thicknesses between which it is looked for, one pair a radius.
    """

    scene_path: Path
    changes: tuple[str, ...]
    model: str
    criterion: str
    limit: float
    radii: tuple[float, ...]
    ends: tuple[tuple[float, float], ...]

    @property
    def measure(self) -> Criterion:
        """The criterion itself."""
        return CRITERIA[self.criterion]

    def point(self, radius: float, thickness: float) -> Point:
        """Name and scene of the run of a ``radius`` and a ``thickness`` [m]."""
        values: dict[str, Value] = {RADIUS: radius, THICKNESS: thickness}
        return point_at(self.scene_path, self.changes, values, (self.model,))

    @cached_property
    def scan(self) -> Plan:
        """The runs that are certain: of every radius the thicknesses that are tried first."""
        axes = (Axis(key=RADIUS, values=self.radii),)
        points = [
            self.point(radius, thickness)
            for radius, ends in zip(self.radii, self.ends, strict=True)
            for thickness in scan(*ends)
        ]
        return Plan(axes=axes, models=(self.model,), points=tuple(points))


def plan_design(
    scene_path: Path,
    changes: Sequence[str],
    radius: str,
    criterion: str,
    limit: float,
    thickness: str | None = None,
) -> DesignPlan:
    """Return the plan of a design curve, the scenes of its certain runs read and checked.

    Parameters
    ----------
    scene_path
        Folder or file of the scene.
    changes
        ``key=value`` for all runs.
    radius
        ``start:stop:count``, ``start:stop:count:log`` or ``a,b,c`` [m].
    criterion
        A name of ``CRITERIA``.
    limit
        What its figure is to stay below.
    thickness
        ``least:largest`` [m]; from a quarter of the scene's own to twice that if None, but below
        what the radius allows.

    Raises
    ------
    SweepError
        The criterion, its limit, the radii or the thicknesses are wrong, or the fluid model is not
        one but a choice.
    SceneError
        A scene is invalid, or lacks what the criterion needs.
    """
    scene = load_scene(scene_path, changes)
    _check(scene, criterion, limit)
    radii = _radii(radius)
    plan = DesignPlan(
        scene_path=scene_path,
        changes=tuple(changes),
        model=scene.model.fluid,
        criterion=criterion,
        limit=limit,
        radii=radii,
        ends=tuple(_ends(thickness, one, scene.diaphragm.thickness) for one in radii),
    )
    _ = plan.scan  # reads and checks the scenes
    return plan


def _check(scene: Scene, criterion: str, limit: float) -> None:
    if criterion not in CRITERIA:
        raise SweepError(f"--criterion: must be one of {', '.join(CRITERIA)}, got '{criterion}'.")
    if not (math.isfinite(limit) and limit > 0.0):
        raise SweepError(
            f"--limit: must be positive, got {limit:g}. Give what is borne of the "
            f"{CRITERIA[criterion].figure}."
        )
    if scene.model.fluid not in FLUIDS:
        raise SweepError(
            f"model.fluid: all runs take one model, got '{scene.model.fluid}'. "
            f"Give one, such as --set model.fluid={FLUIDS.names[-2]}."
        )
    needed = CRITERIA[criterion].needs
    if needed is not None and getattr(scene.diaphragm, needed.rpartition(".")[2]) is None:
        raise SceneError([f"{needed}: the criterion '{criterion}' needs it. Give it in the scene."])


def _radii(text: str) -> tuple[float, ...]:
    try:
        values = parse_axis(f"{RADIUS}={text}").values
        radii = [float(str(one)) for one in values]  # a text is .2, which TOML does not know
    except ValueError as error:
        raise SweepError(
            f"--radius: must be start:stop:count, start:stop:count:log or a,b,c in m, got '{text}'."
        ) from error
    if len(set(radii)) < len(radii):
        raise SweepError(f"--radius: gives a radius twice, got '{text}'.")
    return tuple(radii)


def _ends(text: str | None, radius: float, own: float) -> tuple[float, float]:
    """Least and largest thickness [m] at a ``radius`` [m]; ``own``: the scene's."""
    if text is None:
        most = _BELOW * THICKNESS_OVER_RADIUS * radius
        least, largest = own / _THINNER, min(_THICKER * own, most)
    else:
        try:
            least, largest = (float(part) for part in text.split(":"))
        except ValueError:
            raise SweepError(f"--thickness: must be least:largest [m], got '{text}'.") from None
    if not 0.0 < least < largest < math.inf:
        raise SweepError(
            f"--thickness: at the radius {radius:g} m it would be looked for from {least:g} to "
            f"{largest:g} m. Give least:largest, the lesser first, such as 0.0005:0.004."
        )
    return least, largest
