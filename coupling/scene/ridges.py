"""Ridges of the moulded diaphragm: a thickness profile on the mould's chart.

A ridge is rounded, h (1 + cos(2 pi d/w))/2 thick beyond the rubber between, d from its crest, over
a width w from foot to foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from coupling.ports import Array
from coupling.scene.numerics import MOST_RINGS
from coupling.scene.wrinkles import grid_spacing

if TYPE_CHECKING:
    from coupling.scene.diaphragm import Diaphragm
    from coupling.scene.scene import Scene
    from coupling.scene.tank import Mould

# Spacings of the grid from foot to foot, at least. On 8 to 32 rings the triangles' mean thickness
# of ridges then errs by 1.2 % at the most and that of its cube by 1.5 %; with 2 by 2 and 10 %, with
# 1.5 by 18 and 30 %.
SPACINGS_A_RIDGE = 3.0
_PARTS = 2000  # of the meridian, over which a mean is taken
KEYS = ("ridge_number", "ridge_width", "ridge_height")


@dataclass(frozen=True, kw_only=True)
class Ridges:
    """``number`` ridges of ``width`` and ``height`` [m] on rubber of a ``thickness`` [m].

    Circumferential ones are circles of the mould, their crests at (k - 1/2)/number of its meridian.
    ``radial`` ones are meridians, the first at azimuth 0, whose width is along the circles: where
    these are shorter than number times width ridges meet, and at the pole all do.
    """

    number: int
    width: float
    height: float
    thickness: float
    radial: bool

    def at(self, points: Array, mould: Mould) -> Array:
        """Thickness (k,) [m] at ``points`` (k, 3) [m] of the ``mould``."""
        chart = mould.directions(points)
        if self.radial:
            pitch = 2.0 * np.pi / self.number
            azimuth = np.arctan2(points[:, 1], points[:, 0])
            off = np.mod(azimuth + 0.5 * pitch, pitch) - 0.5 * pitch
            away = np.abs(off) * np.hypot(points[:, 0], points[:, 1])
        else:
            pitch = mould.length / self.number
            polar = np.arctan2(np.hypot(chart[:, 0], chart[:, 1]), chart[:, 2])
            away = np.abs(np.mod(polar * mould.length / (0.5 * np.pi), pitch) - 0.5 * pitch)
        return np.asarray(self.thickness + self.height * self._profile(away))

    def _profile(self, away: Array) -> Array:
        """What of its height a ridge has ``away`` (k,) [m] from its crest."""
        return np.asarray(0.5 + 0.5 * np.cos(2.0 * np.pi * np.minimum(away / self.width, 0.5)))

    def mean(self, mould: Mould) -> float:
        """Of the moulded area [m], by the trapezoidal rule along the meridian."""
        share = np.arange(_PARTS + 1) / _PARTS
        radius = np.array([mould.ring(k, _PARTS)[0] for k in range(_PARTS + 1)])
        weight = radius * np.where((share > 0.0) & (share < 1.0), 1.0, 0.5)
        if self.radial:
            half = np.pi * radius / self.number  # from a crest to the middle between two
            reach = np.minimum(half, 0.5 * self.width)
            wave = 0.5 * self.width / np.pi * np.sin(2.0 * np.pi * reach / self.width)
            covered = 0.5 * (reach + wave) / np.maximum(half, 1e-300)
        else:
            pitch = mould.length / self.number
            away = np.abs(np.mod(share * mould.length, pitch) - 0.5 * pitch)
            covered = self._profile(away)
        return float(self.thickness + self.height * (covered @ weight) / weight.sum())


def ridges_of(rubber: Diaphragm) -> Ridges | None:
    """Those of a scene's section; None without."""
    number, width, height = (getattr(rubber, key) for key in KEYS)
    if number is None or width is None or height is None:
        return None
    return Ridges(
        number=number, width=width, height=height, thickness=rubber.thickness,
        radial=rubber.ridge_direction == "radial",
    )  # fmt: skip


def ridge_problems(scene: Scene) -> list[str]:
    """One line ``key: what is wrong. Mend.`` for each problem of the scene's ridges."""
    rubber, mould = scene.diaphragm, scene.mould
    given = [key for key in KEYS if getattr(rubber, key) is not None]
    if not given:
        return []
    problems = [
        f"diaphragm.{key}: is required beside {given[0]}. "
        f"Give the {type(rubber).model_fields[key].description}."
        for key in KEYS
        if key not in given
    ]
    if rubber.thickness_map is not None:
        problems.append(
            f"diaphragm.{given[0]}: stands beside a thickness_map. Leave one of the two out."
        )
    if scene.cloth.grid == "thesis":
        problems.append(
            f'diaphragm.{given[0]}: does not apply to cloth.grid = "thesis". '
            'Leave it out, or take cloth.grid = "rings".'
        )
    ridges = ridges_of(rubber)
    if problems or ridges is None:
        return problems
    place, room = "the meridian", mould.length
    if ridges.radial:
        place, room = "the rim", 2.0 * math.pi * mould.ring(1, 1)[0]
    widest = room / ridges.number
    if ridges.width > widest * (1.0 + 1e-9):
        return [
            f"diaphragm.ridge_width: {ridges.number} ridges have room for {widest:.4g} m each "
            f"along {place}, got {ridges.width:g}. Give a smaller width, or fewer ridges."
        ]
    return _unresolved(scene, ridges)


def _unresolved(scene: Scene, ridges: Ridges) -> list[str]:
    """Whether the grid can show the ridges: ``SPACINGS_A_RIDGE`` to each."""
    spacing = grid_spacing(scene.mould.length, scene.cloth)
    least = SPACINGS_A_RIDGE * spacing
    if ridges.width >= least * (1.0 - 1e-9):
        return []
    rings = math.ceil(scene.cloth.resolution * least / ridges.width)
    finer = f"Give cloth.resolution = {rings}, or wider ridges."
    mend = finer if rings <= MOST_RINGS else f"A grid has at most {MOST_RINGS} rings: widen them."
    return [
        f"diaphragm.ridge_width: must be at least {SPACINGS_A_RIDGE:g} spacings of the cloth's "
        f"grid, {least:.4g} m, got {ridges.width:g}: narrower ridges fall between its triangles. "
        f"{mend}"
    ]
