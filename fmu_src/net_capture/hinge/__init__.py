"""A hinged appendage of the target: a second rigid body that swings about one axis during the capture.

numbers    where each number of its table stands
motion     kernels: how both bodies move, and what an impulse changes
laying     the table, from the pieces of a scene
part       the term
"""
