"""What to simulate: a scene, read from TOML, checked as a whole, immutable.

The sections stand in ``scene_sections``; here is what concerns more than one of them, and reading
and writing. A ``Scene`` that exists is valid, its motion table included.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import tomli_w
from pydantic import Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from coupling.motion_table import read_motion_table
from coupling.scene_errors import SceneError, problems_of
from coupling.scene_sections import (
    Cloth,
    Coupling,
    Diaphragm,
    Liquid,
    Model,
    Motion,
    OpenFoam,
    Section,
    Tank,
    Time,
    Vector,
)
from coupling.scene_source import SCENE_FILE, apply_override, read_toml, scene_file
from coupling.table_file import TableError

__all__ = [
    "SCENE_FILE",
    "TABLE_FILE",
    "Scene",
    "SceneError",
    "load_scene",
    "plain_values",
    "scene_from",
    "scene_toml",
    "with_overrides",
    "write_scene",
]

TABLE_FILE = "motion.csv"
STEPS_PER_PERIOD = 20
THICKNESS_OVER_RADIUS = 0.05


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
    model: Model = Model()
    cloth: Cloth = Cloth()
    openfoam: OpenFoam = OpenFoam()
    coupling: Coupling = Coupling()
    time: Time

    @property
    def liquid_volume(self) -> float:
        """Volume of the liquid [m^3]."""
        return self.liquid.fill_fraction * self.tank.volume

    @property
    def period(self) -> float | None:
        """Of a sinusoidal motion [s]; None for any other."""
        frequency = self.motion.frequency
        return 1.0 / frequency if self.motion.kind == "sine" and frequency else None

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        problems = [
            *_check_shape(self),
            *_check_grid(self),
            *_check_motion(self),
            *_check_time(self),
        ]
        if problems:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": "\n".join(problems)}
            )
        return self


def _check_shape(scene: Scene) -> list[str]:
    problems = []
    thickest = THICKNESS_OVER_RADIUS * scene.tank.radius
    if scene.diaphragm.thickness >= thickest:
        problems.append(
            f"diaphragm.thickness: must be below {THICKNESS_OVER_RADIUS} radii ({thickest:.4g} m), "
            f"got {scene.diaphragm.thickness:g}. Give metres; a thicker diaphragm is no membrane."
        )
    if not scene.gravity[2] < 0.0:
        problems.append(
            f"gravity: its z component must be negative, got {list(scene.gravity)}. "
            "Turn the tank so that the liquid lies below the diaphragm, at negative z."
        )
    return problems


def _check_grid(scene: Scene) -> list[str]:
    """What the thesis' grid can do: it has no volume constraint, and no middle if odd."""
    problems = []
    if scene.cloth.grid == "thesis" and scene.model.fluid != "datum":
        problems.append(
            f'cloth.grid: "thesis" needs model.fluid = "datum", got "{scene.model.fluid}". '
            'Take cloth.grid = "rings" for a liquid that keeps its volume.'
        )
    if scene.cloth.grid == "thesis" and scene.cloth.resolution % 2:
        problems.append(
            f'cloth.resolution: must be even for cloth.grid = "thesis", got '
            f"{scene.cloth.resolution}. Give the number of nodes across, 26 in the thesis."
        )
    return problems


def _check_motion(scene: Scene) -> list[str]:
    motion = scene.motion
    needs: dict[str, tuple[str, ...]] = {
        "sine": ("frequency", "amplitude"),
        "table": ("file",),
        "rest": (),
    }
    problems = [
        f'motion.{key}: is required for kind = "{motion.kind}". '
        f"Give the {Motion.model_fields[key].description}."
        for key in needs[motion.kind]
        if getattr(motion, key) is None
    ]
    if not any(motion.direction):
        problems.append(
            "motion.direction: must not be zero, got [0, 0, 0]. "
            "Give the direction of the shaking, such as [1.0, 0.0, 0.0]."
        )
    if motion.kind == "table" and motion.file is not None:
        problems += _check_table(Path(motion.file), scene.time.step * scene.time.steps)
    return problems


def _check_table(path: Path, end: float) -> list[str]:
    try:
        table = read_motion_table(path)
    except TableError as error:
        return [f"motion.file: {error}"]
    first, last = float(table.time[0]), float(table.time[-1])
    if first > 0.0 or last < end * (1.0 - 1e-9):
        return [
            f"motion.file: {path}: must cover 0 to {end:g} s, covers {first:g} to {last:g} s. "
            "Shorten time.duration, or give a longer table that starts at 0."
        ]
    return []


def _check_time(scene: Scene) -> list[str]:
    time, problems = scene.time, []
    if time.duration < time.step:
        problems.append(
            f"time.duration: must be at least time.step ({time.step:g} s), got {time.duration:g}. "
            "Give a longer duration, or a smaller step."
        )
    longest = None if scene.period is None else scene.period / STEPS_PER_PERIOD
    if longest is not None and time.step > longest * (1.0 + 1e-9):
        problems.append(
            f"time.step: must be at most 1/{STEPS_PER_PERIOD} of the motion's period "
            f"({longest:.4g} s), got {time.step:g}. Give a smaller step."
        )
    return problems


def load_scene(path: Path, overrides: Sequence[str] = ()) -> Scene:
    """Read ``scene.toml`` from a folder, or the scene file ``path`` itself.

    ``overrides`` are ``key=value`` with dotted keys; the value is TOML, or else a string. A file
    named by ``motion.file`` is looked for beside the scene.

    Raises ``SceneError`` with every problem found, each with its file, key, value and mend.
    """
    file = scene_file(path)
    data = read_toml(file)
    changed = [apply_override(data, text) for text in overrides]
    motion = data.get("motion")
    if isinstance(motion, dict) and isinstance(motion.get("file"), str):
        motion["file"] = str((file.parent / motion["file"]).resolve())
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


def with_overrides(scene: Scene, overrides: Sequence[str]) -> Scene:
    """The same scene with ``key=value`` changes, checked again.

    Raises ``SceneError``.
    """
    data = plain_values(scene)
    changed = [apply_override(data, text) for text in overrides]
    return scene_from(data, changed=changed)


def plain_values(scene: Scene) -> dict[str, Any]:
    """Nested dictionary of all values, defaults included; keys without a value are left out."""
    return scene.model_dump(exclude_none=True)


def scene_toml(scene: Scene) -> str:
    """The scene as TOML, all defaults written out; reading it gives an equal scene."""
    return tomli_w.dumps(plain_values(scene))


def write_scene(scene: Scene, folder: Path) -> Path:
    """Write ``scene.toml`` into ``folder``, with a copy of the motion table, and return its path.

    The folder can be moved and the scene run again from there: the table is named relative to it.
    ``OSError`` where the folder cannot be written.
    """
    data = plain_values(scene)
    if scene.motion.kind == "table" and scene.motion.file is not None:
        copy = folder / TABLE_FILE
        if Path(scene.motion.file).resolve() != copy.resolve():
            shutil.copyfile(scene.motion.file, copy)
        data["motion"]["file"] = TABLE_FILE
    file = folder / SCENE_FILE
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return file
