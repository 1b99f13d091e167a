"""Lists of what a scene or a command chooses by name, each entry imported when it is asked for.

What is chosen stands in one file, and its name in one line of the list of its package. A scene,
which stands below the packages that it chooses from, finds their lists by ``registry_at``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Registry(Mapping[str, T], Generic[T]):
    """Entries by name, in the order of the list.

    Parameters
    ----------
    what
        What an entry is, as messages call it: "fluid model".
    entries
        "package.module:OBJECT" by name; nothing is imported before the entry is asked for.
    """

    def __init__(self, what: str, entries: Mapping[str, str]) -> None:
        self.what = what
        self._places = dict(entries)

    def __getitem__(self, name: str) -> T:
        """The entry called ``name``; KeyError with all names for an unknown one."""
        if name not in self._places:
            raise KeyError(f"unknown {self.what} '{name}'. There are {', '.join(self)}.")
        entry: T = named_at(self._places[name])
        return entry

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __contains__(self, name: object) -> bool:
        """Whether there is such an entry; does not import it."""
        return name in self._places

    @property
    def names(self) -> tuple[str, ...]:
        """Names in the order of the list."""
        return tuple(self._places)

    def rank(self, name: str) -> int:
        """Place of ``name`` in the list, 0 for the first; ValueError for an unknown one."""
        return self.names.index(name)

    def add(self, name: str, place: str, *, before: str | None = None) -> None:
        """List an entry of one's own at ``place``, "package.module:OBJECT", last or ``before`` one.

        Raises ValueError where the name is listed already.
        """
        if name in self._places:
            raise ValueError(f"there is a {self.what} '{name}' already")
        names = list(self._places)
        names.insert(len(names) if before is None else names.index(before), name)
        places = self._places | {name: place}
        self._places = {listed: places[listed] for listed in names}

    def remove(self, name: str) -> None:
        """The reverse of ``add``."""
        del self._places[name]


def named_at(place: str) -> Any:
    """What stands at ``place``, "package.module:NAME"."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def registry_at(place: str) -> Registry[Any]:
    """The list at ``place``, "package:NAME"."""
    found: Registry[Any] = named_at(place)
    return found
