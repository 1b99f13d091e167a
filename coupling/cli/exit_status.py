"""What the command's exit status says, and how a failure is told to a person."""

from __future__ import annotations

import functools
import io
import sys
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from typing import NoReturn, ParamSpec, cast

import typer

from coupling.campaign.sweep_plan import SweepError
from coupling.cli.json_output import one_object, print_failure
from coupling.foam.installation import OpenFoamMissing
from coupling.ports import RunFailed
from coupling.scene.scene import SceneError
from coupling.simulation.interrupts import (
    STATUS,
    exit_at_once,
    raise_interrupt,
    wrapped_interrupts_raised,
)  # fmt: skip
from coupling.store.atomic import UnreadableFile
from coupling.store.folder_lock import FolderError
from coupling.verify import CaseError

P = ParamSpec("P")
# The base of all that is wrong with a command line itself; typer names no other of them.
USAGE_ERROR = cast(type[typer.BadParameter], typer.BadParameter.__base__)
_WRONG_INPUT = (
    SceneError, SweepError, FolderError, CaseError, OpenFoamMissing, UnreadableFile,
)  # fmt: skip


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


def guarded(verb: Callable[P, None]) -> Callable[P, None]:
    """A verb whose expected failures become one message and an exit status."""

    @functools.wraps(verb)
    def guard(*args: P.args, **kwargs: P.kwargs) -> None:
        with one_object(wanted=kwargs.get("as_json") is True):
            checked(*args, **kwargs)

    def checked(*args: P.args, **kwargs: P.kwargs) -> None:
        raise_interrupt()
        try:
            with wrapped_interrupts_raised():
                verb(*args, **kwargs)
        except _WRONG_INPUT as error:
            stop(str(error), ExitStatus.WRONG_INPUT)
        except RunFailed as error:
            stop(str(error), ExitStatus.FAILED)
        except OSError as error:
            where = f"{error.filename}: " if error.filename else ""
            stop(f"{where}{error.strerror or error}", ExitStatus.FAILED)
        except KeyboardInterrupt:
            stop("interrupted", ExitStatus.INTERRUPTED)

    return guard


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
