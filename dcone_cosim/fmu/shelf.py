"""Instances that are used again: `close` lays one aside, and who wants the next gets it reset.

What fmi2Reset costs is a copy; a new instance costs a library, or a process, to be loaded. An instance that refuses to
be reset is freed, and a new one is made in its place.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.fmu.isolation import IsolatedComponent


class Shelf:
    """Where instances lie between two uses, by their archive, their name and where they run.

    made      how many were made new
    reused    how many were taken from here
    """

    def __init__(self) -> None:
        self.made = self.reused = 0
        self._lying: dict[tuple[Any, ...], list[Shelved]] = {}

    def take(self, archive: Archive, name: str, apart: bool, timeout: float) -> Component | IsolatedComponent:
        """An instance as if it were new; `apart` runs it in a process of its own."""
        place = (id(archive), name, apart, timeout)
        lying = self._lying.setdefault(place, [])
        while lying:
            instance = lying.pop()
            try:
                instance.reset()
            except FmuError:
                instance.free()
                continue
            self.reused += 1
            return instance
        instance = _Apart(archive, name, timeout) if apart else _Here(archive, name)
        instance.shelf = lying
        self.made += 1
        return instance

    def clear(self) -> None:
        """Free all that lie here."""
        for lying in self._lying.values():
            while lying:
                with suppress(FmuError):
                    lying.pop().free()


class _LaidAside:
    """An instance that is laid aside when it is closed; mixed in before what it is an instance of."""

    shelf: list[Shelved] | None = None

    def close(self) -> None:
        if self.shelf is None:
            self.free()
        elif self not in self.shelf:
            self.shelf.append(self)  # type: ignore[arg-type]  # what it is mixed into

    def free(self) -> None:
        super().close()  # type: ignore[misc]


class _Here(_LaidAside, Component):
    """One in this process."""


class _Apart(_LaidAside, IsolatedComponent):
    """One in a process of its own."""


Shelved = _Here | _Apart
