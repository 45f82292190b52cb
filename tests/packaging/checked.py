"""Programs of Python whose kernels are compiled with a check of every index."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
STRICT = """
import sys
from pathlib import Path

from numba.core import config, types
from numba.np import arrayobj

from orbital import keeping

def as_it_is(context, builder, kind, index, size):
    return context.cast(builder, index, kind, types.intp if kind.signed else types.uintp)

arrayobj.fix_integer_index = as_it_is
config.OPT, config.LOOP_VECTORIZE, config.SLP_VECTORIZE = config._OptLevel(1), 0, 0
keeping.keep_in(Path(sys.argv.pop(1)))
"""
"""Has an index below zero, which numba counts from the end, stay as it is: no kernel of ours means the end by it.
Optimised little, which takes less time than it saves."""


def run(kept: Path, code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """What a program did with these arguments; an index beyond its array ends it with "out of bounds".

    kept    folder of the kernels that such programs have in common
    """
    return subprocess.run(
        [sys.executable, "-c", STRICT + code, str(kept), *arguments],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={"NUMBA_BOUNDSCHECK": "1", "PYTHONPATH": str(ROOT)},
    )
