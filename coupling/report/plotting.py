"""The first import of matplotlib: as it comes, whatever a user has set for their own figures."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import chdir, contextmanager, nullcontext
from importlib.util import find_spec
from pathlib import Path


@contextmanager
def _as_it_comes() -> Iterator[None]:
    """Within the block matplotlib reads its own settings file and no backend.

    A backend that is not installed, and a settings file that cannot be read, end the import. The
    file of the working folder comes first, then that of MATPLOTLIBRC.
    """
    spec = find_spec("matplotlib")
    assert spec is not None
    assert spec.origin is not None
    own = Path(spec.origin).with_name("mpl-data") / "matplotlibrc"
    before = {name: os.environ.pop(name, None) for name in ("MATPLOTLIBRC", "MPLBACKEND")}
    os.environ["MATPLOTLIBRC"] = str(own)
    try:
        with chdir(own.parent) if Path("matplotlibrc").exists() else nullcontext():
            yield
    finally:
        del os.environ["MATPLOTLIBRC"]
        os.environ.update({name: value for name, value in before.items() if value is not None})


with _as_it_comes():
    import matplotlib as mpl


@contextmanager
def default_settings() -> Iterator[None]:
    """Matplotlib's own defaults within the block, also where a user has loaded other ones."""
    with mpl.rc_context():
        mpl.rcdefaults()
        yield
