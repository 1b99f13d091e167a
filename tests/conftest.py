"""What every test leaves as it found it."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest

from coupling.simulation import interrupts


@pytest.fixture(autouse=True)
def _signals_as_found() -> Iterator[None]:
    """A verb sets handlers: one test's interrupt then ended the run of another."""
    handlers = {number: signal.getsignal(number) for number in interrupts._SIGNALS}
    yield
    interrupts._raised.clear()
    for number, handler in handlers.items():
        if handler is not None:  # of another language
            signal.signal(number, handler)
