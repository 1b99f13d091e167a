"""Time counted in periods of the sine, turned into seconds before a scene is checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic_core import PydanticCustomError

from coupling.scene.choices import motions_with
from coupling.scene.numerics import FEWEST_STEPS_A_PERIOD, MOST
from coupling.scene.sections import LARGEST, LEAST

_SECONDS = {"periods": "duration", "steps_per_period": "step"}


def in_seconds(given: Mapping[str, Any]) -> dict[str, Any]:
    """The plain values of a scene with ``time.duration`` and ``time.step`` in place of periods.

    ``time.periods`` / f is the duration and 1 / (f ``time.steps_per_period``) the step [s], with
    ``motion.frequency`` f [Hz]. Values of a wrong type or range are left as they are: the section
    refuses them. Raises ``PydanticCustomError`` where a count stands beside what it replaces, or
    where there is no sine.
    """
    time, motion = given.get("time"), given.get("motion")
    if not isinstance(time, dict):
        return dict(given)
    counts = [key for key in _SECONDS if key in time]
    problems = [_problem(key, time, motion) for key in counts]
    if any(problems):
        raise PydanticCustomError(
            "cross_check", "{problems}", {"problems": "\n".join(filter(None, problems))}
        )
    seconds = dict(time)
    for key in counts:
        if _usable(key, time[key]):
            count = seconds.pop(key)
            periods = count if key == "periods" else 1.0 / count
            seconds[_SECONDS[key]] = periods / given["motion"]["frequency"]
    return {**given, "time": seconds}


def _problem(key: str, time: Mapping[str, Any], motion: Any) -> str:
    """What is wrong with ``time.<key>`` beside the rest of the scene; empty where nothing is."""
    replaced = _SECONDS[key]
    if replaced in time:
        return (
            f"time.{key}: stands in place of time.{replaced}, got {time[key]} and "
            f"{time[replaced]}. Leave one of the two out."
        )
    if not isinstance(motion, dict) or motion.get("kind") not in motions_with("frequency"):
        return f'time.{key}: needs motion.kind = "sine". Give time.{replaced} in seconds.'
    if not _positive(motion.get("frequency")):
        return f"time.{key}: needs a positive motion.frequency. Give the frequency [Hz]."
    return ""


def _usable(key: str, count: Any) -> bool:
    if key == "steps_per_period":
        return isinstance(count, int) and FEWEST_STEPS_A_PERIOD <= count <= MOST
    return _positive(count)


def _positive(value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and LEAST <= value <= LARGEST
