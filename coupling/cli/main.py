"""The command line: ``edt VERB``. Verbs check their input, call one function and print a table.

A verb is one file, and one line in ``VERBS``.

The modules of the verbs import what they work with only when they are called: to list the verbs
takes neither NumPy nor the scene's checks.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated

import typer

from coupling.cli.exit_status import run_app
from coupling.registry import Registry

# in the order of the help
VERBS: Registry[Callable[..., None]] = Registry(
    "verb",
    {
        "run": "coupling.cli.run:run",
        "resume": "coupling.cli.run:resume",
        "study": "coupling.cli.study:study",
        "sweep": "coupling.cli.sweep:sweep",
        "identify": "coupling.cli.identify:identify",
        "design": "coupling.cli.design:design",
        "compare": "coupling.cli.compare:compare",
        "report": "coupling.cli.report:report",
        "render": "coupling.cli.render:render",
        "export": "coupling.cli.export:export",
        "check": "coupling.cli.check:check",
        "verify": "coupling.cli.verify:verify",
        "build-solver": "coupling.cli.environment:build_solver",
        "info": "coupling.cli.environment:info",
    },
)

# a verification case has options of its own
SETTINGS = {"verify": {"allow_extra_args": True, "ignore_unknown_options": True}}

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
    """Fluid-structure interaction of elastomeric diaphragm tanks."""


for name, verb in VERBS.items():
    app.command(name, context_settings=SETTINGS.get(name))(verb)


def main() -> None:
    """Entry point of ``edt``."""
    run_app(app)
