"""The script that makes the cases' studies again."""

import json
import subprocess

import pytest

from foam_cases import renew

STUDY = {
    "reference": "openfoam", "models": {"datum": {"error": {"cg_amplitude": 0.2}}},
    "uncertainty": {"cg_amplitude": 0.03}, "bernoulli": {}, "sources": [], "verdict": "It errs.",
}  # fmt: skip


def case(tmp_path, command):
    """A case whose README gives ``command``, beside a block that is none of its studies'."""
    folder = tmp_path / "case"
    folder.mkdir()
    readme = (
        "# A case\n\n```sh\n.venv/bin/edt run foam_cases/case\nexit 1\n```\n\n"
        f"Its study.\n\n```sh\n{command}  # as edt study foam_cases/case -o runs/made\n```\n"
    )
    (folder / "README.md").write_text(readme)
    return folder


def writing(content):
    return f"mkdir -p runs/made; printf '%s' '{json.dumps(content)}' > runs/made/study.json"


def test_every_case_with_a_study_or_a_sweep_is_known():
    assert {one.name for one in renew.cases()} == {
        "auto_check", "expulsion", "free_tank", "lorry_record", "pad_sway", "pad_sway_coarse",
        "steady_shapes", "sway_map", "thickness",
    }  # fmt: skip
    [block] = renew.blocks((renew.HERE / "pad_sway" / "README.md").read_text(encoding="utf-8"))
    assert block.count("edt study foam_cases/pad_sway ") == 2
    # Every study says where it goes, or its figures would not be found.
    for one in renew.cases():
        for block in renew.blocks((one / "README.md").read_text(encoding="utf-8")):
            assert block.count("edt study") <= len(renew._OUTPUT.findall(block))


def test_a_study_is_run_kept_and_held_against_what_was_there(tmp_path):
    one = case(tmp_path, writing(STUDY))
    assert renew.renew(one, tmp_path) == [f"{renew.FIGURES}: None, now " + str(kept(one))]
    assert renew.renew(one, tmp_path) == []
    moved = json.loads(json.dumps(STUDY))
    moved["models"]["datum"]["error"]["cg_amplitude"] = 0.25
    readme = (one / "README.md").read_text()
    (one / "README.md").write_text(readme.replace(json.dumps(STUDY), json.dumps(moved)))
    place = f"{renew.FIGURES}.runs/made.errors.datum.cg_amplitude"
    assert renew.renew(one, tmp_path) == [f"{place}: 0.2, now 0.25"]


def kept(one):
    return json.loads((one / renew.FIGURES).read_text())


def test_a_table_is_compared_but_for_its_times(tmp_path):
    one = case(tmp_path, "sed -i 's/1.5,/1.6,/; s/9$/7/' case/data.csv")
    (one / "data.csv").write_text("name,error,wall_s\nfirst,1.5,9\nsecond,2.5,9\n")
    assert renew.renew(one, tmp_path) == ["data.csv[0].error: 1.5, now 1.6"]


def test_a_command_that_fails_ends_its_case(tmp_path):
    with pytest.raises(subprocess.CalledProcessError):
        renew.renew(case(tmp_path, "false"), tmp_path)
