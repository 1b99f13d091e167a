"""Where and how far the rubber has rubbed, how hard, and what that may wear off."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from coupling.metrics.bernoulli import node_areas
from coupling.metrics.places import degrees_of, mould_angles, shell_angles
from coupling.ports import Array, Ints
from coupling.store.results import Results

LEAST = 1e-5  # slip over the rim's radius that is none: what a solve may leave by default
KINDS = ("shell", "self")  # what the sheet rubs on, as ``Results`` names it
# What ``summary.json`` has of each kind.
_SLIP = ("slip_max_m", "slip_mean_m", "slip_place_deg")
_WORK = ("work_max_J_per_m2", "work_mean_J_per_m2", "work_place_deg", "rubbing_pressure_Pa")


@dataclass(frozen=True, kw_only=True)
class Rub:
    """What has gathered over the whole diaphragm: ``largest``, ``mean``, where the largest is.

    Slips [m] or their work per area [J/m^2]. ``node``: the largest's; ``place`` [degrees]: polar
    angle from the moulded pole, azimuth in [0, 360) from x to y.
    """

    largest: float
    mean: float
    node: int
    place: tuple[float, float]


def rub(gathered: Array, reference: Array, triangles: Ints, least: float) -> Rub | None:
    """Return the largest and the mean of the nodes' slips or works, and where the largest is.

    Parameters
    ----------
    gathered
        Distance that each node has slid (n,) [m], or its work per area [J/m^2].
    reference
        Nodes of the moulded sheet (n, 3) [m], its pole on the z axis.
    triangles
        Nodes of each triangle (m, 3).
    least
        What counts as nothing, in the unit of ``gathered``.

    Returns
    -------
    Rub or None
        Largest, mean and a place [degrees]; None where nothing is above ``least``.

    Notes
    -----
    In the mean a node counts with a third of its triangles' moulded area: exact for a slip that is
    linear in each triangle. Of equal largest ones the first is taken.
    """
    node = int(np.argmax(gathered))
    largest = float(gathered[node])
    if not largest > least:
        return None
    area = node_areas(reference[None], triangles)[0]
    return Rub(
        largest=largest,
        mean=float(gathered @ area / area.sum()),
        node=node,
        place=degrees_of(*mould_angles(reference[node])),
    )


def rub_summary(results: Results, wear: tuple[float, float] | None) -> dict[str, Any]:
    """Return what ``summary.json`` says of the rubs on the shell and of the sheet on itself.

    Parameters
    ----------
    results
        A run's results, of which the last instant has all that has gathered.
    wear
        Least and largest wear coefficient [m^2/N], None where it is not known.

    Returns
    -------
    dict
        ``shell_...`` and ``self_...``: slips, their works and where the largest are, null where
        nothing slid; ``rubbing_pressure_Pa``, the mean over the way at the place of the largest
        work; ``shell_work_on_shell_deg``, where on the shell that was done, from its lower pole;
        ``wear_max_m``, least and largest depth worn off there, null without a coefficient.
    """
    found: dict[str, Any] = {}
    for kind in KINDS:
        found |= {f"{kind}_{name}": value for name, value in _of_kind(results, kind, wear).items()}
    return found


def _of_kind(results: Results, kind: str, wear: tuple[float, float] | None) -> dict[str, Any]:
    on_shell = kind == "shell"
    names = (*_SLIP, *_WORK, *(("work_on_shell_deg",) if on_shell else ()), "wear_max_m")
    found: dict[str, Any] = dict.fromkeys(names)
    if not len(results.time):
        return found
    slip, work = (getattr(results, f"{kind}_{what}")[-1] for what in ("slip", "work"))
    reference, triangles = results.reference, results.triangles
    least = LEAST * float(np.hypot(reference[:, 0], reference[:, 1]).max())
    slid = rub(slip, reference, triangles, least)
    if slid is None:
        return found
    found |= dict(zip(_SLIP, (slid.largest, slid.mean, slid.place), strict=True))
    done = rub(np.where(slip > least, work, 0.0), reference, triangles, least=0.0)
    if done is None:
        return found
    pressure = done.largest / float(slip[done.node])
    found |= dict(zip(_WORK, (done.largest, done.mean, done.place, pressure), strict=True))
    if on_shell:
        found["work_on_shell_deg"] = degrees_of(*shell_angles(results.rub_place[-1][done.node]))
    if wear is not None:
        found["wear_max_m"] = [coefficient * done.largest for coefficient in wear]
    return found
