"""The verb ``edt report``."""

from __future__ import annotations

import typer

from coupling.cli.exit_status import guarded
from coupling.cli.options import RunFolder


@guarded("coupling.report")
def report(folder: RunFolder) -> None:
    """Build report.html again from the files of a run, a study or a sweep."""
    from coupling.report import write_report
    from coupling.store.run_folder import check_reportable

    check_reportable(folder)
    typer.echo(write_report(folder))
