"""The file of start values that an FMU carries in its resources, from which its library takes them.

    8   DCONEVAL
    8   check word of all that follows it
   48   key of the library it is for, filled up with zeros
   48   GUID of the FMU, likewise
    8   version of this layout
    8   number of slots
  8 x   a slot of the record each: a Real as a double, an Integer or Boolean as a whole number

Little-endian on every platform. What reads it: fmi2_start.h.
"""

from __future__ import annotations

import struct

from fmu_src.interface import Interface

PATH = "resources/start-values.bin"
MAGIC, VERSION = b"DCONEVAL", 1
BODY = struct.Struct("<48s48sqq")
KEY = slice(16, 64)
"""Where the library's key stands."""
MASK = 2**64 - 1


def slots(interface: Interface) -> bytes:
    """The start value of every slot."""
    rows = [(v.kind == "Real", start) for _, _, v, start in interface.scalars()]
    return b"".join(struct.pack("<d", float(value)) if real else struct.pack("<q", int(value)) for real, value in rows)


def content(interface: Interface, library: str, guid: str) -> bytes:
    """The file.

    Checked  tests/packaging/test_start_values.py
    """
    values = slots(interface)
    body = BODY.pack(library.encode(), guid.encode(), VERSION, len(values) // 8) + values
    return MAGIC + struct.pack("<Q", check_word(body)) + body


def check_word(data: bytes) -> int:
    """FNV-1a with words of eight bytes for bytes, and the upper half folded in after each."""
    value = 0xCBF29CE484222325
    for (word,) in struct.iter_unpack("<Q", data):
        value = (value ^ word) * 0x100000001B3 & MASK
        value ^= value >> 32
    return value


def library_of(data: bytes) -> str:
    """Key of the library that a file is for, as far as it has one."""
    return data[KEY].rstrip(b"\0").decode("ascii", "replace")
