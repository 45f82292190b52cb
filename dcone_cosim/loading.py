"""Finds a scene by its name, its path, or the folder of a run of it, and reads it."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

from dcone_cosim import scenes
from dcone_cosim.errors import InputError
from dcone_cosim.files import no_file
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.reading import parse, read_text

SHIPPED = Path(scenes.__file__).parent


def shipped() -> dict[str, Path]:
    """The scenes that come with the program, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find(name: str) -> Path:
    """Path of a scene given by its name or as a path."""
    known = shipped()
    if name in known:
        return known[name]
    path = Path(name)
    try:
        is_file, is_folder, other = path.is_file(), path.is_dir(), no_file(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{name[:60]} cannot be looked for: {reason}") from error
    if is_file:
        return path
    if is_folder:
        raise InputError(f"{name} is a folder; expected a scene: a .toml file, or one of {', '.join(known)}")
    if other:
        raise InputError(f"{name} is {other}; expected a file")
    if path.suffix == ".toml" or len(path.parts) > 1:
        beside = [str(p) for p in path.parent.glob("*.toml")] if path.parent.is_dir() else []
        raise InputError(f"scene file {name} does not exist{did_you_mean(name, beside or known)}")
    raise InputError(f"no scene named {name!r}{did_you_mean(name, known)}")


def load(name: str, settings: Sequence[str] = (), choose: bool = True) -> Scene:
    """The scene of that name or path, or of the run whose folder that is; a `SceneError` lists every mistake found.

    settings     `KEY.KEY=VALUE`, each in the place of what the file says
    choose       whether the settings that its accuracy asks for are chosen
    """
    from dcone_cosim.scenes.kept import Kept, kept_in

    kept = kept_in(Path(name)) if name not in shipped() else None
    if kept is None:
        path = find(name)
        kept = Kept(path, path.stem, ())
    settings = (*kept.settings, *settings)
    if kept.path.suffix.lower() == ".ssp":
        from dcone_cosim.ssp import system

        return system.load(kept.path, settings, kept.name)
    return parse(read_text(kept.path), kept.name, str(kept.path), kept.path.parent, settings, choose)


def named(scene: str, settings: Sequence[str] = ()) -> Scene:
    """The scene that a command line names: see `load`."""
    if not scene.strip():
        raise InputError("the name of the scene is empty; `dcone list` shows the scenes there are")
    return load(scene, settings)


def title_of(path: Path) -> str:
    """The title of a scene file, without checking the rest."""
    return str(tomllib.loads(read_text(path)).get("title", ""))
