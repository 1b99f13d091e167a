"""What the command's exit status says, and how a failure is told to a person."""

from __future__ import annotations

import functools
import signal
import sys
from collections.abc import Callable
from enum import IntEnum
from types import FrameType
from typing import NoReturn, ParamSpec

import typer

from coupling.foam.installation import OpenFoamMissing
from coupling.ports import RunFailed
from coupling.run_folder import FolderError
from coupling.scene import SceneError
from coupling.sweep_plan import SweepError
from coupling.verify import CaseError

P = ParamSpec("P")


class ExitStatus(IntEnum):
    """0 done; 1 the run failed; 2 the input is wrong, nothing started; 130 interrupted."""

    DONE = 0
    FAILED = 1
    WRONG_INPUT = 2
    INTERRUPTED = 130


def stop(message: str, status: ExitStatus) -> NoReturn:
    """Say ``message`` on stderr and end the verb with ``status``."""
    typer.echo(message, err=True)
    raise typer.Exit(status)


def guarded(verb: Callable[P, None]) -> Callable[P, None]:
    """A verb whose expected failures become one message and an exit status."""

    @functools.wraps(verb)
    def guard(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            verb(*args, **kwargs)
        except (SceneError, SweepError, FolderError, CaseError, OpenFoamMissing) as error:
            stop(str(error), ExitStatus.WRONG_INPUT)
        except RunFailed as error:
            stop(str(error), ExitStatus.FAILED)
        except OSError as error:
            where = f"{error.filename}: " if error.filename else ""
            stop(f"{where}{error.strerror or error}", ExitStatus.FAILED)
        except KeyboardInterrupt:
            stop("interrupted", ExitStatus.INTERRUPTED)

    return guard


def interrupt_on_sigterm() -> None:
    """Let SIGTERM end a run as Ctrl-C does: what was computed is kept, and can be resumed."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupt)


def run_app(app: typer.Typer) -> NoReturn:
    """Run the command line; an interrupt outside of any verb ends it quietly too."""
    interrupt_on_sigterm()
    try:
        app(prog_name="edt")
    except KeyboardInterrupt:
        sys.exit(ExitStatus.INTERRUPTED)
    sys.exit(ExitStatus.DONE)
