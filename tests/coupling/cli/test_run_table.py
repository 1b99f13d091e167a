"""What the command prints of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from coupling.cli.tables import print_summary


@pytest.mark.parametrize("transient", [True, False, None])
def test_a_phasor_that_has_not_settled_is_called_transient(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], transient: bool | None
) -> None:
    cg: dict[str, Any] = {"amplitude_m": [0.1, 0.0, 0.02], "phase_deg": [-30.0, None, 12.0]}
    print_summary({"cg": cg | {"transient": transient}}, tmp_path)
    lines = [line for line in capsys.readouterr().out.splitlines() if " CG " in line]
    assert len(lines) == 2  # amplitude and phase
    assert all(("transient" in line) == (transient is True) for line in lines)


def test_rubs_are_printed_where_there_are_any(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rubs = {"shell_slip_max_m": 0.0123, "shell_wear_max_m": [1e-8, 4e-8], "self_slip_max_m": None}
    print_summary({"rubs": rubs}, tmp_path)
    said = capsys.readouterr().out
    assert "0.0123" in said
    assert "1e-08, 4e-08" in said
    assert "slip on itself" not in said
