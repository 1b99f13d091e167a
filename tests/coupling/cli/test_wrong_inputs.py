"""Wrong inputs through the command: a clear message, the right exit status, no traceback."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.foam.rehearsal import rehearse

SCENE = """\
[tank]
radius = 0.4445
[diaphragm]
thickness = 0.001778
density = 1070.0
youngs_modulus = 8.6e6
poisson_ratio = 0.5
[liquid]
density = 1000.0
viscosity = 1.0e-6
fill_fraction = 0.8
[motion]
kind = "sine"
frequency = 1.25
amplitude = 0.25
[model]
fluid = "hydrostatic"
[time]
duration = 1.0
"""


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working directory with a right scene in ``case``; no verb gets as far as running it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "scene.toml").write_text(SCENE)
    return tmp_path


def write(text: str) -> Callable[[Path], None]:
    return lambda place: void((place / "case" / "scene.toml").write_text(text))


def replace(old: str, new: str) -> Callable[[Path], None]:
    assert old in SCENE
    return write(SCENE.replace(old, new))


def table(text: str) -> Callable[[Path], None]:
    def prepare(place: Path) -> None:
        (place / "case" / "truck.csv").write_text(text)
        replace('kind = "sine"', 'kind = "table"\nfile = "truck.csv"')(place)

    return prepare


def ridges(text: str) -> Callable[[Path], None]:
    def prepare(place: Path) -> None:
        (place / "case" / "ridges.csv").write_text(text)
        replace("thickness = 0.001778", 'thickness_map = "ridges.csv"')(place)

    return prepare


def void(_: object) -> None:
    return None


def nothing(_: Path) -> None:
    return None


def a_file_in_the_way(place: Path) -> None:
    (place / "taken").write_text("a file")


def an_old_run(place: Path) -> None:
    (place / "old").mkdir()
    (place / "old" / "checkpoint.h5").touch()
    (place / "old" / "scene.toml").touch()


def binary(place: Path) -> None:
    (place / "case" / "scene.toml").write_bytes(b"\x00\xff\xfe")


def rest(name: str) -> Callable[[Path], None]:
    return lambda place: void((place / name).mkdir())


WRONG = {
    "missing file": (nothing, "run nowhere.toml", "nowhere.toml: does not exist"),
    "folder without a scene": (rest("empty"), "run empty", "the folder holds no scene.toml"),
    "TOML syntax": (write("[tank\nradius = 1"), "run case", "is not valid TOML"),
    "not text": (binary, "run case", "is not UTF-8 text"),
    "wrong type": (replace("0.4445", '"big"'), "run case", 'must be a number, got "big"'),
    "fill fraction 0": (replace("= 0.8", "= 0.0"), "run case", "must lie in (0, 1), got 0.0"),
    "fill fraction 1": (replace("= 0.8", "= 1"), "run case", "must lie in (0, 1), got 1"),
    "fill fraction 1.4": (
        replace("= 0.8", "= 1.4"),
        "run case",
        "case/scene.toml: liquid.fill_fraction: must lie in (0, 1), got 1.4. "
        "Give the liquid volume over the tank volume.",
    ),
    "negative thickness": (
        replace("0.001778", "-0.001778"),
        "check case",
        "diaphragm.thickness: must be positive, got -0.001778",
    ),
    "thickness in millimetres": (replace("0.001778", "1.778"), "check case", "Give metres"),
    "NaN": (replace("0.4445", "nan"), "run case", "must be a finite number, got nan"),
    "infinite": (replace("1070.0", "inf"), "run case", "must be a finite number, got inf"),
    "unknown key": (replace("radius", "raduis"), "run case", "Did you mean radius?"),
    "unknown section": (replace("[liquid]", "[fluid]"), "run case", "fluid: unknown section"),
    "missing section": (write("[tank]\nradius = 1"), "run case", "Add the section [liquid]"),
    "step too long": (nothing, "run case --set time.step=0.1", "at most 1/20 of the motion's"),
    "no direction": (nothing, "run case --set motion.direction=[0,0,0]", "must not be zero"),
    "weightless": (nothing, "check case --set gravity=[0,0,0]", "A weightless liquid has no level"),
    "missing table": (
        nothing,
        "run case --set motion.kind=table --set motion.file=no.csv",
        "no.csv: cannot be read: No such file",
    ),
    "wrong table": (table("0,0,0,0\n1,x,0,0"), "run case", "line 2: must hold four finite"),
    "table too short": (table("0,0,0,0\n0.9,0,0,0"), "run case", "must cover 0 to 1 s"),
    "no map": (
        replace("thickness = 0.001778", 'thickness_map = "no.csv"'),
        "run case",
        "diaphragm.thickness_map: ",
    ),
    "wrong map": (ridges("0,0,0.001\n90,0,thick"), "run case", "ridges.csv: line 2: must hold"),
    "map that ends early": (ridges("0,0,0.001\n80,0,0.001"), "check case", "covers 0 to 80"),
    "map with a hole": (
        ridges("0,0,0.001\n90,0,0.001\n90,90,0.001"),
        "run case",
        "ridges.csv: polar 0, azimuth 90 is missing",
    ),
    "map in millimetres": (ridges("0,0,1.8\n90,0,1.8"), "check case", "Give metres"),
    "thickness beside a map": (
        replace("thickness =", 'thickness_map = "ridges.csv"\nthickness ='),
        "run case",
        "diaphragm.thickness: is the mean of thickness_map",
    ),
    "grid too coarse for its wrinkles": (
        nothing,
        "check case --set cloth.wrinkling=resolved",
        "Give cloth.resolution = 41 or more",
    ),
    "compliance in the thesis' grid": (
        replace('"hydrostatic"', '"datum"\n[cloth]\ngrid = "thesis"'),
        "run case --set diaphragm.inextensible=false",
        "diaphragm.inextensible: must be true",
    ),
    "unwritable output": (a_file_in_the_way, "run case -o taken/run", "cannot be written"),
    "output is a file": (a_file_in_the_way, "run case -o taken", "cannot be written"),
    "output in use": (an_old_run, "run case -o old", "Go on with it: edt resume old"),
    "output is the case": (nothing, "run case -o case", "would replace"),
    "bad --set": (nothing, "run case --set fill_fraction", "must be key=value"),
    "--set of nothing": (nothing, "run case --set =3", "must be key=value"),
    "--set unknown": (nothing, "run case --set liquid.fil_fraction=1", "Did you mean fill_fract"),
    "unknown fluid": (
        nothing,
        "run case --set model.fluid=magic",
        'must be one of "datum", "hydrostatic", "potential", "openfoam", "auto", got "magic"',
    ),
    "tolerance of auto": (nothing, "run case --set model.tolerance=1.5", "must lie in (0, 1)"),
    "unknown study model": (nothing, "study case --models datum,magic", "got 'datum,magic'"),
    "one study model": (nothing, "study case --models datum", "two or more different"),
    "unknown verb": (nothing, "launch case", "No such command 'launch'"),
    "no scene": (nothing, "run", "Missing argument"),
    "unknown option": (nothing, "run case --fast", "No such option: --fast"),
    "unknown case": (nothing, "verify tsunami", "unknown case 'tsunami'. There are"),
    "unknown case option": (
        nothing,
        "verify eq46 --depth 3",
        "unknown option --depth. It takes --resolution",
    ),
    "case option without value": (nothing, "verify eq46 --resolution", "has no value"),
    "case option of a wrong type": (
        nothing,
        "verify eq46 --resolution fine",
        "--resolution: must be a whole number, got 'fine'",
    ),
    "case option without dashes": (nothing, "verify eq46 3", "'3' is no option"),
    "resume nothing": (rest("empty"), "resume empty", "no run to go on with"),
    "resume nowhere": (nothing, "resume nowhere", "nowhere: does not exist"),
    "resume a file": (a_file_in_the_way, "resume taken", "taken: is not a folder"),
    "report nothing": (rest("empty"), "report empty", "nothing to report"),
    "report nowhere": (nothing, "report nowhere", "nowhere: does not exist"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_told_and_nothing_starts(name: str, place: Path):
    prepare, command, says = WRONG[name]
    prepare(place)
    before = sorted(path for path in place.rglob("*"))
    result = CliRunner().invoke(app, command.split())
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == 2
    assert says in result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.output
    assert sorted(path for path in place.rglob("*")) == before


def test_without_room_on_the_disk_nothing_starts(place: Path, monkeypatch):
    full = shutil.disk_usage(place)._replace(free=64_000)
    monkeypatch.setattr("shutil.disk_usage", lambda _: full)
    result = CliRunner().invoke(app, ["run", "case", "-o", "new"])
    assert result.exit_code == 2
    assert "new: its disk has 0.1 MB left" in result.stderr
    assert "Make room, or give another folder with -o." in result.stderr
    assert not (place / "new" / "scene.toml").exists()


@pytest.mark.parametrize(
    "command",
    ["run case", "check case", "study case --models datum,openfoam", "resume case"],
)
def test_without_openfoam_nothing_starts(command: str, place: Path, monkeypatch):
    rehearse.cache_clear()
    replace('"hydrostatic"', '"openfoam"')(place)
    (place / "case" / "log.txt").touch()
    monkeypatch.setenv("PATH", str(place))
    result = CliRunner().invoke(app, command.split())
    assert result.exit_code == 2
    assert "no program 'pimpleFoam'" in result.stderr
    assert "Install OpenFOAM" in result.stderr
    assert not (place / "runs").exists()


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ("run nowhere", 2),
        ("run case --set liquid.fill_fraction=1.4", 2),
        ("verify tsunami", 2),
        ("launch", 2),
        ("verify eq46", 0),
    ],
)
def test_the_process_itself_ends_with_the_status(arguments: str, status: int, place: Path):
    done = subprocess.run(
        [sys.executable, "-c", "from coupling.cli.main import main; main()", *arguments.split()],
        capture_output=True,
        text=True,
        timeout=60,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
        check=False,
    )
    assert done.returncode == status
    assert bool(done.stderr) == (status != 0)
    assert "Traceback" not in done.stderr
