"""A tiny model with every kind of row, whose kernel is C: it tries the shim alone, and is built in a few seconds."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

from fmu_src.interface import Fault, Group, Interface, Model, Term, Variable
from fmu_src.packaging import c_header, link, platforms, start_values, tools

GUID, KEY = "{toy}", "{library of the toy}"
"""Of the whole, and of its library."""
ENDED, REFUSED, BROKE = 1, 2, 3
MODEL = Model(
    name="toy",
    summary="A cart is pushed.",
    base=(
        Variable("gain", "1", "parameter", "of y on push", 3.0, minimum=0.0, open_minimum=True, maximum=100.0),
        Variable("end", "s", "parameter", "when it ends by itself", 1e9),
        Variable("room", "1", "parameter", "numbers of work memory", 4, "Integer", minimum=0, maximum=10**6),
        Variable("push", "m/s", "input", "speed", minimum=-10.0, maximum=10.0, nominal=2.0, rate="push_rate"),
        Variable("push_rate", "m/s2", "state", "of push"),
        Variable("pull", "m", "input", "adds to y, and is held"),
        Variable("go", "1", "input", "turns the sign of the sum", False, "Boolean"),
        Variable("x", "m", "output", "way", rate="x_rate"),
        Variable("x_rate", "m/s", "state", "of x"),
        Variable(
            "y", "m", "output", "way and more", rate="y_rate", partials=(("push", "y_by_push"), ("pull", "y_by_pull"))
        ),
        Variable("y_rate", "m/s", "state", "of y"),
        Variable("y_by_push", "s", "state", "derivative"),
        Variable("y_by_pull", "1", "state", "derivative"),
        Variable("lit", "1", "output", "pull is positive", kind="Boolean", partials=(("pull", "jump"),)),
        Variable("jump", "1", "state", "derivative of what jumps"),
        Variable("steps", "1", "output", "counted", kind="Integer"),
        Variable("grid[#].at[#]", "m", "output", "multiples of x", shape=(3, 2)),
        Variable("sum", "1", "output", "of the work memory"),
    ),
    groups={"colour": Group({"red": Term("paints it")}, optional=True)},
    faults=(
        Fault(ENDED, "end", "the cart has arrived"),
        Fault(REFUSED, "discard", "the cart is stuck"),
        Fault(BROKE, "error", "the cart broke under", names_variable=True),
    ),
    module="none",
    stop_time=10.0,
    macro_step=0.5,
    differentiable=True,
)
INTERFACE = MODEL.interface({})

HOST = platforms.host().places[0].targets
COMPILER = [sys.executable, "-m", "ziglang", "cc", "-target", HOST[0].triple]
"""Whoever builds FMUs has it; the target is theirs, whose C library is then at hand."""


@dataclass(frozen=True)
class Toy:
    """The built library and the value references of its variables."""

    library: Path
    references: dict[str, int]
    guid: str = GUID


def build(folder: Path, key: str = KEY) -> Toy:
    """Compile and link the toy as if it were a model's, in the folder of its FMU, unpacked."""
    place = folder / "binaries" / platforms.host().places[0].folder
    place.mkdir(parents=True)
    furnish(folder, key=key)
    slot, lines = 0, []
    for v in INTERFACE.variables:
        lines.append(f"#define {v.name.partition('[')[0].upper()} {slot}")
        slot += v.size
    (folder / "slots.h").write_text("\n".join(lines) + "\n")
    (folder / "model.h").write_text(c_header.header(INTERFACE, "toy", key))
    ir = folder / "model.ll"
    flags = ["-O1", "-S", "-emit-llvm", "-ffp-contract=off", "-I", folder]
    tools.run("clang", [*COMPILER, *map(str, flags), str(Path(__file__).parent / "kernel.c"), "-o", str(ir)])
    ir.write_text(re.sub(r'"target-(cpu|features)"="[^"]*" ?', "", ir.read_text()))
    library = place / "toy.so"
    link.link(ir, folder / "model.h", library, HOST)
    return Toy(library, INTERFACE.references)


def furnish(folder: Path, interface: Interface = INTERFACE, key: str = KEY, guid: str = GUID) -> Path:
    """Write a file of start values into the folder of an FMU; where it is."""
    path = folder / start_values.PATH
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(start_values.content(interface, key, guid))
    return path
