"""What a fluid model says of itself: all that the other packages ask of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from coupling.ports import Array, HydrostaticLoad, IterativeStructure, TimeStep
from coupling.scene.scene import Scene
from coupling.step.dry import DryStep

Record = Callable[[float, int, float, float], None]


class LoadModel(Protocol):
    """What every model gives: the load that needs no flow."""

    def load(self, body_force: Array, volume: float) -> HydrostaticLoad:
        """The load of ``volume`` [m^3] under ``body_force`` (3,) [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class CoarserScene:
    """A scene on a coarser grid of its liquid.

    ``width``: by which factor the cells are wider; ``order`` of the error in that width.
    """

    scene: Scene
    width: float
    order: float


Law = Callable[[Array], Array]  # of f/f1 (n,) to the shape of an error


def inertia_left_out(ratio: Array) -> Array:
    """r^2 at r = f/f1 ``ratio``: error of a liquid without inertia.

    One mass on a damped spring: driven by accelerations it moves by c = c0/(1 - r^2 + i d r), and
    without its mass and damper by c0; so that |c0 - c|/|c| is r^2 where d is small.
    """
    return np.asarray(ratio**2)


DAMPING = 0.5  # a quarter of the critical one: of 0.2 to 2 the left-out data miss least about here


def inertia_wrong(ratio: Array) -> Array:
    """r^2/|1 - r^2 + i d r|: error of a liquid whose inertia is wrong, per share of that.

    The same mass: the change of log c by that of log m. d is DAMPING.
    """
    return np.asarray(ratio**2 / np.abs(1.0 - ratio**2 + 1j * DAMPING * ratio))


@dataclass(frozen=True, kw_only=True)
class ErrorLaw:
    """How a model's error goes with f/f1, and against what its data were measured.

    ``law`` takes f/f1 (n,) to the error's shape. ``adds_next``: whether the data were measured
    against the next model, whose own error then comes on top.
    """

    law: Law
    adds_next: bool = False


class FluidModel:
    """A fluid model. What stands here is that of a liquid whose pressure needs no flow.

    A model of one's own derives from this, says ``load_model``, and with a flow ``time_step`` and
    what goes with it.
    """

    name: ClassVar[str]
    colour: ClassVar[str] = "#6b757d"  # in plots
    line: ClassVar[Any] = (0, (1, 1))  # matplotlib's line style
    has_flow: ClassVar[bool] = False  # whether it computes p* at all
    has_viscosity: ClassVar[bool] = False
    keeps_volume: ClassVar[bool] = True  # of the liquid, whatever the diaphragm does
    takes_supply: ClassVar[bool] = False  # whether its volume may fall
    settling: ClassVar[float] = 1.0  # CPU time to settle over that with a volume kept
    coarser_text: ClassVar[str] = "half the triangles"  # what ``coarser`` has, for a table
    error_law: ClassVar[ErrorLaw | None] = None  # None: it has no data, and is not advised
    kernels_of: ClassVar[str | None] = None  # a quicker model with the same compiled kernels
    dissipation_note: ClassVar[str] = ""  # what a report's energy table says of its losses
    pressure_note: ClassVar[str] = ""  # what a report says of how the parts of p* are found
    instead: ClassVar[str] = ""  # what to do where its flow fails: "take model.fluid = ..."

    def problems(self, scene: Scene) -> list[str]:
        """One line ``key: what is wrong. Mend.`` for each thing it cannot do of the scene."""
        del scene
        return []

    def load_model(self, scene: Scene) -> LoadModel:
        """The load that needs no flow."""
        raise NotImplementedError

    def time_step(
        self, scene: Scene, cloth: IterativeStructure, folder: Path, record: Record
    ) -> TimeStep:
        """The step of the settled ``cloth`` with this liquid, whose files go to ``folder``.

        ``record`` is called after every coupling iteration with the time [s], the iteration, its
        relative residual and the seconds it took.
        """
        del scene, folder, record
        return DryStep(cloth)

    def check_installed(self, scene: Scene, *, start: bool) -> None:
        """See that the programs it needs are here, and with ``start`` that they work.

        ``RunFailed`` with the cause and the mend where one does not.
        """

    def installed(self) -> Mapping[str, str]:
        """What was found of the programs it needs, for ``edt info``."""
        return {}

    def step_cost(self, scene: Scene, solve: float) -> float:
        """CPU time [s] of a step; ``solve`` [s] is that of the diaphragm's step alone.

        On the machine of ``estimate.cost``, which says how others compare.
        """
        del scene
        return solve

    def start_cost(self, scene: Scene) -> float:
        """CPU time [s] to put the liquid below the settled diaphragm, on that machine."""
        del scene
        return 0.0

    def memory(self, scene: Scene) -> float:
        """Bytes of RAM that the liquid takes at once beside the diaphragm."""
        del scene
        return 0.0

    def cores(self, scene: Scene) -> int:
        """Number of cores that a run keeps busy."""
        del scene
        return 1

    def error_scale(self, scene: Scene) -> float:
        """Its error in this scene over that of the data, as far as its own grid makes it."""
        del scene
        return 1.0

    def coarser(self, scene: Scene) -> CoarserScene | None:
        """The scene on a coarser grid of its liquid; None where its grid is the diaphragm's."""
        del scene
        return None

    def approximations(self, scene: Scene) -> Mapping[str, CoarserScene]:
        """The scene with what else it approximates by alone made worse, by name; for error bars."""
        del scene
        return {}

    def size(self, scene: Scene) -> Mapping[str, int]:
        """Size of the liquid's own grid, by what is counted: {"cells of the flow's mesh": 1216}."""
        del scene
        return {}

    def fields_size(self, scene: Scene) -> float:
        """Bytes on disk that the flow's fields of a run take, 0 where the scene keeps none."""
        del scene
        return 0.0
