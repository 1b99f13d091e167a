"""Progress on stderr: a bar in a terminal, few lines elsewhere."""

import io

from rich.console import Console

from coupling.cli.progress import RunProgress


def shown(*, terminal: bool) -> str:
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=120)
    with RunProgress(console) as progress:
        for step in range(1, 101):
            progress("settling", 0.01 * step, 1.0, "")
        for step in range(1, 101):
            progress("shaking", 0.005 * step, 0.5, f"{step % 3} iterations [x]")
    return stream.getvalue()


def test_outside_a_terminal_a_stage_gives_its_start_and_its_end():
    assert shown(terminal=False).splitlines() == [
        "settling: 0.010 / 1.000 s",
        "settling: 1.000 / 1.000 s",
        "shaking: 0.005 / 0.500 s 1 iterations [x]",
        "shaking: 0.500 / 0.500 s 1 iterations [x]",
    ]


def test_in_a_terminal_both_stages_have_a_bar():
    last = shown(terminal=True)
    for text in ("settling", "1.000 / 1.000 s", "shaking", "0.500 / 0.500 s", "1 iterations [x]"):
        assert text in last
