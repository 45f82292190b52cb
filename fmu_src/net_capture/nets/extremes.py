"""The ends of a net's range: threads stiff, soft, damped and fine, knots far lighter than bullets, no slack at all."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from fmu_src.extremes import Extreme, Given, Values, times
from fmu_src.net_capture.nets import Checks

Total = Callable[[Values], float]
Sides = Callable[[Values], list[float]]

LIGHTEST_KNOT = 1e-9
"""Mass of a knot [kg] beside bullets of 10 kg."""
HEAVY_BULLET = 10.0
ORDER_AT = 0.8
"""Share of the bound of stability at which the order is looked at, and at a quarter of it."""
FLAT: dict[str, str | None] = {"folding": "flat"}
OPENING = {"target": None, "contact": None, "closing": None, **FLAT}
"""A net that meets nothing."""


def extremes(checks: Checks) -> tuple[Extreme, ...]:
    """Those of a net, by what it says of a scene's values."""
    return (*_stiffness(), *_damping(), *_meshes(checks.sides), *_masses(checks.total), *_folds(checks.widths))


def of_threads(checks: Checks) -> tuple[Extreme, ...]:
    """Those of a net whose meshes and mass are no parameters."""
    return (*_stiffness(), *_damping(), *_folds(checks.widths))


def _stiffness() -> Iterator[Extreme]:
    name = "net.youngs_modulus"
    for factor, duration in ((1e-3, 0.0), (1e-1, 0.0), (1e2, 0.0), (1e4, 4.0), (1e6, 1.0)):
        yield Extreme(
            f"threads {factor:g} times as stiff",
            "Young's modulus of the thread, and with it the substep",
            "energy_gained",
            {name: times(name, factor)},
            duration=duration,
            chief=factor == 1e2,
        )


def _damping() -> Iterator[Extreme]:
    for ratio in (0.0, 0.01, 1.0, 10.0):
        yield Extreme(
            f"threads' damping ratio {ratio:g}",
            "dashpots from none to ten times critical",
            "energy_lost" if ratio else "energy_gained",
            {"net.damping_ratio": ratio},
            chief=ratio in (0.0, 10.0),
        )


def _meshes(sides: Sides) -> Iterator[Extreme]:
    def into(mesh: float) -> Callable[[Values], float]:
        """A mesh near that width, of which the first side holds a whole number."""

        def width(values: Values) -> float:
            side = sides(values)[0]
            return side / max(2, round(side / mesh))

        return width

    whole = ", the whole opening"
    for mesh, duration, much in (
        *((12.0, 0.0, ""), (1.0, 0.0, ""), (0.5, 10.0, "")),
        *((0.25, 4.0, ""), (0.25, 10.0, whole), (0.1, 0.3, ""), (0.1, 10.0, whole)),
    ):
        yield Extreme(
            f"mesh of {mesh:g} m{much}",
            "knot spacing: finer nets have more and lighter knots, and shorter substeps",
            "flight",
            {"net.mesh": into(mesh)},
            terms={"nodes": None},
            duration=duration,
        )


def _masses(total: Total) -> Iterator[Extreme]:
    def mass(values: Values) -> float:
        """Of a net whose inner knots have the lightest mass [kg]: a knot holds two threads' worth."""
        return LIGHTEST_KNOT * total(values) / (2.0 * values["net.mesh"])

    def stiffer(values: Values) -> float:
        """The modulus that keeps the thread's EA, whose section follows the mass."""
        return values["net.youngs_modulus"] * values["net.mass"] / mass(values)

    light: dict[str, Given] = {"net.mass": mass, "bullets.mass": HEAVY_BULLET}
    about = f"knots of {LIGHTEST_KNOT:g} kg beside bullets of {HEAVY_BULLET:g} kg"
    yield Extreme(f"{about}, same EA", "masses ten decades apart on stiff threads", "energy_gained",
                  {**light, "net.youngs_modulus": stiffer}, duration=1.0)  # fmt: skip
    yield Extreme(f"{about}, same material", "the same with threads as thin as they are light", "energy_gained", light)
    yield Extreme("net of 10 mg", "a net far lighter than what it hits may not go through it", "depth",
                  {"net.mass": 1e-5}, needs=("contact",))  # fmt: skip


def _folds(widths: Callable[[Values], tuple[float, float]]) -> Iterator[Extreme]:
    def open_already(values: Values) -> float:
        return (1.0 - 1e-9) * min(widths(values))

    yield Extreme("no slack", "a net that is flat at the start: every thread goes taut at once", "energy_gained",
                  {"net.fold_side": open_already}, terms=OPENING, chief=True)  # fmt: skip
    still: dict[str, Given] = {"net.fold_side": open_already, "bullets.angle": 1.5, "solver.step_ratio": ORDER_AT}
    for ratio in (0.106, 0.5):
        yield Extreme(
            f"taut from the start, damping ratio {ratio:g}",
            "bullets leave a flat net sideways: while all is taut, errors fall with the square of the substep at least",
            "order",
            {**still, "net.damping_ratio": ratio},
            terms=OPENING,
            duration=0.02,
            chief=ratio == 0.5,
        )
    yield Extreme("all slack", "a net folded into a point", "energy_gained", {"net.fold_side": 1e-6}, terms=FLAT)
    yield Extreme(
        "fold as wide as the net",
        "no canister holds that: it is to be refused",
        "refused",
        {"net.fold_side": lambda values: math.nextafter(min(widths(values)), math.inf)},
        terms=FLAT,
    )
