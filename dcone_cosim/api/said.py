"""Values of Python as a scene says them, so that they go the way of `--set` and are checked like any other."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.scenes.text import value_of

EXPECTED = (
    'expected a text with a unit such as "2 mm", a number, true or false, an astropy Quantity, or a list of these'
)


def settings_of(changes: Mapping[str, Any]) -> Iterator[str]:
    """`KEY=VALUE` of each change; a table stands for its keys: {"removal": {"tether.diameter": "2 mm"}}.

    Checked  tests/api/test_scene.py
    """
    for key, value in changes.items():
        if isinstance(value, Mapping):
            yield from settings_of({f"{key}.{inner}": of for inner, of in value.items()})
        else:
            yield f"{key}={told(key, value)}"


def told(key: str, value: Any) -> str:
    """A value as the command line takes it: a text as it stands, unless it would be read as something else."""
    if isinstance(value, str):
        return value if value.strip() == value != "" and value_of(value) == value else json.dumps(value)
    return _toml(key, value)


def _toml(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, str | Path):
        return json.dumps(str(value))
    if hasattr(value, "unit") and hasattr(value, "value"):
        return _toml(key, _of_quantity(value.value, value.unit.to_string()))
    if hasattr(value, "tolist"):
        return _toml(key, value.tolist())
    if isinstance(value, list | tuple):
        return f"[{', '.join(_toml(key, part) for part in value)}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{json.dumps(str(name))} = {_toml(key, part)}' for name, part in value.items())}}}"
    raise InputError(f"{key} = {value!r}: {EXPECTED}")


def _of_quantity(value: Any, unit: str) -> Any:
    """Numbers with their unit as a scene has them, every bit of them."""
    numbers = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(numbers, list):
        return [_of_quantity(number, unit) for number in numbers]
    return f"{numbers!r} {unit}" if unit else numbers
