"""Removal of debris on a tether: a chaser with a thruster and a reel tows a captured target down.

It is a model of its own, apart from the capture, because its scales are others: hours and kilometres outside a snap,
milliseconds and micrometres inside. The equilibrium stretch of a 12 m tether is 6.6 micrometres on an orbit of 7e6 m,
so the pair is carried as one centre of mass and one relative vector, and every switch between slack and taut is located
to rounding. What is computed, and what is left out, stands in `README.md` beside this file.
"""
