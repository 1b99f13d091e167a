"""Narrow strips: the lintearia, full of water, and the chain, swinging."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter

import numpy as np
from scipy.optimize import least_squares
from scipy.special import j0, j1

from cloth.flat import strip
from cloth.mesh import Mesh, rest_gradients
from cloth.step import Cloth
from coupling.ports import Array, HydrostaticLoad
from coupling.verify.case import VerifyResult, quantity
from coupling.verify.mirrored import MirroredCloth
from coupling.verify.profiles import chain_root, lintearia_sheet
from coupling.verify.sheets import FILM, SLACK, TAUT, bring_to_rest, film_settings, water, within

GRAVITY = 9.81
AMPLITUDE = 1e-3  # of the free end, over L: the linear theory errs by its square
ITERATIONS = 400  # per step: what fewer leave unconverged grows from step to step
FIRST_ITERATIONS = 2000  # of the first step, in which the chain's tension builds up from nothing


def _narrow(length: float, segments: int) -> Mesh:
    """Two rows of equilateral triangles."""
    return strip(length, math.sqrt(3.0) * length / segments, segments)


def lintearia(*, length_ratio: float = 1.5, resolution: int = 24) -> VerifyResult:
    """A strip of length L = ``length_ratio`` 2 a between pins 2 a apart, filled to the pins.

    Upside down: the liquid is below and its body force points up. ``resolution``: segments.
    ``sag`` over a and ``area`` of the liquid's section over a^2, of the strip's middle line;
    ``tension`` over rho g a^2, the mean of the whole strip. With free edges such a sheet rolls
    over, whatever its width: it is held to its mirror symmetry. Of second order in the grid.
    """
    clock = perf_counter()
    within("lintearia", "length-ratio", length_ratio, 1.01, 5.0)
    within("lintearia", "resolution", resolution, 6, 1000)
    length = 2.0 * length_ratio
    mesh = _narrow(length, resolution)
    along = mesh.points[:, 0] / length
    start = mesh.points.copy()
    start[:, 0] = 2.0 * along - 1.0
    start[:, 2] = 2.8 * math.sqrt(length_ratio**2 - 1.0) * along * (1.0 - along)
    exact = lintearia_sheet(length_ratio)
    cloth = MirroredCloth(
        mesh=mesh,
        diaphragm=FILM,
        position=start,
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=film_settings(10.0 * exact.tension, 200),
    )
    bring_to_rest("lintearia", cloth, water())
    line = np.flatnonzero(np.abs(mesh.points[:, 1]) < 1e-9 * length)
    x = cloth.state.position[line[np.argsort(mesh.points[line, 0])]]
    area = float(np.sum(0.5 * (x[1:, 2] + x[:-1, 2]) * np.diff(x[:, 0])))
    return VerifyResult(
        case="lintearia",
        options={"length_ratio": length_ratio, "resolution": resolution},
        quantities=(
            quantity("sag", float(x[:, 2].max()), exact.sag),
            quantity("tension", _mean_tension(cloth), exact.tension),
            quantity("area", area, exact.area),
        ),
        wall_s=perf_counter() - clock,
    )


def _mean_tension(cloth: Cloth) -> float:
    """Virial of the tension over the moulded area [N/m]: T where it acts in one direction."""
    gradients, areas = rest_gradients(cloth.reference, cloth.triangles)
    stretch = np.einsum("tid,tie->tde", cloth.state.position[cloth.triangles], gradients)
    virial = np.einsum("tde,tde->t", cloth.save()["tension"], stretch)
    return float(np.sum(areas * virial) / np.sum(areas))


def chain(*, mode: int = 1, step: float = 0.005, resolution: int = 48) -> VerifyResult:
    """A narrow strip of length L = 1 m, hung at one end, released from its n-th mode's shape.

    ``mode`` n; ``step`` [s]; ``resolution``: segments. ``frequency`` is omega sqrt(L/g), of one
    period. The error is of second order in the grid, and -(omega dt)^2/3 in the step. The strip is
    held to its mirror symmetry: its sway in its own plane, undamped, would grow from rounding.
    """
    clock = perf_counter()
    within("chain", "mode", mode, 1, 6)
    within("chain", "resolution", resolution, 6, 1000)
    exact = 0.5 * chain_root(mode)
    omega = exact * math.sqrt(GRAVITY)
    within("chain", "step", step, 2e-3, 0.2 * math.pi / omega)  # at most a tenth of the period
    time, signal = _swing(mode, step, resolution, 2.0 * math.pi / omega)
    return VerifyResult(
        case="chain",
        options={"mode": mode, "step": step, "resolution": resolution},
        quantities=(
            quantity("frequency", _frequency(time, signal, omega) / math.sqrt(GRAVITY), exact),
        ),
        wall_s=perf_counter() - clock,
    )


def _swing(mode: int, step: float, segments: int, duration: float) -> tuple[Array, Array]:
    """Times (T,) [s] and the mode's share (T,) [-] of the deflection after the release."""
    mesh = _narrow(1.0, segments)
    mesh = replace(mesh, fixed=mesh.points[:, 0] == 0.0)
    start, shape = _released(mesh.points, chain_root(mode))
    settings = film_settings(10.0 * GRAVITY, ITERATIONS)
    cloth = MirroredCloth(
        mesh=mesh,
        diaphragm=replace(FILM, density=1.0),
        position=start,
        tensile_stiffness=TAUT,
        compressive_stiffness=SLACK,
        settings=settings,
    )
    first = replace(settings, iterations=FIRST_ITERATIONS)
    load = HydrostaticLoad(density=0.0, body_force=np.array([GRAVITY, 0.0, 0.0]), datum=0.0)
    none = np.zeros_like(start)
    weight = cloth.mass * shape / float(cloth.mass @ (shape * start[:, 2]))
    signal = [1.0]
    steps = math.ceil(duration / step)
    for number in range(steps):
        cloth.begin_step(step, load, settings=first if number == 0 else None)
        cloth.solve(none)
        cloth.accept_step()
        signal.append(float(weight @ cloth.state.position[:, 2]))
    return np.linspace(0.0, step * steps, steps + 1), np.array(signal)


def _released(points: Array, root: float) -> tuple[Array, Array]:
    """Positions (n, 3) [m] of the strip in the mode's shape, inextensible, and the shape (n,)."""
    s = np.linspace(0.0, 1.0, 20001)  # from the free end
    inner = root * np.sqrt(np.maximum(s, 1e-12))
    slope = -AMPLITUDE * 0.5 * root**2 * j1(inner) / inner
    drop = np.sqrt(1.0 - slope**2)
    height = np.concatenate([[0.0], np.cumsum(0.5 * (drop[1:] + drop[:-1]) * np.diff(s))])
    own = 1.0 - points[:, 0]
    shape = np.asarray(j0(root * np.sqrt(np.maximum(own, 0.0))))
    start = points.copy()
    start[:, 0] = height[-1] - np.interp(own, s, height)
    start[:, 2] = AMPLITUDE * shape
    start[points[:, 0] == 0.0, ::2] = 0.0
    return start, shape


def _frequency(time: Array, signal: Array, omega: float) -> float:
    """omega [1/s] of the damped cosine fitted to ``signal``."""

    def misfit(parameters: Array) -> Array:
        turn, damping = parameters * omega
        decay = np.exp(-damping * time)
        basis = np.array([decay * np.cos(turn * time), decay * np.sin(turn * time)]).T
        return np.asarray(basis @ np.linalg.lstsq(basis, signal, rcond=None)[0] - signal)

    return float(least_squares(misfit, np.array([1.0, 0.0])).x[0]) * omega
