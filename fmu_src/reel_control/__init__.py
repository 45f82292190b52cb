"""The control of a reel: it measures a line's length and its rate, and says which tension to give.

It is the linear law of the removal's reel taken out into a unit of its own, so that the two can be coupled, compared
with the law inside, and replaced by somebody else's controller. What is computed stands in `README.md` beside this
file.
"""
