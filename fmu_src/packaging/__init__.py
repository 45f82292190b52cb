"""From kernels to an FMU that any tool can run: LLVM IR, native code, model description, archive.

numba gives the IR in a child process (its code generation is fixed by the environment it is started in), clang from the
`ziglang` wheel makes native code of it beside one C shim that knows no model, so a machine without a compiler suffices.
Start values are not compiled: they stand in a file of the archive, so FMUs of many scenes share one library.
"""
