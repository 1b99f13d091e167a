"""The command line: ``edt VERB``. Verbs check their input, call one function and print a table.

The modules of the verbs import what they work with only when they are called: to list the verbs
takes neither NumPy nor the scene's checks.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from coupling.cli.check import check
from coupling.cli.environment import build_solver, info
from coupling.cli.exit_status import guarded, run_app
from coupling.cli.options import RunFolder
from coupling.cli.render import render
from coupling.cli.run import resume, run
from coupling.cli.study import study
from coupling.cli.sweep import sweep
from coupling.cli.verify import verify

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"diaphragm-tank {version('diaphragm-tank')}")
        raise typer.Exit


@app.callback()
def edt(
    _: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Say the version."),
    ] = False,
) -> None:
    """Fluid-structure interaction of spherical elastomeric diaphragm tanks."""


@guarded("coupling.report")
def report(folder: RunFolder) -> None:
    """Build report.html again from the files of a run, a study or a sweep."""
    from coupling.report import write_report
    from coupling.store.run_folder import check_reportable

    check_reportable(folder)
    typer.echo(write_report(folder))


for verb in (run, resume, study, sweep, report, render, check):
    app.command()(verb)
app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})(verify)
app.command()(build_solver)
app.command()(info)


def main() -> None:
    """Entry point of ``edt``."""
    run_app(app)
