"""Formulas and constants of orbital motion, and nothing else.

This is the lowest floor: it knows no other package of the project, steps nothing in time, reads no file and has never
heard of FMI. It exists so that each formula is written once: the models compile it into their binaries, the sizing and
the reports call it in the process, and the tests judge both by the closed forms kept here (`hill`, `references`,
`oscillators`). SI units and radians everywhere.

The frame of both models is the orbital frame of `frames`: axis 1 radial outward, 2 along-track, 3 along the orbit
normal. Functions under the `kernel` decorator allocate nothing; they write into `out`, their first argument. Those of
`plain` are wanted without numba as well, and compiled by the module they belong to.
"""
