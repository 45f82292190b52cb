"""fmpy's validation of FMUs. Each name of a variable is parsed once in a process: that takes nearly all of the time,
and most FMUs have most of their names in common.

Checked  tests/interop/test_checks.py: a wrong name is found, and found again
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import fmpy.validation
import lark
import pytest

_Lark = lark.Lark
_read: set[tuple[str, str]] = set()
"""Grammars, each with a text that can be parsed by it."""


class _Parser:
    """lark's, for who asks no more than whether a text can be parsed."""

    def __init__(self, grammar: str, **options: Any) -> None:
        self._grammar, self._own = grammar, _Lark(grammar, **options)

    def parse(self, text: str) -> None:
        if (self._grammar, text) not in _read:
            self._own.parse(text)
            _read.add((self._grammar, text))


def _said(validate: Callable[[Any], list[str]], what: Any) -> list[str]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lark, "Lark", _Parser)
        return validate(what)


def validate_fmu(path: Any) -> list[str]:
    """What fmpy finds wrong with an FMU."""
    return _said(fmpy.validation.validate_fmu, str(path))


def validate_model_description(description: Any) -> list[str]:
    """What fmpy finds wrong with a model description that it has read."""
    return _said(fmpy.validation.validate_model_description, description)
