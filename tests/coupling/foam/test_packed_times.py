"""Fields of one time as bytes: with them the version of OpenFOAM, which a resumed run must have."""

from pathlib import Path

import numpy as np
import pytest

from coupling.finite_volume.mesh import half_ball
from coupling.foam.case import Case
from coupling.foam.packed_times import packed, unpack
from coupling.foam.process import OpenFoam, OpenFoamFailed


def case_of(folder, version):
    openfoam = OpenFoam(solver=Path("pimpleFoam"), project_dir=Path("/foam"), version=version)
    return Case(folder, half_ball(176), openfoam=openfoam, timeout=1.0)


@pytest.fixture
def saved(tmp_path):
    """Fields that OpenFOAM v1912 computed."""
    case = case_of(tmp_path / "began", "1912")
    (case.time_folder(0.5) / "uniform").mkdir(parents=True)
    (case.time_folder(0.5) / "uniform" / "time").write_bytes(b"0.5;\xff")
    return packed(case, 0.5)


@pytest.mark.parametrize("version", ["1912", "v1912"])
def test_same_version_goes_on(saved, tmp_path, version):
    case = case_of(tmp_path / "on", version)
    unpack(case, 0.5, saved)
    assert (case.time_folder(0.5) / "uniform" / "time").read_bytes() == b"0.5;\xff"


def test_another_version_is_refused_with_the_mend(saved, tmp_path):
    case = case_of(tmp_path / "on", "v2312")
    with pytest.raises(OpenFoamFailed, match=r"begun with OpenFOAM 1912.* v2312 in /foam\. \S"):
        unpack(case, 0.5, saved)
    assert not case.folder.exists()


def test_checkpoint_without_a_version_goes_on(saved, tmp_path):
    older = {name: data for name, data in saved.items() if name.startswith("file:")}
    assert len(older) == len(saved) - 1
    case = case_of(tmp_path / "on", "v2312")
    unpack(case, 0.5, {**older, "clock": np.zeros(2)})
    assert case.time_folder(0.5).is_dir()
