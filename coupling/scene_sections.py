"""What is simulated: the sections of a scene that describe it, each key and its values.

Every description completes the sentence "Give the ...": it ends the message about a wrong value.
Immutable; SI throughout; a key that is not named here is refused.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from cloth.material import ELASTOMERS
from cloth.material import Diaphragm as Sheet
from coupling.liquids import LIQUIDS
from coupling.ports import Array
from coupling.table_file import TableError
from coupling.thickness_map import ThicknessMap, read_thickness_map

LADDER = ("datum", "hydrostatic", "potential", "openfoam")  # fluid models, the simplest first

_MATERIAL: dict[str, Any] = {"instead": 'a known material such as material = "AF-E-332"'}
_MAP: dict[str, Any] = {"instead": "a thickness_map"}
_LIQUID: dict[str, Any] = {"instead": 'a known liquid such as name = "water"'}


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Vector = Annotated[tuple[float, float, float], BeforeValidator(_as_tuple)]


class Section(BaseModel):
    """Shared settings: frozen, typed strictly (an integer is a number), finite, no other keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Tank(Section):
    """The rigid spherical shell, centred on the origin of the tank frame."""

    radius: float = Field(gt=0, description="tank's inner radius [m]")

    @property
    def volume(self) -> float:
        """Of the whole sphere [m^3]."""
        return 4.0 / 3.0 * float(np.pi) * self.radius**3


def named_material(name: str) -> dict[str, float]:
    """Density, modulus, Poisson's ratio and strength of a built-in elastomer, where known.

    Raises ``PydanticCustomError`` for a name that is not built in.
    """
    found = {known.lower(): data for known, data in ELASTOMERS.items()}.get(name.lower())
    if found is None:
        raise PydanticCustomError(
            "unknown_name",
            "is not a built-in elastomer. Use one of {names}, or give density, youngs_modulus "
            "and poisson_ratio",
            {"key": "material", "names": ", ".join(ELASTOMERS)},
        )
    values = {
        "density": found.density,
        "youngs_modulus": found.youngs_modulus,
        "poisson_ratio": found.poisson_ratio,
        "strength": found.strength,
    }
    return {key: value for key, value in values.items() if value is not None}


def _mean_of_map(given: dict[str, Any]) -> float:
    """Mean thickness [m] of the map that a diaphragm is given.

    Raises ``PydanticCustomError`` for a wrong map, and for a thickness beside it.
    """
    problems = []
    if "thickness" in given:
        problems.append(
            f"diaphragm.thickness: is the mean of thickness_map, got {given['thickness']} beside "
            "it. Leave one of the two out."
        )
    try:
        mean = read_thickness_map(Path(given["thickness_map"])).mean
    except TableError as error:
        problems.append(f"diaphragm.thickness_map: {error}")
    else:
        if not problems:
            return mean
    raise PydanticCustomError("cross_check", "{problems}", {"problems": "\n".join(problems)})


class Diaphragm(Section):
    """The rubber, moulded as a hemisphere and clamped at the equator.

    Either ``material`` or the numbers; a number given beside a material overrides it. Nothing
    breaks at ``strength``: it is there to be compared with the tension. With a ``thickness_map``,
    ``thickness`` is left out and stands for the map's mean over the moulded area.
    """

    thickness: float = Field(
        gt=0,
        description="thickness of the rubber [m], below 0.05 radii",
        json_schema_extra=_MAP,
    )
    thickness_map: str | None = Field(
        default=None,
        description="CSV file with columns polar, azimuth, thickness (degrees, degrees, m)",
    )
    material: str | None = Field(default=None, description="name of a built-in elastomer")
    density: float = Field(
        gt=0, description="density of the rubber [kg/m^3]", json_schema_extra=_MATERIAL
    )
    youngs_modulus: float = Field(
        gt=0, description="Young's modulus of the rubber [Pa]", json_schema_extra=_MATERIAL
    )
    poisson_ratio: float = Field(
        ge=0, le=0.5, description="Poisson ratio, 0.5 for rubber", json_schema_extra=_MATERIAL
    )
    strength: float | None = Field(
        default=None, gt=0, description="tensile strength of the rubber [Pa]"
    )
    inextensible: bool = Field(
        default=True, description="value false for the rubber's own compliance 1/(E t)"
    )
    held: bool = Field(
        default=False, description="value true to hold the settled shape (rigid-body limit)"
    )

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        if isinstance(given.get("thickness_map"), str):
            given = given | {"thickness": _mean_of_map(given)}
        if isinstance(given.get("material"), str):
            given = named_material(given["material"]) | given
        return given

    @property
    def moulded_thickness(self) -> ThicknessMap | None:
        """The map, None where the rubber is of one thickness.

        ``TableError`` if the file has changed since the scene was read and is now wrong.
        """
        return None if self.thickness_map is None else read_thickness_map(Path(self.thickness_map))

    @property
    def thickness_range(self) -> tuple[float, float]:
        """Least and largest thickness [m]."""
        ridges = self.moulded_thickness
        if ridges is None:
            return self.thickness, self.thickness
        return float(ridges.thickness.min()), float(ridges.thickness.max())

    @property
    def sheet(self) -> Sheet:
        """The rubber as the cloth knows it, with what follows from these numbers."""
        return Sheet(
            thickness=self.thickness,
            density=self.density,
            youngs_modulus=self.youngs_modulus,
            poisson_ratio=self.poisson_ratio,
        )


class Liquid(Section):
    """The liquid below the diaphragm: by ``name``, by numbers, or a name with numbers changed."""

    name: str | None = Field(default=None, description="name of a built-in liquid")
    density: float = Field(
        gt=0, description="density of the liquid [kg/m^3]", json_schema_extra=_LIQUID
    )
    viscosity: float = Field(
        gt=0, description="kinematic viscosity of the liquid [m^2/s]", json_schema_extra=_LIQUID
    )
    surface_tension: float | None = Field(
        default=None, gt=0, description="surface tension [N/m]; only Bond and Weber numbers use it"
    )
    fill_fraction: float = Field(gt=0, lt=1, description="liquid volume over the tank volume")

    @model_validator(mode="before")
    @classmethod
    def _fill_from_name(cls, given: Any) -> Any:
        if not isinstance(given, dict) or not isinstance(given.get("name"), str):
            return given
        data = LIQUIDS.get(given["name"].lower())
        if data is None:
            raise PydanticCustomError(
                "unknown_name",
                "is not a built-in liquid. Use one of {names}, or give density and viscosity",
                {"key": "name", "names": ", ".join(LIQUIDS)},
            )
        known = {
            "density": data.density,
            "viscosity": data.viscosity,
            "surface_tension": data.surface_tension,
        }
        return known | given


class Motion(Section):
    """How the tank's centre moves from time 0 on, when the diaphragm has settled.

    ``sine``: amplitude * s(t) * sin(2 pi frequency t) along ``direction``, with s a smooth ramp
    over ``ramp`` periods. Its ``acceleration`` A (2 pi frequency)^2 can be given in place of the
    amplitude A, which then stands for it. ``table``: accelerations from a CSV file. ``rest``: none.
    """

    kind: Literal["sine", "table", "rest"] = Field(
        default="rest", description='kind of motion: "sine", "table" or "rest"'
    )
    frequency: float | None = Field(default=None, gt=0, description="frequency [Hz]")
    amplitude: float | None = Field(
        default=None,
        ge=0,
        description="displacement, centre to peak [m]",
        json_schema_extra={"instead": "the peak acceleration [m/s^2]"},
    )
    acceleration: float | None = Field(
        default=None, ge=0, description="peak acceleration of the sine [m/s^2]"
    )
    direction: Vector = Field(default=(1.0, 0.0, 0.0), description="direction of the shaking")
    ramp: float = Field(default=1.0, ge=0, description="smooth start in periods, 0 for none")
    file: str | None = Field(
        default=None, description="CSV file with columns time, ax, ay, az (s, m/s^2)"
    )

    @model_validator(mode="before")
    @classmethod
    def _amplitude_of_acceleration(cls, given: Any) -> Any:
        if not isinstance(given, dict) or given.get("acceleration") is None:
            return given
        acceleration, frequency = given["acceleration"], given.get("frequency")
        problem = ""
        if given.get("amplitude") is not None:
            problem = f"got {acceleration} beside an amplitude. Leave one of the two out."
        elif given.get("kind") != "sine":
            problem = f'got {acceleration} without a sine. Take kind = "sine", or leave it out.'
        if problem:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": f"motion.acceleration: {problem}"}
            )
        if not (isinstance(acceleration, int | float) and isinstance(frequency, int | float)):
            return given  # what is wrong with either is said of it
        rest = {key: value for key, value in given.items() if key != "acceleration"}
        omega = 2.0 * np.pi * frequency
        return rest | {"amplitude": float(acceleration / omega**2) if omega else 0.0}

    @property
    def unit_direction(self) -> Array:
        """``direction`` scaled to length 1, (3,)."""
        vector: Array = np.array(self.direction)
        unit: Array = vector / np.linalg.norm(vector)
        return unit


class Model(Section):
    """Which liquid the diaphragm feels."""

    fluid: Literal["datum", "hydrostatic", "potential", "openfoam", "auto"] = Field(
        default="openfoam",
        description='fluid model: "datum", "hydrostatic", "potential", "openfoam", or "auto" for '
        "the cheapest that keeps the tolerance",
    )
    tolerance: float = Field(
        default=0.05,
        gt=0,
        lt=1,
        description='relative error of the CG\'s motion that "auto" allows',
    )
