"""Cases with exact answers: ``edt verify``.

A new case is one function with keyword-only options, and one line in ``CASES``. Cases are imported
when they are asked for: listing them starts nothing and needs no OpenFOAM.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from coupling.registry import Registry
from coupling.verify.case import CaseError, Quantity, VerifyResult, beyond, quantity

__all__ = [
    "CASES",
    "CaseError",
    "Quantity",
    "VerifyResult",
    "beyond",
    "case_function",
    "case_options",
    "option_pairs",
    "quantity",
    "run_all",
    "run_case",
]

CASES: Registry[Callable[..., VerifyResult]] = Registry(
    "case",
    {
        "mylar": "coupling.verify.membranes:mylar",
        "balloon": "coupling.verify.membranes:balloon",
        "hammock": "coupling.verify.membranes:hammock",
        "lintearia": "coupling.verify.hanging:lintearia",
        "chain": "coupling.verify.hanging:chain",
        "static-level": "coupling.verify.static_level:static_level",
        "slosh": "coupling.verify.slosh:slosh",
        "layers": "coupling.verify.layers:layers",
        "cylinder": "coupling.verify.cylinder:cylinder",
        "plate": "coupling.verify.plate:plate",
        "piston": "coupling.verify.piston:piston",
        "rigid": "coupling.verify.rigid:rigid",
        "momentum": "coupling.verify.momentum:momentum",
        "hydrostatic-limit": "coupling.verify.hydrostatic_limit:hydrostatic_limit",
        "eq46": "coupling.verify.numbers:eq46",
        "numbers": "coupling.verify.numbers:numbers",
    },
)


def case_function(name: str) -> Callable[..., VerifyResult]:
    """Function of a case; ``CaseError`` for an unknown one."""
    if name not in CASES:
        raise CaseError(f"verify: unknown case '{name}'. There are {', '.join(CASES)}.")
    return CASES[name]


def case_options(name: str) -> dict[str, inspect.Parameter]:
    """Options that a case takes, by name."""
    return dict(inspect.signature(case_function(name), eval_str=True).parameters)


def _converted(case: str, parameter: inspect.Parameter, text: str) -> Any:
    kind = parameter.annotation
    if kind not in (int, float):
        return text
    try:
        return kind(text)
    except ValueError:
        wanted = "a whole number" if kind is int else "a number"
        option = parameter.name.replace("_", "-")
        raise CaseError(f"verify {case}: --{option}: must be {wanted}, got '{text}'.") from None


def run_case(name: str, options: Mapping[str, str] | None = None) -> VerifyResult:
    """Run a case with ``options`` as they stand on the command line, without the dashes.

    ``CaseError`` for an unknown case, an option that it does not take, or a value of another kind.
    """
    function, known = case_function(name), case_options(name)
    values: dict[str, Any] = {}
    for option, text in (options or {}).items():
        key = option.replace("-", "_")
        if key not in known:
            listed = ", ".join(f"--{known_key.replace('_', '-')}" for known_key in known)
            raise CaseError(f"verify {name}: unknown option --{option}. It takes {listed}.")
        values[key] = _converted(name, known[key], text)
    return function(**values)


def run_all() -> tuple[list[VerifyResult], dict[str, str]]:
    """Every case with its own defaults: results, and the reasons of those that failed, by case."""
    from coupling.ports import RunFailed  # with NumPy, which listing the cases does without

    results, failures = [], {}
    for name in CASES:
        try:
            results.append(run_case(name))
        except (RunFailed, ArithmeticError, ImportError, OSError, ValueError) as error:
            failures[name] = f"{type(error).__name__}: {error}"
    return results, failures


def option_pairs(arguments: Sequence[str]) -> dict[str, str]:
    """``--name value`` and ``--name=value`` of a command line, without the dashes.

    ``CaseError`` for a value without an option, and for an option without a value.
    """
    pairs: dict[str, str] = {}
    rest = list(arguments)
    while rest:
        option, equals, value = rest.pop(0).partition("=")
        if not option.startswith("--"):
            raise CaseError(f"verify: '{option}' is no option. Give --option value.")
        if not equals:
            if not rest:
                raise CaseError(f"verify: {option} has no value. Give {option} VALUE.")
            value = rest.pop(0)
        pairs[option.removeprefix("--")] = value
    return pairs
