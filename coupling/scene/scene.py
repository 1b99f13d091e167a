"""What to simulate: a scene, read from TOML, checked as a whole, immutable.

The sections stand in ``sections``, ``diaphragm`` and ``numerics``, what concerns more than one of
them in ``checks``; here they are put together, read and turned into TOML. A ``Scene`` that exists
is valid, its tables included.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import tomli_w
from pydantic import Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from coupling.finite_volume.mesh_sizes import length_for
from coupling.ports import Array
from coupling.scene.carrier import Carrier
from coupling.scene.checks import problems_between
from coupling.scene.choices import motion_kind
from coupling.scene.diaphragm import Diaphragm, Sheet
from coupling.scene.errors import SceneError, problems_of
from coupling.scene.numerics import Cloth, Coupling, OpenFoam, Potential, Time
from coupling.scene.periods import in_seconds
from coupling.scene.report import Report
from coupling.scene.ridges import ridges_of
from coupling.scene.sections import Liquid, Model, Motion, Section, Vector
from coupling.scene.shapes.own_mould import own_mould
from coupling.scene.source import SCENE_FILE, apply_override, as_texts, read_toml, scene_file
from coupling.scene.supply import Supply, with_duration
from coupling.scene.tank import Tank

if TYPE_CHECKING:
    from coupling.scene.tank import Mould

__all__ = [
    "SCENE_FILE",
    "Scene",
    "SceneError",
    "load_scene",
    "plain_values",
    "scene_from",
    "scene_toml",
    "tables_of",
    "with_overrides",
]

# Keys that name a file beside the scene, and what its copy in a run's folder is called.
TABLE_FILES = {
    ("motion", "file"): "motion.csv",
    ("carrier", "force_file"): "force.csv",
    ("diaphragm", "thickness_map"): "thickness.csv",
    ("diaphragm", "mould_profile"): "mould.csv",
    ("tank", "profile"): "profile.csv",
}


class Scene(Section):
    """Everything that a run depends on, in SI units."""

    title: str = Field(default="", description="title of the scene")
    gravity: Vector = Field(
        default=(0.0, 0.0, -9.81),
        description="gravity [m/s^2] as three numbers; the liquid lies at negative z",
    )
    tank: Tank
    diaphragm: Diaphragm
    liquid: Liquid
    motion: Motion = Motion()
    supply: Supply = Supply()
    carrier: Carrier = Carrier()
    model: Model = Model()
    cloth: Cloth = Cloth()
    potential: Potential = Potential()
    openfoam: OpenFoam = OpenFoam()
    coupling: Coupling = Coupling()
    time: Time
    report: Report = Report()

    @property
    def liquid_volume(self) -> float:
        """Volume of the liquid [m^3]."""
        return self.liquid.fill_fraction * self.tank.volume

    @cached_property
    def mould(self) -> Mould:
        """The shape in which the diaphragm is moulded, above or below the rim."""
        shell, part = self.tank.shell, self.diaphragm.mould
        if self.diaphragm.mould_profile is not None:
            return own_mould(self.diaphragm.mould_profile, part)
        return shell.upper_part() if part == "upper" else shell.lower_part()

    @cached_property
    def mean_thickness(self) -> float:
        """Of the diaphragm's moulded area [m]."""
        ridges = ridges_of(self.diaphragm)
        return self.diaphragm.thickness if ridges is None else ridges.mean(self.mould)

    @property
    def sheet(self) -> Sheet:
        """The rubber as the cloth knows it, of its mean thickness."""
        return replace(self.diaphragm.sheet, thickness=self.mean_thickness)

    def thickness_at(self, points: Array) -> Array | None:
        """Thickness (k,) [m] at ``points`` (k, 3) [m] of the mould; None where it is even."""
        by_map, ridges = self.diaphragm.moulded_thickness, ridges_of(self.diaphragm)
        if by_map is not None:
            return by_map.at(self.mould.directions(points))
        return None if ridges is None else ridges.at(points, self.mould)

    @property
    def frequency(self) -> float | None:
        """Of a periodic motion [Hz]; None for any other."""
        return motion_kind(self.motion.kind).frequency(self.motion) or None

    @property
    def period(self) -> float | None:
        """Of a periodic motion [s]; None for any other."""
        return 1.0 / self.frequency if self.frequency else None

    @property
    def wall_spacing(self) -> float:
        """``openfoam.wall_spacing`` over the shell's size, as ``half_ball`` takes it."""
        return self.openfoam.wall_spacing / self.tank.shell.size

    @property
    def half_ball(self) -> tuple[int, float, float]:
        """What the flow's ``half_ball`` is made by: most cells, wall spacing and length over R."""
        shell = self.tank.shell
        length = length_for(shell, -np.array(self.gravity), self.liquid.fill_fraction)
        return self.openfoam.cells, self.wall_spacing, length

    @property
    def loss_time(self) -> float:
        """Time tau [s] of the rubber's loss, eta/(2 pi f) of ``cloth.viscous``."""
        rubber = self.diaphragm
        frequency = rubber.loss_frequency or 1.0 / (self.period or math.inf)
        return rubber.loss_factor / (2.0 * math.pi * frequency) if frequency else 0.0

    @model_validator(mode="before")
    @classmethod
    def _time_in_seconds(cls, given: Any) -> Any:
        return in_seconds(with_duration(given)) if isinstance(given, dict) else given

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        problems = problems_between(self)
        if problems:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": "\n".join(problems)}
            )
        return self


def load_scene(path: str | Path, overrides: Sequence[str] | Mapping[str, Any] = ()) -> Scene:
    """Read ``scene.toml`` from a folder, or the scene file ``path`` itself.

    Parameters
    ----------
    path : str or Path
        The folder or the file. Files that the scene names (``TABLE_FILES``) are looked for beside
        it.
    overrides : Sequence of str or Mapping
        ``key=value`` with dotted keys, the value TOML or else a string; or values by dotted key.

    Returns
    -------
    Scene
        Valid, with every default filled in; it cannot be changed.

    Raises
    ------
    SceneError
        Every problem found, each with its file, key, value and mend.
    """
    file = scene_file(Path(path))
    data = read_toml(file)
    changed = [apply_override(data, text) for text in as_texts(overrides)]
    for section, key in TABLE_FILES:
        values = data.get(section)
        if isinstance(values, dict) and isinstance(values.get(key), str):
            values[key] = str((file.parent / values[key]).resolve())
    return scene_from(data, where=str(file), changed=changed)


def scene_from(data: Mapping[str, Any], where: str = "scene", changed: Sequence[str] = ()) -> Scene:
    """Scene from plain values; ``changed`` are the dotted keys that did not come from ``where``.

    Raises ``SceneError``.
    """
    try:
        return Scene.model_validate(dict(data))
    except ValidationError as error:
        lines = []
        for problem in problems_of(error, Scene):
            key = problem.partition(":")[0]
            from_override = any(name == key or name.startswith(f"{key}.") for name in changed)
            lines.append(f"{'--set' if from_override else where}: {problem}")
        raise SceneError(lines) from error


def with_overrides(scene: Scene, overrides: Sequence[str] | Mapping[str, Any]) -> Scene:
    """The same scene with changes as ``load_scene`` takes them, checked again.

    Raises ``SceneError``.
    """
    data = plain_values(scene)
    changed = [apply_override(data, text) for text in as_texts(overrides)]
    return scene_from(data, changed=changed)


def plain_values(scene: Scene) -> dict[str, Any]:
    """Nested dictionary of all values, defaults included; keys without a value are left out.

    So is the thickness that a map stands for.
    """
    data = scene.model_dump(exclude_none=True)
    if scene.diaphragm.thickness_map is not None:
        del data["diaphragm"]["thickness"]
    return data


def tables_of(scene: Scene) -> dict[tuple[str, str], Path]:
    """Files that the scene uses, by the section and key that name them."""
    files = {}
    for section, key in TABLE_FILES:
        name = getattr(getattr(scene, section), key)
        if name is not None and (section != "motion" or motion_kind(scene.motion.kind).reads_file):
            files[section, key] = Path(name)
    return files


def scene_toml(scene: Scene) -> str:
    """The scene as TOML, all defaults written out; reading it gives an equal scene."""
    return tomli_w.dumps(plain_values(scene))
