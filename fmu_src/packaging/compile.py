"""LLVM IR of a model's entry, free of Python: `python -m fmu_src.packaging.compile MODULE TERMS OUT KEPT`.

Runs as a child process, since what numba emits is settled by the environment it is imported in: a generic processor
and no vectoriser of its own, so that clang chooses both for each target. All but the entry becomes internal, what is
not reached is dropped, and what ties the text to this host (target, numba's own globals) is struck out.
"""

from __future__ import annotations

import gc
import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fmu_src.interface import Model
from fmu_src.packaging import tools

ENTRY = "dcone_entry"
ENVIRONMENT = {
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_LOOP_VECTORIZE": "0",
    "NUMBA_SLP_VECTORIZE": "0",
    "NUMBA_OPT": "1",
    "NUMBA_DISABLE_JIT": "0",
    "NUMBA_DEBUGINFO": "0",
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",  # every overload that does not fit is an error, set in bold
    "PYTHONHASHSEED": "0",
}


def emit(model: Model, terms: Mapping[str, str], path: Path, kept: Path) -> None:
    """Write the IR of one model with its terms to `path`, in a child process.

    kept    folder of the kernels that other choices of terms have in common with this one, see `orbital.keeping`
    """
    what = [model.module, json.dumps(dict(terms)), str(path), str(kept)]
    command = [sys.executable, "-m", "fmu_src.packaging.compile", *what]
    tools.run(f"compiling the kernels of {model.name}", command, {**os.environ, **ENVIRONMENT})


def _keep_loops_whole(llvm: Any) -> None:
    """Have numba's passes leave loops as they are: once unrolled, clang no longer sees what to vectorise."""
    make_options = llvm.create_pipeline_tuning_options

    def options_without_unrolling(speed_level: int = 2) -> Any:
        options = make_options(speed_level)
        options.loop_unrolling = False
        return options

    llvm.create_pipeline_tuning_options = options_without_unrolling


def _lower(module: str, terms: Mapping[str, str], kept: Path) -> str:
    import importlib

    import llvmlite.binding as llvm

    from orbital import keeping

    _keep_loops_whole(llvm)
    keeping.keep_in(kept)
    name, ir = importlib.import_module(module).make_entry(dict(terms)).module_text()
    whole = llvm.parse_assembly(ir)
    for function in whole.functions:
        if not function.is_declaration and function.name != name:
            function.linkage = "internal"
    whole.get_function(name).visibility = "hidden"
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(whole, builder)
    host = re.compile(r'target (datalayout|triple)|source_filename|@"?_ZN08NumbaEnv')
    text = "\n".join(line for line in str(whole).splitlines() if not host.match(line))
    text = text.replace(f'@"{name}"', f"@{ENTRY}").replace(f"@{name}", f"@{ENTRY}")
    foreign = sorted(set(re.findall(r"declare [^@]*@\"?((?:Py|_Py|NRT_|numba_|Numba)[\w.]*)", text)))
    if foreign:
        raise tools.BuildError(f"the kernels of {module} still call Python: {', '.join(foreign)}")
    if "inttoptr (i64" in text:
        raise tools.BuildError(f"the kernels of {module} hold an address of this process")
    return text + "\n"


if __name__ == "__main__":
    gc.disable()  # nearly all objects live to the end: to look through them takes a tenth of the time
    _, _module, _terms, _out, _kept = sys.argv
    Path(_out).write_text(_lower(_module, json.loads(_terms), Path(_kept)))
