"""Ctrl-C, SIGTERM and SIGHUP: all of them end a verb as an interrupt, with status 130."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STATUS = 130
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_usual_hook = sys.unraisablehook
_raised: list[int] = []  # signals since ``raise_interrupt``


def exit_at_once() -> None:
    """Let an interrupt end the process at once, while nothing is there to be kept.

    An exception within an import, above all of compiled modules, may come out as another one.
    """
    for number in _SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has it
            signal.signal(number, _exit)


def raise_interrupt() -> None:
    """From ``exit_at_once`` on, let an interrupt raise ``KeyboardInterrupt``: results are kept.

    Further SIGTERM and SIGHUP are then ignored: a closing terminal, or a batch system, may send
    several while the summary is written.
    """
    _raised.clear()
    sys.unraisablehook = _unraisable
    for number in _SIGNALS:
        if signal.getsignal(number) is _exit:
            signal.signal(number, _raise)


def _unraisable(dropped: sys.UnraisableHookArgs) -> None:
    """Print no trace of an interrupt that Python drops: see ``raise_lost_interrupt``.

    Nor of what fails in the finalizers of what it has left half made.
    """
    if not _raised:
        _usual_hook(dropped)


def _exit(number: int, frame: FrameType | None) -> None:
    try:
        os.write(sys.__stderr__.fileno() if sys.__stderr__ else 2, b"interrupted\n")
    finally:
        os._exit(STATUS)


def _raise(number: int, frame: FrameType | None) -> None:
    for other in _SIGNALS:
        if other != signal.SIGINT and signal.getsignal(other) is _raise:
            signal.signal(other, signal.SIG_IGN)
    _raised.append(number)
    raise KeyboardInterrupt


def raise_lost_interrupt() -> None:
    """Raise ``KeyboardInterrupt`` where one has been raised before, and lost.

    Python drops an exception that a signal raises within a finalizer or a weak reference's
    callback. Whoever goes on for long asks here from time to time.
    """
    if _raised:
        raise KeyboardInterrupt


@contextmanager
def wrapped_interrupts_raised() -> Iterator[None]:
    """Raise ``KeyboardInterrupt`` for any error of the body that comes after one was raised.

    Compiled code raises another error from it: Numba's dispatcher a ``SystemError``, say.
    """
    try:
        yield
    except Exception as error:
        if _raised:
            raise KeyboardInterrupt from error
        raise
