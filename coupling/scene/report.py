"""What a run's report leads with."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from coupling.scene.sections import Section


class Report(Section):
    """The report of a run; nothing that is computed depends on it."""

    lead: Literal["diaphragm", "rubs", "folds"] = Field(
        default="diaphragm",
        description='first section after the verdict: "diaphragm" (its shape), "rubs" or "folds"',
    )
