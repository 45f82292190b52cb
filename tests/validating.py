"""fmpy's validation of FMUs. Each name of a variable is parsed once in a process: that takes nearly all of the time,
and most FMUs have most of their names in common. Of names that differ in the digits of their numbers alone, one is.

Checked  tests/interop/test_checks.py: a wrong name is found, and found again, also where it has the digits of a right
         one at other places
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import fmpy.validation
import lark
import pytest

_Lark = lark.Lark
_read: set[tuple[str, str]] = set()
"""Grammars, each with a text that can be parsed by it."""
_NUMBER = re.compile("[1-9][0-9]*")
"""A number without a leading zero, which counts as one of its own."""


class _Parser:
    """lark's, for who asks no more than whether a text can be parsed."""

    def __init__(self, grammar: str, **options: Any) -> None:
        self._grammar, self._own = grammar, _Lark(grammar, **options)

    def parse(self, text: str) -> None:
        kind = _NUMBER.sub(lambda found: "1" if len(found[0]) == 1 else "11", text)
        if (self._grammar, kind) not in _read:
            self._own.parse(text)
            _read.add((self._grammar, kind))


def said(validate: Callable[[Any], list[str]], what: Any) -> list[str]:
    """What one of fmpy's functions finds wrong."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lark, "Lark", _Parser)
        return validate(what)


def validate_fmu(path: Any) -> list[str]:
    """What fmpy finds wrong with an FMU."""
    return said(fmpy.validation.validate_fmu, str(path))


def validate_model_description(description: Any) -> list[str]:
    """What fmpy finds wrong with a model description that it has read."""
    return said(fmpy.validation.validate_model_description, description)
