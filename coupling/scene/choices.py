"""What a scene chooses by name from lists that stand with what is chosen, as plug-ins do."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from coupling.registry import named_at, registry_at

if TYPE_CHECKING:
    from coupling.scene.scene import Scene
    from coupling.scene.sections import Motion

AUTO = "auto"  # the fluid model that is taken by the scene's own numbers


class MotionKind(Protocol):
    """What a scene asks of a kind of motion (the list is ``coupling.motion.MOTIONS``)."""

    needs: tuple[str, ...]  # keys of the section that have to be given
    takes: tuple[str, ...]  # keys of the section that may be given
    reads_file: bool  # whether ``motion.file`` is its data

    def problems(self, section: Motion, end: float, step: float) -> list[str]:
        """One line ``key: what is wrong. Mend.`` each, of a run to ``end`` [s] in ``step`` s."""

    def frequency(self, section: Motion) -> float | None:
        """Of a periodic motion [Hz], None of any other."""

    def turns(self, section: Motion) -> bool:
        """Whether the tank turns."""


def motion_kinds() -> tuple[str, ...]:
    """Names of all kinds of motion."""
    return registry_at("coupling.motion:MOTIONS").names


def motions_with(key: str) -> tuple[str, ...]:
    """Names of the kinds of motion that need ``key`` of their section."""
    return tuple(name for name in motion_kinds() if key in motion_kind(name).needs)


def motions_reading(key: str) -> tuple[str, ...]:
    """Names of the kinds of motion that need or take ``key`` of their section."""
    kinds = {name: motion_kind(name) for name in motion_kinds()}
    return tuple(name for name, kind in kinds.items() if key in (*kind.needs, *kind.takes))


def motion_kind(name: str) -> MotionKind:
    """The kind of motion called ``name``."""
    kind: MotionKind = registry_at("coupling.motion:MOTIONS")[name]
    return kind


def fluid_models() -> tuple[str, ...]:
    """Names of all fluid models, the simplest first."""
    return registry_at("coupling.fluids:FLUIDS").names


def keeps_volume(fluid: str) -> bool:
    """Whether the fluid model ``fluid`` keeps the liquid's volume; AUTO takes one that does."""
    return fluid == AUTO or bool(registry_at("coupling.fluids:FLUIDS")[fluid].keeps_volume)


def fluid_problems(scene: Scene) -> list[str]:
    """What the scene's fluid model cannot do of it; AUTO takes one that can."""
    if scene.model.fluid == AUTO:
        return []
    return list(registry_at("coupling.fluids:FLUIDS")[scene.model.fluid].problems(scene))


def takes_supply(fluid: str) -> bool:
    """Whether liquid can be drawn with the fluid model ``fluid``; not with AUTO, of any."""
    return fluid != AUTO and bool(registry_at("coupling.fluids:FLUIDS")[fluid].takes_supply)


def models_drawing() -> tuple[str, ...]:
    """Names of the fluid models with which liquid can be drawn."""
    return tuple(name for name in fluid_models() if takes_supply(name))


def default_fluid_model() -> str:
    """That of a scene which names none."""
    return str(named_at("coupling.fluids:DEFAULT"))


def tank_shapes() -> tuple[str, ...]:
    """Names of all shapes of a tank."""
    return registry_at("coupling.scene.shapes:SHAPES").names


def schemes() -> tuple[str, ...]:
    """Names of all coupling schemes."""
    return registry_at("coupling.schemes:SCHEMES").names


def best_scheme() -> str:
    """The one that a run is advised to take."""
    return schemes()[0]


def one_of(names: Callable[[], Iterable[str]], *more: str) -> BeforeValidator:
    """Validator of a key that takes one of ``names()`` or ``more``; ``errors`` has its message."""

    def check(value: Any) -> Any:
        known = (*names(), *more)
        if value not in known:
            raise PydanticCustomError("unknown_choice", "", {"choices": known})
        return value

    return BeforeValidator(check)
