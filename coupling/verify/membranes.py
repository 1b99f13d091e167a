"""Wrinkled sheets of revolution: the Mylar balloon, the natural-shape balloon, the hammock."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

import numpy as np

from cloth.flat import disc, disc_pair
from cloth.step import Cloth
from coupling.ports import Array, HydrostaticLoad
from coupling.verify.case import VerifyResult, quantity
from coupling.verify.profiles import hammock_bag, mylar_balloon, natural_balloon
from coupling.verify.sheets import FILM, SLACK, TAUT, bring_to_rest, film_settings, water, within

SECTORS = 4  # per ring: edges along and across the rays are equal at 2/3 of the radius
ITERATIONS = 100
# r T is constant along a meridian, so that the tension at the first ring grows with the rings. The
# penalty is about four times that [N/m]: below twice, the sheet chatters; far above, it crawls.
PENALTY_MYLAR = 1.25  # N/m per ring
PENALTY_BALLOON = 1.25
PENALTY_HAMMOCK = 0.35


def mylar(*, resolution: int = 24) -> VerifyResult:
    """Two flat discs of radius a, joined at the rim and inflated.

    ``resolution``: rings of a disc. ``radius`` of the rim and ``thickness`` between the poles over
    a, ``volume`` over a^3. Of second order in the grid.
    """
    clock = perf_counter()
    within("mylar", "resolution", resolution, 4, 200)
    sectors = SECTORS * resolution
    mesh = disc_pair(1.0, resolution, sectors)
    lower = 1 + sectors * resolution  # the lower pole
    bulge = 0.2 * (1.0 - np.sum(mesh.points**2, axis=1))
    bulge[lower:] *= -1.0
    cloth = Cloth(
        mesh=mesh,
        diaphragm=FILM,
        position=mesh.points + bulge[:, None] * [0.0, 0.0, 1.0],
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=film_settings(PENALTY_MYLAR * resolution, ITERATIONS),
    )
    load = HydrostaticLoad(density=1.0, body_force=np.zeros(3), datum=1.0)
    bring_to_rest("mylar", cloth, load)
    x, exact = cloth.state.position, mylar_balloon()
    rim = slice(lower - sectors, lower)
    return VerifyResult(
        case="mylar",
        options={"resolution": resolution},
        quantities=(
            quantity("radius", float(_radius(x[rim]).mean()), exact.radius),
            quantity("thickness", float(x[0, 2] - x[lower, 2]), exact.thickness),
            quantity("volume", cloth.model.volume(x), exact.volume),
        ),
        wall_s=perf_counter() - clock,
    )


def balloon(*, resolution: int = 24) -> VerifyResult:
    """The weightless balloon of natural shape: two joined discs, held at one pole, p = b z.

    ``resolution``: rings of a disc, whose radius is half the meridian's length l. ``radius`` (at
    the widest) and ``height`` over l, ``volume`` over l^3. Of second order in the grid.
    """
    clock = perf_counter()
    within("balloon", "resolution", resolution, 4, 200)
    sectors = SECTORS * resolution
    mesh = disc_pair(1.0, resolution, sectors)
    nadir = 1 + sectors * resolution
    mesh = replace(mesh, fixed=np.arange(len(mesh.points)) == nadir)
    distance = np.linalg.norm(mesh.points, axis=1)
    start = 0.65 * mesh.points
    start[:nadir, 2] = 0.75 + 0.45 * (1.0 - distance[:nadir])
    start[nadir:, 2] = 0.75 * distance[nadir:]
    cloth = Cloth(
        mesh=mesh,
        diaphragm=FILM,
        position=start,
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=film_settings(PENALTY_BALLOON * resolution, ITERATIONS),
    )
    bring_to_rest("balloon", cloth, water())
    x, exact, length = cloth.state.position, natural_balloon(), 2.0
    return VerifyResult(
        case="balloon",
        options={"resolution": resolution},
        quantities=(
            quantity("radius", _largest(_radius(x[1:nadir:sectors])) / length, exact.radius),
            quantity("height", float(x[0, 2]) / length, exact.height),
            quantity("volume", cloth.model.volume(x) / length**3, exact.volume),
        ),
        wall_s=perf_counter() - clock,
    )


def hammock(*, ratio: float = 0.8, resolution: int = 24) -> VerifyResult:
    """A flat disc of radius a on a ring of radius b = ``ratio`` a, filled to the ring's plane.

    Upside down: the liquid is below the disc and its body force points up. ``resolution``: rings.
    ``depth`` over a, of first order in the grid, ``volume`` over a^3, of second.
    """
    clock = perf_counter()
    within("hammock", "ratio", ratio, 0.3, 0.98)
    within("hammock", "resolution", resolution, 4, 200)
    mesh = disc(1.0, resolution, SECTORS * resolution)
    start = ratio * mesh.points
    start[:, 2] = 0.7 * np.sqrt(1.0 - ratio**2) * (1.0 - np.sum(mesh.points**2, axis=1))
    start[mesh.fixed, 2] = 0.0
    cloth = Cloth(
        mesh=mesh,
        diaphragm=FILM,
        position=start,
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=film_settings(PENALTY_HAMMOCK * resolution, ITERATIONS),
    )
    bring_to_rest("hammock", cloth, water())
    x, exact = cloth.state.position, hammock_bag(ratio)
    return VerifyResult(
        case="hammock",
        options={"ratio": ratio, "resolution": resolution},
        quantities=(
            quantity("depth", float(x[0, 2]), exact.depth),
            quantity("volume", cloth.model.volume(x), exact.volume),
        ),
        wall_s=perf_counter() - clock,
    )


def _radius(points: Array) -> Array:
    return np.asarray(np.linalg.norm(points[:, :2], axis=1))


def _largest(values: Array) -> float:
    """Of the parabola through the largest of equidistant ``values`` (n,) and its neighbours."""
    k = min(max(int(values.argmax()), 1), len(values) - 2)
    before, middle, after = values[k - 1 : k + 2]
    return float(middle - (after - before) ** 2 / (8.0 * (after - 2.0 * middle + before)))
