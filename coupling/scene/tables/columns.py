"""What the columns of a table are: names and units in its header, and in a row of units."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coupling.scene.tables.text import COMMENT

_ANY = r"\s*(?P<name>.*?)\s*"
# Where a header names the unit: ax [g], ax (g), ax / g, ax in g, acc_x_g.
_UNIT_IN_HEAD = (
    re.compile(_ANY + r"[\[(<{]\s*(?P<unit>[^\])>}]*?)\s*[\])>}]\s*"),
    re.compile(_ANY + r"\s/\s*(?P<unit>\S.*?)\s*"),
    re.compile(r"(?P<name>[^/]+)/(?P<unit>\S.*?)\s*"),
    re.compile(_ANY + r"\s+in\s+(?P<unit>\S+)\s*", re.IGNORECASE),
    re.compile(_ANY + r"[_ ](?P<unit>[^_ ]+)\s*"),
)
_IN_UNITS = str.maketrans(
    {"²": "2", "³": "3", "µ": "u", "μ": "u", "⁻": "-", "−": "-"} | dict.fromkeys("^*·. ", "")
)


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column that is wanted: its ``name``, and how headers may write it.

    ``pattern`` matches the letters of a header, in lower case; ``units`` are the factors to
    ``unit``, by what ``plain_unit`` makes of a unit; ``clock``: whether it may hold dates.
    """

    name: str
    pattern: str
    unit: str
    units: Mapping[str, float]
    clock: bool = False

    def read(self, head: str) -> str | None:
        """Unit that ``head`` gives to this column, "" for none; None if it is another one."""
        for form in _UNIT_IN_HEAD:
            parts = form.fullmatch(head)
            if parts and re.fullmatch(self.pattern, _letters(parts["name"])):
                unit: str = parts["unit"]
                # The last form has no mark of a unit: what is none belongs to another name.
                if form is not _UNIT_IN_HEAD[-1] or plain_unit(unit) in self.units:
                    return unit
        if self.clock and plain_unit(head) in self.units:
            return head.strip()  # a time that is called by its unit
        return "" if re.fullmatch(self.pattern, _letters(head)) else None

    @property
    def choices(self) -> list[str]:
        """One way to write each of the units."""
        first: dict[float, str] = {}
        for unit, factor in self.units.items():
            first.setdefault(factor, unit)
        return list(first.values())

    def factor(self, unit: str) -> float | None:
        """What a value in ``unit`` is to be multiplied by, None where that is not known."""
        plain = plain_unit(unit)
        return self.units.get(plain, 1.0 if plain == "" else None)


def plain_unit(text: str) -> str:
    """A unit without brackets, blanks, signs of powers and case: ``[m/s²]`` is ``m/s2``."""
    unit = text.strip().strip("[]()<>{}").lower().translate(_IN_UNITS)
    return re.sub(r"^(unix|epoch|utc|local|since.*|iso\d*|y+-?m+-?d+|h+:m+:s+f*|t)+", "", unit)


def _letters(text: str) -> str:
    return re.sub(r"[^a-z]", "", text.lower())


def without_mark(line: str) -> str:
    """``line`` without the mark of a comment at its beginning."""
    stripped = line.strip()
    for mark in COMMENT:
        if stripped.startswith(mark):
            return stripped.lstrip("".join(COMMENT)).strip()
    return stripped


def recognised(heads: Sequence[str], wanted: Sequence[Column]) -> int:
    """How many of the columns ``wanted`` stand among ``heads``."""
    return sum(any(column.read(head) is not None for head in heads) for column in wanted)


GRAVITY = 9.80665  # m/s^2 in a unit g
ACCELERATION = {
    **dict.fromkeys(("m/s2", "m/s/s", "ms-2", "ms2", "mps2", "m/sec2", "mpss"), 1.0),
    **dict.fromkeys(("g", "gn", "g0", "gs", "g's"), GRAVITY),
    **dict.fromkeys(("mg", "millig"), 1e-3 * GRAVITY),
    **dict.fromkeys(("cm/s2", "gal"), 1e-2),
    "mm/s2": 1e-3,
    "ft/s2": 0.3048,
    "in/s2": 0.0254,
}
FORCE = {
    **dict.fromkeys(("n", "newton", "newtons"), 1.0),
    **dict.fromkeys(("kn", "kilonewton", "kilonewtons"), 1e3),
    **dict.fromkeys(("lbf", "lb"), 4.4482216152605),
}
MOMENT = {
    **dict.fromkeys(("nm", "newtonmetre", "newtonmetres", "newtonmeter", "newtonmeters"), 1.0),
    **dict.fromkeys(("knm",), 1e3),
    **dict.fromkeys(("lbfft", "ftlbf", "lbft", "ftlb"), 1.3558179483314),
}
TIME = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nanosecond", "nanoseconds"), 1e-9),
}
ANGLE = {
    **dict.fromkeys(("deg", "degree", "degrees", "°"), 1.0),
    **dict.fromkeys(("rad", "radian", "radians"), 57.29577951308232),
}
RATE = {
    **dict.fromkeys(("deg/s", "degree/s", "degrees/s", "°/s", "degs-1", "dps", "deg/sec"), 1.0),
    **dict.fromkeys(("rad/s", "radian/s", "radians/s", "rads-1", "rad/sec"), 57.29577951308232),
}
LENGTH = {
    **dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0),
    **dict.fromkeys(("mm", "millimetre", "millimetres"), 1e-3),
    **dict.fromkeys(("um", "micron", "microns"), 1e-6),
    **dict.fromkeys(("in", "inch", "inches"), 0.0254),
    "mil": 2.54e-5,
}
