"""Whether the solver and the walls' library compile against the headers of other versions.

EDT_OPENFOAM_SOURCES names a folder of OpenCFD's source archives, such as OpenFOAM-v2312.tgz.
Without it these tests are skipped: the headers of other versions are no part of a fresh machine.
What compiles has not been run: nothing is linked here, and no flow computed.
"""

import os
import re
import subprocess
import tarfile
from pathlib import Path

import pytest

from coupling.foam.build import _FLAGS, COMPILE_TIMEOUT
from coupling.foam.debian_source import unpack_headers
from coupling.foam.solver_cache import sources

FOLDER = os.environ.get("EDT_OPENFOAM_SOURCES")
ARCHIVES = sorted(Path(FOLDER).glob("OpenFOAM-v*.t*")) if FOLDER else []
UNITS = sorted(name for name in sources() if name.endswith(".C"))

pytestmark = pytest.mark.skipif(not ARCHIVES, reason="EDT_OPENFOAM_SOURCES names no archives")


def stated(archive, name, pattern):
    """What a file of the source states."""
    with tarfile.open(archive) as files:
        for member in files:
            if member.name.endswith(f"/{name}"):
                found = re.search(pattern, files.extractfile(member).read().decode())
                return found[1]
    raise AssertionError(f"{archive}: no {name}")


@pytest.fixture(scope="module", params=ARCHIVES, ids=lambda path: path.stem)
def compiler(request, tmp_path_factory):
    """The words that start the compiler as this version's wmake does."""
    place = tmp_path_factory.mktemp("headers")
    folders = unpack_headers(request.param, place)
    assert all(folder.is_dir() for folder in folders)
    api = stated(request.param, "META-INFO/api-info", r"api=(\d+)")
    standard = stated(request.param, "wmake/rules/General/Gcc/c++", r"CC\s*:?=.*(-std=\S+)")
    flags = [flag for flag in _FLAGS if not flag.startswith("-std")]
    return ["g++", standard, *flags, f"-DOPENFOAM={api}", *(f"-I{folder}" for folder in folders)]


@pytest.mark.parametrize("unit", UNITS)
def test_source_compiles(compiler, unit, tmp_path):
    for name, text in sources().items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    done = subprocess.run(
        [*compiler, "-fsyntax-only", str(tmp_path / unit)],
        capture_output=True, text=True, timeout=COMPILE_TIMEOUT,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
