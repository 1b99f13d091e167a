"""Where the rubber rubs: how far, how hard, and what that may wear off."""

from __future__ import annotations

from typing import Any

from coupling.metrics.rubs import KINDS
from coupling.report.files import RunFiles
from coupling.report.page import Section, Table, number
from coupling.report.rub_maps import rub_maps, shell_map

_ON = {"shell": "the shell", "self": "itself"}
_NOTE = (
    "Slip is the way that a point slides while it is pressed on, gathered over the run; its work "
    "is the pressure times that way, per moulded area, with which wear goes. Both depend on step "
    "and grid: compare runs that share them. "
)
_WEAR = {
    True: "Worn off: the least and the largest of diaphragm.wear_coefficient times the work.",
    False: "What that wears off takes the rubber’s own coefficient: diaphragm.wear_coefficient.",
}


def rub_table(run: RunFiles) -> Table:
    """Return a table of slips, their works and places, on the shell and on the sheet itself."""
    rubs = run.summary.get("rubs") or run.summary.get("rubbing") or {}
    rows = [row for kind in KINDS for row in _rows(rubs, kind)]
    known = run.scene.diaphragm.wear_coefficient is not None
    return Table(head=["Rubs", ""], rows=rows, note=_NOTE + _WEAR[known])


def _rows(rubs: dict[str, Any], kind: str) -> list[list[str]]:
    """Rows of a ``kind``; those that a summary of an older version lacks are left out."""
    on = _ON[kind]

    def of(name: str) -> Any:
        return rubs.get(f"{kind}_{name}")

    rows = [[f"Largest slip on {on}", _millimetres(of("slip_max_m"))]]
    rows += [["… from the moulded pole, azimuth", _angles(of("slip_place_deg"))]]
    rows += [[f"Mean slip on {on}", _millimetres(of("slip_mean_m"))]]
    rows += [[f"Largest slip work on {on}", number(of("work_max_J_per_m2"), "J/m²")]]
    rows += [["… from the moulded pole, azimuth", _angles(of("work_place_deg"))]]
    if kind == "shell":
        rows += [["… from the shell’s lower pole, azimuth", _angles(of("work_on_shell_deg"))]]
    rows += [["… mean pressure there while sliding", number(of("rubbing_pressure_Pa"), "Pa")]]
    rows += [[f"Mean slip work on {on}", number(of("work_mean_J_per_m2"), "J/m²")]]
    rows += [["Worn off at the most", _range(of("wear_max_m"))]]
    if of("slip_max_m") is None:
        return [[rows[0][0], "none"]]
    return [row for row in rows if row[1] != "–"]


def _millimetres(value: float | None) -> str:
    return number(None if value is None else 1e3 * value, "mm")


def _angles(angles: list[float] | None) -> str:
    return "–" if angles is None else ", ".join(f"{round(angle) % 360}°" for angle in angles)


def _range(depths: list[float] | None) -> str:
    """Depths [m] in micrometres."""
    if depths is None:
        return "–"
    least, largest = (number(1e6 * depth) for depth in depths)
    return f"{least} to {largest}\u202fµm"


def rub_section(run: RunFiles) -> Section:
    """The table, and maps on the moulded shape and on the shell."""
    maps = [*rub_maps(run), *shell_map(run)]
    return Section(
        title="Where the rubber rubs",
        tables=[rub_table(run)],
        pictures=maps,
        columns=min(2, max(1, len(maps))),
    )
