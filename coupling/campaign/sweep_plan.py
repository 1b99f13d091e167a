"""Which scenes a sweep runs: axes read from the command line, and the grid that they span."""

from __future__ import annotations

import itertools
import json
import math
import re
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.estimate.cost import run_cost
from coupling.scene.scene import Scene, SceneError, load_scene

Value = float | int | bool | str | list[float | int]
POINTS = "points"  # folder of the runs
MOST_PROBLEMS = 10
_MEND = (
    "Give key=start:stop:count, key=start:stop:count:log or key=a,b,c, "
    "such as motion.frequency=0.1:4:12:log."
)
MOST_RUNS = 10_000
_MOST_VALUES = 1_000_000  # of an axis: beyond, the cost is not even estimated


class SweepError(ValueError):
    """A sweep that cannot be started; the message says where, what and the mend."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A dotted ``key`` of the scene and the ``values`` that it takes, all different.

    ``logarithmic``: the values are spaced geometrically.
    """

    key: str
    values: tuple[Value, ...]
    logarithmic: bool = False


@dataclass(frozen=True, kw_only=True)
class Point:
    """One point of the grid: ``values`` by key, and its scene on each fluid model, all valid.

    ``name`` follows from the values alone, so a finer grid finds the points that a coarser one ran.
    """

    name: str
    values: dict[str, Value]
    scenes: dict[str, Scene]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """All that a sweep runs, each point with each model, and ``wanted`` figures by dotted name."""

    axes: tuple[Axis, ...]
    models: tuple[str, ...]
    points: tuple[Point, ...]
    wanted: tuple[str, ...] = ()

    @property
    def runs(self) -> dict[Path, Scene]:
        """The scene of each run, by its folder within the sweep's."""
        return {
            Path(POINTS) / point.name / model: scene
            for point in self.points
            for model, scene in point.scenes.items()
        }


def parse_axis(text: str) -> Axis:
    """Axis from ``key=start:stop:count``, ``key=start:stop:count:log`` or ``key=a,b,c``.

    Values may be lists, as in ``key=[1,0,0],[0,1,0]``. Both ends belong to a range. Values are
    rounded to 12 digits, and whole numbers where the ends are written so and all values between
    are. Whether the scene knows the key is not checked.
    Raises ``SweepError``.
    """
    key, equals, given = (part.strip() for part in text.partition("="))
    if not equals or not all(key.split(".")) or not given:
        raise SweepError(f"--over {text}: must name a key and its values. {_MEND}")
    if ":" in given:
        values, logarithmic = _range(text, given.split(":"))
    else:
        values, logarithmic = tuple(map(_value, _parts(given))), False
    counts = Counter(json.dumps(value) for value in values)
    twice = sorted(value for value, count in counts.items() if count > 1)
    if twice:
        raise SweepError(f"--over {text}: gives {', '.join(twice)} twice. Leave one out.")
    return Axis(key=key, values=values, logarithmic=logarithmic)


def _range(text: str, parts: Sequence[str]) -> tuple[tuple[Value, ...], bool]:
    logarithmic = len(parts) == 4 and parts[3].strip() == "log"
    if len(parts) != 3 and not logarithmic:
        raise SweepError(f"--over {text}: is no range. {_MEND}")
    try:
        start, stop, count = float(parts[0]), float(parts[1]), int(parts[2])
    except ValueError:
        raise SweepError(
            f"--over {text}: must be numbers, the count a whole one. {_MEND}"
        ) from None
    if count > _MOST_VALUES:
        raise SweepError(
            f"--over {text}: {count:,} values are too many; a sweep has at most {MOST_RUNS:,} runs."
        )
    if count < 2 or not np.isfinite([start, stop]).all():
        raise SweepError(f"--over {text}: needs finite ends and a count of 2 or more. {_MEND}")
    if logarithmic and not (start > 0.0 and stop > 0.0):
        raise SweepError(
            f"--over {text}: geometric spacing needs positive ends. Leave out :log, or change them."
        )
    spaced = (np.geomspace if logarithmic else np.linspace)(start, stop, count)
    values = [float(f"{value:.12g}") for value in spaced]
    whole = all(re.fullmatch(r"\s*[+-]?\d+\s*", part) for part in parts[:2])
    if whole and all(value.is_integer() for value in values):
        return tuple(int(value) for value in values), logarithmic
    return tuple(values), logarithmic


def _parts(given: str) -> list[str]:
    """``given`` at its commas outside of brackets."""
    return [part.strip() for part in re.split(r",(?![^\[\]]*\])", given)]


def _value(text: str) -> Value:
    """A TOML number, truth value, quoted string or list of numbers; anything else as it stands."""
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    numbers = isinstance(value, list) and all(isinstance(item, float | int) for item in value)
    return value if numbers or isinstance(value, float | int | bool | str) else text


def plan_sweep(
    scene_path: Path, changes: Sequence[str], axes: Sequence[Axis], models: Sequence[str]
) -> Plan:
    """Every point of the grid, the last axis fastest, with its scenes read and checked.

    ``changes``: ``key=value`` for all points. Nothing is run or written.

    Raises
    ------
    SweepError
        No axis, one key on two axes, the model as an axis, two values that give the same folder,
        or more than ``MOST_RUNS`` runs.
    SceneError
        A point's scene is invalid: each different problem once, with the first point that has it.
    """
    keys = [axis.key for axis in axes]
    if not keys or len(set(keys)) < len(keys):
        raise SweepError(f"--over: must be given, and once for each key. {_MEND}")
    if "model.fluid" in keys:
        raise SweepError(
            "--over model.fluid: every point runs on all models. "
            "Name them instead, such as --models hydrostatic,openfoam."
        )
    _check_size(scene_path, changes, axes, models)
    points: list[Point] = []
    problems: dict[str, str] = {}
    for combined in itertools.product(*(axis.values for axis in axes)):
        values = dict(zip(keys, combined, strict=True))
        scenes = {}
        for model in models:
            try:
                scenes[model] = _scene_at(scene_path, changes, values, model)
            except SceneError as error:
                for problem in error.problems:
                    problems.setdefault(problem, _label(values))
        points.append(Point(name=_name(values), values=values, scenes=scenes))
    if problems:
        raise SceneError(_told(problems, keys))
    _check_names(points)
    return Plan(axes=tuple(axes), models=tuple(models), points=tuple(points))


def point_at(
    scene_path: Path, changes: Sequence[str], values: dict[str, Value], models: Sequence[str]
) -> Point:
    """Return one point by its ``values``; raises ``SceneError`` where its scene is invalid."""
    scenes = {model: _scene_at(scene_path, changes, values, model) for model in models}
    return Point(name=_name(values), values=values, scenes=scenes)


def _check_size(
    scene_path: Path, changes: Sequence[str], axes: Sequence[Axis], models: Sequence[str]
) -> None:
    """Refuse a grid that is too large, with what it would cost by its first point."""
    runs = math.prod(len(axis.values) for axis in axes) * len(models)
    if runs <= MOST_RUNS:
        return
    first = {axis.key: axis.values[0] for axis in axes}
    scenes = [_scene_at(scene_path, changes, first, model) for model in models]
    mean = sum(run_cost(scene, scene.model.fluid) for scene in scenes) / len(scenes)
    raise SweepError(
        f"--over: {runs:,} runs, some {mean * runs / 86400.0:,.1f} days of one core by the first "
        f"point's estimate, are more than {MOST_RUNS:,}. Give fewer values, or split them over "
        "several sweeps."
    )


def _scene_at(
    scene_path: Path, changes: Sequence[str], values: dict[str, Value], model: str
) -> Scene:
    here = [f"{key}={json.dumps(value)}" for key, value in values.items()]
    return load_scene(scene_path, [*changes, *here, f"model.fluid={model}"])


def _told(problems: dict[str, str], keys: Sequence[str]) -> list[str]:
    lines = []
    for problem, where in problems.items():
        of_axis = any(problem.startswith(f"--set: {key}:") for key in keys)
        message = problem.replace("--set", "--over", 1) if of_axis else problem
        lines.append(f"{message} (At {where}.)")
    more = len(lines) - MOST_PROBLEMS
    return lines if more <= 0 else [*lines[:MOST_PROBLEMS], f"... and {more} problems more."]


def _label(values: dict[str, Value]) -> str:
    return ", ".join(f"{key}={value}" for key, value in values.items())


def _name(values: dict[str, Value]) -> str:
    """A folder's name: keys and values, in letters that every file system and OpenFOAM take."""
    parts = (f"{key}_{_in_name(value)}" for key, value in values.items())
    return re.sub(r"[^\w.+-]", "-", "__".join(parts))


def _in_name(value: Value) -> str:
    return "_".join(map(str, value)) if isinstance(value, list) else str(value)


def _check_names(points: Sequence[Point]) -> None:
    seen: dict[str, Point] = {}
    for point in points:
        other = seen.setdefault(point.name, point)
        if other is not point:
            raise SweepError(
                f"--over: {_label(other.values)} and {_label(point.values)} would share the folder "
                f"{point.name}. Rename one of the values."
            )
