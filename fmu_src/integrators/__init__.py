"""Integrators, each a factory that is given the equations and returns kernels; none knows any model.

`scheme.py` is the seam: what a scheme offers to whoever steps with it. Every scheme is a short file of its own, whose
docstring states formula, order, edge of stability and source. The kernels allocate nothing: stages and dense output
live in memory the caller owns, so that a run can be saved by copying that memory. Only correctly rounded operations are
used (no `pow`), and coefficients are formed from those or written out, so that the steps taken are the same on every
platform.
"""
