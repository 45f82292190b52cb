"""The schemes that advance the nodes, by the name a scene gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from fmu_src.interface import Variable
from fmu_src.net_capture.formulas import accurate_step, longest_step
from fmu_src.rows import parameter, peak


def as_closely(values: Mapping[str, float], step: float) -> Mapping[str, tuple[float, float]]:
    """Nothing holds less closely."""
    return {}


class Needs(NamedTuple):
    """What a scheme wants before it is made.

    make_rouse(composition)   kernel `rouse(p, work, node)`: called before something other than a thread pulls a node,
                              whose positions in X and velocities in P are those of now afterwards
    make_rouse_all(composition)   kernel `rouse_all(p, work)`: the same of all nodes
    planes                    node planes of its own, behind NODE_PLANES
    longest_step, accurate_step   kernels (stiffness_rate, damping_rate) -> the longest stable step at a node, and the
                              step that is accurate [s], see `formulas`; `solver.stability_bound`, the default substep
                              and what `inspect` tells follow from them. Of a scheme that has no bound the first is the
                              leapfrog's, see `unbounded`
    whole                     whether everything that is shown with it is meant, or the net's shape alone
    factors                   substeps over the default one at which its error is measured against its cost, coarse to
                              fine; the last is for references
    steepest                  the largest share of the bound among them
    keeps                     share of the mouth area within which the accurate step stays [1]
    keeps_energy              whether it also stays within 1 % of the energy
    follows                   whether its substep may change on the way: it has a bound, and `Scheme.change`
    falls                     how the remainder of the energy book falls with the step
    instead                   criteria of a capture that mean nothing with it, each with the one by which a case that is
                              about it is judged first in its place; "" for none: there is no such case
    within(values, step)      criteria that hold less closely with it than with others, in a scene of these values at a
                              substep [s]: shares up to which a run counts as accurate and as stable, each derived
    """

    make_rouse: Any
    make_rouse_all: Any
    planes: int
    longest_step: Any = longest_step
    accurate_step: Any = accurate_step
    factors: tuple[float, ...] = (6.0, 4.0, 3.0, 2.0, 1.4, 1.0, 0.7, 0.5, 0.25)
    steepest: float = 0.95
    keeps: float = 0.003
    keeps_energy: bool = True
    whole: bool = True
    follows: bool = True
    falls: str = "with the square of solver.step_ratio"
    instead: Mapping[str, str] = MappingProxyType({})
    within: Callable[[Mapping[str, float], float], Mapping[str, tuple[float, float]]] = as_closely


UNBOUNDED: Mapping[str, str] = MappingProxyType({"bound": ""})
"""Of a scheme that is stable at any step: the bound told with it is the leapfrog's, see `unbounded`."""


class Scheme(NamedTuple):
    """Kernels of one scheme; nodes have positions in the planes X, and F is clear between substeps.

    lag                      share of a substep by which velocities lie before positions, and the losses that `step`
                             books end before now
    own_words(p)             whole numbers of work memory it wants for itself
    begin(p, work)           take over the positions in X and the velocities in U, which belong to the same instant
    step(p, work)            all nodes one substep on, and what the dashpots took
    place(p, work)           positions of now, and velocities as the dashpots see them, into SHOWN and SHOWN_RATE
    stored(p, work)          energy in the stretched threads as shown [J]
    show(p, work)            positions and velocities of now into SHOWN and SHOWN_RATE, and into SHOWN_BACK the
                             velocities with which the next substep begins; power of the dashpots now; the state stays
    change(p, work, substep) make ready for substeps of another length [s] than `solver_substep`, which still has the
                             present one; power of the dashpots now. None: it goes at one length only
    fault(p)                 code of what stopped the last substep, 0 for nothing; None: nothing ever does
    """

    lag: float
    own_words: Any
    begin: Any
    step: Any
    place: Any
    stored: Any
    show: Any
    change: Any = None
    fault: Any = None


MOST_RATIO = 1e4
"""Largest `solver.step_ratio` of a scheme without a bound."""


def unbounded(keeps: float) -> tuple[Variable, ...]:
    """Rows of a scheme that is stable at any step, in place of the model's own: its step is counted in the leapfrog's
    bound on the same net, and may exceed it.

    keeps    see `Needs`
    """
    return (
        parameter(
            "solver.step_ratio",
            "1",
            "substep over the stability bound that the leapfrog has on the same net, which this scheme may exceed; "
            f"zero: as large as keeps the mouth area within {100.0 * keeps:g} % at damping ratios from 0.1 on",
            0.0,
            0.0,
            MOST_RATIO,
        ),
        peak(
            "solver.stability_bound",
            "s",
            "stability bound that the leapfrog has on the same net, in which solver.step_ratio counts; this scheme has "
            "none",
        ),
    )


def schemes() -> dict[str, Any]:
    """Every scheme's term, by name."""
    from fmu_src.net_capture.schemes import leapfrog, rk4, ros2, xpbd

    return {"leapfrog": leapfrog.PART, "rk4": rk4.PART, "ros2": ros2.PART, "xpbd": xpbd.PART}
