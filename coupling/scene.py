"""What to simulate: a scene, read from TOML, checked as a whole, immutable.

The sections stand in ``scene_sections`` and ``scene_numerics``, what concerns more than one of them
in ``scene_checks``; here they are put together, read and written. A ``Scene`` that exists is valid,
its tables included.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import tomli_w
from pydantic import Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from coupling.scene_checks import problems_between
from coupling.scene_errors import SceneError, problems_of
from coupling.scene_numerics import Cloth, Coupling, OpenFoam, Time
from coupling.scene_sections import Diaphragm, Liquid, Model, Motion, Section, Tank, Vector
from coupling.scene_source import SCENE_FILE, apply_override, read_toml, scene_file

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
        problems = problems_between(self)
        if problems:
            raise PydanticCustomError(
                "cross_check", "{problems}", {"problems": "\n".join(problems)}
            )
        return self


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
