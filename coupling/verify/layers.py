"""Laminar boundary layers of a small slosh: what they take, on a mesh that resolves them."""

from __future__ import annotations

import tempfile
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from coupling.estimate.sloshing_modes import lateral_eigenvalue, lateral_heights, layer_slip
from coupling.finite_volume.blocks import Divisions
from coupling.finite_volume.mesh import LiquidMesh, half_ball
from coupling.finite_volume.swept import swept_gradient
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.fluids.potential.wall_layers import layer_speed
from coupling.foam.installation import find_openfoam
from coupling.motion.sine import smooth_ramp
from coupling.verify.case import VerifyResult, quantity
from coupling.verify.level_tank import DENSITY, GRAVITY, RADIUS, level_shape, level_tank
from coupling.verify.sheets import within

AMPLITUDE = 1e-4  # over R: a tenth of the lowest cells that are taken here
RAMP, PERIODS = 1.0, 2.0  # of soft start, and in all: the last one is evaluated


def layers(
    *, viscosity: float = 1e-5, spacing: float = 0.0015, step: float = 0.01, resolution: int = 2700
) -> VerifyResult:
    """Energy ``loss`` a period and ``lambda`` = omega^2 R/g of a slosh in a half-full ball.

    The surface, a wall that does not move along itself, is led through the first lateral mode's
    shape, and the flow's pressure on it is split into the mode's inertia and its damping: no
    coupling. ``viscosity`` [m^2/s]; ``spacing``: height of the wall cells over R, 0 for even ones;
    ``step`` [s]; ``resolution``: cells of the mesh.

    ``loss`` is that of Stokes's layers, 2 pi sqrt(nu/(2 omega))/R times what ``layer_slip`` has of
    ball and surface; corrections are of order sqrt(nu/omega)/R of it, and ``backward`` adds
    pi (omega dt)^3. The mesh's error is of second order in the spacing over the layer's thickness
    sqrt(2 nu/omega): 7.4, 5.5 and 2.7 % at spacings of 1.08, 0.72 and 0.36 times that, steps' 1.2 %
    included. The layer's own inertia lowers ``lambda`` by ``loss``/(2 pi), which is taken into
    account; ``backward`` takes 2/3 (omega dt)^2 of it, 0.23 % at 10 ms.
    """
    clock = perf_counter()
    eigenvalue = lateral_eigenvalue(1.0, 1)
    omega = float(np.sqrt(eigenvalue * GRAVITY / RADIUS))
    within("layers", "viscosity", viscosity, 1e-9, 1e-3)
    within("layers", "spacing", spacing, 0.0, 0.2)
    within("layers", "step", step, 1e-4, 0.1 * np.pi / omega)
    least = Divisions.of(4, spacing).cells  # with four cells across the mesh's inner cube
    within("layers", "resolution", resolution, least, 100_000)
    rate = layer_speed(viscosity, omega / (2.0 * np.pi)) * sum(layer_slip(1.0, 1)) / RADIUS
    loss = 2.0 * np.pi / omega * rate
    with tempfile.TemporaryDirectory() as folder:
        led = _led(Path(folder), half_ball(resolution, spacing), omega, step, viscosity)
    return VerifyResult(
        case="layers",
        options={
            "viscosity": viscosity,
            "spacing": spacing,
            "step": step,
            "resolution": resolution,
        },
        quantities=(
            quantity("loss", 2.0 * np.pi * led.damping / (omega * led.inertia), loss),
            quantity(
                "lambda",
                led.stiffness / led.inertia * RADIUS / GRAVITY,
                eigenvalue / (1.0 + loss / (2.0 * np.pi)),
            ),
        ),
        wall_s=perf_counter() - clock,
    )


@dataclass(frozen=True, kw_only=True)
class LedMode:
    """Of a mode that the surface is led through: what resists its amplitude.

    ``stiffness`` [N/m] of gravity, ``damping`` [N s/m] and ``inertia`` [kg] of the liquid, all of
    heights whose largest is 1.
    """

    stiffness: float
    damping: float
    inertia: float


def _led(folder: Path, mesh: LiquidMesh, omega: float, step: float, viscosity: float) -> LedMode:
    """Lead the surface through the mode at ``omega`` [1/s], and fit the pressure on it."""
    flow = OpenFoamFlow(
        folder, mesh, openfoam=find_openfoam(keep_alive=True), shell=level_tank("sphere"),
        density=DENSITY, viscosity=viscosity, timeout=120.0,
    )  # fmt: skip
    level, shell, path, volume = level_shape(mesh, level_tank("sphere"), 0.0)
    distance = np.linalg.norm(level[:, :2], axis=1)
    shape = lateral_heights(1.0, 1, distance / distance.max())
    shape = shape * level[:, 0] / np.maximum(distance, 1e-12)
    lift = shape[:, None] * path
    gradient = swept_gradient(level[flow.faces])  # of the faces' volumes, by their corners' places
    swept = np.einsum("fkx,fkx->f", gradient, lift[flow.faces])
    area = gradient[..., 2].sum(axis=1)
    count = round(PERIODS * 2.0 * np.pi / (omega * step))
    push, motion = np.zeros(count), np.zeros((count, 2))
    with closing(flow):
        flow.start(level, shell, volume)
        for number in range(count):
            time = (number + 1) * step
            risen, _, _ = smooth_ramp(time, RAMP * 2.0 * np.pi / omega)
            height = AMPLITUDE * RADIUS * risen * np.sin(omega * time)
            flow.begin_step(number * step, step)
            push[number] = flow.solve(flow.close_volume(level + height * lift)) @ swept
            flow.accept_step()
            motion[number] = np.sin(omega * time), np.cos(omega * time)
    last = slice(count - round(2.0 * np.pi / (omega * step)), None)
    (inertial, viscous), *_ = np.linalg.lstsq(motion[last], push[last], rcond=None)
    size = AMPLITUDE * RADIUS
    return LedMode(
        stiffness=DENSITY * GRAVITY * float(swept**2 @ (1.0 / area)),
        damping=-float(viscous) / (size * omega),
        inertia=float(inertial) / (size * omega**2),
    )
