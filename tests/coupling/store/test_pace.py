"""Jobs that take a share of the wall time."""

from __future__ import annotations

import pytest

from coupling.store import pace
from coupling.store.pace import Pace


def test_a_job_is_due_when_its_last_cost_is_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr(pace, "perf_counter", lambda: clock[0])
    job = Pace(0.25)
    assert job.due
    with job.timed():
        clock[0] += 2.0
    seen = []
    for clock[0] in (102.0, 109.9, 110.0):  # 2 s in 8 more: a quarter, from end to end
        seen.append(job.due)
    assert seen == [False, False, True]
