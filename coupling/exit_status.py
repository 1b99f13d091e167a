"""What the command's exit status says, and how a failure is told to a person."""

from __future__ import annotations

import functools
import signal
import sys
from collections.abc import Callable
from enum import IntEnum
from types import FrameType
from typing import NoReturn, ParamSpec, cast

import typer

from coupling.foam.installation import OpenFoamMissing
from coupling.json_output import one_object, print_failure
from coupling.ports import RunFailed
from coupling.run_folder import FolderError
from coupling.scene import SceneError
from coupling.sweep_plan import SweepError
from coupling.verify import CaseError

P = ParamSpec("P")
# The base of all that is wrong with a command line itself; typer names no other of them.
USAGE_ERROR = cast(type[typer.BadParameter], typer.BadParameter.__base__)


class ExitStatus(IntEnum):
    """0 done; 1 the run failed; 2 the input is wrong, nothing started; 130 interrupted."""

    DONE = 0
    FAILED = 1
    WRONG_INPUT = 2
    INTERRUPTED = 130


def stop(message: str, status: ExitStatus) -> NoReturn:
    """Say ``message`` on stderr and end the verb with ``status``."""
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
        status = app(prog_name="edt", standalone_mode=False)
    except USAGE_ERROR as error:
        error.show()
        with one_object(wanted="--json" in sys.argv[1:]):
            print_failure(error.format_message(), error.exit_code)
        sys.exit(error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(ExitStatus.INTERRUPTED)
    sys.exit(status or ExitStatus.DONE)
