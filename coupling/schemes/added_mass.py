"""Robin-Neumann: the structure carries the liquid's inertia."""

from __future__ import annotations

from coupling.ports import SchemeSettings
from coupling.schemes.iqn_ils import IqnIls


class AddedMass(IqnIls):
    """Quasi-Newton steps of a structure that carries the liquid's inertia (Robin-Neumann).

    ``takes_inertia`` makes ``InterfaceProblem`` put that into the structure's step, and the balance
    of it into the flow's pressure; ``LiquidInertia`` is the matrix.

    The plain fixed point then has the factor (M_flow - M_a) c / ((M_s + M_a) c + K) per mode, small
    when M_a is the flow's own discrete operator, so that the first step needs no relaxation. In
    violent sway at 10 ms it is 0.11, spread over the whole interface. That is no matter of
    convection: a flow solver without its convective term leaves 0.11 too. A good half is the change
    of the operator with the shape within the step, times the acceleration, which ``CoupledStep``
    takes in where it makes iterations slow; the rest what the flow itself answers differently. The
    step's own columns take care of some. Columns of former steps are of another shape by then: one
    reused step took 3.67 iterations a step, none took 3.65.
    """

    takes_inertia = True
    typical_iterations = 4.0

    def __init__(self) -> None:
        super().__init__(1.0, 0)

    @classmethod
    def of(cls, settings: SchemeSettings) -> AddedMass:
        """Return the scheme, which has no settings of its own."""
        del settings
        return cls()
