"""What the diaphragm remembers between steps, to and from named arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from cloth.arrays import Array

# What a node has of its contacts, each (n,) or (n, 3); see ``cloth.rubbing``.
PRESSURES = ("shell_pressure", "self_pressure")
GATHERED = ("shell_slip", "self_slip", "shell_work", "self_work", "rub_place")


@dataclass(frozen=True, kw_only=True)
class ClothState:
    """Where the diaphragm stands after a step (arrays are copies).

    ``position``, ``velocity`` (n, 3) [m, m/s]; ``datum_pressure`` [Pa]; ``volume`` of the liquid
    [m^3]; ``strain`` and ``tension`` (m,) [-, N/m], the largest principal ones of every triangle;
    ``contact_force`` (n, 3) [N] that the sheet exerts on the shell and on itself;
    ``shell_pressure``, ``self_pressure`` (n,) [Pa], those of the contact with the shell and with
    another part of the sheet; ``shell_slip``, ``self_slip`` (n,) [m]: how far a node has slid so
    far, pressed on either; ``shell_work``, ``self_work`` (n,) [J/m^2]: int p ds on that way;
    ``rub_place`` (n, 3) [m]: where on the shell, the mean weighted by p ds, 0 where it slid
    nowhere. Pressures and works are per moulded area. ``change``: the last inner iteration's rms
    displacement [m], the solver's own error. The largest tensions do not converge: where the sheet
    snaps taut they grow as 1/step, and where it is locked against the shell they are not unique.
    Pressures are the same.
    """

    position: Array
    velocity: Array
    datum_pressure: float
    volume: float
    strain: Array
    tension: Array
    contact_force: Array
    shell_pressure: Array
    self_pressure: Array
    shell_slip: Array
    self_slip: Array
    shell_work: Array
    self_work: Array
    rub_place: Array
    change: float


def untouched(nodes: int) -> dict[str, Array]:
    """Return slips, works and places of so many ``nodes`` that have slid nowhere, by name."""
    return {name: np.zeros((nodes, 3) if name == "rub_place" else nodes) for name in GATHERED}


def principal_tension(tension: Array) -> Array:
    """Return the larger singular value (m,) of every ``tension`` (m, 3, 2), in its unit."""
    first, second = tension[:, :, 0], tension[:, :, 1]
    a = np.einsum("td,td->t", first, first)
    b = np.einsum("td,td->t", first, second)
    c = np.einsum("td,td->t", second, second)
    return np.asarray(np.sqrt(0.5 * (a + c) + np.hypot(0.5 * (a - c), b)))


@dataclass(kw_only=True)
class Memory:
    """Everything the next step starts from.

    ``position``, ``velocity`` and their ``previous_`` values (n, 3); ``previous_dt`` [s], 0 when
    there is no previous step; ``tension`` (m, 3, 2) [N/m], the strain limit's dual in physical
    units; ``contact_force`` (n, 3) [N], the shell's; ``datum`` [Pa]; ``volume`` [m^3];
    ``strain`` (m,); ``rubber_strain`` (m, 3), the rubber's own (``cloth.viscous``); ``change`` [m];
    pressures, slips, works (n,) and ``rub_place`` (n, 3) as in ``ClothState``; ``near``, 1 where
    parts of the sheet are near each other. Scalars are arrays of shape (1,).
    """

    position: Array
    velocity: Array
    previous_position: Array
    previous_velocity: Array
    previous_dt: Array
    tension: Array
    contact_force: Array
    datum: Array
    volume: Array
    strain: Array
    rubber_strain: Array
    change: Array
    shell_pressure: Array
    self_pressure: Array
    shell_slip: Array
    self_slip: Array
    shell_work: Array
    self_work: Array
    rub_place: Array
    near: Array

    @classmethod
    def at_rest(cls, position: Array, triangles: int, volume: float) -> Memory:
        """Return the memory of a sheet at rest, without tension, contact or history.

        ``position`` (n, 3) [m], number of ``triangles``, ``volume`` [m^3] of the liquid.
        """
        still = np.zeros_like(position)
        return cls(
            position=position.copy(),
            velocity=still,
            previous_position=position.copy(),
            previous_velocity=still,
            previous_dt=np.zeros(1),
            tension=np.zeros((triangles, 3, 2)),
            contact_force=still,
            datum=np.zeros(1),
            volume=np.array([volume]),
            strain=np.zeros(triangles),
            rubber_strain=np.zeros((triangles, 3)),
            change=np.zeros(1),
            **{name: np.zeros(len(position)) for name in PRESSURES},
            **untouched(len(position)),
            near=np.zeros(1),
        )

    def save(self) -> dict[str, Array]:
        """Return copies of all arrays, by name."""
        return {f.name: np.array(getattr(self, f.name)) for f in fields(self)}

    @classmethod
    def restored(cls, saved: Mapping[str, Array], like: Memory) -> Memory:
        """Return the memory that ``save`` wrote; names and shapes must be those of ``like``.

        Raises ValueError where one is missing or has another shape.
        """
        values: dict[str, Array] = {}
        for f in fields(cls):
            if f.name not in saved:
                raise ValueError(f"cloth checkpoint: {f.name} is missing. Was it saved by a cloth?")
            value = np.array(saved[f.name], dtype=np.float64)
            shape = getattr(like, f.name).shape
            if value.shape != shape:
                raise ValueError(
                    f"cloth checkpoint: {f.name} has shape {value.shape}, this mesh needs {shape}. "
                    "Restart with the resolution of the run that wrote it."
                )
            values[f.name] = value
        return cls(**values)


def state_of(memory: Memory) -> ClothState:
    """Return the state of the sheet in ``memory``, in copies."""
    m = memory
    return ClothState(
        position=m.position.copy(),
        velocity=m.velocity.copy(),
        datum_pressure=float(m.datum[0]),
        volume=float(m.volume[0]),
        strain=m.strain.copy(),
        tension=principal_tension(m.tension),
        contact_force=m.contact_force.copy(),
        **{name: getattr(m, name).copy() for name in (*PRESSURES, *GATHERED)},
        change=float(m.change[0]),
    )
