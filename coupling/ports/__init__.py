"""What the parts of a coupled run promise each other.

Data flows one way: scene -> structure | liquid -> coupled step -> results. Every seam stands here,
so that a participant, a fluid or a scheme can be replaced without touching the others.
"""

from __future__ import annotations

from coupling.ports.arrays import AnyArray, Array, Ints
from coupling.ports.failures import Cause, RunFailed, StepFailed
from coupling.ports.flow import (
    Flow,
    FlowSample,
    InterfaceMotion,
    LiquidInertia,
    LiquidSample,
)
from coupling.ports.scheme import Scheme, SchemeSettings
from coupling.ports.step import AT_REST, StepReport, TimeStep
from coupling.ports.structure import (
    DiaphragmState,
    HydrostaticLoad,
    IterativeStructure,
    Recoil,
    Rotor,
    Structure,
    StructureState,
)
from coupling.ports.turn import Turn
from coupling.ports.walls import Confinement, OnRays, Shell

__all__ = [
    "AT_REST",
    "AnyArray",
    "Array",
    "Cause",
    "Confinement",
    "DiaphragmState",
    "Flow",
    "FlowSample",
    "HydrostaticLoad",
    "InterfaceMotion",
    "Ints",
    "IterativeStructure",
    "LiquidInertia",
    "LiquidSample",
    "OnRays",
    "Recoil",
    "Rotor",
    "RunFailed",
    "Scheme",
    "SchemeSettings",
    "Shell",
    "StepFailed",
    "StepReport",
    "Structure",
    "StructureState",
    "TimeStep",
    "Turn",
]
