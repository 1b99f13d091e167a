"""By which power of a step or spacing the errors fall."""

from __future__ import annotations

STEP_ORDER = 2.0  # of the time schemes of cloth and flow, see ``edt verify chain`` and ``slosh``
SHEET_ORDER = 2.0  # in the spacing of the rings: CG of the pad sway at 12, 18 and 24 rings
LIMIT_ORDER = 1.0  # in the compliance that stands for none: the strain of a given tension
