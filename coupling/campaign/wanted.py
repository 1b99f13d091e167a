"""Figures of a run's ``summary.json`` that a sweep is asked for, by dotted names."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from coupling.campaign.sweep_plan import SweepError
from coupling.metrics.summary import summarise
from coupling.scene.scene import Scene
from coupling.store.results import Results
from coupling.store.results_layout import FIELDS, dims_of
from coupling.store.run_record import RunStatistics

_NEAREST = 3  # names that are offered in place of an unknown one
_ENDINGS = {
    "_J_per_m2": "J m-2", "_N_per_m": "N m-1", "_m2": "m2", "_deg": "degree", "_Pa": "Pa",
    "_Ns": "N s", "_Nm": "N m", "_J": "J", "_m": "m", "_N": "N", "_s": "s",
    "_bytes": "byte", "slosh_frequency": "Hz",
}  # fmt: skip


def unit_of_figure(name: str) -> str:
    """Return the unit of a figure by its name, an index left out; "1" for a relative one."""
    stem = name.rstrip("0123456789").rstrip(".") if name.rpartition(".")[2].isdigit() else name
    return next((unit for ending, unit in _ENDINGS.items() if stem.endswith(ending)), "1")


def check_wanted(names: Sequence[str], scene: Scene) -> tuple[str, ...]:
    """Return ``names`` of figures if runs of ``scene`` can have them.

    A name is dotted, such as ``rubs.self_work_max_J_per_m2``, of a list with an index from 0:
    ``cg.amplitude_m.0``. Held against the summary of a run without steps: what is below a figure
    that such a run does not know, as where it rubbed, is not checked.

    Raises ``SweepError`` for a name twice, an unknown one (with the nearest known ones), and one of
    what is no number.
    """
    summary = _without_steps(scene)
    known = dict(_figures(summary))
    for name in names:
        if names.count(name) > 1:
            raise SweepError(f"--want {name}: is given twice. Leave one out.")
        _check(name, summary, known)
    return tuple(names)


def figure_at(summary: Mapping[str, Any], name: str) -> float | bool | None:
    """Return the figure of a ``summary`` by its dotted ``name``; None where it has no number."""
    value: Any = summary
    for part in name.split("."):
        value = _below(value, part)
    return value if isinstance(value, bool | int | float) else None


def _check(name: str, summary: Mapping[str, Any], known: Mapping[str, Any]) -> None:
    value: Any = summary
    for part in name.split("."):
        if value is None:
            return  # what a run without steps does not know
        if not _has(value, part):
            raise SweepError(_unknown(name, known))
        value = _below(value, part)
    if isinstance(value, Mapping | list):
        parts = list(value) if isinstance(value, Mapping) else range(len(value))
        listed = ", ".join(f"{name}.{part}" for part in parts)
        raise SweepError(f"--want {name}: has several figures. Give one or more of {listed}.")
    if isinstance(value, str):
        raise SweepError(f"--want {name}: is a text, '{value[:40]}'. Give figures.")


def _unknown(name: str, known: Mapping[str, Any]) -> str:
    last = name.rpartition(".")[2]
    near = [one for one in known if name and (name in one or last in one.split("."))][:_NEAREST]
    near += difflib.get_close_matches(name, known, n=_NEAREST, cutoff=0.6)
    mend = f"Did you mean {', '.join(dict.fromkeys(near))}?" if near else "See summary.json."
    return f"--want {name}: no summary has that. {mend}"


def _has(value: Any, part: str) -> bool:
    if isinstance(value, list):
        return part.isdigit() and int(part) < len(value)
    return isinstance(value, Mapping) and part in value


def _below(value: Any, part: str) -> Any:
    if not _has(value, part):
        return None
    return value[int(part)] if isinstance(value, list) else value[part]


def _figures(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every figure below ``value`` with its dotted name."""
    if isinstance(value, list):
        value = dict(enumerate(value))
    if not isinstance(value, Mapping):
        yield name, value
        return
    for part, one in value.items():
        yield from _figures(one, f"{name}.{part}".lstrip("."))


def _without_steps(scene: Scene) -> dict[str, Any]:
    """The summary of a run of ``scene`` that failed at its start, on a sheet of one triangle."""
    sizes = {"node": 3, "triangle": 1, "axis": 3}
    arrays: dict[str, Any] = {
        name: np.zeros((0, *(sizes[dimension] for dimension in dims_of(name))))
        for name, _ in FIELDS.values()
    }
    nothing = Results(
        model=scene.model.fluid, version="", scene_toml="", metrics={}, metric_units={},
        reference=np.eye(3), triangles=np.array([[0, 1, 2]]), **arrays,
    )  # fmt: skip
    return summarise(nothing, RunStatistics(), scene, "failed", None)
