"""Entry point of ``edt``: imports the command only when an interrupt cannot break that."""

from __future__ import annotations

from coupling.simulation.interrupts import exit_at_once


def main() -> None:
    """Run the command line."""
    exit_at_once()
    from coupling.cli.main import main as run_command

    run_command()
