"""What is read from a solver's log: its last figures, without leaving files."""

from coupling.foam.logs import read_log

LOG = """Create time

Time = 0.02

GAMG:  Solving for p, Initial residual = 1, Final residual = 2e-12, No Iterations 17
time step continuity errors : sum local = 5e-16, global = -4e-18, cumulative = -4e-18
GAMG:  Solving for p, Initial residual = 0.01, Final residual = 8.5e-12, No Iterations 10
time step continuity errors : sum local = 4.25e-16, global = -4e-18, cumulative = -8e-18
ExecutionTime = 0.02 s  ClockTime = 0 s

End
"""


def test_last_figures_count(tmp_path):
    log = tmp_path / "log.pimpleFoam"
    log.write_text(LOG)
    said = read_log(log)
    assert said is not None
    assert (said.continuity, said.residual, said.iterations) == (4.25e-16, 8.5e-12, 10)
    assert [path.name for path in tmp_path.iterdir()] == ["log.pimpleFoam"]


def test_log_without_figures(tmp_path):
    log = tmp_path / "log.pimpleFoam"
    log.write_text("Create time\n")
    assert read_log(log) is None
