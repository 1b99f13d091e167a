"""How liquid is drawn from the tank: a section of a scene, and what the others must be for it.

Descriptions complete the sentence "Give the ...", as in ``sections``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import Field

from coupling.scene.choices import models_drawing, takes_supply
from coupling.scene.sections import Section
from coupling.scene.wrinkles import grid_spacing

if TYPE_CHECKING:
    from coupling.scene.scene import Scene

FILMS = 2.0  # least end of a drawing, in films that the grid leaves on the shell


class Supply(Section):
    """Liquid drawn from the tank, slowly: for a liquid without a flow, in a tank at rest.

    From time 0 on the volume falls evenly from ``liquid.fill_fraction`` to ``end_fill_fraction``,
    which is reached after ``duration``; then it stays. ``time.duration`` may be left out and is
    that one then. Without these keys nothing is drawn.
    """

    end_fill_fraction: float | None = Field(
        default=None, gt=0, lt=1, description="liquid volume over the tank volume at the end"
    )
    duration: float | None = Field(
        default=None, gt=0, description="time in which the volume falls to its end [s]"
    )

    @property
    def drawn(self) -> bool:
        """Whether any liquid is drawn."""
        return self.end_fill_fraction is not None


def with_duration(given: Mapping[str, Any]) -> dict[str, Any]:
    """The plain values of a scene, with the supply's duration where [time] has none."""
    supply, time = given.get("supply"), given.get("time", {})
    if not isinstance(supply, dict) or not isinstance(time, dict):
        return dict(given)
    if "duration" not in supply or {"duration", "periods"} & time.keys():
        return dict(given)
    return {**given, "time": {"duration": supply["duration"], **time}}


def film_fraction(scene: Scene) -> float:
    """What a diaphragm that lies on the shell leaves between its chords and it, over the tank.

    (h/(2 R))^2 with the grid's spacing h: a triangle of sides a, b, c with its corners on a sphere
    is (a^2 + b^2 + c^2)/(24 R) off it in the mean, an equilateral one of height h so h^2/(6 R), and
    half a sphere is covered. Within 5 % on 6 to 24 rings.
    """
    spacing = grid_spacing(scene.mould.length, scene.cloth)
    return (0.5 * spacing / scene.tank.shell.size) ** 2


def drawing(scene: Scene) -> str:
    """How fast liquid is drawn, in words; empty where none is."""
    end, duration = scene.supply.end_fill_fraction, scene.supply.duration
    if end is None or duration is None:
        return ""
    share = scene.liquid.fill_fraction - end
    gravity = math.hypot(*scene.gravity)
    damped = scene.cloth.fold_damping * math.sqrt(scene.tank.shell.size / gravity)
    text = (
        f"Liquid is drawn at {share * scene.tank.volume / duration:.3g} m^3/s, in a step "
        f"{share * scene.time.step / duration:.2g} of the tank"
    )
    if damped == 0.0:
        return f"{text}."
    return f"{text}, over {duration / damped:.3g} times as long as cloth.fold_damping acts."


def supply_problems(scene: Scene) -> list[str]:
    """One line ``key: what is wrong. Mend.`` for each problem of drawing liquid in this scene."""
    supply = scene.supply
    for key, other in (("end_fill_fraction", "duration"), ("duration", "end_fill_fraction")):
        if getattr(supply, key) is None and getattr(supply, other) is not None:
            said = Supply.model_fields[key].description
            return [f"supply.{key}: is required beside {other}. Give the {said}."]
    if not supply.drawn:
        return []
    return [*_of_others(scene), *_of_volume(scene)]


def _of_others(scene: Scene) -> list[str]:
    """What fluid model, motion and diaphragm must be."""
    problems = []
    if not takes_supply(scene.model.fluid):
        names = " or ".join(f'"{name}"' for name in models_drawing())
        problems.append(
            f"supply: liquid can be drawn with model.fluid = {names} alone, got "
            f'"{scene.model.fluid}": a flow has no outlet here. Set model.fluid = {names}, or '
            "leave the section out."
        )
    if scene.motion.kind != "rest":
        problems.append(
            "supply: liquid is drawn from a tank at rest alone, got motion.kind = "
            f'"{scene.motion.kind}". Set motion.kind = "rest", or leave the section out.'
        )
    if scene.diaphragm.held:
        problems.append(
            "supply: a diaphragm that is held cannot follow the liquid, got diaphragm.held = true. "
            "Leave one of the two out."
        )
    return problems


def _of_volume(scene: Scene) -> list[str]:
    """Whether the end is below the start, and what the grid can come to."""
    start, end = scene.liquid.fill_fraction, scene.supply.end_fill_fraction
    assert end is not None
    if end >= start:
        return [
            f"supply.end_fill_fraction: must be below liquid.fill_fraction ({start:g}), got "
            f"{end:g}. Give a smaller one; a tank is not filled here."
        ]
    least = FILMS * film_fraction(scene)
    if end >= least:
        return []
    now = scene.cloth.resolution
    rings = math.ceil(now * math.sqrt(least / end))
    return [
        f"supply.end_fill_fraction: must be at least {least:.2g} on {now} rings, got {end:g}: half "
        "of that is left between the shell and the grid's chords. Give more, or cloth.resolution "
        f"= {rings}."
    ]
