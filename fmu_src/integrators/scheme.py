"""What a scheme is to whoever steps with it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple


class AdaptiveScheme(NamedTuple):
    """One embedded scheme: sizes, and kernels whose `context` is whatever the equations need, handed through untouched.

    stages        doubles of stage memory; the derivative at the begin of the step lies first in it, given on entry
    last          where in it the derivative at the end of the step lies on return
    dense         doubles of dense output

    attempt(context, start, step, stages, end)         one step; if its stages cannot be found, `error` says so
    error(context, end, step, stages, low, high)       estimate of its error in units of the tolerance; infinite where
                                                       the step failed
    prepare_dense(context, start, end, step, stages, dense, scratch)
    dense_value(start, dense, fraction, first, count, out)
    dense_rate(dense, fraction, step, first, count, out)
    next_step(step, error, previous_error)             step to try next, after a success
    shorter_step(step, error)                          step to try after a rejection
    reach(damping)                                     longest step on an oscillation, in radians of its fastest motion:
                                                       within stability and, if undamped or nearly so, accurate;
                                                       damping: half its damping rate over that of the fastest motion
    """

    stages: int
    last: int
    dense: int
    attempt: Callable[..., Any]
    error: Callable[..., Any]
    prepare_dense: Callable[..., Any]
    dense_value: Callable[..., Any]
    dense_rate: Callable[..., Any]
    next_step: Callable[..., Any]
    shorter_step: Callable[..., Any]
    reach: Callable[..., Any]
