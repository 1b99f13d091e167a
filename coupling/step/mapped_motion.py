"""How the flow's interface moves where the structure's formula and the step's map have it."""

from __future__ import annotations

import math

import numpy as np

from coupling.interface.mapping import StepMap
from coupling.ports import Array, InterfaceMotion, Structure, Turn


def mapped_motion(
    structure: Structure, step_map: StepMap, nodes: Array, shift: Array, turn: Turn | None
) -> InterfaceMotion:
    """Return the motion of the interface in a step that the ``structure`` has begun.

    The map is that of the step's end, in the tank's axes then. In a tank that turns, points that
    are none of the nodes, such as those on the shell, turn as well: there the map takes what the
    nodes' motion has beyond a rigid turn, and the turn is that of the interface itself.

    Parameters
    ----------
    structure
        The structure, whose step has begun.
    step_map
        The step's map.
    nodes
        Where the structure's are expected at the step's end (n, 3) [m].
    shift
        What closes the volume of the mapped structure (p, 3) [m].
    turn
        How the tank turns, None where it does not.

    Returns
    -------
    InterfaceMotion
        The motion of the interface's p points.
    """
    b = math.sqrt(structure.acceleration_scale)
    still, inertial = structure.still_position(), structure.inertial_prediction()
    if turn is None:
        return InterfaceMotion(
            still=step_map.to_flow(still) + shift, inertial=step_map.to_flow(inertial) + shift, b=b
        )
    end = step_map.to_flow(nodes)
    points = end + shift

    def mapped(places: Array, back: Array, back_there: Array) -> Array:
        beyond = step_map.to_flow(places + back) - end
        return np.asarray(points - back_there + beyond)

    return InterfaceMotion(
        still=mapped(still, b * turn.velocity(nodes), b * turn.velocity(points)),
        inertial=mapped(
            inertial, b**2 * turn.acceleration_at(nodes), b**2 * turn.acceleration_at(points)
        ),
        b=b,
    )
