"""A hinged appendage of the target: a second rigid body that swings about one axis during the capture.

numbers    where each number of its table stands
matrix     the matrix of the masses, and the rates that follow from the momenta
motion     kernels: how both bodies move; the equations
meeting    kernels: what an impulse of contact changes
"""
