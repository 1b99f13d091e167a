"""NASTRAN bulk data of a mechanical model: CONM2, CELAS2, CDAMP2 and what ties them to the tank.

Spring and mass lie at the hinge's height: in a linear analysis without gravity's stiffness that
moves as the pendulum does, also where the tank turns (X'' = -w^2 (X - X_hinge)). The same masses
move along both lateral axes, as in a tank that is round about the vertical.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.mechanical.exports.axes import axes_of
from coupling.store.atomic import write_text

FILE = "nastran.bdf"
TANK = 1  # grid at the tank's centre, to be joined to the structure
FIXED = 2  # grid of the fixed mass
FIRST = 10  # of mode k: ten times k + 1 its hinge, one more its mass


def write_nastran(place: Path, content: Mapping[str, Any], row: Mapping[str, Any]) -> None:
    """Write ``nastran.bdf``, in SI: an include file without executive and case control."""
    along, _, upwards = axes_of(content)
    said = (
        f"fill fraction {row['fill_fraction']:g}, amplitude {row['amplitude_m']:g} m",
        f"liquid {row['liquid_mass_kg']:.6g} kg; SI units; grid {TANK} is the tank's centre",
        "coordinate system 1: x along the motion identified, z against gravity",
        "masses at the height of their pendulums' hinges; leave gravity's stiffness out",
    )
    lines = [f"$ {text}" for text in said]
    lines += _card("CORD2R", 1, 0, 0.0, 0.0, 0.0, *upwards, *along)
    lines += _grid(TANK, 0.0) + _grid(FIXED, row["fixed_height_m"])
    lines += _card("CONM2", 1, FIXED, 1, row["fixed_mass_kg"])
    hinges, masses = [], []
    for index, mode in enumerate(row["modes"]):
        hinge = FIRST * (index + 1)
        mass = hinge + 1
        hinges.append(hinge)
        masses.append(mass)
        lines += _grid(hinge, mode["hinge_height_m"]) + _grid(mass, mode["hinge_height_m"])
        lines += _card("CONM2", mass, mass, 1, mode["mass_kg"])
        for axis in (1, 2):
            element = 100 * (index + 1) + 10 * axis
            joined = (hinge, axis, mass, axis)
            lines += _card("CELAS2", element, mode["spring_rate_n_m"], *joined)
            lines += _card("CDAMP2", element + 1, mode["damper_n_s_m"], *joined)
    lines += _card("RBE2", 1, TANK, 123456, FIXED, *hinges)
    lines += _card("RBE2", 2, TANK, 3456, *masses)
    write_text(place / FILE, "\n".join(lines) + "\n")


def _grid(number: int, height: float) -> list[str]:
    return _card("GRID", number, 1, 0.0, 0.0, height, 1)


def _card(name: str, *values: float) -> list[str]:
    """Lines of a card in the large field format: four fields of 16 characters a line."""
    fields = [_field(value) for value in values]
    rows: Sequence[list[str]] = [fields[start : start + 4] for start in range(0, len(fields), 4)]
    lines = []
    for place, row in enumerate(rows):
        head = f"{name}*" if place == 0 else "*"
        lines.append(f"{head:<8}" + "".join(f"{field:>16}" for field in row))
    if len(lines) % 2:
        lines.append("*")
    return lines


def _field(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.9E}"
