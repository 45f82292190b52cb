"""How a model trades accuracy for time: its settings from coarse to fine.

A model that has such settings has a module `trade` with

    NUMERICS                     groups whose terms differ in how a thing is computed, not in what is computed
    BESIDE                       others such, which are tried and told only where they are not the default
    DETAILS                      levels of detail: they carry over what without them is followed
    BY_TOLERANCE                 whether sizes of settings are tolerances, else they are steps
    rungs(values, terms)         settings of the scheme that the terms name, coarse to fine; the last is for references
    refinements(values, terms)   by name, other settings that refine the model itself, each coarse to fine
    whole(terms)                 whether everything that is shown with these terms is meant, energies too
    instead(terms)               criteria of a phase that mean nothing with these terms, each with the one that is asked
                                 in its place, "" for none
    reference(terms)             groups and terms of them with which a reference is computed in place of these
    within(values, terms)        criteria that hold less closely with these terms than with others: shares up to which a
                                 run counts as accurate and as stable

values are all parameters and inputs by FMI name, SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Rung(NamedTuple):
    """One setting.

    size      what the error falls with, over that of the default setting: a step, a tolerance, a length [1]
    values    parameters that make it, SI by FMI name
    """

    size: float
    values: Mapping[str, float]
