"""A scene at hand, and others like it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from dcone_cosim.api.said import settings_of
from dcone_cosim.errors import InputError
from dcone_cosim.loading import named, shipped, title_of
from dcone_cosim.scene.data import Scene as Checked


class Scene:
    """A scene that has passed every check.

    name, title   as in its file; the title tells what was changed
    phases        names of its phases, in their order
    text          as TOML, with what was changed
    settings      what was changed, as `--set` says it
    notes, warnings   what may not be meant, as `dcone validate` tells it
    """

    def __init__(self, name: str | Path, settings: Sequence[str] = ()) -> None:
        self.source, self.settings = str(name), tuple(settings)
        self.checked: Checked = named(self.source, self.settings)

    @property
    def name(self) -> str:
        return self.checked.name

    @property
    def title(self) -> str:
        return self.checked.title

    @property
    def phases(self) -> tuple[str, ...]:
        return tuple(phase.name for phase in self.checked.phases)

    @property
    def text(self) -> str:
        return self.checked.text

    @property
    def notes(self) -> tuple[str, ...]:
        return self.checked.notes

    @property
    def warnings(self) -> tuple[str, ...]:
        return self.checked.cautions

    def with_(self, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> Scene:
        """The same scene with other values; it is checked anew, and `InputError` says what is wrong as for `--set`.

        changes    by key: {"removal.tether.diameter": "2 mm"}
        tables     the same by table: removal={"tether.diameter": "2 mm", "duration": "1 h"}

        A value is a text with its unit, a number, true or false, an astropy Quantity, or a list of these.
        """
        found = list(settings_of({**(changes or {}), **tables}))
        if not found:
            raise InputError(
                'nothing is changed; expected keys and values, such as {"removal.tether.diameter": "2 mm"}'
            )
        new = {setting.partition("=")[0] for setting in found}
        kept = [setting for setting in self.settings if setting.partition("=")[0] not in new]
        return Scene(self.source, [*kept, *found])

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {self.title}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(phase.name)}</td><td>{phase.duration:g} s in steps of {phase.macro_step:g} s</td>"
            f"<td>{escape(', '.join(phase.main.terms.values()) or str(phase.main.fmu))}</td></tr>"
            for phase in self.checked.phases
        )
        return f"<b>{escape(self.title or self.name)}</b><table>{rows}</table>"


def load_scene(name: str | Path, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> Scene:
    """A scene by the name of one that comes with the program, by its path, or by the folder of a run of it.

    `changes` and `tables` change values at once, see `Scene.with_`.
    """
    settings = settings_of({**(changes or {}), **tables})
    return Scene(name, list(settings))


def list_scenes() -> dict[str, str]:
    """The scenes that come with the program: name and title."""
    return {name: title_of(path) for name, path in shipped().items()}


def as_scene(scene: Scene | str | Path) -> Scene:
    return scene if isinstance(scene, Scene) else Scene(scene)
