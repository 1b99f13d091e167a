"""Makes ``record.csv``: what a logger on the bed of a lorry shows that brakes to a stop.

    python foam_cases/lorry/record.py

The lorry is a body on two axles with linear springs and dampers: surge, heave and pitch. x points
forward, y left, z up; pitch is right-handed about y, so that a positive one is nose down. The
logger is fixed to the body and shows, in the body's own axes, what an accelerometer and a gyroscope
do: R^T (a - g) in g and the angular rates in degrees a second, with five digits.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

MASS, INERTIA = 8000.0, 20_000.0  # kg, kg m^2 about y, on the springs
AXLES = np.array([2.2, -2.8])  # m before the centre of mass
HEIGHT = 1.3  # m of the centre of mass above the road
SPRINGS, DAMPERS = np.array([1.4e5, 1.2e5]), np.array([7e3, 6e3])  # N/m, N s/m of each axle
BRAKING, BEGIN, END, EDGE = 5.0, 0.5, 2.5, 0.2  # m/s^2, s; the brakes come on and go within EDGE
LOGGER = np.array([-1.0, 0.0, 0.1])  # m from the centre of mass, in the body's axes
TANK = LOGGER + np.array([-0.4, 0.0, 0.6])  # the middle of the tank's rim
G, RATE, LENGTH = 9.80665, 200.0, 6.0  # m/s^2, Hz, s


def braking(time: float) -> float:
    """Of the wheels [m/s^2], backwards."""
    on, off = np.clip((time - BEGIN) / EDGE, 0.0, 1.0), np.clip((time - END) / EDGE, 0.0, 1.0)
    return float(BRAKING * (on**2 * (3.0 - 2.0 * on) - off**2 * (3.0 - 2.0 * off)))


def accelerations(time: float, state: np.ndarray) -> tuple[float, float]:
    """Of heave [m/s^2] and pitch [rad/s^2]; ``state``: heave, pitch and their rates."""
    heave, pitch, rise, turn = state
    force = -SPRINGS * (heave - AXLES * pitch) - DAMPERS * (rise - AXLES * turn)
    moment = -float(AXLES @ force) + MASS * braking(time) * HEIGHT
    return float(force.sum()) / MASS, moment / INERTIA


def history(time: np.ndarray) -> np.ndarray:
    """Heave, pitch and their rates (k, 4) of a lorry that rolls evenly until it brakes."""
    found = solve_ivp(
        lambda t, y: np.concatenate([y[2:], accelerations(t, y)]), (0.0, time[-1]), np.zeros(4),
        t_eval=time, rtol=1e-9, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    return np.asarray(found.y.T)


def acceleration_of(place: np.ndarray, time: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Of a ``place`` of the body (3,) [m], in the road's axes (k, 3) [m/s^2]."""
    found = []
    for instant, state in zip(time, states, strict=True):
        lift, twist = accelerations(instant, state)
        rate, turned = np.array([0.0, state[3], 0.0]), np.array([0.0, twist, 0.0])
        lever = np.cross(turned, place) + np.cross(rate, np.cross(rate, place))
        found.append(np.array([-braking(instant), 0.0, lift]) + attitude(state[1]) @ lever)
    return np.array(found)


def attitude(pitch: float) -> np.ndarray:
    """R (3, 3) of a ``pitch`` [rad]: from the body's axes to the road's."""
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def shown(time: np.ndarray) -> np.ndarray:
    """What the logger shows (k, 6): accelerations [g] and angular rates [degrees/s]."""
    states = history(time)
    felt = acceleration_of(LOGGER, time, states)
    felt[:, 2] += G
    felt = np.array([a @ attitude(state[1]) for a, state in zip(felt, states, strict=True)])
    rates = np.zeros_like(felt)
    rates[:, 1] = np.degrees(states[:, 3])
    return np.column_stack([felt / G, rates])


def main() -> None:
    """Write the record beside this file."""
    time = np.arange(round(LENGTH * RATE) + 1) / RATE
    file = Path(__file__).with_name("record.csv")
    lines = ["time [s],ax [g],ay [g],az [g],wx [deg/s],wy [deg/s],wz [deg/s]"]
    lines += [
        f"{t:.3f}," + ",".join(f"{value:.5f}" for value in row)
        for t, row in zip(time, shown(time), strict=True)
    ]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
