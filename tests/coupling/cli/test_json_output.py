"""With --json a verb prints one object, whatever its exit status; and what verify says."""

import json
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from test_cli import SUMMARY, case, driver, edt

from coupling.cli.exit_status import run_app
from coupling.cli.main import app
from coupling.ports import RunFailed
from coupling.verify import VerifyResult, beyond, quantity

__all__ = ["case", "driver"]  # fixtures


def failure(result):
    """The object that a verb has printed, after a look at its exit status."""
    content = json.loads(result.stdout)
    assert content["exit_status"] == result.exit_code
    assert content["error"] in result.stderr
    return content["error"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "nowhere"),
        ("resume", "nowhere"),
        ("study", "nowhere"),
        ("sweep", "nowhere", "--over", "tank.radius=1,2"),
        ("check", "nowhere"),
        ("check", "half_full", "--set", "tank.radius=-1"),
        ("study", "half_full", "--models", "water"),
        ("verify", "nothing"),
        ("verify", "chain", "--nope", "1"),
        ("verify", "momentum", "--step", "0"),
        ("verify", "momentum", "--fluid", "potential", "--resolution", "-1"),
        ("verify", "slosh", "--step", "-1"),
        ("verify", "slosh", "--fluid", "potential", "--step", "nan"),
        ("verify", "cylinder", "--fluid", "openfoam", "--step", "0"),
        ("verify", "slosh", "--resolution", "1"),
    ],
)
def test_wrong_input_is_an_object_too(case: Path, arguments: tuple[str, ...]):
    result = edt(*arguments, "--json")
    assert result.exit_code == 2
    assert failure(result)


def test_a_run_that_failed_prints_its_summary_and_no_second_object(case: Path, driver, monkeypatch):
    failed = SUMMARY | {"status": "failed", "error": "t = 0.1 s: of the test."}
    monkeypatch.setattr(driver, "run", lambda *_, **__: failed)
    result = edt("run", case, "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["error"] == "t = 0.1 s: of the test."


def test_a_run_that_fails_without_a_summary_is_an_object(case: Path, driver, monkeypatch):
    def full(*_, **__):
        raise RunFailed("the disk is full.")

    monkeypatch.setattr(driver, "run", full)
    result = edt("run", case, "--json")
    assert result.exit_code == 1
    assert failure(result) == "the disk is full."


@pytest.mark.parametrize("arguments", [["check"], ["check", "here", "--bad"], ["nothing"]])
def test_a_command_line_that_cannot_be_read_is_an_object(arguments, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["edt", *arguments, "--json"])
    with pytest.raises(SystemExit) as ended:
        run_app(app)
    assert ended.value.code == 2
    printed = capsys.readouterr()
    assert json.loads(printed.out)["exit_status"] == 2
    assert json.loads(printed.out)["error"] in printed.err


def test_the_version_is_said():
    result = edt("--version")
    assert result.exit_code == 0
    assert result.stdout.strip() == f"diaphragm-tank {version('diaphragm-tank')}"


def test_verify_fails_beyond_the_tolerance_that_is_given():
    """A chain of 16 links errs by some 1e-3 in its frequency."""
    options = ("verify", "chain", "--resolution", "16", "--step", "0.02")
    error = json.loads(edt(*options, "--json").stdout)["quantities"][0]["error"]
    assert edt(*options, "--tolerance", 2.0 * error).exit_code == 0
    result = edt(*options, "--tolerance", 0.5 * error)
    assert result.exit_code == 1
    assert f"chain: frequency errs by {error:.3g}, above the tolerance" in result.stderr
    content = json.loads(edt(*options, "--tolerance", 0.5 * error, "--json").stdout)
    assert list(content["beyond"]) == ["chain"]
    assert edt(*options, "--tolerance", "-1").exit_code == 2


def test_an_error_that_is_no_number_is_beyond_any_tolerance():
    one = VerifyResult(
        case="one", options={}, quantities=(quantity("height", float("nan"), 1.0),), wall_s=0.0
    )
    assert beyond([one], 1e9) == {"one": "height errs by nan, above the tolerance of 1e+09"}
    assert beyond([one], None) == {}
