"""The verb ``edt verify``."""

from __future__ import annotations

from typing import Annotated

import typer

from coupling.cli.exit_status import ExitStatus, guarded, stop
from coupling.cli.json_output import print_json
from coupling.cli.options import AsJson, OpenFoamPrefix
from coupling.verify import CASES, beyond, option_pairs, run_all, run_case


@guarded("coupling.cli.tables", "coupling.ports")
def verify(
    ctx: typer.Context,
    case: Annotated[
        str | None, typer.Argument(metavar="CASE", help=f"One of {', '.join(CASES)}; or all.")
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance",
            min=0.0,
            metavar="ERROR",
            help="Largest error allowed; end with status 1 where a quantity errs by more.",
        ),
    ] = None,
    openfoam: OpenFoamPrefix = None,
    as_json: AsJson = False,
) -> None:
    """Hold cases against exact answers. Options of the case follow: --level 0.6 --mode 1."""
    if case is not None:
        results, failures = [run_case(case, option_pairs(ctx.args))], dict[str, str]()
    else:
        results, failures = run_all()
    far = beyond(results, tolerance)
    if as_json:
        judged = {} if tolerance is None else {"tolerance": tolerance, "beyond": far}
        cases = [result.to_dict() for result in results]
        print_json((cases[0] if case else {"cases": cases, "failures": failures}) | judged)
    else:
        from coupling.cli.tables import print_verify

        print_verify(results, failures)
    reasons = failures | far
    if reasons:
        stop("\n".join(f"{name}: {why}" for name, why in reasons.items()), ExitStatus.FAILED)
