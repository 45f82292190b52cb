"""What an FMU is called in the cache, and whether a file there is what its name says."""

from __future__ import annotations

import re
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path

from fmu_src.packaging import start_values
from fmu_src.packaging.platforms import KNOWN, Platform

KEY = 16
"""Digits of the key that stand in the file name."""
NAME = re.compile(rf"(?P<model>\w+)-(?P<key>[0-9a-f]{{{KEY}}})-(?P<platform>[\w-]+)\.fmu")
DAMAGED = "damaged"
ANOTHERS = "another's, whose key is not the one in its name"
UNKNOWN = "of a name that this program gives to no FMU"


def file_name(model: str, key: str, platform: Platform) -> str:
    return f"{model}-{key[:KEY]}-{platform.name}.fmu"


def as_guid(key: str) -> str:
    """A hash in the form of a GUID."""
    return "{" + f"{key[:8]}-{key[8:12]}-{key[12:16]}-{key[16:20]}-{key[20:32]}" + "}"


def fault(path: Path) -> str:
    """What is wrong with a cached FMU, in words that follow "is"; "" for a file that is whole and what its name says.

    Whole: every entry is there with the checksum it was written with. What its name says: its start values are for a
    library of that key, and it has the model's library for the platform.

    Checked  tests/packaging/test_kept.py
    """
    named = NAME.fullmatch(path.name)
    platform = KNOWN.get(named["platform"]) if named else None
    if named is None or platform is None:
        return UNKNOWN
    if not path.is_file():
        return "no file"
    try:
        with zipfile.ZipFile(path) as archive:
            broken = archive.testzip()
            values = archive.read(start_values.PATH)
            archive.getinfo("modelDescription.xml")
            for place in platform.places:
                archive.getinfo(f"binaries/{place.folder}/{named['model']}{platform.suffix}")
    except KeyError:
        return ANOTHERS
    except Exception:  # zipfile answers damage with a dozen kinds of error, those of zlib and struct among them
        return DAMAGED
    if broken is not None:
        return DAMAGED
    key = start_values.library_of(values).strip("{}").replace("-", "")
    return "" if key.startswith(named["key"]) else ANOTHERS


def holds(cache: Path, library: Path) -> bool:
    """Whether an FMU of the cache has this library, byte for byte: then it was built here, whatever its file says of
    itself, and whatever values stand beside it.

    Checked  tests/packaging/test_kept.py
    """
    content = library.read_bytes()
    alike = len(content), zlib.crc32(content)
    for path in cache.glob("*.fmu"):
        with suppress(Exception), zipfile.ZipFile(path) as archive:  # what is damaged vouches for nothing
            for entry in archive.infolist():
                about = entry.file_size, entry.CRC
                if entry.filename.startswith("binaries/") and about == alike and archive.read(entry) == content:
                    return True
    return False
