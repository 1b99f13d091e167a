"""``log.txt``: what is logged during a run, and by that run alone."""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from pathlib import Path

from threadpoolctl import threadpool_limits

FILE = "log.txt"

_LOGGERS = ("cloth", "coupling")
_run: ContextVar[object] = ContextVar("run", default=None)


@contextmanager
def run_log(folder: Path) -> Iterator[None]:
    """Write to ``log.txt`` in ``folder`` all that is logged in this context meanwhile.

    Runs in other threads of the process keep logs of their own.
    """
    handler = _File(folder / FILE, encoding="utf-8", errors="backslashreplace")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    handler.addFilter(lambda record: _run.get() is handler)
    token = _run.set(handler)
    for name in _LOGGERS:
        logging.getLogger(name).addHandler(handler)
    try:
        yield
    finally:
        for name in _LOGGERS:
            logging.getLogger(name).removeHandler(handler)
        _run.reset(token)
        handler.close()


class _File(logging.FileHandler):
    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - logging's own name
        if not isinstance(sys.exc_info()[1], OSError):  # a full disk ends the run by itself
            super().handleError(record)


class _ProcessSettings:
    """Settings of the whole process while a run goes in any of its threads.

    One BLAS thread, since the products are small; messages of level INFO are logged.
    """

    def __init__(self) -> None:
        self._lock, self._runs, self._undo = threading.Lock(), 0, ExitStack()

    def __enter__(self) -> None:
        with self._lock:
            self._runs += 1
            if self._runs > 1:
                return
            self._undo.enter_context(threadpool_limits(1))
            for logger in map(logging.getLogger, _LOGGERS):
                self._undo.callback(logger.setLevel, logger.level)
                logger.setLevel(logging.INFO)

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._runs -= 1
            if self._runs == 0:
                self._undo.close()


process_settings = _ProcessSettings()
