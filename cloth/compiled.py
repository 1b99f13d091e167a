"""The one place that knows the compiler."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

from cloth.compiled_cache import cache_of

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return ``function`` compiled on its first call (and cached on disk), its signature kept.

    Every operation as written: with sums re-associated, a function that calls others gives other
    bits when it comes from the cache than when it was just compiled, and no resumed run would
    repeat the first. It costs nothing here: memory and square roots bound these loops.
    """
    dispatcher: Any = numba.njit(error_model="numpy")(function)
    dispatcher._cache = cache_of(function)
    return cast(Function, dispatcher)
