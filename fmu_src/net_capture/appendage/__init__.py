"""The appendage of a target that swings during the capture, as a scene says it; its kernels are in `hinge`.

laying     its table, from the pieces of a scene
part       the term
"""
