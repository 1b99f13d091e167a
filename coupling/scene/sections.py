"""What is simulated: the sections of a scene that describe it, each key and its values.

Every description completes the sentence "Give the ...": it ends the message about a wrong value.
Immutable; SI throughout; a key that is not named here is refused.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from coupling.ports import Array
from coupling.scene.choices import (
    AUTO,
    default_fluid_model,
    fluid_models,
    motion_kinds,
    motions_reading,
    one_of,
)
from coupling.scene.liquids import LIQUIDS
from coupling.scene.motion_file import read_motion_table
from coupling.scene.motion_table import MotionTable
from coupling.scene.spectrum_table import SpectrumTable, read_spectrum_table

_LIQUID: dict[str, Any] = {"instead": 'a known liquid such as name = "water"'}


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Vector = Annotated[tuple[float, float, float], BeforeValidator(_as_tuple)]
OptionalVector = Annotated[tuple[float, float, float] | None, BeforeValidator(_as_tuple)]


# In SI units no quantity of a tank lies outside; products and ratios of a few of them are finite.
LEAST, LARGEST = 1e-15, 1e15
THINNEST_FILL = 1e-6  # below it the level's own formula loses its digits


class Section(BaseModel):
    """Shared settings: frozen, typed strictly (an integer is a number), finite, no other keys.

    A number is 0 or has a size from LEAST to LARGEST; so has the largest part of a vector. Keys in
    ``MINUTE`` see to that themselves.
    """

    MINUTE: ClassVar[tuple[str, ...]] = ()

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    def __getstate__(self) -> dict[Any, Any]:
        """Without the tables that were read: another process reads them itself."""
        state = super().__getstate__()
        values = state["__dict__"]
        return state | {"__dict__": {key: values[key] for key in type(self).model_fields}}

    @field_validator("*", mode="after")
    @classmethod
    def _of_a_size(cls, value: Any, info: ValidationInfo) -> Any:
        if info.field_name in cls.MINUTE:
            return value
        parts = value if isinstance(value, tuple) else (value,)
        sizes = [abs(part) for part in parts if isinstance(part, float)]
        if sizes and max(sizes) != 0.0 and not LEAST <= max(sizes) <= LARGEST:
            raise PydanticCustomError("size", "must be 0 or have a size from 1e-15 to 1e+15")
        return value


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

    @field_validator("fill_fraction", mode="after")
    @classmethod
    def _leaves_room(cls, value: float) -> float:
        if not THINNEST_FILL <= value <= 1.0 - THINNEST_FILL:
            raise PydanticCustomError(
                "fill", "must leave more than 1e-6 of the tank to both liquid and gas"
            )
        return value

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
    """How the tank moves from time 0 on, when the diaphragm has settled.

    ``sine``: amplitude * s(t) * sin(2 pi frequency t) along ``direction``, with s a smooth ramp
    over ``ramp`` periods. Its ``acceleration`` A (2 pi frequency)^2 can be given in place of the
    amplitude A, which then stands for it. With an ``angle``, and with an amplitude or without one,
    the tank turns in the same time about ``axis`` through ``point``. ``table``: accelerations from
    a CSV file, those of ``point`` if it has angular rates or angles as well. ``psd``: a record of
    ``duration`` made from a CSV file of power spectral densities, a sum of harmonics whose phases
    are random by the ``seed``. ``rest``: none.
    """

    kind: Annotated[str, one_of(motion_kinds)] = Field(
        default="rest", description='kind of motion, such as "sine", "table", "psd" or "rest"'
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
    angle: float | None = Field(
        default=None,
        ge=0,
        lt=90,
        description="angle that a sine turns by, centre to peak [degrees]",
    )
    axis: Vector = Field(
        default=(0.0, 1.0, 0.0), description="direction of the axis that a sine turns about"
    )
    point: OptionalVector = Field(
        default=None,
        description="three numbers: place in the tank's axes, from the middle of its rim [m], that "
        "a sine turns about, or where the accelerations of a table with rotation were measured",
    )
    ramp: float = Field(default=1.0, ge=0, description="smooth start in periods, 0 for none")
    file: str | None = Field(
        default=None,
        description="CSV file with columns time, ax, ay, az (s, m/s^2, or as its header says) and, "
        "of a tank that turns, wx, wy, wz (deg/s, rad/s) or roll, pitch, yaw (deg, rad); for a psd "
        "frequency, x, y, z (Hz, g^2/Hz)",
    )
    at_rest: Annotated[tuple[float, float, float] | None, BeforeValidator(_as_tuple)] = Field(
        default=None,
        description="three numbers that a table shows of a tank at rest [m/s^2], which are "
        "subtracted: [0.0, 0.0, 9.80665] where an accelerometer's gravity is in it, else 0",
    )
    duration: float | None = Field(
        default=None, gt=0, description="length of the record that a psd makes [s]"
    )
    seed: int | None = Field(
        default=None, ge=0, description="seed, a whole number, of a psd's random phases"
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
        elif given.get("kind") not in motions_reading("amplitude"):
            problem = f'got {acceleration} without a sine. Take kind = "sine", or leave it out.'
        if problem:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": f"motion.acceleration: {problem}"}
            )
        if not (isinstance(acceleration, int | float) and isinstance(frequency, int | float)):
            return given  # what is wrong with either is said of it
        if max(acceleration, frequency) > LARGEST or 0 < frequency < LEAST:
            return given
        rest = {key: value for key, value in given.items() if key != "acceleration"}
        omega = 2.0 * np.pi * frequency
        amplitude = float(acceleration / omega**2) if omega else 0.0
        if amplitude > LARGEST or 0.0 < amplitude < LEAST:
            problem = (
                f"motion.acceleration: at {frequency:g} Hz gives an amplitude of {amplitude:g} m, "
                "beyond 1e-15 to 1e+15. Give the acceleration in m/s^2 and the frequency in Hz."
            )
            raise PydanticCustomError("cross_check", "{problems}", {"problems": problem})
        return rest | {"amplitude": amplitude}

    @cached_property
    def record(self) -> MotionTable:
        """The accelerations of a ``table``, read once. Raises ``TableError``.

        Less ``at_rest``, but for a table with rotation: there that turns with the tank's axes.
        """
        assert self.file is not None
        table = read_motion_table(Path(self.file))
        return table if self.at_rest is None or table.turns else table.less(self.at_rest)

    @cached_property
    def spectrum(self) -> SpectrumTable:
        """The densities of a ``psd``, read once. Raises ``TableError``."""
        assert self.file is not None
        return read_spectrum_table(Path(self.file))

    @property
    def unit_direction(self) -> Array:
        """``direction`` scaled to length 1, (3,)."""
        vector: Array = np.array(self.direction) / np.abs(self.direction).max()
        unit: Array = vector / np.linalg.norm(vector)
        return unit


class Model(Section):
    """Which liquid the diaphragm feels."""

    fluid: Annotated[str, one_of(fluid_models, AUTO)] = Field(
        default_factory=default_fluid_model,
        description=f'name of a fluid model, or "{AUTO}" for the cheapest that keeps the tolerance',
    )
    tolerance: float = Field(
        default=0.05,
        gt=0,
        lt=1,
        description='relative error of the CG\'s motion that "auto" allows',
    )
