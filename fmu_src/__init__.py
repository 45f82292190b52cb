"""The two models, as numba kernels, and what packs them into FMI 2.0 co-simulation units.

Physics is written once. The same kernel runs in the process (`fmu_src.instance`) and, compiled ahead of time, inside
the FMU's binary, where it gives the same bits.

A model is a table of variables (`interface`, its rows made by `rows`) and an entry of kernels; the limits in the table
hold in the shim, and in the kernels through `limits`.
"""
