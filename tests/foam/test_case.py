"""The case as OpenFOAM itself sees it: mesh, imposed points, restarts and the first pressure."""

import os
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from PyFoam.LogAnalysis.FoamLogAnalyzer import FoamLogAnalyzer
from PyFoam.LogAnalysis.RegExpLineAnalyzer import RegExpLineAnalyzer

from cloth.kinematics import kinematics
from cloth.shell.sphere import Sphere
from coupling.finite_volume.geometry import cell_geometry, fan_volume, non_orthogonality
from coupling.finite_volume.gradients import wall_distance
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.swept import pressure_force
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.fields import read_cells, read_points
from coupling.foam.installation import find_openfoam
from coupling.foam.process import run_program
from coupling.ports import InterfaceMotion

pytestmark = pytest.mark.openfoam

RADIUS, DENSITY, STEP = 0.4445, 1000.0, 0.005


def flow_at_rest(folder, cells, viscosity=1e-6, openfoam=None):
    """A flow below a dome, written to ``folder``."""
    mesh = half_ball(cells)
    flow = OpenFoamFlow(
        folder, mesh, openfoam=openfoam or find_openfoam(), shell=Sphere(RADIUS), density=DENSITY,
        viscosity=viscosity, timeout=60.0,
    )  # fmt: skip
    points = RADIUS * mesh.points
    patch = points[mesh.patch_points].copy()
    patch[:, 2] += 0.2 * (RADIUS - np.sum(patch[:, :2] ** 2, axis=1) / RADIUS)
    patch[mesh.rim, 2] = 0.0
    outline = points.copy()
    outline[mesh.patch_points] = patch
    volume = fan_volume(outline[mesh.faces[mesh.inner_faces :]])
    flow.start(patch, points[mesh.shell_points], volume)
    return flow


def moved(flow, size):
    """The interface tilted by ``size`` [m], its rim at rest, its volume closed."""
    points = flow.points
    across = np.sum(points[:, :2] ** 2, axis=1) / RADIUS**2
    shift = np.zeros_like(points)
    shift[:, 2] = size * points[:, 0] / RADIUS * np.clip(1 - across, 0, None)
    shift[flow.mesh.rim] = 0.0
    return flow.close_volume(points + shift)


def check_mesh(flow, *arguments):
    program = shutil.which("checkMesh")
    done = subprocess.run(
        [program, "-case", str(flow.case.folder), *arguments], capture_output=True, text=True,
        env=find_openfoam().environment | {"PWD": os.fspath(flow.case.folder)},
        cwd=flow.case.folder, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:]
    return done.stdout


def figure(text, after):
    return float(text.split(after, 1)[1].split()[0].rstrip("."))


@pytest.fixture(params=["restart", "keep-alive"])
def solver(request, alive):
    return alive if request.param == "keep-alive" else find_openfoam()


@pytest.fixture(params=[176, 540])
def flow(request, tmp_path):
    return flow_at_rest(tmp_path / "foam", request.param)


def test_check_mesh_finds_what_the_coupler_computes(flow):
    text = check_mesh(flow, "-time", "0")
    assert "Mesh OK." in text
    assert "Upper triangular ordering OK." in text
    assert "Boundary openness" in text
    geometry = cell_geometry(flow.mesh, flow.mesh_points)
    exact = {"rel": 1e-11}  # the same formulas: rounding only
    assert figure(text, "Total volume = ") == pytest.approx(geometry.volume.sum(), **exact)
    assert figure(text, "Min volume = ") == pytest.approx(geometry.volume.min(), **exact)
    angle = non_orthogonality(flow.mesh, geometry)
    assert figure(text, "Mesh non-orthogonality Max: ") == pytest.approx(angle.max(), **exact)
    mean = np.degrees(np.arccos(np.cos(np.radians(angle)).mean()))
    assert figure(text, "average: ") == pytest.approx(mean, **exact)
    assert int(figure(text, "hexahedra: ")) == flow.mesh.cells


def test_points_are_imposed_exactly(flow):
    flow.begin_step(0.0, STEP)
    flow.solve(moved(flow, 2e-3))
    found = read_points(flow.case.time_folder(STEP) / "polyMesh" / "points")
    assert (found == flow._following.now.points).all()
    assert np.abs(found - flow.mesh_points).max() > 1e-4
    assert "Mesh OK." in check_mesh(flow, "-latestTime")


def test_solver_converges_and_conserves_volume(flow, tmp_path):
    flow.begin_step(0.0, STEP)
    flow.solve(moved(flow, 2e-3))
    log = flow.case.folder / "log.pimpleFoam"
    assert "End" in log.read_text()
    analyzer = FoamLogAnalyzer()
    number = r"([-+.\deE]+)"
    analyzer.addAnalyzer("flux", RegExpLineAnalyzer(
        "flux", f".*continuity errors : sum local = {number}, global = {number}"
    ))  # fmt: skip
    analyzer.addAnalyzer("p", RegExpLineAnalyzer(
        "p", f".*Solving for p, .*Final residual = {number}, No Iterations {number}"
    ))  # fmt: skip
    analyzer.setDirectory(str(tmp_path))
    with log.open("rb") as stream:
        analyzer.analyze(stream)
    flux = analyzer.getAnalyzer("flux").getData(STEP)
    pressure = analyzer.getAnalyzer("p").getData(STEP)
    # The pressure's residual is relative to the flux of a step, of some per cent of the volume.
    assert max(abs(float(value)) for value in flux) < 1e-12
    assert 0 < float(pressure[0]) <= 1e-11
    assert 0 < int(pressure[1]) < 200


def test_step_repeats_itself(flow):
    flow.begin_step(0.0, STEP)
    target = moved(flow, 2e-3)
    first = flow.solve(target).copy()
    other = flow.solve(moved(flow, 3e-3)).copy()
    again = flow.solve(target)
    # Bit for bit: a fresh process from the same files. Another target gives another pressure.
    assert (again == first).all()
    assert np.abs(other - first).max() > 0.1 * np.abs(first).max()


def test_first_pressure_is_that_of_the_inertia(flow):
    # From rest an Euler step is linear: p = -M_a a but for the solver's splitting and the swing of
    # the mesh in the step, which falls with the motion. Forces carry the same weights.
    laplacian = NeumannLaplacian(flow.mesh, cell_geometry(flow.mesh, flow.mesh_points))
    inertia = LiquidInertia.of(laplacian, flow.points, DENSITY)
    start = flow.points
    target = moved(flow, 1e-5)
    flow.begin_step(0.0, STEP)
    force = pressure_force(start, flow.faces, flow.solve(target))
    acceleration = (target - start) / STEP**2
    expected = -inertia.force(acceleration)
    assert np.linalg.norm(force - expected) < 0.02 * np.linalg.norm(expected)


def wall_values(path, patch, count):
    """Values (count,) that OpenFOAM wrote for a ``patch``, binary."""
    data = path.read_bytes().split(b"boundaryField")[1].split(patch)[1].split(b"value", 1)[1]
    return np.frombuffer(data.split(b"(", 1)[1][: 8 * count])


def test_walls_pressure_is_what_the_coupler_carries_on_to_them(tmp_path):
    flow = flow_at_rest(tmp_path / "foam", 540)
    flow.begin_step(0.0, STEP)
    face = flow.solve(moved(flow, 2e-3))
    got = wall_values(flow.case.time_folder(STEP) / "p", b"diaphragm", len(face)) * DENSITY
    assert np.ptp(got - face) < 1e-9 * np.ptp(face)
    cells = read_cells(flow.case.time_folder(STEP) / "p", flow.mesh.cells) * DENSITY
    own = flow.mesh.owner[flow.mesh.diaphragm]
    geometry = flow._following.now.geometry
    area = np.linalg.norm(geometry.face_area[flow.mesh.diaphragm], axis=1)
    across = DENSITY * wall_distance(flow.mesh, geometry) * flow._solution.walls.rate / area
    aside = got - (cells[own] - across)
    assert np.ptp(aside) > 0.005 * np.ptp(face)  # this mesh leans


@pytest.mark.parametrize("cells", [176, 540])
def test_pressure_of_uneven_steps_is_that_of_the_inertia(tmp_path, alive, cells):
    # As above, for accelerations that take the last steps' lengths into account as the solver does.
    flow = flow_at_rest(tmp_path / "foam", cells, openfoam=alive)
    inertia = LiquidInertia.of(
        NeumannLaplacian(flow.mesh, cell_geometry(flow.mesh, flow.mesh_points)),
        flow.points,
        DENSITY,
    )
    place, speed = [flow.points] * 2, [np.zeros_like(flow.points)] * 2
    previous = 0.0
    for dt, size in ((STEP, 1e-5), (STEP / 2, 2e-5), (STEP / 4, -1e-5), (STEP, 3e-5)):
        target = moved(flow, size)
        step = kinematics(dt, previous, place[0], speed[0], place[1], speed[1])
        flow.begin_step(flow.time, dt)
        force = pressure_force(target, flow.faces, flow.solve(target))
        flow.accept_step()
        expected = -inertia.force((target - step.prediction) / step.b**2)
        assert np.linalg.norm(force - expected) < 0.02 * np.linalg.norm(expected)
        place, speed, previous = [target, place[0]], [step.velocity(target), speed[0]], dt
    flow.close()


def test_inertia_of_a_moving_flow_is_that_of_the_steps_end(flow):
    # What the coupling has to iterate away is p + M_a a. Fluxes and pressures are taken on the
    # faces at the step's end, which the swing turns and stretches; what M_a leaves there are the
    # convective terms.
    size = 0.1 * RADIUS
    for number in range(2):
        flow.begin_step(number * STEP, STEP)
        flow.solve(moved(flow, size))
        flow.accept_step()
    start = flow.points
    flow.begin_step(flow.time, STEP)
    end = moved(flow, size)
    bump = np.zeros_like(end)
    bump[:, 2] = 1e-4 * np.where(flow.mesh.rim, 0.0, end[:, 0] * end[:, 1]) / RADIUS**2
    other = flow.close_volume(end + bump)
    answers = [pressure_force(end, flow.faces, flow.solve(points)) for points in (other, end)]
    change, acceleration = answers[0] - answers[1], (other - end) / (2 * STEP / 3) ** 2
    left = [
        float(np.linalg.norm(change + flow.liquid_inertia(points).force(acceleration)))
        for points in (start, end)
    ]
    assert left[1] < 0.8 * left[0]
    assert left[1] < 0.05 * np.linalg.norm(change)


def test_restarts_equal_one_continuous_run(tmp_path):
    # The interface moves for two steps and then stands still, so that one process can go on alone.
    # A thick liquid keeps a flow alive that depends on all that a restart must carry over.
    flow = flow_at_rest(tmp_path / "foam", 176, viscosity=1e-3)
    for number, size in enumerate((2e-3, 4e-3)):
        flow.begin_step(number * STEP, STEP)
        flow.solve(moved(flow, size))
        flow.accept_step()
    time, steps = flow.time, 5
    flow.save()  # keeps this time's files
    shutil.copytree(flow.case.folder, tmp_path / "continuous")
    for number in range(steps):
        flow.begin_step(time + number * STEP, STEP)
        flow._following._base = flow.mesh_points
        flow.solve(flow.points)
        flow.accept_step()
    end = f"{round(time + steps * STEP, 11):.12g}"
    case = tmp_path / "continuous"
    step = case / "system" / "step"
    flow.case._write_step(time, time + steps * STEP)
    shutil.copy(flow.case.folder / "system" / "step", step)
    step.write_text(re.sub(r"deltaT .*;", f"deltaT {STEP};", step.read_text()))
    shutil.copy(case / f"{time:.12g}" / "polyMesh" / "points",
                case / f"{time:.12g}" / "polyMesh" / "points0")  # fmt: skip
    openfoam = find_openfoam()
    run_program(
        openfoam.solver, case, openfoam=openfoam, log=case / "log", timeout=60, moment="all"
    )
    cells = flow.mesh.cells
    for name, tolerance in (("U", 1e-6), ("p", 1e-6)):  # linear solvers' 1e-11, over the steps
        one = read_cells(case / end / name, cells)
        two = read_cells(flow.case.time_folder(flow.time) / name, cells)
        assert np.abs(one).max() > 1e-9
        assert np.abs(one - two).max() < tolerance * np.abs(one).max(), name


def test_wall_pressure_keeps_the_cells_beside_it_at_the_speed_of_the_fluxes(tmp_path):
    # The lowest slosh decays below a level surface as exp(-1.84 z/R), by 15 % half a cell down.
    # With no pressure gradient at the wall the cells there feel half their neighbour only.
    found = {}
    built = find_openfoam()
    for name, openfoam in (("own", built), ("stock", replace(built, walls=None))):
        flow = flow_at_rest(tmp_path / name, 540, openfoam=openfoam)
        start = flow.points
        target = moved(flow, 1e-4)
        flow.begin_step(0.0, STEP)
        flow.solve(target)
        geometry = cell_geometry(flow.mesh, flow.mesh_points)
        area = geometry.face_area[flow.mesh.diaphragm]
        normal = area / np.linalg.norm(area, axis=1)[:, None]
        motion = (target - start)[flow.mesh.patch_faces].mean(axis=1) / STEP
        wall = np.sum(motion * normal, axis=1)
        velocity = flow._solution.velocity[flow.mesh.owner[flow.mesh.diaphragm]]
        beside = np.sum(velocity * normal, axis=1)
        found[name] = wall @ beside / (wall @ wall)
        depth = wall_distance(flow.mesh, geometry).mean()
        kind = (flow.case.folder / "0" / "p").read_text()
        assert ("zeroGradient" in kind) == (name == "stock")
    assert found["own"] == pytest.approx(np.exp(-1.84 * depth / RADIUS), rel=0.05)
    assert found["stock"] < 0.5 * found["own"]


def test_points_that_slide_along_a_sheet_at_rest_leave_the_liquid_at_rest(tmp_path, solver):
    # The sheet's facets change, the sheet does not move: no pressure, no velocity. As a motion of
    # the wall the same would be a blow.
    flow = flow_at_rest(tmp_path / "foam", 176, openfoam=solver)
    target = moved(flow, 2e-3)
    flow.begin_step(0.0, STEP)
    blow = np.abs(flow.solve(target)).max()
    swift = np.abs(flow._solution.velocity).max()
    flow.solve(target, InterfaceMotion(still=target, inertial=target, b=STEP))
    assert np.abs(flow._solution.wall_pressure).max() < 1e-6 * blow  # the linear solvers' 1e-11
    assert np.abs(flow._solution.velocity).max() < 1e-6 * swift
    flow.accept_step()
    flow.close()


def test_a_sheet_drives_the_same_liquid_whether_or_not_its_points_slide(tmp_path, solver):
    # Points that follow the sheet, and points that slide along it by half a cell's width, on a
    # sheet in the same motion. What differs is the facets' shape.
    found = []
    for slides in (False, True):
        flow = flow_at_rest(tmp_path / str(slides), 540, openfoam=solver)
        start, target = flow.points, moved(flow, 1e-4)
        motion = InterfaceMotion(still=start, inertial=start, b=STEP)
        if slides:
            turn = np.where(flow.mesh.rim, 0.0, 0.05 * (1 - np.hypot(*start[:, :2].T) / RADIUS))
            aside = np.stack([-start[:, 1], start[:, 0], 0 * turn], axis=1) * turn[:, None]
            slid, motion = flow.close_volume(target + aside), motion.shifted(aside)
            target = slid
        flow.begin_step(0.0, STEP)
        flow.solve(target, motion)
        found.append(pressure_force(target, flow.faces, flow._solution.face_pressure))
        flow.close()
    force = [np.sum(nodal * (found[0] / np.linalg.norm(found[0]))) for nodal in found]
    assert force[1] == pytest.approx(force[0], rel=0.03)
