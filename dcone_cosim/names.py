"""Names that people give: which known one a misspelt one was probably meant to be, and which cannot be told on."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from dcone_cosim.errors import InputError

LONGEST = 200
"""Characters of a name for which others like it are looked for: no name that is known has so many."""


def nearest(given: str, known: Iterable[str]) -> str | None:
    """The known name closest to the given one, or None when none resembles it."""
    if len(given) > LONGEST:
        return None
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


def check_text(name: str) -> None:
    """`InputError` for a name that is not UTF-8, which no file of results could tell."""
    try:
        name.encode("utf-8")
    except UnicodeEncodeError:
        told = name.encode("utf-8", "backslashreplace").decode("utf-8")
        raise InputError(f"{told}: this name is not UTF-8; choose another") from None
