"""Coupling schemes for the interface's fixed point x = S(F(x)), behind one protocol.

Each has the form its paper gives it. With the added-mass scheme the structure takes the liquid's
inertia into its own step (a Robin condition), which changes S.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.ports import Array, Scheme


class FixedPoint:
    """x <- x + omega r. With omega = 1 it diverges where the liquid is heavier than the wall."""

    def __init__(self, relaxation: float = 1.0) -> None:
        self.relaxation = relaxation

    def begin_step(self) -> None:
        """Nothing is kept within a step."""

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and its residual (k,)."""
        return x + self.relaxation * residual

    def accept_step(self) -> None:
        """Nothing is kept between steps."""

    def save(self) -> dict[str, Array]:
        """No memory."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """No memory."""


class Aitken(FixedPoint):
    """Dynamic relaxation (Irons & Tuck, IJNME 1, 1969; Kuettler & Wall, Comput. Mech. 43, 2008).

    omega_k+1 = -omega_k r_k . (r_k+1 - r_k) / |r_k+1 - r_k|^2. A step's first omega is the last
    step's, no larger than ``relaxation``.
    """

    def __init__(self, relaxation: float) -> None:
        super().__init__(relaxation)
        self._omega = relaxation
        self._previous: Array | None = None

    def begin_step(self) -> None:
        """Forget the residual; bound the relaxation as the papers do."""
        self._previous = None
        self._omega = float(np.sign(self._omega)) * min(abs(self._omega), self.relaxation)

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and its residual (k,)."""
        if self._previous is not None:
            change = residual - self._previous
            length = float(change @ change)
            if length > 0:
                self._omega *= -float(self._previous @ change) / length
        self._previous = residual
        return x + self._omega * residual

    def save(self) -> dict[str, Array]:
        """The relaxation that the next step starts with."""
        return {"omega": np.array([self._omega])}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._omega = float(saved["omega"][0])


class IqnIls:
    """Interface quasi-Newton, inverse least squares (Degroote et al., Comput. Struct. 87, 2009).

    V holds differences of residuals, W those of x~ = x + r, newest first; the update is
    W argmin |V c + r| + r. Columns of ``reuse`` former steps are kept; QR filtering drops those
    that depend on newer ones (Haelterman et al., Comput. Struct. 171, 2016).
    """

    # Of a column's length: what must be left beyond the newer columns. The diaphragm's contact and
    # its inner iteration make columns of former steps noisy: on the start of pad sway (8 steps
    # reused) 0.1 takes 13 iterations a step, 0.3 takes 16, 0.001 diverges, and no reuse takes 25.
    FILTER = 0.1

    def __init__(self, relaxation: float, reuse: int, *, filtering: float = FILTER) -> None:
        self.relaxation, self.reuse, self.filtering = relaxation, reuse, filtering
        self._steps: list[tuple[Array, Array]] = []  # (V, W) of former steps, newest first
        self.begin_step()

    def begin_step(self) -> None:
        """Start the step's own columns."""
        self._v: list[Array] = []
        self._w: list[Array] = []
        self._last: tuple[Array, Array] | None = None

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and its residual (k,)."""
        image = x + residual
        if self._last is not None:
            self._v.insert(0, residual - self._last[0])
            self._w.insert(0, image - self._last[1])
        self._last = (residual, image)
        v = np.array(self._v + [c for step in self._steps for c in step[0]]).T
        if v.size == 0:
            return x + self.relaxation * residual
        w = np.array(self._w + [c for step in self._steps for c in step[1]]).T
        keep = self._independent(v)
        q, r = np.linalg.qr(v[:, keep])
        coefficient = np.linalg.solve(r, -(q.T @ residual))
        return np.asarray(image + w[:, keep] @ coefficient)

    def _independent(self, v: Array) -> list[int]:
        """Columns, newest first, that are not combinations of newer ones (modified QR)."""
        keep: list[int] = []
        basis = np.empty((len(v), 0))
        for column in range(v.shape[1]):
            if len(keep) == len(v):
                break
            vector = v[:, column]
            rest = vector - basis @ (basis.T @ vector)
            rest -= basis @ (basis.T @ rest)
            size = float(np.linalg.norm(rest))
            if size > self.filtering * float(np.linalg.norm(vector)):
                keep.append(column)
                basis = np.column_stack([basis, rest / size])
        return keep

    def accept_step(self) -> None:
        """Keep this step's columns for the next ``reuse`` steps."""
        if self.reuse and self._v:
            self._steps.insert(0, (np.array(self._v), np.array(self._w)))
            del self._steps[self.reuse :]

    def save(self) -> dict[str, Array]:
        """The columns of former steps."""
        saved = {}
        for number, (v, w) in enumerate(self._steps):
            saved[f"v{number}"], saved[f"w{number}"] = v, w
        return saved

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        count = sum(name.startswith("v") for name in saved)
        self._steps = [(saved[f"v{k}"], saved[f"w{k}"]) for k in range(count)]


class AddedMass(IqnIls):
    """Quasi-Newton steps of a structure that carries the liquid's inertia (Robin-Neumann).

    The plain fixed point then has the factor (M_flow - M_a) c / ((M_s + M_a) c + K) per mode, small
    when M_a is the flow's own discrete operator, so that the first step needs no relaxation. What
    is left where the shape changes violently is a few slow modes, which the step's own columns take
    care of. Columns of former steps are of another operator by then: in violent sway 8 reused steps
    took 4.3 iterations a step and failed twice, none took 3.3 and never failed.
    """

    def __init__(self) -> None:
        super().__init__(1.0, 0)


def scheme_named(name: str, *, relaxation: float, reuse: int) -> tuple[Scheme, bool]:
    """The scheme of the scene's ``coupling.scheme``, and whether it takes the added mass in."""
    match name:
        case "fixed-point":
            return FixedPoint(), False
        case "aitken":
            return Aitken(relaxation), False
        case "iqn-ils":
            return IqnIls(relaxation, reuse), False
        case "added-mass":
            return AddedMass(), True
    raise ValueError(f"no coupling scheme '{name}'")
