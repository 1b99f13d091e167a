"""Interface quasi-Newton by least squares on former iterates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from coupling.ports import Array, SchemeSettings


@dataclass(frozen=True, kw_only=True)
class IqnIlsSettings:
    """Constants of the quasi-Newton schemes.

    ``filtering``: share of a column's length that must be left beyond the newer columns, or the
    column is dropped. The diaphragm's contact and its inner iteration make columns of former steps
    noisy: on the start of pad sway (8 steps reused) 0.1 takes 13 iterations a step, 0.3 takes 16,
    0.001 diverges, and no reuse takes 25.
    """

    filtering: float = 0.1


class IqnIls:
    """Interface quasi-Newton, inverse least squares (Degroote et al., Comput. Struct. 87, 2009).

    V holds differences of residuals, W those of x~ = x + r, newest first; the update is
    W argmin |V c + r| + r. Columns of ``reuse`` former steps are kept; QR filtering drops those
    that depend on newer ones (Haelterman et al., Comput. Struct. 171, 2016).
    """

    takes_inertia: ClassVar[bool] = False
    typical_iterations: ClassVar[float] = 11.0

    def __init__(
        self, relaxation: float, reuse: int, *, settings: IqnIlsSettings | None = None
    ) -> None:
        self.relaxation, self.reuse = relaxation, reuse
        self.settings = settings or IqnIlsSettings()
        self._steps: list[tuple[Array, Array]] = []  # (V, W) of former steps, newest first
        self._v, self._w = list[Array](), list[Array]()  # of this step
        self._last: tuple[Array, Array] | None = None  # residual and image

    @classmethod
    def of(cls, settings: SchemeSettings) -> IqnIls:
        """Return the scheme with the scene's first relaxation and its number of former steps."""
        return cls(settings.relaxation, settings.reuse)

    def begin_step(self) -> None:
        """Start the step's own columns."""
        self._v, self._w, self._last = [], [], None

    def update(self, x: Array, residual: Array) -> Array:
        """Return the next iterate x~ + W argmin |V c + r| of x~ = x + r.

        Parameters
        ----------
        x
            Interface vector (k,), of any unit.
        residual
            Residual r = S(F(x)) - x at ``x`` (k,), in its unit.

        Returns
        -------
        Array
            The next interface vector (k,); x + ``relaxation`` r while there is no column.
        """
        image = self._add_column(x, residual)
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
            if size > self.settings.filtering * float(np.linalg.norm(vector)):
                keep.append(column)
                basis = np.column_stack([basis, rest / size])
        return keep

    def _add_column(self, x: Array, residual: Array) -> Array:
        """Take in what has changed since the iterate before; the image x~ (k,) of x (k,)."""
        image = x + residual
        if self._last is not None:
            self._v.insert(0, residual - self._last[0])
            self._w.insert(0, image - self._last[1])
        self._last = (residual, image)
        return image

    def accept_step(self, x: Array, residual: Array) -> None:
        """Keep this step's columns for the next ``reuse`` steps, that of its end included.

        Parameters
        ----------
        x
            Interface vector (k,) that the step ends at.
        residual
            Residual S(F(x)) - x at ``x`` (k,), in its unit.
        """
        self._add_column(x, residual)
        if self.reuse and self._v:
            self._steps.insert(0, (np.array(self._v), np.array(self._w)))
            del self._steps[self.reuse :]

    def save(self) -> dict[str, Array]:
        """Return the columns of former steps."""
        saved = {}
        for number, (v, w) in enumerate(self._steps):
            saved[f"v{number}"], saved[f"w{number}"] = v, w
        return saved

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        count = sum(name.startswith("v") for name in saved)
        self._steps = [(saved[f"v{k}"], saved[f"w{k}"]) for k in range(count)]
