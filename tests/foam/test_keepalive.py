"""The solver that stays alive: equal to restarts, on one processor and on two, and its end."""

import dataclasses
import os
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
from test_case import STEP, check_mesh, flow_at_rest, moved

from coupling.foam.fields import read_cells, read_points
from coupling.foam.installation import find_openfoam
from coupling.foam.process import OpenFoamFailed
from coupling.ports import RunFailed

pytestmark = pytest.mark.openfoam

SIZES = (2e-3, 5e-3, 9e-3, 10e-3)  # where the interface goes, step by step [m]
# Residuals of 1e-11, times the condition of a pressure matrix of a few hundred cells, some 1e3.
SOLVER_TOLERANCE = 1e-8
SIZES_OF_MESH = pytest.mark.parametrize("cells", [176, 540])


@pytest.fixture
def flow_of(tmp_path):
    """Make flows of a thick liquid, each in a folder of its own; their solvers end with the test.

    A thick liquid keeps a flow alive that depends on all that a step hands on to the next.
    """
    made = []

    def make(openfoam, cells=176):
        folder = tmp_path / f"foam{len(made)}"
        made.append(flow_at_rest(folder, cells, 1e-3, openfoam))
        return made[-1]

    yield make
    for flow in made:
        flow.close()


@pytest.fixture
def two(alive):
    """OpenFOAM on two processors."""
    return find_openfoam(keep_alive=True, processors=2)


def stepped(flow, number, *, tries=()):
    """Pressure and velocity of step ``number``, after ``tries`` that are given up."""
    flow.begin_step(number * STEP, STEP)
    for size in (*tries, SIZES[number]):
        pressure = flow.solve(moved(flow, size)).copy()
    velocity = flow._solution.velocity.copy()
    return pressure, velocity, flow.accept_step()


def distance(one, other):
    """Largest difference over the largest value."""
    return float(np.abs(one - other).max() / np.abs(other).max())


@SIZES_OF_MESH
def test_alive_equals_restarts(flow_of, alive, cells):
    staying = flow_of(alive, cells)
    restarted = flow_of(find_openfoam(), cells)
    assert (staying.case.solver, restarted.case.solver) == ("keep-alive", "restart")
    for number in range(len(SIZES)):
        # Tries also fix where the inner points of the mesh go.
        one, other = (
            stepped(f, number, tries=(1.2 * SIZES[number],)) for f in (staying, restarted)
        )
        assert distance(one[0], other[0]) < SOLVER_TOLERANCE
        assert distance(one[1], other[1]) < SOLVER_TOLERANCE
        assert np.abs(other[0]).max() > 1.0  # [Pa]
        assert 0 <= one[2].continuity_error < 1e-12
        assert one[2].continuity_error == pytest.approx(other[2].continuity_error, abs=1e-12)


@SIZES_OF_MESH
def test_alive_repeats_a_step_bit_for_bit(flow_of, alive, cells):
    flow = flow_of(alive, cells)
    stepped(flow, 0)
    flow.begin_step(STEP, STEP)
    targets = [moved(flow, size) for size in (5e-3, 8e-3, 3e-3)]
    first = [flow.solve(target).copy() for target in targets]
    again = [flow.solve(target).copy() for target in reversed(targets)]
    for one, other in zip(first, reversed(again), strict=True):
        assert (one == other).all()
    assert distance(first[0], first[1]) > 0.1


def test_convecting_flux_is_that_of_the_start_without_correct_phi(flow_of, alive):
    # Then the fluxes of the step's start enter the momentum equation: they are put back too.
    flows = flow_of(alive), flow_of(find_openfoam())
    for flow in flows:
        settings = flow.case.folder / "system" / "fvSolution"
        settings.write_text(settings.read_text().replace("PIMPLE\n{", "PIMPLE\n{ correctPhi no;"))
    for number in range(3):
        one, other = (stepped(flow, number, tries=(12e-3,)) for flow in flows)
        assert distance(one[0], other[0]) < SOLVER_TOLERANCE
        assert distance(one[1], other[1]) < SOLVER_TOLERANCE


def test_two_processors_equal_one(flow_of, alive, two):
    serial, parallel = flow_of(alive), flow_of(two)
    assert len(parallel.case.parts) == 2
    for number in range(len(SIZES)):
        one, other = (stepped(f, number, tries=(1.2 * SIZES[number],)) for f in (parallel, serial))
        assert distance(one[0], other[0]) < SOLVER_TOLERANCE
        assert distance(one[1], other[1]) < SOLVER_TOLERANCE


@pytest.mark.parametrize("steps", [1, 2])
def test_files_are_those_of_a_restart(flow_of, alive, steps):
    staying, restarted = flow_of(alive), flow_of(find_openfoam())
    for number in range(steps):
        stepped(staying, number)
        stepped(restarted, number)
    end = steps * STEP
    assert staying.case.times == [0.0]
    staying.case.flush(end)
    assert staying.case.times == [0.0, end]
    folder = staying.case.time_folder(end)
    found, expected = (
        {path.name for path in flow.case.time_folder(end).rglob("*") if path.is_file()}
        for flow in (staying, restarted)
    )
    assert found == expected - {"functionObjectProperties", "points0"}  # there are none; the target
    assert {"U", "U_0", "p", "Uf", "Uf_0", "V0", "meshPhi", "points"} <= found
    assert (read_points(folder / "polyMesh" / "points") == staying.mesh_points).all()
    assert "Mesh OK." in check_mesh(staying, "-latestTime")
    velocity = read_cells(folder / "U", staying.mesh.cells)
    assert (velocity == staying._solution.velocity).all()


@pytest.mark.parametrize("lost", [False, True], ids=["", "lost"])
@pytest.mark.parametrize("kind", ["alive", "two"])
def test_process_goes_on_from_its_own_files(flow_of, request, kind, lost):
    broken, whole = (flow_of(request.getfixturevalue(kind)) for _ in range(2))
    for number in range(2):
        stepped(broken, number)
        stepped(whole, number)
    saved = broken.save()
    assert any(name.startswith("file:") for name in saved)
    stepped(broken, 2)
    stepped(whole, 2)
    if lost:
        shutil.rmtree(broken.case.folder)
    broken.restore(saved)  # as a resumed run does: the process ends, a new one reads the files
    assert broken.case.times[-1] == 2 * STEP
    for number in (2, 3):
        one = stepped(broken, number)
        if number == 3:
            other = stepped(whole, 3)
            assert distance(one[0], other[0]) < SOLVER_TOLERANCE
            assert distance(one[1], other[1]) < SOLVER_TOLERANCE


def test_checkpoint_of_other_processors_is_refused(flow_of, alive, two):
    serial, parallel = flow_of(alive), flow_of(two)
    stepped(serial, 0)
    stepped(parallel, 0)
    of_one, of_two = serial.save(), parallel.save()
    with pytest.raises(OpenFoamFailed, match=r"of 1 processors(.|\n)*openfoam.processors = 1\."):
        parallel.restore(of_one)
    with pytest.raises(OpenFoamFailed, match=r"of 2 processors(.|\n)*openfoam.processors = 2\."):
        serial.restore(of_two)


def test_checkpoint_with_the_walls_pressure_is_refused_without_its_library(flow_of, alive):
    begun = flow_of(alive)
    stepped(begun, 0)
    without = flow_of(dataclasses.replace(find_openfoam(), walls=None))
    with pytest.raises(OpenFoamFailed, match=r"walls' pressure(.|\n)*Run 'edt build-solver'"):
        without.restore(begun.save())


def test_log_does_not_grow_for_ever(flow_of, alive, monkeypatch):
    flow = flow_of(alive)
    stepped(flow, 0)
    flow.save()
    whole = flow.case.log.stat().st_size
    monkeypatch.setattr("coupling.foam.keepalive.LOG_LIMIT", whole - 1)
    stepped(flow, 1)
    flow.save()
    assert flow.case.log.stat().st_size == 0
    stepped(flow, 2)
    assert 0 < flow.case.log.stat().st_size < whole
    assert flow.case.log.read_text().lstrip().startswith("Time = 0.015")


def test_length_of_a_repeated_step_may_change(flow_of, alive):
    one, other = flow_of(alive), flow_of(alive)
    for flow in (one, other):
        stepped(flow, 0)
        flow.begin_step(STEP, STEP)
    one.solve(moved(one, 6e-3))
    answers = []
    for flow in (one, other):
        flow.begin_step(STEP, 0.5 * STEP)
        flow.solve(moved(flow, 4e-3))
        flow.accept_step()
        flow.begin_step(1.5 * STEP, STEP)
        answers.append(flow.solve(moved(flow, 7e-3)).copy())
    assert (answers[0] == answers[1]).all()


def test_uneven_steps_go_on_from_files(flow_of, alive):
    """The solver knows the last step's length, whether it took it itself or reads of it."""
    staying, closed = flow_of(alive), flow_of(alive)
    pressures = []
    for flow in (staying, closed):
        for dt, size in zip((STEP, STEP / 2, STEP / 2, STEP), SIZES, strict=True):
            flow.begin_step(flow.time, STEP)
            flow.solve(moved(flow, size))
            flow.begin_step(flow.time, dt)
            pressures.append(flow.solve(moved(flow, size)).copy())
            flow.accept_step()
            if flow is closed:
                flow.close()
    for one, other in zip(pressures[:4], pressures[4:], strict=True):
        assert distance(one, other) < SOLVER_TOLERANCE


def test_restarts_refuse_uneven_steps(flow_of):
    flow = flow_of(find_openfoam())
    stepped(flow, 0)
    flow.begin_step(flow.time, STEP / 2)
    with pytest.raises(OpenFoamFailed, match=r"step before was one of 0\.005 s"):
        flow.solve(moved(flow, SIZES[1]))


def process_of(flow):
    return flow.case._pipes._process.pid


def running(process):
    """Whether the process of this number runs; a zombie does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def children(process):
    return [int(n) for n in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def gone(processes, seconds=5.0):
    until = time.monotonic() + seconds
    while any(map(running, processes)) and time.monotonic() < until:
        time.sleep(0.01)
    return not any(map(running, processes))


@pytest.mark.parametrize("kind", ["alive", "two"])
def test_killed_solver_is_told_with_its_log(flow_of, request, kind):
    flow = flow_of(request.getfixturevalue(kind))
    stepped(flow, 0)
    process = process_of(flow)
    solvers = [process] if kind == "alive" else children(process)
    os.kill(solvers[-1], signal.SIGKILL)
    flow.begin_step(STEP, STEP)
    with pytest.raises(OpenFoamFailed) as caught:
        flow.solve(moved(flow, 5e-3))
    stated = str(caught.value)
    assert re.search(r"^t = 0.01 s: edtPimpleFoam ended with (signal 9|exit status \d+)", stated)
    assert "continuity errors" in stated or kind == "two"  # mpirun has the last word then
    assert gone([process, *solvers])
    with pytest.raises(OpenFoamFailed, match=r"t = 0.005 s ended with the process(.|\n)*resume"):
        flow.solve(moved(flow, 5e-3))


def test_hanging_solver_is_ended_in_time(flow_of, alive):
    flow = flow_of(alive)
    stepped(flow, 0)
    process = process_of(flow)
    os.kill(process, signal.SIGSTOP)
    flow.case._pipes.timeout = 0.5
    flow.begin_step(STEP, STEP)
    start = time.monotonic()
    with pytest.raises(OpenFoamFailed, match=r"gave no answer within 0\.5 s"):
        flow.solve(moved(flow, 5e-3))
    assert time.monotonic() - start < 4.0
    assert gone([process])


def test_fatal_error_of_the_solver_is_told(flow_of, alive):
    flow = flow_of(alive)
    (flow.case.folder / "0" / "p").unlink()
    flow.begin_step(0.0, STEP)
    with pytest.raises(OpenFoamFailed, match=r"exit status 1(.|\n)*cannot find file"):
        flow.solve(moved(flow, 2e-3))


@pytest.mark.parametrize("processors", [1, 2])
def test_solver_dies_with_us(alive, tmp_path, processors):
    script = f"""
        import sys, time
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from pathlib import Path
        from test_case import STEP, find_openfoam, flow_at_rest, moved
        openfoam = find_openfoam(keep_alive=True, processors={processors})
        flow = flow_at_rest(Path({str(tmp_path)!r}) / "foam", 176, 1e-3, openfoam)
        flow.begin_step(0.0, STEP)
        flow.solve(moved(flow, 2e-3))
        print(flow.case._pipes._process.pid, flush=True)
        time.sleep(600)
    """
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True
    ) as parent:
        process = int(parent.stdout.readline())
        all_of_it = [process, *children(process)]
        assert len(all_of_it) >= processors
        assert all(map(running, all_of_it))
        parent.kill()
    assert gone(all_of_it)


def test_closed_solver_ends_by_itself(flow_of, alive):
    flow = flow_of(alive)
    stepped(flow, 0)
    process = process_of(flow)
    flow.close()
    assert gone([process], seconds=0.0)
    assert flow.case.log.read_text().rstrip().endswith("End")
    assert flow.case.times == [0.0, STEP]  # what was committed stands in files
    stepped(flow, 1)  # and is where a step still starts


def test_several_processors_without_their_programs(alive, monkeypatch, tmp_path):
    with pytest.raises(RunFailed, match=r"processors(.|\n)*edt build-solver"):
        find_openfoam(processors=2)
    monkeypatch.setenv("PATH", str(tmp_path))
    (tmp_path / "pimpleFoam").symlink_to(alive.solver)
    with pytest.raises(RunFailed, match=r"'mpirun'(.|\n)*apt-get install openmpi-bin"):
        find_openfoam(keep_alive=True, processors=2)


def test_own_solver_is_never_replaced(alive, tmp_path, monkeypatch):
    monkeypatch.setenv("EDT_ALLOW_COMMAND", "1")
    (tmp_path / "myFoam").symlink_to(alive.solver)
    assert find_openfoam(str(tmp_path / "myFoam"), keep_alive=True).keep_alive is None


def test_broken_solver_is_told(flow_of, alive, tmp_path):
    program = tmp_path / "edtPimpleFoam"
    program.write_text("#!/bin/sh\necho symbol lookup error; exit 127\n")
    program.chmod(0o755)
    flow = flow_of(dataclasses.replace(alive, keep_alive=program))
    flow.begin_step(0.0, STEP)
    with pytest.raises(OpenFoamFailed, match=r"exit status 127(.|\n)*symbol lookup error"):
        flow.solve(moved(flow, 2e-3))


def test_run_on_several_processors_is_refused_before_it_starts(edt, scene, tmp_path):
    for verb in ("run", "check"):
        folder = ("-o", tmp_path / "run") if verb == "run" else ()
        done = edt(verb, scene, *folder, "--set", "openfoam.processors=2",
                   "--set", "openfoam.keep_alive=false")  # fmt: skip
        assert done.returncode == 2
        assert "openfoam.processors" in done.stderr
        assert "edt build-solver" in done.stderr
    assert not (tmp_path / "run").exists()


def test_command_builds_it_once_and_tells_where_it_is(edt, alive):
    done = edt("build-solver")
    assert (done.returncode, done.stdout.strip()) == (0, str(alive.keep_alive))
    assert str(alive.keep_alive) in edt("info", "--json").stdout


def test_steps_that_no_decimals_hold(flow_of, alive):
    """Steps of 1/30 s: where one ends and the next begins is the same time, digit for digit."""
    step = 1.0 / 30.0
    flows = flow_of(alive), flow_of(find_openfoam())
    pressures = []
    for flow in flows:
        for number, size in enumerate(SIZES):
            flow.begin_step(number * step, step)
            pressures.append(flow.solve(moved(flow, size)).copy())
            flow.accept_step()
        assert flow.time == round(len(SIZES) * step, 11)
    one, other = pressures[: len(SIZES)], pressures[len(SIZES) :]
    assert all(distance(a, b) < SOLVER_TOLERANCE for a, b in zip(one, other, strict=True))
