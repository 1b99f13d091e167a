"""What helps against a failed run: only what differs from what its scene has already."""

from __future__ import annotations

from coupling.fluids import FLUIDS
from coupling.motion import MOTIONS
from coupling.ports import Cause, RunFailed
from coupling.scene.scene import Scene
from coupling.schemes import SCHEMES

RESTARTED = "restart"  # the flow solver that cannot take a step in parts


def with_mend(failure: RunFailed | ArithmeticError, scene: Scene, flow_solver: str | None) -> str:
    """The message of ``failure``, and what may help ``scene``, before a log that it quotes.

    ``flow_solver``: whether that of the run stayed alive or was restarted, None without a flow.
    """
    cause = failure.cause if isinstance(failure, RunFailed) else Cause.SHEET
    first, line, rest = str(failure).partition("\n")
    helps = "" if cause is None else mend(cause, scene, flow_solver)
    return f"{first} {helps}".rstrip() + line + rest


def mend(cause: Cause, scene: Scene, flow_solver: str | None) -> str:
    """A sentence on what may help ``scene`` against ``cause``; as ``with_mend``."""
    if scene.cloth.grid == "thesis":  # whose own steps are not the scene's
        return ""
    options = [_shorter_step(scene, flow_solver)]
    if cause is Cause.COUPLING:
        options = [*better_scheme(scene), *options]
    if cause is Cause.MESH:
        options = []
        options += _given(MOTIONS[scene.motion.kind].gentler)
    if flow_solver is not None:
        options += _given(FLUIDS[scene.model.fluid].instead)
    return said(options)


def better_scheme(scene: Scene) -> list[str]:
    """Return the advice to take the best coupling scheme; none where the scene has it."""
    best = next(iter(SCHEMES))
    return [] if scene.coupling.scheme == best else [f"take coupling.scheme = '{best}'"]


def _given(text: str) -> list[str]:
    return [text] if text else []


def _shorter_step(scene: Scene, flow_solver: str | None) -> str:
    shorter = f"halve time.step (it is {scene.time.step:g} s)"
    if flow_solver != RESTARTED:
        return shorter
    return f"run 'edt build-solver', whose solver takes such a step in parts, or {shorter}"


def said(options: list[str]) -> str:
    """Return ``options`` as one sentence."""
    text = ", or ".join(options)
    return f"{text[:1].upper()}{text[1:]}."
