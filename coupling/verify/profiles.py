"""Exact shapes of inextensible sheets that are free to wrinkle, and of a hanging chain.

A wrinkled sheet of revolution carries tension along its meridians alone. Without weight, r T is
constant along a meridian and the pressure bends it: with p = rho g z and C = r T/(rho g),
theta' = r z/C, where theta is the angle to the horizontal and ' the derivative along the meridian.
This is integrated with C = 1, which only sets the unit of length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk, gamma, jn_zeros

from coupling.ports import Array


@dataclass(frozen=True, kw_only=True)
class Mylar:
    """Dimensions of the Mylar balloon over the radius a of its flat discs.

    ``radius`` and ``thickness`` over a, ``volume`` over a^3.
    """

    radius: float
    thickness: float
    volume: float


def mylar_balloon() -> Mylar:
    """Two flat discs joined at the rim and inflated (Paulsen, Amer. Math. Monthly 101, 1994).

    r/a = 4 sqrt(2 pi)/Gamma(1/4)^2, thickness pi/2 (r/a)^2 a, volume 2 pi/3 (r/a)^2 a^3.
    """
    radius = 4.0 * math.sqrt(2.0 * math.pi) / float(gamma(0.25)) ** 2
    return Mylar(
        radius=radius,
        thickness=0.5 * math.pi * radius**2,
        volume=2.0 / 3.0 * math.pi * radius**2,
    )


def _meridian(z: float, theta: float, *, rising: bool) -> tuple[float, Array, Array]:
    """From the axis, at ``z`` and ``theta``, until r (``rising``) or z (not so) falls to zero.

    Length, the end (r, z, theta, volume) and r at 20001 equal steps; r' = cos(theta),
    z' = sin(theta) if z is a height, ``rising``, and -sin(theta) if it is a depth,
    volume' = pi r^2 sin(theta).
    """

    def slope(_: float, y: Array) -> list[float]:
        r, height, angle = y[:3]
        up = math.sin(angle)
        return [math.cos(angle), up if rising else -up, r * height, math.pi * r * r * up]

    def stop(_: float, y: Array) -> float:
        return float(y[0 if rising else 1])

    stop.terminal, stop.direction = True, -1.0  # type: ignore[attr-defined]
    path = solve_ivp(
        slope, (0.0, 50.0), [0.0, z, theta, 0.0], rtol=1e-11, atol=1e-12, events=stop,
        dense_output=True,
    )  # fmt: skip
    assert path.t_events is not None
    assert path.y_events is not None
    assert path.sol is not None
    length = float(path.t_events[0][0])
    return length, path.y_events[0][0], path.sol(np.linspace(0.0, length, 20001))[0]


@dataclass(frozen=True, kw_only=True)
class Balloon:
    """Dimensions of the balloon of natural shape over the length l of its meridian.

    Largest ``radius`` and ``height`` over l, ``volume`` over l^3.
    """

    radius: float
    height: float
    volume: float


@cache
def natural_balloon() -> Balloon:
    """The weightless balloon of natural shape: p grows with height from 0 at the nadir.

    The payload hangs at the nadir; at the top, where r = 0 again, the sheet is level, which is
    what the slope at the nadir is sought for.
    """

    def slope_at_top(theta: float) -> float:
        return float(_meridian(0.0, theta, rising=True)[1][2]) - math.pi

    theta = float(brentq(slope_at_top, 0.4, 1.0, xtol=1e-13))
    length, end, radii = _meridian(0.0, theta, rising=True)
    return Balloon(
        radius=float(radii.max()) / length,
        height=float(end[1]) / length,
        volume=float(end[3]) / length**3,
    )


@dataclass(frozen=True, kw_only=True)
class Hammock:
    """Dimensions of a disc hung from a ring over the radius a of the flat disc.

    ``depth`` over a, ``volume`` over a^3.
    """

    depth: float
    volume: float


@cache
def hammock_bag(ratio: float) -> Hammock:
    """A flat disc of radius a hung from a ring of radius ``ratio`` a, filled to the ring's plane.

    z is the depth below the ring. ``ratio`` in (0.2, 0.999); others are not checked.
    """

    def too_wide(depth: float) -> float:
        length, end, _ = _meridian(depth, 0.0, rising=False)
        return float(end[0]) / length - ratio

    depth = float(brentq(too_wide, 0.05, 1.9, xtol=1e-13))
    length, end, _ = _meridian(depth, 0.0, rising=False)
    # The ring carries the liquid: V = 2 pi C sin(theta) there.
    volume = 2.0 * math.pi * math.sin(float(end[2]))
    return Hammock(depth=depth / length, volume=volume / length**3)


@dataclass(frozen=True, kw_only=True)
class Lintearia:
    """Dimensions of a sheet full of water between pins that are 2 a apart.

    ``sag`` over a, ``tension`` over rho g a^2, ``area`` over a^2.
    """

    sag: float
    tension: float
    area: float


def lintearia_sheet(length_ratio: float) -> Lintearia:
    """A cylindrical sheet of length L = ``length_ratio`` 2 a > 2 a, filled to its pins.

    Euler's elastica: k = sin(alpha/2), l^2 = T/(rho g): L = 2 l K(k), 2 a = 2 l (2 E(k) - K(k)),
    sag = 2 k l, area = 2 l^2 sin(alpha).
    """

    def half_span(m: float) -> float:  # over l, with m = k^2
        return float(2.0 * ellipe(m) - ellipk(m))

    closed = float(brentq(half_span, 0.5, 0.99, xtol=1e-15))
    m = float(brentq(lambda m: ellipk(m) - length_ratio * half_span(m), 0.0, closed, xtol=1e-15))
    k, scale = math.sqrt(m), 1.0 / half_span(m)
    return Lintearia(
        sag=2.0 * k * scale,
        tension=scale**2,
        area=2.0 * scale**2 * math.sin(2.0 * math.asin(k)),
    )


def chain_root(mode: int) -> float:
    """Return j_0n: a hanging chain swings as J_0(j_0n sqrt(s/L)), s from its free end."""
    return float(jn_zeros(0, mode)[-1])
