"""The one place that knows the compiler."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

# Sums may be re-associated so that they vectorise; NaN and infinity keep their meaning. The order
# is fixed at compile time, so a repeated call repeats its answer bit for bit on one machine.
_FLAGS = {"reassoc", "contract", "arcp", "nsz"}


def compiled(function: Function) -> Function:
    """``function`` compiled on its first call (and cached on disk), its signature kept."""
    return cast(Function, numba.njit(cache=True, fastmath=_FLAGS, error_model="numpy")(function))


def compiled_strictly(function: Function) -> Function:
    """As ``compiled``, but every operation as written: the same bits wherever it is inlined.

    A compiled function that calls others may sum in another order once it comes from the cache
    on disk. A chaotic algorithm would turn that into another answer.
    """
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
