"""A step to be solved, and what solves it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array
from cloth.kinematics import Kinematics
from cloth.linear import System
from cloth.load import Load, Settings
from cloth.model import ClothModel
from cloth.recoil import TankRecoil
from cloth.self_contact.planes import Planes
from cloth.self_contact.result import Contact


@dataclass(frozen=True, kw_only=True)
class StepProblem:
    """A step to be solved: what is held during it.

    ``scale`` [m]: the step's (``cloth.load.step_scale``).
    ``constant_force`` (n, 3) [N] does not depend on the iterate.
    ``committed`` (n, 3) [m] is the step's start; ``start`` (n, 3) [m] and ``datum`` [Pa] are where
    the iteration sets out; ``penalty`` [N/m] is the stretch's; ``rest`` (m, 3) is the strain free
    of tension, (0, 3) where that is none. ``own``: the kinematics of the motion in the shell's own
    axes, which damping sees; ``kin`` is that in axes that do not turn, ``own`` where the shell does
    not. ``recoil``: of a free tank.
    """

    model: ClothModel
    settings: Settings
    penalty: float
    system: System
    dt: float
    scale: float
    kin: Kinematics
    load: Load
    own: Kinematics
    committed: Array
    start: Array
    datum: float
    tension: Array
    rest: Array
    contact_force: Array
    constant_force: Array
    recoil: TankRecoil | None


@dataclass(kw_only=True)
class Solution:
    """The end of a step: see ``cloth.state`` for the names; ``iterations`` done.

    ``change`` [m] is the rms displacement that further iterations would add, as estimated, and
    that made the last iterate admissible (see ``cloth.ending``).
    ``rub`` (n, 3) [N]: the friction that the sheet exerts on the shell, ``self_rub`` on itself;
    ``pressing`` (n, 2) [N]: the size of the normal force on the shell, and the sum of those on
    other parts of the sheet;
    ``contact``: of the sheet with itself; ``planes``: what kept it apart in the iteration;
    ``turned`` (3,) [rad]: how a free tank ends beyond the attitude that the step presumes;
    ``admissible``: what made the iterate so meets the tolerance, the volume is kept, and no part
    crosses another; ``converged``: both parts of ``change`` meet it.
    """

    position: Array
    tension: Array
    contact_force: Array
    rub: Array
    self_rub: Array
    pressing: Array
    datum: float
    turned: Array
    volume: float
    strain: Array
    change: float
    iterations: int
    contact: Contact | None
    planes: Planes | None
    admissible: bool
    converged: bool


def constant_force(
    model: ClothModel,
    settings: Settings,
    system: System,
    kin: Kinematics,
    own: Kinematics,
    load: Load,
    rows: Array | None,
    driven: Array | None = None,
) -> Array:
    """Return what no iteration changes in the right-hand side: inertia, weight, damping and rim.

    The damping is tau_b times the rate of the bending force but for what turns the normals, the
    moulded curvature's part included: Q alone would damp the rotation of a curved sheet that does
    not bend.

    Parameters
    ----------
    model, settings, system
        The sheet, its damping, and the step's matrix.
    kin
        Kinematics of the step.
    own
        Those of the motion in the shell's own axes.
    load
        The liquid's load, with gravity less the tank's acceleration.
    rows
        B/b of the liquid's inertia (r, n, 3) [sqrt(N/m)]; None without one.
    driven
        What the fixed nodes' acceleration adds to it (r,) [sqrt(N m)], as
        ``cloth.turning.rim_inertia`` returns it; None where they have none.

    Returns
    -------
    Array
        Nodal forces (n, 3) [N], zero on the fixed nodes.
    """
    b, anchor = kin.b, own.position_anchor
    inertial = model.mass[:, None] * (kin.prediction / b**2 + load.body_force)
    drag = (settings.drag / b * model.mass)[:, None] * anchor
    damping = -settings.bending_damping / b * model.held_normals_force(anchor)
    rim = system.lift(model.clamped, model.mesh.fixed)
    rim += (1.0 + settings.bending_damping / b) * model.bending.held
    total = inertial + drag + damping + rim
    if rows is not None:
        flat = rows.reshape(len(rows), -1)
        without = flat @ kin.prediction.ravel()
        without = without if driven is None else without - driven
        total = total + (flat.T @ without).reshape(-1, 3)
    total[model.mesh.fixed] = 0.0
    return np.asarray(total)
