"""What a sizing asks: factor of safety, what else the line has to bear, how much is tried.

A scene's table [sizing] says it, the command line goes before that, and what neither says has a default that the report
tells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from dcone_cosim.errors import InputError
from dcone_cosim.scene.data import Scene
from dcone_cosim.sizing.flux import Flux
from orbital.materials import FORMS, Material, UnknownMaterial, named


@dataclass(frozen=True)
class Options:
    """How a sizing is done.

    factor_of_safety      on the highest tension [1]
    least_breaking_load   that handling asks for, whatever the line bears in space [N]
    mission_time          that the line is out [s]; None: until the scene's thrust has brought the pair down
    cut_probability       that debris cuts the line in that time, at most [1]
    offset                of the pull from the chaser's centre of mass, where the chaser is a point [m]
    torque                of the chaser's attitude control, where the scene has none [N m]
    ranges                key of the scene: least and largest value, as texts
    samples, steps        runs of the uncertain values at random; points of a sensitivity
    materials             names of those that the line is sized of beside the scene's own; empty: all that there are
    quick                 fewer runs, for a first look
    phase                 the tow that is sized
    told                  names of those that the scene or the command line says
    """

    factor_of_safety: float = 2.0
    least_breaking_load: float = 0.0
    mission_time: float | None = None
    cut_probability: float = 0.01
    flux: Flux = field(default_factory=Flux)
    offset: float = 0.1
    torque: float = 0.2
    ranges: Mapping[str, Sequence[str]] = field(default_factory=dict)
    samples: int = 64
    steps: int = 7
    materials: tuple[str, ...] = ()
    quick: bool = False
    phase: str = "removal"
    told: frozenset[str] = frozenset()


FULL, QUICK = Options(), Options(samples=12, steps=3, quick=True)
_FLUX = {
    "flux": "value",
    "flux_size": "size",
    "flux_exponent": "exponent",
    "flux_sizes": "sizes",
    "flux_values": "values",
}
MOST_SAMPLES = 100_000


def options_of(
    scene: Scene,
    quick: bool = False,
    factor_of_safety: float | None = None,
    samples: int | None = None,
    ranges: Sequence[str] = (),
    materials: Sequence[str] = (),
    phase: str | None = None,
) -> Options:
    """What a sizing of a scene asks.

    ranges      `KEY=LEAST..LARGEST` of the command line
    materials   names, of yarns and of braids as in "Kevlar 29 braid"
    phase       the tow, where the scene has two
    """
    for name in materials:
        try:
            of_name(name)
        except UnknownMaterial as error:
            raise InputError(f"--material {name}: {error}") from None
    told = dict(scene.sizing)
    chosen = QUICK if quick else FULL
    if factor_of_safety is not None:
        told["factor_of_safety"] = factor_of(factor_of_safety)
    if samples is not None:
        if not 0 <= samples <= MOST_SAMPLES:
            raise InputError(f"--samples {samples}: expected 0 to {MOST_SAMPLES}")
        told["samples"] = samples
    told["ranges"] = {**told.get("ranges", {}), **dict(_range(text) for text in ranges)}
    told["materials"] = tuple(materials)
    if phase is not None:
        told["phase"] = phase
    flux = {_FLUX[name]: told.pop(name) for name in list(told) if name in _FLUX}
    if flux:
        told["flux"] = replace(chosen.flux, source="the scene, [sizing]", off=1.0, **flux)
    return replace(chosen, **told, told=frozenset(name for name, value in told.items() if value))


def factor_of(told: float) -> float:
    """A factor of safety that the command line tells, or `InputError`."""
    if not 1.0 <= told <= 100.0:
        raise InputError(f"--fos {told:g}: expected a factor of safety from 1 to 100")
    return told


def of_name(name: str) -> Material:
    """The material of a name that may have its form behind it: "Kevlar 29", "Kevlar 29 braid"."""
    plain = name.strip()
    form = next((form for form in FORMS if plain.lower().endswith(f" {form}")), "")
    return named(plain[: len(plain) - len(form)].strip(), form or FORMS[0])


def _range(text: str) -> tuple[str, tuple[str, str]]:
    key, sign, ends = text.partition("=")
    low, dots, high = ends.partition("..")
    if not (sign and dots and key.strip() and low.strip() and high.strip()):
        raise InputError(
            f'--range {text}: expected KEY=LEAST..LARGEST, such as "removal.thrust.level=-0.02 N..-0.005 N"'
        )
    return key.strip(), (low.strip(), high.strip())
