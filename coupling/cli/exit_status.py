"""What the command's exit status says, and how a failure is reported."""

from __future__ import annotations

import functools
import io
import sys
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from importlib import import_module
from typing import NoReturn, ParamSpec, cast

import typer

from coupling.cli.json_output import one_object, print_failure
from coupling.simulation.interrupts import (
    STATUS,
    exit_at_once,
    raise_interrupt,
    wrapped_interrupts_raised,
)

P = ParamSpec("P")
# The base of all that is wrong with a command line itself; typer names no other of them.
USAGE_ERROR = cast(type[typer.BadParameter], typer.BadParameter.__base__)


class ExitStatus(IntEnum):
    """0 done; 1 the run failed; 2 the input is wrong, nothing started; 130 interrupted."""

    DONE = 0
    FAILED = 1
    WRONG_INPUT = 2
    INTERRUPTED = STATUS


def stop(message: str, status: ExitStatus) -> NoReturn:
    """Say ``message`` on stderr and end the verb with ``status``."""
    with suppress(OSError):  # the terminal was closed
        typer.echo(message, err=True)
    print_failure(message, status)
    raise typer.Exit(status)


def guarded(*modules: str) -> Callable[[Callable[P, None]], Callable[P, None]]:
    """Make a verb whose expected failures become one message and an exit status.

    ``modules``: those that the verb works with. They are imported when it is called, so that the
    others start without them, and before interrupts are raised: an interrupt within an import,
    above all of compiled modules, may come out as another error.
    """

    def guard(verb: Callable[P, None]) -> Callable[P, None]:
        @functools.wraps(verb)
        def called(*args: P.args, **kwargs: P.kwargs) -> None:
            with one_object(wanted=kwargs.get("as_json") is True):
                for module in modules:
                    import_module(module)
                _checked(verb, *args, **kwargs)

        return called

    return guard


def _checked(verb: Callable[P, None], *args: P.args, **kwargs: P.kwargs) -> None:
    raise_interrupt()
    try:
        with wrapped_interrupts_raised():
            verb(*args, **kwargs)
    except typer.Exit:
        raise
    except KeyboardInterrupt:
        stop("interrupted", ExitStatus.INTERRUPTED)
    except _wrong_input() as error:
        stop(str(error), ExitStatus.WRONG_INPUT)
    except _failure() as error:
        stop(str(error), ExitStatus.FAILED)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        stop(f"{where}{error.strerror or error}", ExitStatus.FAILED)


def _wrong_input() -> tuple[type[Exception], ...]:
    """What is raised before anything starts; imported when a verb has failed, as it takes long."""
    from coupling.campaign.sweep_plan import SweepError
    from coupling.foam.prefixes import OpenFoamMissing
    from coupling.scans.errors import ScanError
    from coupling.scene.errors import SceneError
    from coupling.store.atomic import UnreadableFile
    from coupling.store.folder_lock import FolderError
    from coupling.verify.case import CaseError

    return (
        SceneError, SweepError, FolderError, CaseError, OpenFoamMissing, UnreadableFile, ScanError,
    )  # fmt: skip


def _failure() -> type[Exception]:
    from coupling.ports import RunFailed

    return RunFailed


def run_app(app: typer.Typer) -> NoReturn:
    """Run the command line; an interrupt outside of any verb ends it quietly too.

    What the terminal's encoding lacks is printed as its code.
    """
    exit_at_once()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        status = app(prog_name="edt", standalone_mode=False)
    except USAGE_ERROR as error:
        error.show()
        with one_object(wanted="--json" in sys.argv[1:]):
            print_failure(error.format_message(), error.exit_code)
        sys.exit(error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(ExitStatus.INTERRUPTED)
    sys.exit(status or ExitStatus.DONE)
