"""How it is simulated: the sections of a scene on grids, coupling and time.

Descriptions complete the sentence "Give the ...", as in ``sections``.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from cloth.thesis.grid import SIZE
from coupling.scene.choices import best_scheme, one_of, schemes
from coupling.scene.sections import Section

MOST_RINGS = 200
MOST_PROCESSORS = 256
FEWEST_STEPS_A_PERIOD = 20
MOST = 1_000_000  # of what is counted: no run comes near it
_WHOLE = 1e-3  # steps: what a number of a few digits may miss a whole one by


class Cloth(Section):
    """The diaphragm's mesh and solver.

    ``grid = "thesis"`` is the thesis' own square grid and explicit algorithm, to be measured
    against; of the settings here it takes ``resolution`` only.
    """

    resolution: int = Field(
        default=24,
        ge=4,
        le=MOST_RINGS,
        description='number of rings of triangles; with grid = "thesis" the even number of nodes '
        "across its square, the thesis' 26 if left out",
    )
    grid: Literal["rings", "thesis"] = Field(
        default="rings", description='grid: "rings" or "thesis"'
    )
    wrinkling: Literal["relaxed", "resolved"] = Field(
        default="relaxed",
        description='wrinkling model: "relaxed" (folds below the grid) or "resolved" (by the '
        "rubber's own stiffness, on a grid that is fine enough)",
    )
    tolerance: float = Field(
        default=1e-5,
        gt=0,
        lt=0.01,
        description="rms displacement over the radius that a solve may leave; less in a step that "
        "moves the sheet by little",
    )
    iterations: int = Field(
        default=1000, ge=20, le=100000, description="inner iterations of a solve, at most"
    )
    stiffness: float = Field(
        default=100.0,
        ge=10,
        le=10000,
        description="tensile stiffness of an inextensible sheet over rho b R^2, of the largest "
        "body force b",
    )
    fold_damping: float = Field(
        default=5.0,
        ge=0,
        description="bending moment per rate over that per curvature, over sqrt(R/g); stands for "
        "folds below the grid",
    )
    slack_drag: float = Field(
        default=20.0, ge=0, description="rate of slack cloth's tangential drag, over sqrt(g/R)"
    )

    @model_validator(mode="before")
    @classmethod
    def _size_of_thesis(cls, given: Any) -> Any:
        if not isinstance(given, dict) or given.get("grid") != "thesis":
            return given
        return {"resolution": SIZE} | given

    @property
    def rings(self) -> float:
        """Spacings from the pole to the rim: half the nodes across where the grid is square."""
        return self.resolution / 2.0 if self.grid == "thesis" else self.resolution


class Potential(Section):
    """The irrotational liquid's unknowns; read only when ``model.fluid`` is ``potential``."""

    degree: int = Field(
        default=8, ge=2, le=14, description="degree of the potential's harmonic polynomials"
    )


class OpenFoam(Section):
    """The flow solver and its mesh; read only when ``model.fluid`` is ``openfoam``."""

    command: str = Field(
        default="pimpleFoam", min_length=1, description="solver: a name on PATH or a path"
    )
    cells: int = Field(
        default=1300,
        ge=176,
        le=MOST,
        description="cells of the mesh, at most: it has 176, 540, 1216, 2300, 4320, 6664 and so "
        "on; in a tank that is longer than wide and stands more of them lie along it and fewer "
        "across",
    )
    wall_spacing: float = Field(
        default=0.0,
        ge=0,
        description="height of the cells at shell and diaphragm [m], at most, in the half ball "
        "that the mesh is made from; more layers are taken, of growing height; 0 for even cells",
    )
    keep_alive: bool = Field(
        default=True,
        description="value false to restart the stock solver every iteration, also where the one "
        "that stays alive has been built",
    )
    processors: int = Field(
        default=1, ge=1, le=MOST_PROCESSORS, description="number of processes of the flow solver"
    )
    write_fields: bool = Field(
        default=False,
        description="value true to keep the flow's U [m/s] and p [m^2/s^2], p*/rho beyond "
        "hydrostatics, in foam/ at the times of output; case.foam opens them in ParaView",
    )
    timeout: float = Field(default=120.0, gt=0, description="longest wait for one solver call [s]")


class Coupling(Section):
    """How diaphragm and flow are made to agree within a step."""

    scheme: Annotated[str, one_of(schemes)] = Field(
        default_factory=best_scheme,
        description="name of a coupling scheme, for a fluid model that iterates",
    )
    tolerance: float = Field(default=1e-3, gt=0, lt=1, description="relative residual to reach")
    max_iterations: int = Field(default=30, ge=1, le=MOST, description="most iterations of a step")
    reuse: int = Field(
        default=8, ge=0, le=MOST, description="number of past steps that iqn-ils reuses"
    )
    max_unconverged: int = Field(
        default=5,
        ge=0,
        le=MOST,
        description="number of unconverged steps after which the run stops",
    )
    max_unconverged_share: float = Field(
        default=0.2,
        ge=0,
        le=1,
        description="share of a run's steps that may be unconverged: it stops where more are, "
        "however few; 1 to leave that to max_unconverged",
    )
    relaxation: float = Field(
        default=0.01, gt=0, le=1, description="first relaxation of aitken and iqn-ils"
    )


class Time(Section):
    """Steps and output. Time 0 is the settled state; the shaking starts there.

    ``periods`` and ``steps_per_period`` may be given in place of ``duration`` and ``step``. The
    scene turns them into those two (``periods``), so they are None in every valid scene.
    """

    settle: float = Field(
        default=1.0,
        ge=0,
        le=1000,
        description="time that the thesis' diaphragm moves before time 0 [s]; any other comes to "
        "rest without a clock",
    )
    settle_tolerance: float = Field(
        default=1e-6,
        gt=0,
        lt=0.1,
        description="force that settling may leave on the diaphragm, over rho g R^3; more than "
        "the default starts one that never comes to rest (heavy, or with its folds resolved)",
    )
    duration: float = Field(
        gt=0,
        description="simulated time after settling [s], reached in whole steps",
        json_schema_extra={"instead": "the periods of a sine to simulate"},
    )
    step: float = Field(default=0.005, gt=0, description="time step [s]")
    step_tolerance: float | None = Field(
        default=None,
        gt=0,
        lt=0.1,
        description="rms error of the diaphragm over R that a step's length may add; where it adds "
        "more, as in slams, the step is taken in parts, down to an eighth; without it all steps "
        "are whole unless they fail",
    )
    output_every: int = Field(
        default=4,
        ge=1,
        le=MOST,
        description="number of steps between instants at which what is over the diaphragm's nodes "
        "and triangles is written out; no figure of the summary depends on it",
    )
    checkpoint_every: int | None = Field(
        default=None,
        ge=1,
        le=MOST,
        description="largest number of steps between checkpoints, which are taken as often as 2 % "
        "of the wall time allows in any case",
    )
    periods: float | None = Field(
        default=None, gt=0, description="number of the sine's periods to simulate"
    )
    steps_per_period: int | None = Field(
        default=None,
        ge=FEWEST_STEPS_A_PERIOD,
        le=MOST,
        description=f"number of steps in a period of the sine, {FEWEST_STEPS_A_PERIOD} or more",
    )

    @property
    def steps(self) -> int:
        """Number of whole steps that reach the duration, to a thousandth of a step."""
        return max(1, math.ceil(self.duration / self.step - _WHOLE))

    @property
    def end(self) -> float:
        """Time at the end of the last step [s]."""
        return self.steps * self.step

    @property
    def beyond(self) -> str:
        """What a user should know where the last step ends after the duration; else empty."""
        if abs(self.duration / self.step - self.steps) <= _WHOLE:
            return ""
        return (
            f"time.duration: {self.duration:g} s is no whole number of steps of {self.step:g} s: "
            f"{self.steps} are computed, to {self.end:g} s."
        )
