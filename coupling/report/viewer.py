"""What the turnable view in the report shows: the diaphragm's last period, packed as JSON.

The view itself is ``webgl/viewer.js``. It draws with three.js, of which ``webgl/three.min.js`` is
the part in use: half a megabyte (plotly.js is nine times as much), of MIT licence, quick enough to
play, turned by mouse and finger. All of it goes into the page.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps

from coupling.fluids import ASSUMED, FLUIDS
from coupling.ports import Array, Shell
from coupling.report.files import RunFiles
from coupling.report.instants import shown_instants, views
from coupling.report.outline import levels, meridian
from coupling.report.page import Section
from coupling.report.picture import DIVERGING, SEQUENTIAL, last_period_rows, seen_from
from coupling.store.attitude import body_force
from coupling.store.results import Results

WHOLE, STATIC, DYNAMIC = "pressure", "hydrostatic", "dynamic"  # quantities of the view
CORNERS = 181  # of the meridian
INSTANTS = 60  # at most, of a period
BYTES = 8_000_000  # of all runs' arrays, before base64 adds a third
_TOP = 32767  # of a 16 bit integer
_SEEN = (0.02, 0.98)  # quantiles that the colours span: a slam would leave all the rest pale


def run_viewer(run: RunFiles) -> str:
    """A run's own view: hydrostatic pressure beside p*; without a flow the pressure alone."""
    parts = (STATIC, DYNAMIC) if run.has_flow else (WHOLE,)
    return _packed([run], run, [(run.label, part) for part in parts])


def study_view(runs: Sequence[RunFiles], study: Mapping[str, Any]) -> list[Section]:
    """Section with two of the ``runs`` side by side, at first hydrostatic and reference.

    ``runs`` are complete ones of one scene. Its pictures, which also print, are the reference's.
    Without a reference the first of the ``runs`` stands for it.
    """
    seen = [run for run in runs if len(run.results.time)]
    if not seen:
        return []
    best = next((run for run in seen if run.label == study["reference"]), seen[0])
    others = sorted((run for run in seen if run is not best), key=_worth_comparing)
    shown = [(run.label, WHOLE) for run in (*others[:1], best)]
    pictures, scale = views(best)
    return [
        Section(
            title="Pressure on the diaphragm",
            text=f"Pictures of {best.label}, at instants {shown_instants(best)}.",
            pictures=pictures,
            columns=4,
            scale=scale,
            viewer=_packed(seen, best, shown),
        )
    ]


def _worth_comparing(run: RunFiles) -> int:
    """The assumption first, then what else has a flow, the simplest first."""
    if run.label not in FLUIDS:
        return len(FLUIDS) + 1
    if run.label == ASSUMED:
        return 0
    return 1 + FLUIDS.rank(run.label) if run.has_flow else len(FLUIDS)


def _packed(runs: Sequence[RunFiles], timed: RunFiles, shown: Sequence[tuple[str, str]]) -> str:
    """JSON of the last period of ``runs``, at the instants of ``timed``."""
    results, scene, shell = timed.results, timed.scene, timed.scene.tank.shell
    rows = last_period_rows(results, _affordable(runs))
    pull = body_force(np.array(scene.gravity), results)[rows]
    pull = pull / np.maximum(np.linalg.norm(pull, axis=1), 1e-300)[:, None]
    axis = int(np.argmax(np.ptp(results.tank_displacement, axis=0)))
    azimuth, elevation = seen_from(results)
    content = {
        "views": [{"model": model, "quantity": quantity} for model, quantity in shown],
        "runs": [_run(run, _nearest(run.results, results.time[rows])) for run in runs],
        "time": _rounded(results.time[rows]),
        "tank": {
            "axis": "xyz"[axis],
            "displacement": _rounded(results.tank_displacement[rows, axis]),
            **_shape(shell),
        },
        "pull": _rounded(pull),
        "levels": _rounded(levels(shell, results.volume[rows], -pull)),
        "camera": {"azimuth": azimuth, "elevation": elevation},
        "colours": {"diverging": _colours(DIVERGING), "sequential": _colours(SEQUENTIAL)},
    }
    return json.dumps(content, separators=(",", ":"), allow_nan=False)


def _shape(shell: Shell) -> dict[str, Any]:
    """The rim's radius [m], points and normals of the meridian, half the extent and its middle."""
    points, normal = meridian(shell, CORNERS)
    middle = 0.5 * sum(shell.poles)
    half = max(float(points[:, 0].max()), shell.poles[1] - middle)
    profile = np.column_stack([points[:, [0, 2]], normal[:, [0, 2]]])
    return {"radius": shell.size, "profile": _rounded(profile), "middle": middle, "half": half}


def _affordable(runs: Sequence[RunFiles]) -> int:
    """Instants that fit into ``BYTES``; two at least, of however fine a sheet."""
    fixed = sum(run.results.triangles.size * _index(run.results).itemsize for run in runs)
    one = sum(10 * len(run.results.reference) for run in runs)  # 5 integers of 2 bytes a node
    return int(np.clip((BYTES - fixed) // one, 2, INSTANTS))


def _index(results: Results) -> np.dtype[Any]:
    """The smallest integers that number the nodes."""
    small = len(results.reference) <= np.iinfo(np.uint16).max
    return np.dtype("<u2" if small else "<u4")


def _nearest(results: Results, wanted: Array) -> list[int]:
    return [int(np.argmin(np.abs(results.time - instant))) for instant in wanted]


def _run(run: RunFiles, rows: list[int]) -> dict[str, Any]:
    results = run.results
    dynamic, pressure = results.dynamic_pressure[rows] / 1e3, results.pressure[rows] / 1e3
    quantities = {WHOLE: pressure, STATIC: pressure - dynamic, DYNAMIC: dynamic}
    return {
        "model": run.label,
        "flow": run.has_flow,
        "triangles": _text(results.triangles.astype(_index(results))),
        "wide": _index(results).itemsize == 4,
        "position": _quantised(results.position[rows]),
        "pressure": _quantised(pressure),
        "dynamic": _quantised(dynamic) if run.has_flow else None,
        "range": {name: _range(values) for name, values in quantities.items()},
        "cg": _rounded(results.liquid_cg[rows]),
    }


def _range(values: Array) -> list[float]:
    low, high = np.quantile(values, _SEEN)
    return [round(float(low), 5), round(float(high), 5)]


def _quantised(values: Array) -> dict[str, Any]:
    """16 bit integers and what one of them is worth; off by half of that, 1.5e-5 of the largest."""
    unit = float(np.abs(values).max(initial=0.0)) / _TOP or 1.0
    return {"unit": unit, "values": _text(np.rint(values / unit).astype("<i2"))}


def _rounded(values: Array) -> Any:
    return np.round(values, 5).tolist()


def _text(values: npt.NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _colours(name: str) -> str:
    """256 colours, red, green and blue in bytes."""
    return _text(np.rint(255.0 * colormaps[name](np.arange(256))[:, :3]).astype(np.uint8))
