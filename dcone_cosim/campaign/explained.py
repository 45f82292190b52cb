"""What the spread of a campaign's figures comes from, as far as its cases can tell: indices, surrogates."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

import numpy as np

from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.inputs import JITTER, Inputs
from dcone_cosim.campaign.outcomes import answered, succeeded
from dcone_cosim.campaign.sensitivity import Indices, Surrogate, sobol_indices, surrogates
from dcone_cosim.campaign.spec import RANDOM, SALTELLI, Spec

NOTHING = 0.9
"""Error of a surrogate from which on it explains nothing [1]."""
VAGUE = 0.5
"""Half the width of a total index's interval from which on it says nothing [1]."""
SUCCESS = "success"
"""Name of the figure that is 1 where a case came out as is wanted, else 0."""


@dataclass
class Explained:
    """By figure."""

    indices: list[Indices] = field(default_factory=list)
    surrogates: dict[str, list[Surrogate]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def explained(spec: Spec, inputs: Inputs, made: Sequence[Made]) -> Explained:
    """Indices of cases that were made for them, or surrogates of cases at random."""
    found = Explained()
    figures = [name.removesuffix("?") for name in spec.indices]
    if spec.sampler == SALTELLI:
        if find_spec("SALib") is None:
            found.notes.append("no Sobol indices: SALib is not installed; pip install 'dcone-cosim[campaign]'")
            return found
        for name in (*figures, SUCCESS):
            one = sobol_indices(name, inputs.names, _column(spec, made, name), spec.confidence, spec.seed)
            if one is not None:
                found.indices.append(one)
            elif name != SUCCESS:
                found.notes.append(f"no Sobol indices of {name}: it does not change, or too few cases have it")
    elif spec.sampler in RANDOM and figures:
        if spec.correlations or any(one.together for one in spec.dispersions):
            found.notes.append("no surrogates: the values are correlated, and no share of the spread is that of one")
        elif find_spec("openturns") is None:
            found.notes.append("no surrogates: OpenTURNS is not installed; pip install 'dcone-cosim[campaign]'")
        else:
            found.surrogates = dict(_surrogates(spec, inputs, made, figures))
    return found


def _surrogates(
    spec: Spec, inputs: Inputs, made: Sequence[Made], figures: Sequence[str]
) -> Iterator[tuple[str, list[Surrogate]]]:
    smooth = [place for place, one in enumerate(inputs.inputs) if one.name != JITTER]
    points = np.array([one.point for one in made], dtype=float)
    for name in figures:
        names, normal = [inputs.names[i] for i in smooth], [inputs.inputs[i].normal for i in smooth]
        fitted = surrogates(names, normal, points[:, smooth], np.array(_column(spec, made, name)))
        if fitted:
            yield name, fitted


def _column(spec: Spec, made: Sequence[Made], name: str) -> list[float]:
    """A figure of every case, NaN where it has none."""
    if name == SUCCESS:
        verdicts = [succeeded(one.row, spec.success) for one in made]
        return [math.nan if verdict is None else float(verdict) for verdict in verdicts]
    values = [one.row.figures.get(name) if answered(one.row) else None for one in made]
    return [float(value) if isinstance(value, int | float) else math.nan for value in values]


def sentences(found: Explained) -> Iterator[str]:
    """What explains most, in words.

    Checked  tests/campaign/test_sensitivity.py
    """
    for one in found.indices:
        first = max(one.inputs, key=lambda index: index.total)
        share, error = 100.0 * first.total, 100.0 * first.total_error
        if not first.total_error < VAGUE:
            yield f"{one.figure}: {one.samples} base samples are too few to tell what its variance comes from"
            continue
        yield f"{one.figure}: {first.name} takes part in {share:.0f} % of its variance (+- {error:.0f} %)"
    for name, fitted in found.surrogates.items():
        best = min(fitted, key=lambda surrogate: surrogate.error)
        if best.error >= NOTHING:
            yield f"{name}: no surrogate explains it; its pattern is below the jitter, or needs more cases"
            continue
        yield (
            f"{name}: a {best.kind} explains {100.0 * (1.0 - best.error):.0f} % of the variance of cases it has not "
            "seen; the rest is jitter, or finer than it can be"
        )


def as_dict(found: Explained) -> dict[str, Any]:
    """For machines."""
    return {
        "indices": {
            one.figure: {
                "samples": one.samples,
                "left_out": one.left_out,
                "inputs": {index.name: _index(index) for index in one.inputs},
            }
            for one in found.indices
        },
        "surrogates": {
            name: [
                {
                    "kind": one.kind,
                    "degree": one.degree,
                    "cases": one.cases,
                    "error": one.error,
                    "indices": {key: {"first": first, "total": total} for key, (first, total) in one.indices.items()},
                }
                for one in fitted
            ]
            for name, fitted in found.surrogates.items()
        },
    }


def _index(one: Any) -> Mapping[str, float]:
    return {"first": one.first, "first_error": one.first_error, "total": one.total, "total_error": one.total_error}
