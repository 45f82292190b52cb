"""Where built FMUs are kept, and whether a file is one of them."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Where built FMUs are kept: `DCONE_CACHE`, or the user's cache folder."""
    given = os.environ.get("DCONE_CACHE")
    if given:
        return Path(given)
    import platformdirs

    return Path(platformdirs.user_cache_dir("dcone"))


def fault(path: Path) -> str:
    """What is wrong with a file of the cache, in words that follow "is"; "" for nothing."""
    from fmu_src.packaging.kept import fault

    return fault(path)


def is_ours(library: Path) -> bool:
    """Whether the binary of an FMU's file was built by this program: it is alone in its folder, and the cache, where
    nobody else puts anything, has the same. What the file says of itself proves nothing: anybody can write that."""
    from fmu_src.packaging.kept import holds

    return list(library.parent.iterdir()) == [library] and holds(cache_folder(), library)
