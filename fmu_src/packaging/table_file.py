"""The file of tables that an FMU carries in its resources, where a part of it brings any.

    8   DCONETAB
    8   check word of all that follows it
    8   identity of the block, which the start values name too
    8   version of this layout
    8   number of tables
    8   words of the block
   16   zeros
  8 x   the block, see fmu_src/tables.py

Little-endian on every platform. What reads it: fmi2_tables.h.
"""

from __future__ import annotations

import struct

from fmu_src.interface import Interface
from fmu_src.packaging.start_values import check_word

PATH = "resources/tables.bin"
MAGIC, VERSION = b"DCONETAB", 1
HEAD = struct.Struct("<qqqq16x")


def content(interface: Interface) -> bytes:
    """The file; ValueError if the interface has not been given its tables.

    Checked  tests/packaging/test_tables.py
    """
    words = interface.table_block
    body = HEAD.pack(interface.tables_identity, VERSION, len(interface.tables), len(words)) + words.tobytes()
    return MAGIC + struct.pack("<Q", check_word(body)) + body
