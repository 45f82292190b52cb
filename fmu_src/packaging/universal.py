"""One macOS file from several: a table of contents before them, each part left as it is."""

from __future__ import annotations

import struct
from collections.abc import Sequence

MAGIC = 0xCAFEBABE
"""Of a universal file; it and its table are big-endian on every machine."""
PART_MAGIC = 0xFEEDFACF
"""Of a 64-bit little-endian Mach-O file."""
ALIGNMENT = 14
"""Each part begins at a multiple of two to this power [bytes]: a page of an arm64 Mac, and four of an x86-64 one."""


def join(parts: Sequence[bytes]) -> bytes:
    """A universal Mach-O file of 64-bit Mach-O files for different processors; ValueError if one is none.

    Source   Apple, <mach-o/fat.h>: two words of header, then five for each part
    Checked  tests/packaging/test_platforms.py
    """
    head = [struct.pack(">II", MAGIC, len(parts))]
    body: list[bytes] = []
    end = 8 + 20 * len(parts)
    for part in parts:
        magic, kind, subtype = struct.unpack_from("<III", part.ljust(12, b"\0"))
        if magic != PART_MAGIC:
            raise ValueError("a part of a universal binary is no 64-bit Mach-O file")
        begin = end + -end % (1 << ALIGNMENT)
        head.append(struct.pack(">IIIII", kind, subtype, begin, len(part), ALIGNMENT))
        body += [b"\0" * (begin - end), part]
        end = begin + len(part)
    return b"".join(head + body)
