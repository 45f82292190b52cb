"""FMUs of our models, built on demand, and written to files for others."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dcone_cosim.cache import Times
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.names import did_you_mean
from dcone_cosim.ours.kept import cache_folder
from dcone_cosim.scratch import Scratch, clear_left
from fmu_src.catalogue import MODELS as CATALOGUE
from fmu_src.interface import Interface
from fmu_src.packaging.description import Experiment
from fmu_src.packaging.sources import SHIM

PAGE = "wasm32"
"""The platform of FMUs that a page runs, for `write_fmus`."""


@dataclass(frozen=True)
class Furnished:
    """An FMU of ours to be written for others, with values of its own.

    name          of its file, without suffix
    values        that it starts with where they are not the model's, SI by FMI name of a parameter or input
    experiment    the run that it is for
    tables        numbers of each table of its parts, by name
    """

    name: str
    model: str
    terms: Mapping[str, str]
    values: Mapping[str, float]
    experiment: Experiment
    tables: Mapping[str, Any] = field(default_factory=dict, compare=False)


def shared_with_template() -> dict[str, str]:
    """The files of our own FMI interface that an FMU from the C template has as well, by name."""
    return {name: (SHIM / name).read_text(encoding="utf-8") for name in ("fmi2_log.h", "fmi2_absent.h")}


def _built(interfaces: Sequence[Interface], announce: Callable[[str], None], platforms: Sequence[Any] = ()) -> Any:
    """Paths of the FMUs of each interface, one per platform, this machine's alone if none is named.

    Before a build begins it is told how long it took before; how long it takes is kept.
    """
    from fmu_src.packaging.builds import build_all
    from fmu_src.packaging.platforms import host
    from fmu_src.packaging.tools import BuildError

    clear_left(cache_folder())  # nothing else looks there when all is built already
    announced: list[str] = []
    began, times = clock.perf_counter(), Times(cache_folder())

    def tell(text: str) -> None:
        if text.startswith("building") and not announced:
            announced.append(text)
            text = f"{text}; {times.spoken()}"
        announce(text)

    try:
        built = build_all(interfaces, cache_folder(), tell, list(platforms) or [host()], Scratch)
    except BuildError as error:
        raise FmuError(str(error)) from None
    if announced and not platforms:
        times.keep(clock.perf_counter() - began)
    return built


def ensure(wanted: Sequence[tuple[str, Mapping[str, str]]], announce: Callable[[str], None]) -> list[Path]:
    """Path of the FMU of each model with its terms; those that the cache has not are built side by side, each once."""
    keys = [(model, tuple(terms.items())) for model, terms in wanted]
    unlike = list(dict.fromkeys(keys))
    built = _built([CATALOGUE[model].interface(dict(terms)) for model, terms in unlike], announce)
    paths = {key: path for key, (path,) in zip(unlike, built, strict=True)}
    return [paths[key] for key in keys]


def platform_names(text: str) -> tuple[str, ...]:
    """Platforms by the names the command line gives, `all` or a list with commas; InputError if one is unknown."""
    from fmu_src.packaging.platforms import PLATFORMS

    if text == "all":
        return tuple(PLATFORMS)
    names = dict.fromkeys(name.strip() for name in text.split(","))
    for name in names:
        if name not in PLATFORMS:
            expected = f"expected all, or some of {', '.join(PLATFORMS)}"
            raise InputError(
                f"--platforms {text}: {name!r} is not a platform; {expected}{did_you_mean(name, PLATFORMS)}"
            )
    return tuple(names)


def write_fmus(
    wanted: Sequence[Furnished], platforms: Sequence[str], folder: Path, announce: Callable[[str], None]
) -> list[Path]:
    """Write FMUs to a folder, each with its values and for all platforms named; InputError for values it cannot have.

    With no platforms named they are for this machine. Linux on arm64 has archives of its own too. Values cost no build:
    the libraries are those of the cache.
    """
    from fmu_src.packaging.builds import furnish
    from fmu_src.packaging.platforms import KNOWN, archives, host

    chosen = [KNOWN[name] for name in platforms] or [host()]
    interfaces = [_furnished(fmu) for fmu in wanted]
    keys = [(fmu.model, tuple(fmu.terms.items())) for fmu in wanted]
    unlike = list(dict.fromkeys(keys))
    built = _built([CATALOGUE[model].interface(dict(terms)) for model, terms in unlike], announce, platforms and chosen)
    libraries = dict(zip(unlike, built, strict=True))
    written = []
    for fmu, key, interface in zip(wanted, keys, interfaces, strict=True):
        of = dict(zip(chosen, libraries[key], strict=True))
        for ending, together in archives(chosen):
            written.append(folder / f"{fmu.name}{ending}.fmu")
            taken = {of[platform]: folders for platform, folders in together.items()}
            furnish(taken, interface, fmu.experiment, written[-1])
    return written


def with_tables(fmu: Path, model: str, terms: Mapping[str, str], tables: Mapping[str, Any], folder: Path) -> Path:
    """An FMU of the cache written once more to a folder, with the tables of its parts."""
    from fmu_src.packaging.builds import furnish
    from fmu_src.packaging.platforms import host

    interface = CATALOGUE[model].interface(terms).with_tables(tables)
    places = [place.folder for place in host().places]
    furnish({fmu: places}, interface, Experiment.of(interface.model), folder / fmu.name)
    return folder / fmu.name


def _furnished(fmu: Furnished) -> Interface:
    try:
        return CATALOGUE[fmu.model].interface(fmu.terms).with_tables(fmu.tables).starting(fmu.values)
    except ValueError as error:
        raise InputError(f"{fmu.name}.fmu cannot start with the values it is to have: {error}") from None


def printable(text: str) -> str:
    """A text as XML and a page can hold it, whatever the name of a file may be."""
    return "".join(c if c.isprintable() else "?" for c in text)
