"""JSON on stdout: a verb with ``--json`` prints one object, also where it fails."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_wanted: ContextVar[bool] = ContextVar("_wanted", default=False)  # and not printed yet


@contextmanager
def one_object(*, wanted: bool) -> Iterator[None]:
    """Within it ``print_failure`` prints an object if one is ``wanted`` and none was printed."""
    before = _wanted.set(wanted)
    try:
        yield
    finally:
        _wanted.reset(before)


def print_json(value: Mapping[str, Any]) -> None:
    """Print ``value`` on stdout as JSON; numbers that JSON does not know become null."""
    print(json.dumps(_finite(value), indent=2))
    _wanted.set(False)


def print_failure(message: str, status: int) -> None:
    """Print why a verb ends with ``status``, as an object of ``error`` and ``exit_status``."""
    if _wanted.get():
        print_json({"error": message, "exit_status": int(status)})


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
