"""Which known name a misspelt one was probably meant to be."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(given: str, known: Iterable[str]) -> str | None:
    """The known name closest to the given one, or None when none resembles it."""
    names = list(known)
    found = difflib.get_close_matches(given, names, n=1, cutoff=0.5)
    if found:
        return found[0]
    # a name said with too few or too many of its parts: `altitude` for `orbit.altitude`
    ends = [name for name in names if name.endswith("." + given) or given.endswith("." + name)]
    return min(ends, key=len) if ends else None


def did_you_mean(given: str, known: Iterable[str]) -> str:
    """`; did you mean 'x'?`, or what is known when nothing resembles it and the list is short, or nothing."""
    names = list(dict.fromkeys(known))
    match = nearest(given, names)
    if match is not None:
        return f"; did you mean {match!r}?"
    if 0 < len(names) <= 12:
        return f"; known: {', '.join(sorted(names))}"
    return ""
