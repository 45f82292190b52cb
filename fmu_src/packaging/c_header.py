"""The generated C header that tells the shim about one model: slots, bounds, derivatives, faults."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fmu_src.interface import Fault, Interface, Variable
from fmu_src.packaging.dependence import first_slots, partials, rates
from fmu_src.packaging.description import LOG_CATEGORIES

KIND_CODES = {"Real": 1, "Integer": 2, "Boolean": 3}
ACCESS = {"state": 0, "output": 1, "parameter": 2, "input": 3}
SEVERITY = {"error": 0, "discard": 1, "end": 2}
STATE_HEAD = 152
"""What a saved state begins with, before record and work memory [bytes]."""
UNKNOWN = Fault(0, "error", "the kernel gave a fault that is not in its table")


def header(interface: Interface, identifier: str, library: str) -> str:
    """Text of `model.h`, the same whatever the start values are.

    library    key by which the library knows its start values and saved states

    Checked  tests/packaging/test_toy.py
    """
    scalars = list(interface.scalars())
    codes = [str(KIND_CODES[v.kind] + 4 * ACCESS[v.causality]) for _, _, v, _ in scalars]
    rate_table = rates(interface)
    pairs = [(r.slot, r.rate) for r in rate_table]
    moving = [(r.slot, r.rate) for r in rate_table if r.is_input]
    partial_table = [(p.output, p.input, p.slot) for p in partials(interface)]
    lines = [
        "/* generated from the model's table of variables */",
        f"#define DCONE_IDENTIFIER {_string(identifier)}",
        f"#define DCONE_LIBRARY {_string(library)}",
        f"#define DCONE_STATE_HEAD {STATE_HEAD}",
        f"#define DCONE_SLOTS {len(scalars)}",
        f"#define DCONE_ROWS {len(interface.variables)}",
        f"#define DCONE_RATES {len(pairs)}",
        f"#define DCONE_MOVING {len(moving)}",
        f"#define DCONE_PARTIALS {len(partial_table)}",
        f"#define DCONE_TABLES {len(interface.tables)}",
        f"#define DCONE_DIFFERENTIABLE {int(interface.model.differentiable)}",
        "static const unsigned char slot_code[DCONE_SLOTS] = {" + ",".join(codes) + "};",
        *_table("struct row row_table[]", [_row(slot, v) for slot, v in first_slots(interface).values()]),
        *_table("struct rate rate_table[]", [*pairs, (-1, -1)]),
        *_table("struct rate moving_table[]", [*moving, (-1, -1)]),
        *_table("struct partial partial_table[]", [*partial_table, (-1, -1, 0)]),
        *_table("struct fault fault_table[]", [*map(_fault, interface.model.faults), _fault(UNKNOWN)]),
        *_table("char *const category_name[]", [_string(name) for name, _ in LOG_CATEGORIES]),
    ]
    return "\n".join(lines) + "\n"


def _table(declared: str, rows: Sequence[tuple[object, ...]] | Sequence[str]) -> list[str]:
    """A constant array, one row a line."""
    text = [row if isinstance(row, str) else "{" + ", ".join(map(str, row)) + "}" for row in rows]
    return [f"static const {declared} = {{", *(f"    {line}," for line in text), "};"]


def _row(slot: int, v: Variable) -> tuple[object, ...]:
    if len(v.shape) > 2:
        raise ValueError(f"{v.name}: the shim names arrays of at most two indices")
    bounded = v.causality in ("parameter", "input") and v.kind != "Boolean"
    columns = v.shape[1] if len(v.shape) == 2 else 1
    numbers = map(_number, (v.minimum, v.maximum, _typical(v)))
    return slot, v.size, columns, int(bounded), int(v.open_minimum), *numbers, _string(v.name), _string(v.unit)


def _typical(v: Variable) -> float:
    """A size that its values have: its nominal one, else that of its start values, else 1."""
    return v.nominal or max(abs(float(start)) for start in v.starts()) or 1.0


def _fault(fault: Fault) -> tuple[object, ...]:
    return fault.code, SEVERITY[fault.severity], int(fault.names_variable), _string(fault.text)


def _number(value: float) -> str:
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def _string(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
