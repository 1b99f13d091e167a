"""Parameters of Basilisk's slosh particles, by the names of its modules' attributes.

Basilisk's ``LinearSpringMassDamper`` is a mass at r_PB_B + rho pHat_B with the spring rate k and
the damper c; its ``FuelTank`` with ``FuelTankModelConstantVolume`` bears the mass that does not
slosh. The particle's weight acts where the particle is, so it lies a pendulum's length below the
hinge: force and moment are then the pendulum's under the acceleration that was identified at.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coupling.mechanical.exports.axes import axes_of
from coupling.store.atomic import write_json

FILE = "basilisk.json"


def write_basilisk(place: Path, content: Mapping[str, Any], row: Mapping[str, Any]) -> None:
    """Write ``basilisk.json``; the tank's centre is the origin of its positions (SI)."""
    along, _, upwards = axes_of(content)
    write_json(
        place / FILE,
        {
            "acceleration_m_s2": content["gravity_m_s2"],
            "FuelTankModelConstantVolume": {
                "propMassInit": row["fixed_mass_kg"],
                "radiusTankInit": content["radius_m"],
                "r_TcT_TInit": _column(row["fixed_height_m"] * upwards),
            },
            "LinearSpringMassDamper": [
                {
                    "massInit": mode["mass_kg"],
                    "k": mode["spring_rate_n_m"],
                    "c": mode["damper_n_s_m"],
                    "r_PB_B": _column(mode["mass_height_m"] * upwards),
                    "pHat_B": _column(along),
                    "rhoInit": 0.0,
                    "rhoDotInit": 0.0,
                }
                for mode in row["modes"]
            ],
        },
    )


def _column(vector: Any) -> list[list[float]]:
    return [[float(part)] for part in vector]
