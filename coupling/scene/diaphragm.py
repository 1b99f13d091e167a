"""The rubber of a scene: by the name of an elastomer or by numbers, of one thickness or by a map.

Descriptions complete the sentence "Give the ...", as in ``sections``.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from cloth.material import ELASTOMERS
from cloth.material import Diaphragm as Sheet
from coupling.scene.sections import LARGEST, Section
from coupling.scene.tables.text import TableError
from coupling.scene.thickness_map import ThicknessMap, read_thickness_map

__all__ = ["Diaphragm", "Sheet", "named_material"]

_MATERIAL: dict[str, Any] = {"instead": 'a known material such as material = "AF-E-332"'}
_MAP: dict[str, Any] = {"instead": "a thickness_map"}


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


_LEAST_WEAR = 1e-24  # m^2/N; rubber on a smooth wall has some 1e-16 to 1e-12


def _wear_range(value: Any) -> Any:
    """``value`` as a tuple. Raises ``PydanticCustomError`` for what is no range of coefficients."""
    listed = list(value) if isinstance(value, list | tuple) else []
    pair = len(listed) == 2 and all(_is_positive(one) for one in listed)
    if value is None or (pair and listed[0] <= listed[1]):
        return tuple(map(float, listed)) or None
    problem = (
        f"diaphragm.wear_coefficient: must be two numbers from {_LEAST_WEAR:g} to {LARGEST:g}, the "
        f"lesser first, got {str(value)[:60]}. "
        "Give the range of the depth worn off over the slip work per area [m^2/N], as measured "
        "for this rubber on this wall; rigs differ by factors."
    )
    raise PydanticCustomError("cross_check", "{problems}", {"problems": problem})


def _is_positive(value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and _LEAST_WEAR <= value <= LARGEST


class Diaphragm(Section):
    """The rubber, moulded as the shell above or below its rim, and held there.

    Either ``material`` or the numbers; a number given beside a material overrides it. Nothing
    breaks at ``strength``: it is there to be compared with the tension. With a ``thickness_map``,
    ``thickness`` is left out and stands for the map's mean over a hemisphere's area. With ridges it
    is that of the rubber between them. A hinged rim
    turns freely, as the thesis' simple support does; a clamped one holds the moulded slope.
    """

    MINUTE = ("wear_coefficient",)

    thickness: float = Field(
        gt=0,
        description="thickness of the rubber [m], below 0.05 radii",
        json_schema_extra=_MAP,
    )
    thickness_map: str | None = Field(
        default=None,
        description="CSV file with columns polar, azimuth, thickness (degrees, degrees, m, or as "
        "its header says)",
    )
    mould: Literal["upper", "lower"] = Field(
        default="upper",
        description='part of the shell to which the rubber is moulded: "upper" or "lower", above '
        "or below the rim",
    )
    mould_profile: str | None = Field(
        default=None,
        description="CSV file with columns r, z (m, or as its header says): a closed meridian from "
        "pole to pole, the rim at z = 0, to whose part the rubber is moulded, not to the shell's",
    )
    ridge_number: int | None = Field(default=None, ge=1, le=1000, description="number of ridges")
    ridge_width: float | None = Field(
        default=None, gt=0, description="width of a ridge from foot to foot [m]"
    )
    ridge_height: float | None = Field(
        default=None, gt=0, description="height of a ridge over the rubber between ridges [m]"
    )
    ridge_direction: Literal["circumferential", "radial"] = Field(
        default="circumferential",
        description='direction of the ridges: "circumferential" (circles) or "radial" (meridians)',
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
    rim: Literal["hinged", "clamped"] = Field(
        default="hinged",
        description='support at the rim: "hinged" or "clamped" (the moulded slope is held)',
    )
    loss_factor: float = Field(
        default=0.0,
        ge=0,
        le=2,
        description="loss factor of the rubber's stretch, tan delta at loss_frequency; needs "
        "inextensible = false",
    )
    loss_frequency: float | None = Field(
        default=None,
        gt=0,
        description="frequency [Hz] of loss_factor, a sine's own if left out",
    )
    friction_shell: float = Field(
        default=0.0, ge=0, le=5, description="Coulomb coefficient of friction on the shell"
    )
    friction_self: float = Field(
        default=0.0, ge=0, le=5, description="Coulomb coefficient of friction on itself"
    )
    wear_coefficient: Annotated[tuple[float, float] | None, BeforeValidator(_wear_range)] = Field(
        default=None,
        description="depth worn off over the slip work per area [m^2/N], the least and the "
        "largest that are thought possible",
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

    @cached_property
    def moulded_thickness(self) -> ThicknessMap | None:
        """The map, None where the rubber is of one thickness; read once."""
        return None if self.thickness_map is None else read_thickness_map(Path(self.thickness_map))

    @property
    def thickness_range(self) -> tuple[float, float]:
        """Least and largest thickness [m]."""
        by_map = self.moulded_thickness
        if by_map is None:
            return self.thickness, self.thickness + (self.ridge_height or 0.0)
        return float(by_map.thickness.min()), float(by_map.thickness.max())

    @property
    def sheet(self) -> Sheet:
        """The rubber as the cloth knows it, with what follows from these numbers."""
        return Sheet(
            thickness=self.thickness,
            density=self.density,
            youngs_modulus=self.youngs_modulus,
            poisson_ratio=self.poisson_ratio,
        )
